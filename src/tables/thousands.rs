//! Signs that stand before decimals or between thousands: 5.982 is 5982 where a comma stands before decimals.
//!
//! Numbers with one to three digits before a sign and three behind it may be either. What else is in the file decides: a
//! number that can only be a decimal, a line above the numbers that says so. A file is asked for such a line where nothing
//! does.

use super::blocks::Block;
use super::columns::{Column, ReadingNote};
use super::error::{ContentError, shortened};
use super::lines::Separator;
use super::numbers::{NumberStyle, number};
use super::units::Dimension;

/// The signs that numbers of a file have before decimals, beyond doubt or because a line says so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DecimalSigns {
    point: bool,
    comma: bool,
}

/// What a field is with respect to a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// Digits alone; whether they are three, as a whole number below a thousand has beside larger ones.
    Whole {
        three: bool,
    },
    /// Decimals or thousands.
    Either,
    /// A number that the sign makes a decimal.
    Decimal,
    Other,
}

impl Shape {
    fn of(field: &str, sign: char) -> Self {
        let digits = field.trim_start_matches(['-', '+', '\u{2212}']);
        let all_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let Some((whole, rest)) = digits.split_once(sign) else {
            return if all_digits(digits) { Self::Whole { three: digits.len() == 3 } } else { Self::Other };
        };
        let is_group = whole.len() <= 3 && all_digits(whole) && !whole.starts_with('0');
        if is_group && rest.split(sign).all(|part| part.len() == 3 && all_digits(part)) {
            return Self::Either;
        }
        if number(field, true).is_some() { Self::Decimal } else { Self::Other }
    }
}

impl DecimalSigns {
    /// Those in the rows of some blocks of a text and in the lines above them, `Decimal separator: comma`.
    pub fn of<'b, 'a: 'b>(blocks: impl IntoIterator<Item = &'b Block<'a>>, text: &'a str) -> Self {
        let mut found = Self::default();
        for block in blocks {
            block.above.iter().for_each(|(_, line)| found.add_stated(line));
            let has_commas = block.separator.allows_decimal_comma();
            for (_, line) in block.lines(text) {
                let [of_point, of_comma] = [!found.point, !found.comma && has_commas];
                if !(of_point || of_comma) {
                    break;
                }
                let is_decimal = |sign: char| {
                    line.contains(sign)
                        && block.separator.split(line).iter().any(|field| Shape::of(field, sign) == Shape::Decimal)
                };
                found.point |= of_point && is_decimal('.');
                found.comma |= of_comma && is_decimal(',');
            }
        }
        found
    }

    fn add_stated(&mut self, line: &str) {
        let lower = line.to_lowercase();
        if !(lower.contains("decimal") || lower.contains("dezimal")) {
            return;
        }
        let says = |words: &[&str]| words.iter().any(|word| lower.contains(word));
        self.point |= says(&["point", "punkt", "dot", "\".\"", "'.'"]);
        self.comma |= says(&["comma", "komma", "\",\"", "','"]);
    }
}

/// A column that is read.
#[derive(Clone, Debug)]
pub struct UsedColumn {
    /// Its place, from 0.
    index: usize,
    /// It in messages.
    label: String,
    /// Whether a factor of a thousand is no slip that shows: not in ratios, temperatures and angles.
    at_stake: bool,
}

impl UsedColumn {
    /// A column of lengths, moduli or the like, called `label`.
    pub fn new(index: usize, label: &str) -> Self {
        Self { index, label: label.to_owned(), at_stake: true }
    }
}

impl<Q: Copy> Column<Q> {
    /// The column as one that is read.
    pub fn used(&self) -> UsedColumn {
        let is_out = matches!(self.unit.dimension, Dimension::Number | Dimension::Temperature | Dimension::Angle);
        UsedColumn { index: self.index, label: self.label(), at_stake: !is_out && self.logarithm.is_none() }
    }
}

/// What a column has of numbers that may be either.
#[derive(Debug, Default)]
struct Doubtful {
    /// The line and the text of the first one.
    first: Option<(usize, String)>,
    /// How many there are, with those below a thousand that may stand beside them.
    numbers: usize,
    /// Whether there are others, so that none are thousands.
    others: bool,
}

impl<'a> Block<'a> {
    /// How its numbers are written in a file with these signs, and notes of what had to be decided.
    ///
    /// # Errors
    /// [`ContentError`] where the numbers of one of the `columns` may be decimals or whole thousands.
    pub fn style_with(
        &self,
        text: &'a str,
        DecimalSigns { point, comma }: DecimalSigns,
        columns: &[UsedColumn],
    ) -> Result<(NumberStyle, Vec<ReadingNote>), ContentError> {
        // The sign that may part thousands: the other one than that before decimals.
        let signs: &[char] = match (point, comma, self.separator.allows_decimal_comma()) {
            (true, true, _) | (true, false, false) => &[],
            (true, false, true) => &[','],
            (false, true, _) | (false, false, false) => &['.'],
            (false, false, true) => &['.', ','],
        };
        let (mut notes, mut thousands) = (Vec::new(), None);
        for &sign in signs {
            let doubtful = columns.iter().zip(self.doubtful(text, columns, sign));
            let doubtful: Vec<(&UsedColumn, Doubtful)> = doubtful.filter(|(_, found)| found.first.is_some()).collect();
            let may_be = |(column, found): &(&UsedColumn, Doubtful)| column.at_stake && !found.others;
            if point || comma {
                // Where some cannot be thousands the file has both signs before decimals, which is refused.
                thousands = (!doubtful.is_empty() && doubtful.iter().all(may_be)).then_some(sign);
                let decided = doubtful.iter().filter(|_| thousands.is_some());
                notes.extend(decided.map(|(column, found)| found.decided(column, sign)));
                continue;
            }
            let by_semicolons = sign == ',' && self.separator == Separator::Letter(';');
            for (column, found) in doubtful.iter().filter(|found| may_be(found)) {
                if by_semicolons {
                    notes.push(found.decimal(column));
                } else if found.numbers > 1 {
                    return Err(found.either(column, sign));
                }
            }
        }
        Ok((self.style().with_thousands(thousands), notes))
    }

    /// What each of the `columns` has.
    fn doubtful(&self, text: &'a str, columns: &[UsedColumn], sign: char) -> Vec<Doubtful> {
        let mut found: Vec<Doubtful> = columns.iter().map(|_| Doubtful::default()).collect();
        if !self.lines(text).any(|(_, line)| line.contains(sign)) {
            return found;
        }
        for row in self.rows(text) {
            for (column, found) in columns.iter().zip(&mut found) {
                if let Some(field) = row.fields.get(column.index) {
                    found.add(row.line, field, sign);
                }
            }
            if found.iter().all(|found| found.others) {
                break;
            }
        }
        found
    }
}

impl Doubtful {
    fn add(&mut self, line: usize, field: &str, sign: char) {
        match Shape::of(field, sign) {
            Shape::Either => {
                self.numbers += 1;
                self.first.get_or_insert_with(|| (line, field.to_owned()));
            }
            Shape::Whole { three: true } => self.numbers += 1,
            Shape::Other if number(field, true).is_none() => (),
            Shape::Whole { .. } | Shape::Decimal | Shape::Other => self.others = true,
        }
    }

    /// The line and the text of the first number that may be either.
    fn shown(&self) -> (Option<usize>, &str) {
        self.first.as_ref().map_or((None, ""), |(line, field)| (Some(*line), field))
    }

    fn decided(&self, column: &UsedColumn, sign: char) -> ReadingNote {
        let field = self.shown().1;
        let (whole, other) = (field.replace(sign, ""), if sign == '.' { "commas" } else { "points" });
        let text = format!("{}: {field} is {whole}, for {other} stand before the decimals of the file", column.label);
        ReadingNote { text, assumed: true }
    }

    fn decimal(&self, column: &UsedColumn) -> ReadingNote {
        let field = self.shown().1;
        let text = format!("{}: {field} has a decimal comma, for semicolons part the fields", column.label);
        ReadingNote { text, assumed: true }
    }

    fn either(&self, column: &UsedColumn, sign: char) -> ContentError {
        let (line, field) = self.shown();
        let whole = field.replace(sign, "");
        let [decimal, parted] = if sign == '.' { ["point", "comma"] } else { ["comma", "point"] };
        let expected = format!(
            "a line above the names that says which it is, \"# decimal {decimal}\" for {field} or \"# decimal {parted}\" \
             for {whole}: all numbers of the column have three digits behind the sign, and no other number of the file \
             decides"
        );
        ContentError::value(line, &column.label, &format!("\"{}\"", shortened(field)), &expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Result<(Vec<Option<f64>>, Option<String>), String> {
        let blocks = Block::all(text, true);
        let signs = DecimalSigns::of(&blocks, text);
        let last = blocks[0].columns - 1;
        let (mut style, notes) = blocks[0]
            .style_with(text, signs, &[UsedColumn::new(last, "E")])
            .map_err(|error| error.within("t".as_ref()))?;
        let read = blocks[0].rows(text).map(|row| style.read(&row.fields[last]).map_err(|error| error.to_string()));
        Ok((read.collect::<Result<_, _>>()?, notes.into_iter().next().map(|note| note.text)))
    }

    #[test]
    fn numbers_that_may_be_thousands_are_asked_about() {
        for text in
            ["f;E\n1;5.982\n10;12.004\n", "f,E\n1,5.982\n10,12.004\n", "f E\n1 5,982\n10 12,004\n", "E\n982\n5.982\n"]
        {
            let refusal = numbers(text).unwrap_err();
            assert!(
                refusal.contains("expected a line above the names that says which it is, \"# decimal "),
                "{refusal}"
            );
            assert!(refusal.contains("for 5982"), "{refusal}");
        }
    }

    #[test]
    fn what_else_the_file_has_decides() {
        for (text, first) in [
            // Decimals beyond doubt, in the column and beside it.
            ("f,E\n1,5.982\n10,12.04\n", 5.982),
            ("f,E\n0.1,5.982\n10,12.004\n", 5.982),
            ("f,E\n1,5.982\n10,0.004\n", 5.982),
            ("f;E\n1;5.982\n10;1234.500\n", 5.982),
            ("f;E\n1;5.982\n1e-3;12.004\n10.5;12.004\n", 5.982),
            ("# decimal point\nf;E\n1;5.982\n10;12.004\n", 5.982),
            ("Dezimaltrennzeichen: Komma\nf\tE\n1\t5,982\n10\t12,004\n", 5.982),
            // Whole numbers beyond a thousand have no sign.
            ("f;E\n1;5.982\n10;12004\n", 5.982),
            ("f;E\n1;5,982\n10;12,004\n", 5.982),
            // One number alone.
            ("f;E\n1;5.982\n", 5.982),
            ("f;E\n0,1;5.982\n10;12.004\n", 5982.0),
            ("f;E\n0.1;5,982\n10;12,004\n", 5982.0),
            ("# decimal comma\nf;E\n1;5.982\n10;982\n", 5982.0),
        ] {
            let (read, note) = numbers(text).unwrap();
            assert_eq!(read[0], Some(first), "{text} {note:?}");
            assert!(first < 1e3 || note.is_some_and(|note| note.contains("is 5982, for ")), "{text}");
        }
    }
}
