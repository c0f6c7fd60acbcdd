//! Headings of columns: from `Storage Modulus (E') [MPa]` to a role and its unit.
//!
//! A heading names a role by one of its documented names or symbols, whole, or by two of them behind each other; case,
//! blanks, `_`, `-` and `.` do not count, but of symbols that differ by their case alone (T and t) the one that is written
//! is meant. Its unit stands beside it in brackets (`x [mm]`), behind a comma or a slash (`x / mm`), as a last word
//! (`x_mm`), or in the row below the names.

use std::borrow::Cow;

use asperity::tables::{ContentError, Dimension, Role, Unit, shortened};

/// What a heading says.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// The place of its role in the list of these.
    pub role: usize,
    /// Its unit, where one is named.
    pub unit: Option<Unit>,
}

/// A heading that names a role and is refused.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedHeading {
    /// The place of the role.
    pub role: usize,
    /// The text that is no unit of it.
    pub found: String,
    /// What is expected in its place.
    pub expected: String,
}

/// A text without what does not count in names.
fn normal(text: &str) -> String {
    let skipped = |letter: &char| letter.is_whitespace() || "_-.()|".contains(*letter);
    plain(text).to_lowercase().chars().filter(|letter| !skipped(letter)).collect()
}

/// How well a text names a role: by a name as it is written, or but for what does not count.
fn names(role: &Role, text: &str) -> Option<bool> {
    let all = || role.names.split(", ").chain([role.key]).filter(|name| !name.is_empty());
    if all().any(|name| name == text.trim()) {
        return Some(true);
    }
    let wanted = normal(text);
    if wanted.is_empty() {
        return None;
    }
    let is_it = |name: &str| {
        let rest = wanted.strip_prefix(&normal(name));
        rest.is_some_and(|rest| rest.is_empty() || all().any(|other| normal(other) == rest && other != name))
    };
    all().any(is_it).then_some(false)
}

/// The ways to part a heading into a name and the text of a unit; whether that is one for certain.
fn splits(heading: &str) -> Vec<(&str, &str, bool)> {
    let bracketed = [('[', ']'), ('(', ')'), ('<', '>')].into_iter().filter_map(|(open, close)| {
        let (name, unit) = heading.strip_suffix(close)?.rsplit_once(open)?;
        Some((name, unit, true))
    });
    let parted = [" in ", ",", "/", ":"].into_iter().filter_map(|sign| {
        let (name, unit) = heading.split_once(sign)?;
        Some((name, unit, false))
    });
    let words = heading.match_indices([' ', '_']).map(|(at, _)| (&heading[..at], &heading[at + 1..], false));
    bracketed.chain(parted).chain(words).collect()
}

/// A unit as a heading may write it; `mm_s` is mm/s.
fn unit_in(text: &str) -> Option<Unit> {
    Unit::parse(text).or_else(|| Unit::parse(&text.trim().replacen('_', "/", 1)))
}

/// The role that a heading names, with a unit beside it or in the line `below`; `None` where it names none of them.
///
/// # Errors
/// [`RefusedHeading`] where what stands in the place of the unit is none of the role, or something stands behind it.
pub fn find(heading: &str, below: &str, roles: &[Role]) -> Result<Option<Heading>, RefusedHeading> {
    let text = plain(heading);
    let below = below.trim().trim_start_matches(['[', '(', '<']).trim_end_matches([']', ')', '>']);
    let mut found: Vec<(bool, bool, Heading)> = Vec::new();
    let mut refused = None;
    let mut consider = |name: &str, unit: &str, is_certain: bool| {
        for (i, role) in roles.iter().enumerate() {
            let Some(exact) = names(role, name) else { continue };
            match unit_in(unit) {
                _ if unit.trim().is_empty() => found.push((false, exact, Heading { role: i, unit: None })),
                Some(unit) if unit.is_of(role.dimension) => {
                    found.push((true, exact, Heading { role: i, unit: Some(unit) }));
                }
                // One letter may name several quantities: t [s], t [°C].
                Some(_) if normal(name).chars().count() == 1 => (),
                _ if is_certain => refused = refused.take().or_else(|| Some((i, unit.trim().to_owned()))),
                _ => (),
            }
        }
    };
    consider(&text, below, true);
    for (name, unit, is_certain) in splits(&text) {
        consider(name, unit, is_certain);
    }
    // A unit counts more than a name as it is written, and that more than the order of the roles.
    let best = found.into_iter().rev().max_by_key(|(has_unit, exact, _)| (*has_unit, *exact));
    match (best, refused) {
        (Some((_, _, heading)), _) => Ok(Some(heading)),
        (None, Some((role, found))) => {
            Err(RefusedHeading { role, found, expected: format!("one of {}", roles[role].dimension.units()) })
        }
        (None, None) => behind_unit(&text, roles),
    }
}

/// Refuses what stands behind the unit of a role: `E' [Pa] x1e6`.
fn behind_unit(text: &str, roles: &[Role]) -> Result<Option<Heading>, RefusedHeading> {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some((name, rest)) = text.split_once(open) else { continue };
        let Some((unit, rest)) = rest.split_once(close) else { continue };
        let is_it = |role: &Role| {
            names(role, name).is_some() && Unit::parse(unit).is_some_and(|unit| unit.is_of(role.dimension))
        };
        if let Some(role) = roles.iter().position(is_it) {
            let expected = format!("nothing behind the unit, {name}[{unit}], and numbers in it");
            return Err(RefusedHeading { role, found: rest.trim().to_owned(), expected });
        }
    }
    Ok(None)
}

/// The unit of a dimension beside a name, whatever that is, or in the line below it.
///
/// # Errors
/// The text in brackets or below that is none of the dimension.
pub fn unit_beside(heading: &str, below: &str, dimension: Dimension) -> Result<Option<Unit>, String> {
    let text = plain(heading);
    let below = below.trim().trim_start_matches(['[', '(', '<']).trim_end_matches([']', ')', '>']);
    let mut all = splits(&text);
    all.push(("", below, true));
    if let Some((name, rest)) = text.split_once('[')
        && let Some((unit, _)) = rest.split_once(']')
    {
        all.push((name, unit, true));
    }
    let known = |unit: &str| unit_in(unit).filter(|unit| unit.is_of(dimension));
    let certain = all.iter().find(|(_, unit, is_certain)| *is_certain && !unit.trim().is_empty());
    match (all.iter().find_map(|(_, unit, _)| known(unit)), certain) {
        (Some(unit), _) => Ok(Some(unit)),
        (None, Some((_, unit, _))) => Err(unit.trim().to_owned()),
        (None, None) => Ok(None),
    }
}

/// The column that a `wanted` name or number from 1 chooses among these headings.
///
/// # Errors
/// [`ContentError`] at `line` with the names that there are.
pub fn chosen(
    wanted: &str,
    headings: &[Cow<'_, str>],
    columns: usize,
    line: Option<usize>,
) -> Result<usize, ContentError> {
    let without_unit =
        |heading: &str| splits(heading).first().map_or_else(|| normal(heading), |(name, ..)| normal(name));
    let is_it = |by: &dyn Fn(&str) -> bool| (0..headings.len()).filter(|&i| by(headings[i].trim())).collect::<Vec<_>>();
    let exact = is_it(&|text| text == wanted.trim());
    let similar = is_it(&|text| normal(text) == normal(wanted));
    let bare = is_it(&|text| without_unit(text) == normal(wanted));
    let found = [exact, similar, bare].into_iter().find(|found| !found.is_empty()).unwrap_or_default();
    let number = wanted.trim().parse().ok().filter(|number| (1..=columns).contains(number));
    match (&found[..], number) {
        (&[column], _) => Ok(column),
        ([], Some(number)) => Ok(number - 1),
        (found, _) => {
            let names: Vec<String> = headings.iter().map(|name| format!("\"{}\"", name.trim())).collect();
            let which = if found.is_empty() { "one of" } else { "one name of its own, of" };
            let expected = format!("{which} {} or a number from 1 to {columns}", names.join(", "));
            Err(ContentError::value(line, "columns", &format!("\"{}\"", shortened(wanted)), &expected))
        }
    }
}

/// The text with one spelling of primes, degrees, powers and µ.
pub fn plain(text: &str) -> String {
    const SIGNS: [(&str, &str); 24] = [
        ("″", "''"),
        ("”", "''"),
        ("\"", "''"),
        ("\u{94}", "''"),
        ("ʺ", "''"),
        ("′", "'"),
        ("’", "'"),
        ("´", "'"),
        ("`", "'"),
        ("\u{92}", "'"),
        ("ʹ", "'"),
        ("º", "°"),
        ("˚", "°"),
        ("⁻¹", "-1"),
        ("−1", "-1"),
        ("²", "2"),
        ("^", ""),
        ("·", " "),
        ("⋅", " "),
        ("\u{a0}", " "),
        ("\u{b5}", "\u{3bc}"),
        ("deg ", "deg"),
        ("° ", "°"),
        ("−", "-"),
    ];
    SIGNS.iter().fold(text.trim().to_owned(), |text, (sign, plain)| text.replace(sign, plain))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROLES: [Role; 6] = [
        Role::new("x", "position", Dimension::Length),
        Role::new("storage", "E', storage modulus, E prime", Dimension::Pressure),
        Role::new("tangent", "tan d, tan delta", Dimension::Number),
        Role::new("time", "t", Dimension::Time),
        Role::new("temperature", "T, temp", Dimension::Temperature),
        Role::new("speed", "v", Dimension::Speed),
    ];

    fn read(heading: &str, below: &str) -> Result<Option<(&'static str, Option<&'static str>)>, String> {
        let found = find(heading, below, &ROLES).map_err(|refused| refused.found)?;
        Ok(found.map(|heading| (ROLES[heading.role].key, heading.unit.map(|unit| unit.name))))
    }

    #[test]
    fn names_are_whole() {
        for (heading, key, unit) in [
            ("x [mm]", "x", Some("mm")),
            ("X", "x", None),
            ("Position_um", "x", Some("µm")),
            ("x / µm", "x", Some("µm")),
            ("x in in", "x", Some("in")),
            ("Storage modulus (E') [MPa]", "storage", Some("MPa")),
            ("Storage_Modulus, MPa", "storage", Some("MPa")),
            ("E′ (GPa)", "storage", Some("GPa")),
            ("tan(delta) [-]", "tangent", Some("1")),
            ("T", "temperature", None),
            ("t", "time", None),
            ("t [°C]", "temperature", Some("°C")),
            ("T (sec)", "time", Some("s")),
            ("speed_mm_s", "speed", Some("mm/s")),
        ] {
            assert_eq!(read(heading, ""), Ok(Some((key, unit))), "{heading}");
        }
        for heading in
            ["", "[mm]", "x_2 [mm]", "x raw", "relaxation storage modulus [MPa]", "v [bar]", "curing temp", "x y"]
        {
            assert_eq!(read(heading, ""), Ok(None), "{heading}");
        }
        assert_eq!(read("x", "[mm]"), Ok(Some(("x", Some("mm")))));
        assert_eq!(read("Temp", "°C"), Ok(Some(("temperature", Some("°C")))));
        for (heading, found) in
            [("x (pixels)", "pixels"), ("E' [Pa] x1e6", "x1e6"), ("E' (10^6 Pa)", "106 Pa"), ("speed [bar]", "bar")]
        {
            assert_eq!(read(heading, ""), Err(found.to_owned()), "{heading}");
        }
    }

    #[test]
    fn a_unit_belongs_to_its_column_whatever_that_is_called() {
        let read = |name: &str, below: &str| {
            unit_beside(name, below, Dimension::Length).map(|unit| unit.map(|unit| unit.name)).map_err(|_| ())
        };
        for (name, below, unit) in [
            ("Texture [µm]", "", Ok(Some("µm"))),
            ("Sensor 3 (mm)", "", Ok(Some("mm"))),
            ("Signal in nm", "", Ok(Some("nm"))),
            ("Raw_um", "", Ok(Some("µm"))),
            ("Laser [µm] left", "", Ok(Some("µm"))),
            ("Relief", "[mm]", Ok(Some("mm"))),
            ("Value of sensor", "", Ok(None)),
            ("Signal [V]", "", Err(())),
            ("Signal", "counts", Err(())),
        ] {
            assert_eq!(read(name, below), unit, "{name} {below}");
        }
    }
}
