//! The columns that a client wants of a file, and the table of numbers that it gets.

use super::blocks::Block;
use super::columns::{Column, Header, ReadingNote, UnitRule};
use super::error::{ContentError, shortened};
use super::headings::{Heading, Words};
use super::lines::Line;
use super::range::{ANY, NumberRange};
use super::thousands::DecimalSigns;
use super::units::Dimension;

/// What a file with one table must hold.
#[derive(Clone, Debug)]
pub struct Format<Q: 'static, const N: usize> {
    /// The words of its quantities.
    pub vocabulary: &'static [Words<Q>],
    /// The columns.
    pub columns: [Wanted<Q>; N],
    /// The columns in words.
    pub expected: &'static str,
    /// Whether a table without names is refused; else it has its columns in their order, in SI units.
    pub needs_names: bool,
    /// The least number of rows.
    pub least: usize,
    /// Whether the numbers of the first column must rise.
    pub rises: bool,
    /// What else the file may hold.
    pub others: Others,
}

/// What is done about all that is not wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Others {
    /// There must be no other columns and no other lines but comments.
    Refused,
    /// Columns, and lines behind the table, are left out, which a note says; a second table is refused.
    LeftOut,
    /// So are other tables than the longest.
    Tables,
}

/// A column that is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<Q: 'static> {
    /// What it may hold; the first where the file has no names.
    pub quantities: &'static [Q],
    /// Its name, where the file has none.
    pub name: &'static str,
    /// What its numbers are, as a plural.
    pub meaning: &'static str,
    /// The numbers that it may hold, in SI units.
    pub range: NumberRange,
    /// Whether a file must have it.
    pub required: bool,
    /// Whether a table without names has it.
    pub unnamed: bool,
    /// Which it is, where several have such names.
    pub choice: Choice,
    /// What is done where no unit is named.
    pub unit: UnitRule,
}

/// Which of several columns with such names is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// There must be one alone.
    One,
    /// The only one of the first quantity that there is.
    FirstQuantity,
    /// The first one.
    First,
}

/// The numbers of a table.
#[derive(Debug)]
pub struct Table<'a, Q, const N: usize> {
    /// The columns; `None` of those that the file does not have.
    pub columns: [Option<Column<Q>>; N],
    /// The rows, in SI units; 0 in columns that the file does not have.
    pub rows: Vec<[f64; N]>,
    /// The lines of the rows.
    pub lines: Vec<usize>,
    /// How they were read.
    pub notes: Vec<ReadingNote>,
    /// The line of the names.
    pub line: Option<usize>,
    /// The lines above the rows; comments without their sign.
    pub above: Vec<Line<'a>>,
}

impl<Q> Wanted<Q> {
    /// A column that must be there, with any number, in SI units where it names none.
    pub const fn new(quantities: &'static [Q], name: &'static str, meaning: &'static str) -> Self {
        let (choice, unit) = (Choice::One, UnitRule::Assumed);
        Self { quantities, name, meaning, range: ANY, required: true, unnamed: true, choice, unit }
    }

    /// The same, which need not be there.
    pub const fn optional(self) -> Self {
        Self { required: false, unnamed: false, ..self }
    }

    /// The same, which a table with names need not have.
    pub const fn optional_by_name(self) -> Self {
        Self { required: false, ..self }
    }

    /// The same where a file must not have it.
    #[must_use]
    pub const fn absent(self) -> Self {
        Self { quantities: &[], required: false, unnamed: false, ..self }
    }

    /// The same with numbers of a range.
    pub const fn within(self, range: NumberRange) -> Self {
        Self { range, ..self }
    }
}

impl<Q: Copy + PartialEq, const N: usize> Format<Q, N> {
    /// A file with rows of these columns and nothing else of importance.
    pub const fn new(vocabulary: &'static [Words<Q>], columns: [Wanted<Q>; N], expected: &'static str) -> Self {
        let (needs_names, least, rises) = (false, 1, false);
        Self { vocabulary, columns, expected, needs_names, least, rises, others: Others::LeftOut }
    }

    /// Reads the table in a text.
    ///
    /// # Errors
    /// [`ContentError`] with the line, the column, what was found and what was expected.
    pub fn read<'a>(&self, text: &'a str) -> Result<Table<'a, Q, N>, ContentError> {
        let mut notes = Vec::new();
        let block = self.block(text, &mut notes)?;
        let header = Header::read(&block, self.vocabulary, &[]);
        let columns = match header.names.is_empty() {
            true => self.unnamed(&block, &mut notes)?,
            false => self.named(&block, &header, &mut notes)?,
        };
        let used: Vec<usize> = columns.iter().flatten().map(|column| column.index).collect();
        match self.others {
            Others::Refused => self.check_others(text, &block, &header, &used)?,
            Others::LeftOut | Others::Tables => {
                notes.extend(header.left_out(&used));
                let mut below = block.below(text);
                notes.extend(below.next().map(|(line, _)| behind_note(line, 1 + below.count())));
            }
        }
        let mut table =
            Table { columns, rows: Vec::new(), lines: Vec::new(), notes, line: header.line, above: Vec::new() };
        self.add_rows(text, &block, &mut table)?;
        Ok(Table { above: block.above, ..table })
    }

    /// The only table, or the longest.
    fn block<'a>(&self, text: &'a str, notes: &mut Vec<ReadingNote>) -> Result<Block<'a>, ContentError> {
        let mut blocks = Block::all(text, false);
        let longest = (0..blocks.len()).max_by_key(|&i| blocks[i].rows);
        let Some(block) = longest.map(|i| blocks.swap_remove(i)) else {
            return Err(self.too_few(Some(text.lines().count().max(1)), 0));
        };
        blocks.sort_by_key(|other| other.first);
        let mut others = blocks.iter().filter(|other| other.columns > 1);
        if self.others == Others::Tables {
            notes.extend(others.map(|other| {
                let text = format!("lines {} to {}, another table, are left out", other.first, other.last);
                ReadingNote { text, assumed: false }
            }));
        } else if let Some(other) = others.next() {
            let given = format!("from line {} and from line {}", other.first, block.first);
            return Err(ContentError::value(Some(other.first), "tables", &given, "one table"));
        }
        Ok(block)
    }

    fn too_few(&self, line: Option<usize>, rows: usize) -> ContentError {
        let expected = if self.least == 1 { "at least one row" } else { "at least two rows" };
        ContentError::value(line, "rows", &rows.to_string(), &format!("{expected} of numbers: {}", self.expected))
    }

    /// The columns by their names.
    fn named(
        &self,
        block: &Block<'_>,
        header: &Header<'_, Q>,
        notes: &mut Vec<ReadingNote>,
    ) -> Result<[Option<Column<Q>>; N], ContentError> {
        let mut columns = [const { None }; N];
        for (place, wanted) in columns.iter_mut().zip(&self.columns) {
            let Some(index) = self.place(wanted, header)? else { continue };
            let is_first = |heading: &Heading<Q>| heading.quantity == wanted.quantities[0];
            let rule = match wanted.unit {
                UnitRule::AssumedOfFirst if header.headings[index].as_ref().is_some_and(is_first) => UnitRule::Assumed,
                UnitRule::AssumedOfFirst => UnitRule::Named,
                rule => rule,
            };
            let column = header.column(index, rule, None)?;
            column.check_plain(header.line)?;
            column.check_assumed(block, header.line)?;
            notes.push(column.note(wanted.meaning));
            *place = Some(column);
        }
        for column in columns.iter().flatten() {
            column.check_beside(columns.iter().flatten(), header.line)?;
        }
        Ok(columns)
    }

    /// Where a column stands.
    fn place(&self, wanted: &Wanted<Q>, header: &Header<'_, Q>) -> Result<Option<usize>, ContentError> {
        let mut found = match wanted.choice {
            Choice::FirstQuantity => {
                let kinds = wanted.quantities.iter().map(|quantity| header.places(&[*quantity]));
                kinds.into_iter().find(|places| !places.is_empty()).unwrap_or_default()
            }
            Choice::One | Choice::First => header.places(wanted.quantities),
        };
        if wanted.choice == Choice::First {
            found.truncate(1);
        }
        let refuse = |given: &str, expected: &str| Err(ContentError::value(header.line, "columns", given, expected));
        match found[..] {
            [] if wanted.required => refuse(&header.given(), self.expected),
            [] => Ok(None),
            [index] => Ok(Some(index)),
            [first, second, ..] => {
                let [first, second] = [first, second].map(|index| header.names[index].trim());
                refuse(&format!("\"{first}\" and \"{second}\""), &format!("one of them; {}", self.expected))
            }
        }
    }

    /// The columns of a table without names in their order, in SI units.
    fn unnamed(&self, block: &Block<'_>, notes: &mut Vec<ReadingNote>) -> Result<[Option<Column<Q>>; N], ContentError> {
        let required = self.columns.iter().filter(|column| column.unnamed).count();
        let refuse = |given: &str, expected: &str| ContentError::value(Some(block.first), "columns", given, expected);
        if self.needs_names {
            return Err(refuse("no names", self.expected));
        }
        if block.columns != required {
            let expected = format!("{}; without names {required} columns in this order", self.expected);
            return Err(refuse(&block.columns.to_string(), &expected));
        }
        let dimension = |quantity: Q| self.vocabulary.iter().find(|words| words.quantity == quantity);
        let mut next = 0..;
        let columns = self.columns.each_ref().map(|wanted| {
            let (index, quantity) = (if wanted.unnamed { next.next()? } else { return None }, wanted.quantities[0]);
            let dimension = dimension(quantity).map_or(Dimension::Number, |words| words.dimension);
            Some(Column::unnamed(index, wanted.name, quantity, dimension))
        });
        for (column, wanted) in
            columns.iter().zip(&self.columns).filter_map(|(found, wanted)| Some((found.as_ref()?, wanted)))
        {
            column.check_assumed(block, None)?;
            let (number, meaning, unit) = (column.index + 1, wanted.meaning, column.unit);
            let text = format!("no names: column {number} is taken as {meaning} in {unit}");
            notes.push(ReadingNote { text, assumed: true });
        }
        Ok(columns)
    }

    /// Refuses other columns, and other lines than comments below the names.
    fn check_others(
        &self,
        text: &str,
        block: &Block<'_>,
        header: &Header<'_, Q>,
        used: &[usize],
    ) -> Result<(), ContentError> {
        if (0..block.columns).any(|index| !used.contains(&index)) {
            let expected = format!("{} alone, in {} columns", self.expected, used.len());
            let given = format!("{} in {} columns", header.given(), block.columns);
            return Err(ContentError::value(header.line, "columns", &given, &expected));
        }
        match block.stray_line(&header.head).or_else(|| block.below(text).next()) {
            Some((line, text)) => {
                Err(ContentError::value(Some(line), "row", &format!("\"{}\"", shortened(text)), "numbers"))
            }
            None => Ok(()),
        }
    }

    fn add_rows<'a>(&self, text: &'a str, block: &Block<'a>, table: &mut Table<'_, Q, N>) -> Result<(), ContentError> {
        let used: Vec<_> = table.columns.iter().flatten().map(Column::used).collect();
        let (mut style, notes) = block.style_with(text, DecimalSigns::of([block], text), &used)?;
        table.notes.extend(notes);
        for row in block.rows(text) {
            let mut numbers = [0.0; N];
            for ((number, column), wanted) in numbers.iter_mut().zip(&table.columns).zip(&self.columns) {
                let Some(column) = column else { continue };
                *number = column.read(&row, &mut style, wanted.range)?;
            }
            if let (Some(before), Some(column)) = (table.rows.last().filter(|_| self.rises), &table.columns[0])
                && numbers[0] <= before[0]
            {
                let [found, before] = [numbers[0], before[0]].map(|number| column.in_si_units(number));
                let expected = format!("more than {before}, that of the row before: they must rise");
                return Err(ContentError::value(Some(row.line), &column.label(), &found, &expected));
            }
            table.rows.push(numbers);
            table.lines.push(row.line);
        }
        if table.rows.len() < self.least { Err(self.too_few(Some(block.last), table.rows.len())) } else { Ok(()) }
    }
}

/// A note of lines behind a table that are not read.
pub fn behind_note(line: usize, count: usize) -> ReadingNote {
    let text = match count {
        1 => format!("line {line}, behind the table, is left out"),
        _ => format!("{count} lines from line {line} on, behind the table, are left out"),
    };
    ReadingNote { text, assumed: false }
}

#[cfg(test)]
mod tests {
    use super::super::range::POSITIVE;
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Of {
        Time,
        Force,
        Pressure,
    }

    const LOADS: Format<Of, 2> = Format::new(
        &[
            Words::new(Of::Time, Dimension::Time, "t time", ""),
            Words::new(Of::Force, Dimension::Force, "force", ""),
            Words::new(Of::Pressure, Dimension::Pressure, "pressure", ""),
        ],
        [
            Wanted::new(&[Of::Time], "time", "times"),
            Wanted { choice: Choice::FirstQuantity, ..Wanted::new(&[Of::Pressure, Of::Force], "load", "loads") }
                .within(POSITIVE),
        ],
        "time and load",
    );

    fn refusal(format: &Format<Of, 2>, text: &str) -> String {
        format.read(text).map_or_else(|error| error.within("t.csv".as_ref()), |table| format!("{table:?}"))
    }

    #[test]
    fn wanted_columns_are_read_and_all_else_is_said() {
        let text = "# a drum\nrun;t [ms];force [kN];pressure [bar]\n1;5;9;0,5\n2;7,5;9;1\n\nmean;6\n";
        let table = LOADS.read(text).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!((&table.rows[..], &table.lines[..]), (&[[0.005, 5e4], [0.0075, 1e5]][..], &[3, 4][..]));
        let notes: Vec<&str> = table.notes.iter().map(|note| note.text.as_str()).collect();
        let expected = [
            "times from column 2 (t [ms]) in ms",
            "loads from column 4 (pressure [bar]) in bar",
            "columns left out: run, force [kN]",
            "line 6, behind the table, is left out",
        ];
        assert_eq!(notes, expected);
        let two = "t [s],force [N]\n1,2\n2,2\n# rest\nt [s],force [N]\n1,2\n";
        assert!(refusal(&LOADS, two).starts_with("t.csv:6: tables = from line 6 and from line 2: expected one table"));
        let longest = Format { others: Others::Tables, ..LOADS };
        let table = longest.read(two).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!(table.notes[0].text, "lines 6 to 6, another table, are left out");
    }

    /// Beside a column in another unit SI is no guess.
    #[test]
    fn a_unit_is_not_assumed_beside_another_one() {
        const POINTS: Format<u8, 2> = Format::new(
            &[Words::new(0, Dimension::Length, "x", ""), Words::new(1, Dimension::Area, "area", "")],
            [Wanted::new(&[0], "x", "positions"), Wanted::new(&[1], "area", "areas")],
            "x,area",
        );
        let refused = POINTS.read("x [mm],area\n1,2\n").map_or_else(|error| error.to_string(), |_| String::new());
        let expected = "unit of column 2 (area): expected the unit beside its name, as in area [m²], for column 1 (x [mm]) \
                        names mm";
        assert_eq!(refused, expected);
        assert!(POINTS.read("x [m],area\n1,2\n").is_ok() && POINTS.read("x,area\n1,2\n").is_ok());
    }

    #[test]
    fn a_strict_file_has_nothing_else() {
        let strict = Format { others: Others::Refused, needs_names: true, ..LOADS };
        assert!(strict.read("# ours\nt,force\ns,N\n1,2\n\n# end\n").is_ok());
        for (text, message) in [
            (
                "t,force,x\n1,2,3\n",
                "t.csv:1: columns = \"t, force, x\" in 3 columns: expected time and load alone, in 2 columns",
            ),
            ("t,force\n1,2,3\n", "t.csv:1: columns = \"t, force, \" in 3 columns: expected time and load alone"),
            ("t,force\none,two\n1,2\n", "t.csv:2: row = \"one,two\": expected numbers"),
            ("t,force\n1,2\nend\n", "t.csv:3: row = \"end\": expected numbers"),
            ("1,2\n", "t.csv:1: columns = no names: expected time and load"),
            (
                "t,force [kN]\n1,2\n1,-2\n",
                "t.csv:3: column 2 (force [kN]) = \"-2\": expected a number from 1e-30 to 1e30 in N",
            ),
            ("t,force\n1,2\n1,\n", "t.csv:3: column 2 (force): expected a number from 1e-30 to 1e30"),
        ] {
            assert!(refusal(&strict, text).starts_with(message), "{text}\n{}", refusal(&strict, text));
        }
    }
}
