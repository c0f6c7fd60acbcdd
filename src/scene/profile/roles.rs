//! Which columns of a profile are x and z: by what is chosen, by their names, or the only two there are.

use super::header::{ColumnAxis, Header};
use super::options::{ProfileOptions, ThirdColumn};
use crate::tables::{Block, ContentError, shortened, words};

pub(super) const EXPECTED_COLUMNS: &str = "two, x and z, separated by comma, semicolon, tab or blanks";
const CHOOSE: &str = "columns = [\"x\", \"z\"] (--columns x,z) with the names or the numbers of the columns";

/// Which columns hold what, from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roles {
    /// None where the points have an even spacing.
    pub(super) x: Option<usize>,
    /// Of an areal measurement.
    pub(super) y: Option<usize>,
    pub(super) z: usize,
    pub(super) mark: Option<(usize, ThirdColumn)>,
}

impl Roles {
    /// Of points in space.
    pub(super) const XYZ: Self = Self { x: Some(0), y: Some(1), z: 2, mark: None };

    /// By `columns`, or by the names, or the first two columns of a file that has no others.
    pub(super) fn choose(
        block: &Block<'_>,
        header: &Header<'_>,
        options: &ProfileOptions,
    ) -> Result<Self, ContentError> {
        let mark = mark(header, options, block.columns);
        let roles = match &options.columns[..] {
            [] => Self::by_names(block, header, options, mark)?,
            [z] => Self { x: None, y: None, z: column(z, block, header)?, mark },
            [x, z] => Self { x: Some(column(x, block, header)?), y: None, z: column(z, block, header)?, mark },
            more => {
                return Err(ContentError::value(
                    None,
                    "columns",
                    &format!("{} names", more.len()),
                    "x and z, or z alone",
                ));
            }
        };
        match (roles.x, &options.spacing[..]) {
            (None, []) => Err(no_spacing(block, header)),
            (Some(x), [_, ..]) => {
                let expected = format!("none, for x is {}", header.table.label(x));
                Err(ContentError::value(None, "spacing", "given", &expected))
            }
            _ => Ok(roles),
        }
    }

    fn by_names(
        block: &Block<'_>,
        header: &Header<'_>,
        options: &ProfileOptions,
        mark: Option<(usize, ThirdColumn)>,
    ) -> Result<Self, ContentError> {
        let [x, y, z] = [ColumnAxis::X, ColumnAxis::Y, ColumnAxis::Z].map(|axis| header.table.places(&[axis]));
        if block.columns == 1 {
            return Ok(Self { x: None, y: None, z: 0, mark });
        }
        if header.table.names.is_empty() && header.table.headings.is_empty() {
            return Self::unnamed(block, options, mark);
        }
        match (&x[..], &y[..], &z[..]) {
            (&[x], [], &[z]) | (&[x], &[z], []) => Ok(Self { x: Some(x), y: None, z, mark }),
            (&[x], &[y], &[z]) => Ok(Self { x: Some(x), y: Some(y), z, mark }),
            ([], [], &[z]) if !options.spacing.is_empty() => Ok(Self { x: None, y: None, z, mark }),
            _ => {
                let why = match (x.len(), z.len().max(y.len())) {
                    (0, 0) => "the names do not tell x and z",
                    (0, 1) => "no name is that of x; spacing in place of x where points are even",
                    (1, 0) => "no name is that of z",
                    _ => "several columns have such names",
                };
                Err(ContentError::value(
                    header.table.line,
                    "columns",
                    &header.table.given(),
                    &format!("{CHOOSE}: {why}"),
                ))
            }
        }
    }

    /// Without names: x and z, and beside them what `third_column` says.
    fn unnamed(
        block: &Block<'_>,
        options: &ProfileOptions,
        mark: Option<(usize, ThirdColumn)>,
    ) -> Result<Self, ContentError> {
        match (block.columns, options.third_column) {
            (2, _) | (3, Some(ThirdColumn::Valid | ThirdColumn::Invalid)) => {
                Ok(Self { x: Some(0), y: None, z: 1, mark })
            }
            // One of them may count the rows, or be y.
            (count, third) => {
                let marks =
                    if count == 3 && third.is_none() { "; third_column if the third one marks points" } else { "" };
                let expected = format!("{EXPECTED_COLUMNS}{marks}; or {CHOOSE}");
                Err(ContentError::value(Some(block.first), "columns", &count.to_string(), &expected))
            }
        }
    }
}

fn no_spacing(block: &Block<'_>, header: &Header<'_>) -> ContentError {
    let hint = block.above.iter().find(|(_, line)| {
        ["spacing", "step", "increment", "interval"].iter().any(|word| line.to_lowercase().contains(word))
    });
    let hint = hint.map_or_else(String::new, |(line, text)| format!("; line {line} says \"{}\"", shortened(text)));
    let expected = format!(
        "the distance of the points in m, spacing = 1e-5 (--spacing 1e-5), for {} holds heights without x{hint}",
        if block.columns == 1 { "the only column".into() } else { header.table.label(0) },
    );
    ContentError::value(Some(block.first), "spacing", "not given", &expected)
}

/// A column by its name, or by its number from 1.
fn column(name: &str, block: &Block<'_>, header: &Header<'_>) -> Result<usize, ContentError> {
    let wanted = words(name);
    let is_it = |by: &dyn Fn(&str) -> bool| {
        (0..header.table.names.len()).filter(|&i| by(header.table.names[i].trim())).collect::<Vec<_>>()
    };
    let number =
        || name.trim().parse().ok().filter(|number| (1..=block.columns).contains(number)).map(|number| number - 1);
    let exact = is_it(&|text| text == name.trim());
    let similar = is_it(&|text| words(text) == wanted);
    // Without its unit.
    let begins = is_it(&|text| words(text).starts_with(&wanted));
    let found = [exact, similar, begins].into_iter().find(|found| !found.is_empty()).unwrap_or_default();
    match (&found[..], number()) {
        (&[column], _) | ([], Some(column)) => Ok(column),
        (found, _) => {
            let names: Vec<String> = header.table.names.iter().map(|name| format!("\"{}\"", name.trim())).collect();
            let which = if found.is_empty() { "one of" } else { "one name of its own, of" };
            let expected = format!("{which} {} or a number from 1 to {}", names.join(", "), block.columns);
            Err(ContentError::value(header.table.line, "columns", &format!("\"{}\"", shortened(name)), &expected))
        }
    }
}

/// The column that marks points, by its name or else the third one.
fn mark(header: &Header<'_>, options: &ProfileOptions, columns: usize) -> Option<(usize, ThirdColumn)> {
    let meaning = |name: &str| {
        let name = name.to_lowercase();
        let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
        if has(&["invalid", "missing", "mask", "bad", "outlier"]) {
            Some(ThirdColumn::Invalid)
        } else if has(&["valid", "good"]) {
            Some(ThirdColumn::Valid)
        } else {
            None
        }
    };
    let by_name = (0..header.table.names.len()).find_map(|i| Some((i, meaning(&header.table.names[i])?)));
    match options.third_column {
        Some(ThirdColumn::Ignore) => None,
        Some(given) => by_name.map(|(i, _)| (i, given)).or((columns == 3).then_some((2, given))),
        None => by_name,
    }
}
