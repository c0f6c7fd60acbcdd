//! Workbooks of tables: what their sheets hold is what a text of the same rows holds.

use std::fs;
use std::io::{Cursor, Write as _};

use zip::write::{SimpleFileOptions, ZipWriter};

use crate::common::{asperity, assert_names, run, scratch};
use asperity::scene::Scene;

/// A workbook with sheets of these names and rows, its fields parted by commas: numbers as such, words as text.
fn xlsx(sheets: &[(&str, &str)]) -> Vec<u8> {
    const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let each = |text: fn(usize, &str) -> String| {
        sheets.iter().enumerate().map(|(i, (name, _))| text(i + 1, name)).collect::<String>()
    };
    let relations =
        each(|i, _| format!("<Relationship Id='r{i}' Type='{OFFICE}/worksheet' Target='worksheets/sheet{i}.xml'/>"));
    let listed = each(|i, name| format!("<sheet name='{name}' sheetId='{i}' r:id='r{i}'/>"));
    let cell = |(column, field): (usize, &str)| {
        let letter = char::from(b'A' + u8::try_from(column).unwrap());
        match field.parse::<f64>() {
            Ok(_) => format!("<c r='{letter}{{row}}'><v>{field}</v></c>"),
            Err(_) => format!("<c r='{letter}{{row}}' t='inlineStr'><is><t>{field}</t></is></c>"),
        }
    };
    let row = |(i, line): (usize, &str)| {
        let cells: String = line.split(',').enumerate().map(cell).collect();
        format!("<row r='{0}'>{1}</row>", i + 1, cells.replace("{row}", &(i + 1).to_string()))
    };
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let mut part = |name: &str, content: String| {
        writer.start_file(name, SimpleFileOptions::default()).unwrap();
        writer.write_all(content.as_bytes()).unwrap();
    };
    part(
        "_rels/.rels",
        format!(
            "<Relationships xmlns='{PACKAGE}'><Relationship Id='r1' Type='{OFFICE}/officeDocument' \
             Target='xl/workbook.xml'/></Relationships>"
        ),
    );
    part("xl/_rels/workbook.xml.rels", format!("<Relationships xmlns='{PACKAGE}'>{relations}</Relationships>"));
    part(
        "xl/workbook.xml",
        format!("<workbook xmlns='{MAIN}' xmlns:r='{OFFICE}'><sheets>{listed}</sheets></workbook>"),
    );
    for (i, (_, rows)) in sheets.iter().enumerate() {
        let rows: String = rows.lines().enumerate().map(row).collect();
        let sheet = format!("<worksheet xmlns='{MAIN}'><sheetData>{rows}</sheetData></worksheet>");
        part(&format!("xl/worksheets/sheet{}.xml", i + 1), sheet);
    }
    writer.finish().unwrap().into_inner()
}

/// The second sheet holds the motion; an FMU carries it as text, which is the same scene without the workbook.
#[test]
fn a_motion_in_a_workbook_is_that_of_its_text() {
    let folder = scratch("workbook-motion");
    let motion = "time [ms],u [mm],w [mm]\n0,0,0\n1.125,0.5,-0.02\n2.375,1.5,-0.02\n";
    let rest = "name = 'rig'\nlayer.masses = 3\nlayer.spacing = 1e-4\nlayer.mass = 1e-6\n\
                layer.vertical = { stiffness = 1e3, damping = 1e-2 }\n\
                layer.horizontal = { stiffness = 1e3, damping = 1e-2 }\n\
                surface = { kind = 'flat' }\nfriction = { coulomb = 0.5 }\n";
    let of_file = |file: &str| format!("{rest}[[excitation]]\nfile = '{file}'\n");
    fs::write(folder.join("rig.csv"), motion).unwrap();
    fs::write(folder.join("rig.xlsx"), xlsx(&[("about", "a rig,of ours"), ("log", motion)])).unwrap();
    let result = |name: &str, file: &str| {
        let (scene, output) = (folder.join(format!("{name}.toml")), folder.join(format!("{name}.out.csv")));
        fs::write(&scene, of_file(file)).unwrap();
        run(asperity().arg("simulate").arg(&scene).arg("-o").arg(&output));
        fs::read_to_string(output).unwrap()
    };
    assert_eq!(result("book", "rig.xlsx"), result("text", "rig.csv"));
    let book = asperity_study::files::load_scene(&folder.join("book.toml"), &[]).unwrap();
    assert!(book.notes.iter().any(|note| note.text.starts_with("rig.xlsx: sheet log: ")), "{:?}", book.notes);
    let [carried] = &book.files[..] else { unreachable!() };
    fs::write(folder.join(&carried.carried_name), carried.carried().unwrap()).unwrap();
    fs::remove_file(folder.join("rig.xlsx")).unwrap();
    assert_eq!(Scene::load(&folder.join("book.toml")).unwrap().excitation, book.excitation);
}

/// One sheet an isotherm, by their names; another one is left out. The same as rows with a column of temperatures.
#[test]
fn sheets_named_by_temperature_are_one_set_of_data() {
    let folder = scratch("workbook-isotherms");
    let rows = |factor: f64| {
        let row = |i: i32| {
            let [frequency, storage, loss] = [f64::from(i), factor * f64::from(2 + i), factor * 0.3 * f64::from(2 + i)];
            format!("{frequency},{storage},{loss}")
        };
        format!("f [Hz],E' [MPa],E'' [MPa]\n{}", (1..=6).map(row).collect::<Vec<_>>().join("\n"))
    };
    let (book, output) = (folder.join("dma.xlsx"), folder.join("out.csv"));
    let fit = |sheets: &[(&str, &str)]| {
        fs::write(&book, xlsx(sheets)).unwrap();
        let options = ["--wlf", "7,120,293.15", "--fit-error", "0.4"];
        let result = asperity().arg("fit").arg(&book).arg("-o").arg(&output).args(options).output().unwrap();
        (String::from_utf8(result.stdout).unwrap(), String::from_utf8(result.stderr).unwrap())
    };
    let [cold, warm] = [rows(1.5), rows(1.0)];
    let (printed, notes) = fit(&[("-10 °C", &cold), ("T=25", &warm), ("Notes", "by hand")]);
    assert!(printed.contains("12 rows") && printed.contains("263.15 to 298.15 K"), "{printed}{notes}");
    assert_names(&notes, "-10 °C at 263.15 K | T=25 at 298.15 K");
    let (_, refusal) = fit(&[("a", &cold), ("b", &warm)]);
    assert!(refusal.contains("in sheets named by their temperatures"), "{refusal}");
    let (_, refusal) = fit(&[("-10 °C", &cold), ("25 °C", "f [Hz],E' [MPa]\n1,2\n")]);
    assert_names(&refusal, "sheet 25 °C | loss");
}
