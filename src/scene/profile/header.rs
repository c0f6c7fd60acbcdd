//! What stands above the data: units, and the name of a third column.

use super::{LengthUnit, ThirdColumn};
use crate::scene::text_table::Columns;

/// What the header says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Header {
    /// The units of x and z.
    pub(super) units: [Option<LengthUnit>; 2],
    /// Whether a unit stands beside one of the two columns alone: it is taken for both, which may be wrong.
    pub(super) is_one_sided: bool,
    pub(super) third_column: Option<ThirdColumn>,
}

/// Lines above the data that may hold the names of the columns and their units.
const NEAR: usize = 2;

/// Reads the header's `lines`, comments included. Units are looked for in the last two lines, beside or below the names
/// of columns, as in `x [mm]; z (µm)`, `X_(microns),y1`, `z / µm`; and in lines of their own, as in `X-Unit: mm`.
pub(super) fn read(lines: &[&str]) -> Header {
    let lines: Vec<&str> = lines.iter().map(|line| line.trim_start_matches(['#', '%', '!', ' '])).collect();
    let mut set = [None; 2];
    let settings = lines.iter().filter_map(|line| setting(line));
    settings.for_each(|(axes, unit)| axes.iter().for_each(|&axis| set[axis] = Some(unit)));
    let near = || lines.iter().rev().filter(|line| setting(line).is_none()).take(NEAR);
    let beside = near().map(|line| column_units(line)).find(|units| *units != [None, None]).unwrap_or_default();
    let (x, z) = (beside[0].or(set[0]), beside[1].or(set[1]));
    Header {
        units: [x.or(z), z.or(x)],
        is_one_sided: x.is_none() != z.is_none(),
        third_column: near().find_map(|line| third_column(&Columns::split(line, true))),
    }
}

/// Of a line such as `X-Unit: mm` or `unit;um`: the axes, 0 for x and 1 for z, and their unit.
fn setting(line: &str) -> Option<(&'static [usize], LengthUnit)> {
    let words: Vec<String> = words(line).map(str::to_lowercase).collect();
    let mut units = words.iter().filter_map(|word| unit_of(word));
    let (unit, None) = (units.next()?, units.next()) else { return None };
    let name = words.iter().position(|word| word.ends_with("unit") || word.ends_with("units"))?;
    let names = |axis: &[&str]| {
        let of_axis = |word: &String| axis.iter().any(|name| word == name || *word == format!("{name}unit"));
        words[..=name].iter().any(of_axis)
    };
    Some(match (names(&["x"]), names(&["z", "y", "height"])) {
        (true, false) => (&[0], unit),
        (false, true) => (&[1], unit),
        _ => (&[0, 1], unit),
    })
}

/// The units beside the names of two columns, or below them.
fn column_units(line: &str) -> [Option<LengthUnit>; 2] {
    if line.contains([';', '\t', ',']) {
        let row = Columns::split(line, true);
        return [field_unit(row.fields[0]), field_unit(row.fields[1])];
    }
    let fields: Vec<&str> = line.split_whitespace().collect();
    if let [x, z] = fields[..] {
        return [field_unit(x), field_unit(z)];
    }
    // Blanks separate too much: only what is marked as a unit is one.
    let marked = |(i, field): (usize, &&str)| {
        let after_slash = i > 0 && fields[i - 1].ends_with('/');
        if after_slash || field.contains(['[', '(', '/']) { field_unit(field) } else { None }
    };
    let mut units = fields.iter().enumerate().filter_map(marked);
    [units.next(), units.next()]
}

/// The unit at the end of the name of a column: `x [mm]`, `X_(microns)`, `z / µm`, `mm`.
fn field_unit(field: &str) -> Option<LengthUnit> {
    words(field).last().and_then(unit_of)
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty())
}

fn unit_of(word: &str) -> Option<LengthUnit> {
    let lower = word.to_lowercase();
    let stem = lower.strip_suffix('s').filter(|stem| stem.len() > 2).unwrap_or(&lower);
    Some(match stem {
        // A single capital M is no metre.
        "m" if word == "m" => LengthUnit::Metre,
        "meter" | "metre" => LengthUnit::Metre,
        "mm" | "millimeter" | "millimetre" => LengthUnit::Millimetre,
        // Two letters look like µ: the sign of the unit and the Greek one.
        "um" | "\u{b5}m" | "\u{3bc}m" | "micron" | "micrometer" | "micrometre" => LengthUnit::Micrometre,
        "nm" | "nanometer" | "nanometre" => LengthUnit::Nanometre,
        _ => return None,
    })
}

fn third_column(row: &Columns<'_>) -> Option<ThirdColumn> {
    if row.count < 3 {
        return None;
    }
    let name = row.fields[2].to_lowercase();
    let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
    if has(&["invalid", "missing", "mask", "bad", "outlier"]) {
        Some(ThirdColumn::Invalid)
    } else if has(&["valid", "good"]) {
        Some(ThirdColumn::Valid)
    } else {
        None
    }
}
