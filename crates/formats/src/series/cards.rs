//! Cards of programs of finite elements: g, k and τ of Abaqus, shares and times of Ansys.
//!
//! Their numbers have no units: times are taken in s, and E_0 stands in a comment, with its unit.

use asperity::tables::{ContentError, POSITIVE, ReadingNote, shortened};

use super::written::{ModulusKind, WrittenSeries, WrittenTerm, note};
use crate::text::{Decimal, Line};

/// The series in the cards of a text; `None` where there are none.
pub(super) fn read(text: &str) -> Option<Result<WrittenSeries<'_>, ContentError>> {
    let lines = || (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| !line.is_empty());
    let of_abaqus = |word: &'static str| lines().filter(move |(_, line)| is_keyword(line, word));
    let of_ansys = |words: &'static [&'static str]| lines().filter(move |(_, line)| is_table(line, words));
    let (abaqus, ansys) = (of_abaqus("VISCOELASTIC").next(), of_ansys(&["PRONY"]).next());
    let (line, comment, terms, ignored) = match (abaqus, ansys) {
        (Some((line, _)), _) => {
            let terms = check_one(of_abaqus("VISCOELASTIC"))
                .and_then(|()| abaqus_terms(lines().skip_while(move |(number, _)| *number < line)));
            (line, "**", terms, of_abaqus("TRS").next().map(shift_note))
        }
        (None, Some((line, _))) => {
            let terms = check_one(of_ansys(&["PRONY", "SHEAR"])).and_then(|()| ansys_terms(lines()));
            (line, "!", terms, of_ansys(&["SHIFT"]).next().map(shift_note))
        }
        (None, None) => return None,
    };
    let name = if abaqus.is_some() { "Abaqus" } else { "Ansys" };
    let mut notes = vec![note(format!("a card of {name}; relaxation times in s are assumed"), true)];
    notes.extend(ignored);
    notes.extend(of_ansys(&["PRONY", "BULK"]).next().map(|(line, text)| {
        note(format!("line {line} ({text}) is not taken: the model's Poisson's ratio does not relax"), true)
    }));
    Some(terms.map(|terms| WrittenSeries {
        terms,
        kind: ModulusKind::Relative,
        names_unit: true,
        line: Some(line),
        header: lines().map(|(number, line)| (number, line.trim_start_matches(['*', '!', '#', '/', ' ']))).collect(),
        comment,
        notes,
    }))
}

/// Whether a line is this keyword of Abaqus, and no comment.
fn is_keyword(line: &str, word: &str) -> bool {
    let name = line.strip_prefix('*').and_then(|name| name.split(',').next());
    name.is_some_and(|name| name.replace(' ', "").eq_ignore_ascii_case(word))
}

/// Whether a line is a table of Ansys of this kind: `TB,PRONY,1,1,2,SHEAR`.
fn is_table(line: &str, words: &[&str]) -> bool {
    let fields: Vec<String> =
        line.split('!').next().unwrap_or_default().split(',').map(|field| field.trim().to_uppercase()).collect();
    let kinds = [fields.get(1), fields.get(5)];
    fields[0] == "TB" && words.iter().zip(kinds).all(|(word, kind)| kind.is_some_and(|kind| kind == word))
}

/// One series alone: of two materials, or of two temperatures, none is the file's.
fn check_one<'a>(mut series: impl Iterator<Item = Line<'a>>) -> Result<(), ContentError> {
    match (series.next(), series.next()) {
        (Some((first, _)), Some((second, card))) => {
            let given = format!("\"{}\", a second one beside that of line {first}", shortened(card));
            Err(ContentError::value(Some(second), "card", &given, "the series of one material: a file for each"))
        }
        _ => Ok(()),
    }
}

/// A shift with temperature is the scene's.
fn shift_note((line, card): Line<'_>) -> ReadingNote {
    let key = "material.wlf = { c1, c2, reference_temperature, temperature }";
    note(format!("line {line} ({}), the shift with temperature, is not taken: write {key}", shortened(card)), true)
}

/// The rows g, k, τ below `*VISCOELASTIC, TIME=PRONY`.
fn abaqus_terms<'a>(mut lines: impl Iterator<Item = Line<'a>>) -> Result<Vec<WrittenTerm>, ContentError> {
    let (number, keyword) = lines.next().unwrap_or_default();
    if !keyword.to_uppercase().replace(' ', "").contains("TIME=PRONY") {
        let given = format!("\"{keyword}\"");
        return Err(ContentError::value(
            Some(number),
            "card",
            &given,
            "*VISCOELASTIC, TIME=PRONY, with rows of g, k, tau",
        ));
    }
    let data = lines.filter(|(_, line)| !line.starts_with("**")).take_while(|(_, line)| !line.starts_with('*'));
    data.map(|(line, row)| {
        let fields: Vec<&str> = row.trim_end_matches(',').split(',').map(str::trim).collect();
        let &[shear, bulk, time] = &fields[..] else {
            return Err(ContentError::value(Some(line), "columns", &fields.len().to_string(), "three: g, k, tau"));
        };
        let bulk = if bulk.is_empty() { Some(0.0) } else { Some(share(line, bulk)?) };
        Ok(WrittenTerm { line, time: seconds(line, time)?, modulus: share(line, shear)?, bulk })
    })
    .collect()
}

/// The constants of `TBDATA` below `TB,PRONY,…,SHEAR`: share and time by turns.
fn ansys_terms<'a>(lines: impl Iterator<Item = Line<'a>>) -> Result<Vec<WrittenTerm>, ContentError> {
    let mut constants: Vec<(usize, &str)> = Vec::new();
    let mut is_shear = false;
    for (number, line) in lines {
        let fields: Vec<&str> = line.split('!').next().unwrap_or_default().split(',').map(str::trim).collect();
        let is = |place: usize, word: &str| fields.get(place).is_some_and(|field| field.eq_ignore_ascii_case(word));
        if is(0, "TB") {
            is_shear = is(1, "PRONY") && is(5, "SHEAR");
        } else if is(0, "TBDATA") && is_shear {
            let next = (constants.len() + 1).to_string();
            if !(is(1, &next) || is(1, "")) {
                let given = fields.get(1).copied().unwrap_or_default();
                return Err(ContentError::value(Some(number), "TBDATA", given, &format!("constants from {next} on")));
            }
            constants.extend(fields.iter().skip(2).filter(|field| !field.is_empty()).map(|field| (number, *field)));
        }
    }
    if constants.is_empty() || !constants.len().is_multiple_of(2) {
        let given = constants.len().to_string();
        let expected = "shares and times by turns, in TBDATA below TB,PRONY,…,SHEAR";
        return Err(ContentError::value(constants.last().map(|(line, _)| *line), "constants", &given, expected));
    }
    let term = |pair: &[(usize, &str)]| {
        let (line, time) = pair[1];
        Ok(WrittenTerm { line, time: seconds(line, time)?, modulus: share(pair[0].0, pair[0].1)?, bulk: None })
    };
    constants.chunks_exact(2).map(term).collect()
}

fn share(line: usize, field: &str) -> Result<f64, ContentError> {
    let found = Decimal::Point.read(field).filter(|share| (0.0..=1.0).contains(share));
    found.ok_or_else(|| {
        ContentError::value(Some(line), "modulus", &format!("\"{field}\""), "a share of E_0, from 0 to 1")
    })
}

fn seconds(line: usize, field: &str) -> Result<f64, ContentError> {
    let error = || ContentError::value(Some(line), "relaxation_time", &format!("\"{field}\""), &POSITIVE.to_string());
    Decimal::Point.read(field).filter(|time| POSITIVE.holds(*time)).ok_or_else(error)
}
