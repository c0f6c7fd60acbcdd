//! The sign before the decimals of a file: 5.982 may be decimals or thousands; what else the file has decides, or it is
//! asked for.

use asperity::tables::{ContentError, shortened};

use super::blocks::Block;
use super::numbers::Decimal;

/// What the fields of a column say of the sign before decimals.
#[derive(Debug, Default)]
struct Evidence {
    /// A number that has one reading alone.
    found: Option<Decimal>,
    /// The line and the text of the first that has two.
    doubtful: Option<(usize, String)>,
    /// Whether a whole number above a thousand has no sign between its thousands, so that others have none either.
    long: bool,
}

impl Evidence {
    fn add(&mut self, line: usize, field: &str) {
        if !field.contains(['.', ',']) {
            let digits = field.trim_start_matches(['-', '+']);
            self.long |= digits.len() > 3 && digits.bytes().all(|byte| byte.is_ascii_digit());
            return;
        }
        match (Decimal::Point.read(field), Decimal::Comma.read(field)) {
            (Some(_), None) => self.found = Some(Decimal::Point),
            (None, Some(_)) => self.found = Some(Decimal::Comma),
            (Some(point), Some(comma)) if point != comma => {
                self.doubtful.get_or_insert_with(|| (line, field.to_owned()));
            }
            _ => (),
        }
    }

    /// Of the fields at places of the rows of some blocks, up to the first that decides.
    fn of<'b, 'a: 'b>(blocks: &[&'b Block<'a>], text: &'a str, takes: impl Fn(usize) -> bool) -> Self {
        let mut found = Self::default();
        for row in blocks.iter().flat_map(|block| block.rows(text)) {
            for (_, field) in row.fields.iter().enumerate().filter(|(index, _)| takes(*index)) {
                found.add(row.line, field);
            }
            if found.found.is_some() {
                break;
            }
        }
        found
    }

    /// The sign of these fields, as far as it is beyond doubt.
    fn decided(&self) -> Option<Decimal> {
        let of_long = || {
            let (_, field) = self.doubtful.as_ref().filter(|_| self.long)?;
            Some(if field.contains(',') { Decimal::Comma } else { Decimal::Point })
        };
        self.found.or_else(of_long)
    }
}

/// A column that is read.
#[derive(Clone, Debug)]
pub struct UsedColumn {
    /// Its place, from 0.
    pub index: usize,
    /// It in messages.
    pub label: String,
    /// Whether a factor of a thousand is no slip that shows: not in ratios, temperatures and angles.
    pub at_stake: bool,
}

/// The sign before the decimals of a file whose tables are some `blocks`, of which the `columns` are read: what a line above
/// says, or the only one that all numbers leave possible.
///
/// # Errors
/// [`ContentError`] where the numbers of one of the `columns` may be decimals or whole thousands.
pub fn decimal_of(blocks: &[&Block<'_>], text: &str, columns: &[UsedColumn]) -> Result<Decimal, ContentError> {
    let stated = blocks.iter().flat_map(|block| &block.above).find_map(|(_, line)| stated(line));
    if let Some(stated) = stated {
        return Ok(stated);
    }
    let is_used = |index: usize| columns.iter().any(|column| column.index == index);
    let used = Evidence::of(blocks, text, is_used).found;
    if let Some(found) = used.or_else(|| Evidence::of(blocks, text, |_| true).found) {
        return Ok(found);
    }
    let mut decided = None;
    for column in columns {
        let evidence = Evidence::of(blocks, text, |index| index == column.index);
        match (evidence.decided(), &evidence.doubtful) {
            (Some(found), _) => decided = Some(found),
            (None, Some((_, field))) if !column.at_stake => {
                decided = decided.or(Some(if field.contains(',') { Decimal::Comma } else { Decimal::Point }));
            }
            (None, Some((line, field))) if decided.is_none() => return Err(either(column, *line, field)),
            _ => (),
        }
    }
    Ok(decided.unwrap_or(Decimal::Point))
}

/// The sign that a line such as `Decimal separator: comma` or `# decimal point` names.
fn stated(line: &str) -> Option<Decimal> {
    let lower = line.to_lowercase();
    if !(lower.contains("decimal") || lower.contains("dezimal")) {
        return None;
    }
    let says = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    match (says(&["point", "punkt", "dot", "\".\"", "'.'"]), says(&["comma", "komma", "\",\"", "','"])) {
        (true, false) => Some(Decimal::Point),
        (false, true) => Some(Decimal::Comma),
        _ => None,
    }
}

fn either(column: &UsedColumn, line: usize, field: &str) -> ContentError {
    let sign = if field.contains('.') { '.' } else { ',' };
    let whole = field.replace(sign, "");
    let [decimal, parted] = if sign == '.' { ["point", "comma"] } else { ["comma", "point"] };
    let expected = format!(
        "a line above the names that says which it is, \"# decimal {decimal}\" for {field} or \"# decimal {parted}\" for \
         {whole}: all numbers of the column have three digits behind the sign, and no other number of the file decides"
    );
    ContentError::value(Some(line), &column.label, &format!("\"{}\"", shortened(field)), &expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(text: &str) -> Result<Option<f64>, String> {
        let blocks = Block::all(text, true);
        let used = UsedColumn { index: blocks[0].columns - 1, label: "E".to_owned(), at_stake: true };
        let decimal = decimal_of(&[&blocks[0]], text, &[used]).map_err(|error| error.to_string())?;
        Ok(blocks[0].rows(text).next().and_then(|row| decimal.read(row.fields.last()?)))
    }

    #[test]
    fn numbers_that_may_be_thousands_are_asked_about() {
        for text in [
            "f;E\n1;5.982\n10;12.004\n",
            "f;E\n1;5,982\n10;12,004\n",
            "f,E\n1,5.982\n10,12.004\n",
            "f E\n1 5,982\n10 12,004\n",
            "E\n982\n5.982\n",
            "f;E\n1;5.982\n",
        ] {
            let refusal = first(text).unwrap_err();
            assert!(refusal.contains("\"# decimal ") && refusal.contains("for 5982"), "{refusal}");
        }
    }

    #[test]
    fn what_else_the_file_has_decides() {
        for (text, number) in [
            // Decimals beyond doubt, in the column and beside it.
            ("f,E\n1,5.982\n10,12.04\n", 5.982),
            ("f,E\n0.1,5.982\n10,12.004\n", 5.982),
            ("f,E\n1,5.982\n10,0.004\n", 5.982),
            ("f;E\n1;5.982\n10;1234.500\n", 5.982),
            ("# decimal point\nf;E\n1;5.982\n10;12.004\n", 5.982),
            ("Dezimaltrennzeichen: Komma\nf\tE\n1\t5,982\n10\t12,004\n", 5.982),
            // Whole numbers beyond a thousand have no sign.
            ("f;E\n1;5.982\n10;12004\n", 5.982),
            ("f;E\n0,1;5.982\n10;12.004\n", 5982.0),
            ("f;E\n0.1;5,982\n10;12,004\n", 5982.0),
            ("f;E\n1;5.982,5\n10;12.004\n", 5982.5),
            ("f;E\n1;5 982,5\n10;12 004\n", 5982.5),
            ("f;E\n1;5'982\n10;12'004\n", 5982.0),
            ("# decimal comma\nf;E\n1;5.982\n10;982\n", 5982.0),
        ] {
            assert_eq!(first(text), Ok(Some(number)), "{text}");
        }
    }
}
