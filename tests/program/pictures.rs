//! The pictures of the documentation: all are made by scenes/pictures, and none is older than what makes it. The links
//! of the pages lead somewhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{root, run, scratch};

/// The files below a folder of the repository.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// The pages and pictures of the documentation, relative to the repository.
fn documents() -> BTreeSet<String> {
    let all = ["docs", "scenes", "examples", "modelDescription"].map(|folder| files(&root().join(folder))).concat();
    let top = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name));
    let relative = |path: PathBuf| path.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
    all.into_iter().chain(top).map(relative).collect()
}

fn is_picture(path: &str) -> bool {
    path.ends_with(".svg") || path.ends_with(".png")
}

/// What `scenes/pictures --list` says: whether a picture is quickly made, and its path.
fn listed() -> Vec<(bool, String)> {
    let text = run(Command::new("bash").arg(root().join("scenes/pictures")).arg("--list"));
    let line = |line: &str| {
        let mut words = line.split(' ');
        (words.next() == Some("quick"), words.next().unwrap().to_owned())
    };
    text.lines().map(line).collect()
}

#[test]
fn every_picture_is_made_by_the_script() {
    // Those of the validation page are made with it.
    let is_made = |path: &String| is_picture(path) && !path.starts_with("docs/validation/");
    let committed: BTreeSet<String> = documents().into_iter().filter(is_made).collect();
    let made: BTreeSet<String> = listed().into_iter().map(|(_, path)| path).collect();
    assert_eq!(made, committed);
}

/// Rounding of another machine moves a point by the last digit at most, a tenth of a pixel.
const LAST_DIGIT: f64 = 0.11;

#[test]
fn no_picture_is_older_than_what_makes_it() {
    let folder = scratch("pictures");
    let script = root().join("scenes/pictures");
    run(Command::new("bash").arg(script).arg(&folder).env("ASPERITY", env!("CARGO_BIN_EXE_asperity")));
    for (_, picture) in listed().into_iter().filter(|(quick, _)| *quick) {
        let [made, committed] = [&folder, root()].map(|place| fs::read_to_string(place.join(&picture)).unwrap());
        let ((made_words, made), (words, numbers)) = (parts(&made), parts(&committed));
        let again = "`scenes/pictures FOLDER` makes it anew";
        assert!(made_words == words && made.len() == numbers.len(), "{picture}: other elements; {again}");
        for (made, number) in made.iter().zip(&numbers) {
            let [a, b] = [made, number].map(|text| text.parse::<f64>().unwrap());
            assert!((a - b).abs() <= LAST_DIGIT, "{picture}: {made} in place of {number}; {again}");
        }
    }
}

/// A text with a mark in place of each number, and the numbers.
fn parts(text: &str) -> (String, Vec<String>) {
    let (mut words, mut numbers, mut in_number) = (String::new(), Vec::new(), false);
    for letter in text.chars() {
        let is_digit = letter.is_ascii_digit() || (in_number && letter == '.');
        match (is_digit, in_number) {
            (true, false) => numbers.push(letter.to_string()),
            (true, true) => numbers.last_mut().unwrap().push(letter),
            (false, _) => words.push(letter),
        }
        if is_digit && !in_number {
            words.push('#');
        }
        in_number = is_digit;
    }
    (words, numbers)
}

/// Links of Markdown to files of the repository, headings left out.
fn links(text: &str) -> Vec<String> {
    let mut fenced = false;
    let mut found = Vec::new();
    for line in text.lines() {
        fenced ^= line.trim_start().starts_with("```");
        if fenced || line.starts_with("    ") {
            continue;
        }
        for rest in line.split("](").skip(1) {
            let target = rest.split(')').next().unwrap_or_default();
            if !target.contains(':') {
                found.push(target.split('#').next().unwrap_or_default().to_owned());
            }
        }
    }
    found.retain(|target| !target.is_empty());
    found
}

#[test]
fn every_link_leads_to_a_file() {
    let pages: Vec<String> = documents().into_iter().filter(|path| path.ends_with(".md")).collect();
    let mut count = 0;
    for page in &pages {
        let path = root().join(page);
        for target in links(&fs::read_to_string(&path).unwrap()) {
            count += 1;
            assert!(path.parent().unwrap().join(&target).exists(), "{page}: no {target}");
        }
    }
    assert!(count > 100, "{count} links of {} pages", pages.len());
}

/// Every page of the documentation is a chapter of the book.
#[test]
fn the_book_has_every_page() {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let chapters: BTreeSet<String> = links(&summary).into_iter().filter(|link| !link.starts_with("../")).collect();
    let page = |path: String| path.strip_prefix("docs/").filter(|name| name.ends_with(".md")).map(str::to_owned);
    let pages: BTreeSet<String> =
        documents().into_iter().filter_map(page).filter(|name| name != "SUMMARY.md").collect();
    assert_eq!(chapters, pages);
}
