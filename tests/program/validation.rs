//! The validation page: its quick comparisons agree, and it says what comes out; the README's table is of it.

use crate::common::root;
use crate::validation::{ALL, page};

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap()
}

fn cells(line: &str) -> Vec<&str> {
    line.split('|').map(str::trim).collect()
}

/// The number that a cell begins with, and what follows it.
fn number(cell: &str) -> Option<(f64, &str)> {
    let (number, unit) = cell.split_once(' ').unwrap_or((cell, ""));
    Some((number.parse().ok()?, unit))
}

/// Whether cells say the same to the digits printed; roundings below 1e-6 differ from processor to processor.
fn are_same(made: &str, page: &str) -> bool {
    let (Some((made, unit)), Some((page, other))) = (number(made), number(page)) else { return made == page };
    unit == other
        && ((made - page).abs() <= 1e-4 * page.abs() || (unit.is_empty() && made.abs().max(page.abs()) < 1e-6))
}

#[test]
fn the_page_says_what_comes_out_and_it_agrees() {
    let text = read("docs/validation.md");
    for entry in ALL.iter().filter(|entry| entry.quick) {
        let comparison = (entry.compare)();
        for row in &comparison.rows {
            assert!(row.agrees(), "{}, {}: {} for {}", entry.title, row.quantity, row.found, row.expected);
        }
        let made = page::section(entry, &comparison);
        let (_, rest) = text.split_once(&format!("\n## {}\n", entry.title)).expect("a section of the page");
        let of_page = rest.split("\n## ").next().unwrap();
        let made = made.split_once('\n').unwrap().1;
        assert_eq!(made.lines().count(), of_page.lines().count(), "{}: {made}", entry.title);
        for (made, of_page) in made.lines().zip(of_page.lines()) {
            let (found, said) = (cells(made), cells(of_page));
            let same = found.len() == said.len() && found.iter().zip(&said).all(|(a, b)| are_same(a, b));
            assert!(same, "{}: the page has\n{of_page}\nand what comes out is\n{made}", entry.title);
        }
    }
}

/// A picture for each that the page shows, and none else.
#[test]
fn its_pictures_are_there() {
    let text = read("docs/validation.md");
    let mut shown: Vec<&str> =
        text.split("](validation/").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    shown.sort_unstable();
    let folder = std::fs::read_dir(root().join("docs/validation")).unwrap();
    let mut files: Vec<String> = folder.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    files.sort_unstable();
    assert_eq!(shown, files);
}

#[test]
fn the_readme_has_five_rows_of_it() {
    let (readme, text) = (read("README.md"), read("docs/validation.md"));
    let overview: Vec<Vec<&str>> = text.lines().filter(|line| line.starts_with("| [")).map(cells).collect();
    let table = page::table(&readme).expect("the README has its marks");
    let rows: Vec<Vec<&str>> = table.lines().skip(2).map(cells).collect();
    assert_eq!(rows.len(), 5);
    for row in rows {
        let title = format!("[{}](", row[1]);
        let of_page = overview.iter().find(|line| line[1].starts_with(&title)).expect("a row of the page");
        assert_eq!(row[2..5], of_page[2..5]);
    }
}
