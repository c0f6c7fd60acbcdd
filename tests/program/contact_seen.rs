//! What shows the contact of a run: animations, pictures of an instant, the masses as arrays.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{Table, asperity, assert_names, browser, python, root, run, scratch};

/// A scene of some masses that stick and slip, with friction and a material.
fn scene() -> PathBuf {
    root().join("tests/reference/rough-coulomb.toml")
}

fn failure(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(!output.status.success(), "{command:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn simulate(folder: &Path, options: &[&str]) -> Command {
    let mut command = asperity();
    command.current_dir(folder).arg("simulate").arg(scene()).args(["-o", "out.csv"]).args(options);
    command
}

/// In the page before anything else: what fails is kept.
const LISTEN: &str = "<script>
    const failures = [];
    addEventListener('error', (event) => failures.push(event.message));
    console.error = console.warn = (text) => failures.push(text);
</script>";

/// At its end: what a user does, and what is seen then.
const USE: &str = "<script>
    const seen = { failures };
    const pixels = () => {
        const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
        return data.reduce((sum, value) => (sum * 31 + value) | 0, 7);
    };
    const key = (key, more) => document.dispatchEvent(new KeyboardEvent('keydown', { key, ...more }));
    const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
    const reds = new Set();
    for (let i = 0; i < data.length; i += 4) reds.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    seen.colours = reds.size;
    seen.last = Number(slider.max);
    const pictures = [pixels()];
    slider.value = seen.last;
    slider.dispatchEvent(new Event('input'));
    pictures.push(pixels());
    seen.slid = shown;
    key('ArrowLeft');
    seen.left = shown;
    pictures.push(pixels());
    key('Home');
    key('ArrowRight', { shiftKey: true });
    seen.right = shown;
    seen.pictures = new Set(pictures).size;
    speed.value = 3;
    key(' ');
    seen.button = button.textContent;
    const watch = () => {
        // A slow machine takes its time to the first frames.
        if (shown <= seen.right) return setTimeout(watch, 100);
        seen.played = shown;
        // A slow machine is at the end by now, where it stops by itself.
        if (button.textContent === 'Pause') key(' ');
        seen.paused = button.textContent;
        seen.text = output.textContent;
        const said = document.createElement('pre');
        said.textContent = `SEEN${JSON.stringify(seen)}SEEN`;
        document.body.append(said);
    };
    setTimeout(watch, 1500);
</script>";

#[test]
fn an_animation_opens_in_a_browser_and_is_moved_by_slider_keys_and_clock() {
    let folder = scratch("contact-page");
    run(&mut simulate(&folder, &["--animate", "out.html", "--rows", "20"]));
    let page = fs::read_to_string(folder.join("out.html")).unwrap();
    assert!(!page.contains("http") && !page.contains("{{"), "all of the page is in its file");
    let used = page.replacen("<head>", &format!("<head>{LISTEN}"), 1).replacen("</body>", &format!("{USE}</body>"), 1);
    let used_page = folder.join("used.html");
    fs::write(&used_page, used).unwrap();

    let mut command = Command::new(browser());
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1200,800", "--dump-dom"]);
    command.arg(format!("--user-data-dir={}", folder.join("profile").display())).arg("--virtual-time-budget=20000");
    let dom = run(command.arg(format!("file://{}", used_page.display())));
    let said = dom.split("SEEN").nth(dom.split("SEEN").count() - 2).expect("the page says what it saw");
    let seen: serde_json::Value = serde_json::from_str(&said.replace("&gt;", ">").replace("&amp;", "&")).expect(said);
    let number = |name: &str| seen[name].as_u64().unwrap_or_else(|| panic!("{name}: {seen}"));

    assert_eq!(seen["failures"].as_array().unwrap().len(), 0, "{seen}");
    // Ground, road, rubber, text, axes, and the edges between them.
    assert!(number("colours") > 10, "{seen}");
    let last = number("last");
    let rows = Table::read(&folder.join("out.csv")).column("time").len() as u64;
    assert_eq!(last, rows - 1);
    assert_eq!(
        [number("slid"), number("left"), number("right"), number("pictures")],
        [last, last - 1, 10, 3],
        "{seen}"
    );
    assert_eq!((seen["button"].as_str(), seen["paused"].as_str()), (Some("Pause"), Some("Play")), "{seen}");
    assert!(number("played") > number("right"), "{seen}");
    assert!(seen["text"].as_str().unwrap().contains("masses"), "{seen}");
}

/// As the columns of the result file, to the last bit.
#[test]
fn the_masses_are_arrays_that_numpy_reads() {
    let folder = scratch("contact-arrays");
    run(&mut simulate(
        &folder,
        &["--elements", "out.npz", "--rows", "7", "--set", "fmu.outputs=['forces','elements']"],
    ));
    let script = "
import csv, numpy
arrays = numpy.load('out.npz')
names, *rows = csv.reader(open('out.csv'))
columns = dict(zip(names, numpy.array(rows, dtype=float).T))
masses = len(arrays['rest_x'])
for name in ('time', 'u', 'w', 'F_x', 'F_z'):
    assert (arrays[name] == columns[name]).all(), name
for name in ('x', 'z', 'F_N', 'F_T', 'mode'):
    expected = numpy.array([columns[f'element[{i + 1}].{name}'] for i in range(masses)]).T
    assert arrays[name].shape == expected.shape and (arrays[name] == expected).all(), name
assert arrays['mode'].dtype == numpy.int8 and len(arrays['profile_x']) == len(arrays['profile_z']) > 1
assert abs(arrays['F_N']).max() > 0
print(masses)
";
    let masses = run(Command::new(python()).current_dir(&folder).args(["-c", script]));
    assert!(masses.trim().parse::<usize>().unwrap() > 1);
}

#[test]
fn a_contact_is_drawn_at_its_time_which_is_a_row() {
    let folder = scratch("contact-moment");
    run(&mut simulate(&folder, &["--rows", "4"]));
    let before = Table::read(&folder.join("out.csv"));
    let end = *before.column("time").last().unwrap();
    let time = 0.77 * end;
    let options = [format!("{time}=out.svg"), format!("{end}=out.png")];
    run(&mut simulate(&folder, &["--rows", "4", "--contact", &options[0], "--contact", &options[1]]));
    let svg = fs::read_to_string(folder.join("out.svg")).unwrap();
    assert!(["sticks", "slips", "free", "x in "].iter().all(|text| svg.contains(text)));
    assert!(fs::read(folder.join("out.png")).unwrap().starts_with(b"\x89PNG"));
    // One row more, the others as they were.
    let with = Table::read(&folder.join("out.csv"));
    let times = with.column("time");
    let extra = times.iter().position(|&row| (row - time).abs() <= 1e-12 * end).expect("a row at the time");
    assert_eq!(times.len(), before.column("time").len() + 1);
    for name in ["time", "F_x", "F_z"] {
        let mut column = with.column(name);
        column.remove(extra);
        assert_eq!(column, before.column(name), "{name}");
    }
    let late = format!("{}=late.png", 1.1 * end);
    assert_names(failure(&mut simulate(&folder, &["--contact", &late])), "t = ");
    for (wrong, expected) in
        [("1e-3", "expected TIME=OUT.svg"), ("1e-3=a.pdf", "ends in .svg or .png"), ("x=a.png", "expected a time")]
    {
        assert!(failure(&mut simulate(&folder, &["--contact", wrong])).contains(expected), "{wrong}");
    }
}

#[test]
fn an_animation_may_be_a_row_of_pictures() {
    let folder = scratch("contact-film");
    run(&mut simulate(&folder, &["--animate", "row.png", "--rows", "2"]));
    let rows = Table::read(&folder.join("out.csv")).column("time").len();
    let pictures = (1..=rows).map(|i| fs::read(folder.join(format!("row-{i:03}.png"))).unwrap());
    let pictures: std::collections::BTreeSet<_> = pictures.collect();
    assert!(pictures.len() > 1 && !folder.join(format!("row-{:03}.png", rows + 1)).exists());
}

/// Without -o the rows are where the program runs, under the scene's name.
#[test]
fn a_result_file_has_a_name_by_default() {
    let folder = scratch("contact-default");
    run(asperity().current_dir(&folder).arg("simulate").arg(scene()).args(["--rows", "1"]));
    assert!(Table::read(&folder.join("rough-coulomb.csv")).column("time").len() > 1);
}
