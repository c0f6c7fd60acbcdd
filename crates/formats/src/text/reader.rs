//! Tables of text of some kind: their columns by names, by what is said of them, or by their order.

use std::borrow::Cow;

use asperity::tables::{
    ContentError, Dimension, FileKind, GivenColumns, NumberRange, Others, Presence, ReadColumn, ReadTable, ReadingNote,
    Role, Unit, UnitRule, shortened,
};

use super::blocks::Block;
use super::decimals::{UsedColumn, decimal_of};
use super::head::Head;
use super::lines::Line;
use super::names::{self, Heading, chosen, unit_beside};
use super::numbers::Decimal;

/// Reads the table of a kind in a text; the lines above it, comments without their sign.
///
/// # Errors
/// [`ContentError`] with the line, the column, what was found and what was expected.
pub fn read<'a>(
    text: &'a str,
    kind: &FileKind,
    given: &GivenColumns,
) -> Result<(ReadTable, Vec<Line<'a>>), ContentError> {
    let mut notes = Vec::new();
    let block = only_block(text, kind, &mut notes)?;
    let is_given = |name: &str| given.iter().any(|(_, column)| column.trim() == name.trim());
    let roles: Vec<Role> = kind.roles.iter().filter(|role| role.presence != Presence::Absent).copied().collect();
    let head = block.head(&|name| is_given(name) || !matches!(names::find(name, "", &roles), Ok(None)))?;
    let choice = Choice { kind, roles: &roles, given, block: &block, head: &head };
    let mut columns =
        if head.names.is_empty() && given.is_empty() { choice.by_position()? } else { choice.by_names()? };
    let used: Vec<UsedColumn> = columns.iter().map(used_column).collect();
    let decimal = decimal_of(&[&block], text, &used)?;
    let mut lines = Vec::with_capacity(block.rows);
    for row in block.rows(text) {
        for column in &mut columns {
            let field = row.fields.get(column.index).map_or("", |field| field);
            let number = value(column, kind, decimal, row.line, field)?;
            column.values.push(number);
        }
        lines.push(row.line);
    }
    if kind.rises {
        notes.extend(without_repeats(&mut columns, &mut lines));
    }
    let left_out = left_out(&head.names, &columns);
    if kind.others == Others::Refused {
        choice.check_others(text, &left_out)?;
    }
    notes.insert(0, told(&columns, lines.len(), &left_out));
    let mut below = block.below(text);
    notes.extend(below.next().map(|(line, _)| behind_note(line, 1 + below.count())));
    let table = ReadTable { columns, lines, notes, line: head.line.or(Some(block.first)) };
    kind.check(&table)?;
    Ok((table, block.above))
}

/// The only table, or the longest.
fn only_block<'a>(text: &'a str, kind: &FileKind, notes: &mut Vec<ReadingNote>) -> Result<Block<'a>, ContentError> {
    let mut blocks = Block::all(text, false);
    let longest = (0..blocks.len()).max_by_key(|&i| blocks[i].rows);
    let Some(block) = longest.map(|i| blocks.swap_remove(i)) else {
        let is_clock =
            |line: &str| line.matches(':').count() > 1 && line.contains(|letter: char| letter.is_ascii_digit());
        let clock = if text.lines().any(is_clock) { ", times in seconds and not as of a clock" } else { "" };
        let expected = format!("at least one row of numbers{clock}: {}", kind.expected);
        return Err(ContentError::value(Some(text.lines().count().max(1)), "rows", "0", &expected));
    };
    blocks.sort_by_key(|other| other.first);
    let mut others = blocks.iter().filter(|other| other.columns > 1);
    if kind.others == Others::Tables {
        notes.extend(others.map(|other| {
            let text = format!("lines {} to {}, another table, are left out", other.first, other.last);
            ReadingNote { text, assumed: false }
        }));
    } else if let Some(other) = others.next() {
        let given = format!("from line {} and from line {}", other.first, block.first);
        return Err(ContentError::value(
            Some(other.first),
            "tables",
            &given,
            "one table, with as many fields in each row",
        ));
    }
    Ok(block)
}

/// Takes out rows that are all the same as the one before: a file of a run may have its events twice.
fn without_repeats(columns: &mut [ReadColumn], lines: &mut Vec<usize>) -> Option<ReadingNote> {
    let is_new = |row: usize| row == 0 || columns.iter().any(|column| column.values[row - 1] != column.values[row]);
    let kept: Vec<bool> = (0..lines.len()).map(is_new).collect();
    let repeats = kept.iter().filter(|is_kept| !**is_kept).count();
    if repeats == 0 {
        return None;
    }
    let mut keep = kept.iter().copied();
    lines.retain(|_| keep.next().unwrap_or(true));
    for column in columns {
        let mut keep = kept.iter().copied();
        column.values.retain(|_| keep.next().unwrap_or(true));
    }
    let text = format!("{repeats} rows that are those before them once more are taken as one");
    Some(ReadingNote { text, assumed: false })
}

/// A column as one that is read.
pub fn used_column(column: &ReadColumn) -> UsedColumn {
    let is_out = matches!(column.unit.dimension, Dimension::Number | Dimension::Temperature | Dimension::Angle);
    UsedColumn { index: column.index, label: column.label(), at_stake: !is_out }
}

/// The number in a field of a column, in SI units. One with a sign of per cent is one where the column has ratios.
pub fn number_of(column: &ReadColumn, decimal: Decimal, field: &str) -> Option<f64> {
    match field.strip_suffix('%') {
        Some(percent) if column.dimension == Dimension::Number => {
            decimal.read(percent.trim_end()).map(|number| number / 100.0)
        }
        Some(_) => None,
        None => decimal.read(field).map(|written| column.unit.to_si(written)),
    }
}

/// The number in a field of a column, in SI units, which is one of its range.
fn value(
    column: &ReadColumn,
    kind: &FileKind,
    decimal: Decimal,
    line: usize,
    field: &str,
) -> Result<f64, ContentError> {
    let range = kind.role(column.key).map_or(asperity::tables::ANY, |role| role.range);
    let read = number_of(column, decimal, field).filter(|number| range.holds(*number));
    read.ok_or_else(|| no_number(column, range, decimal, (line, field)))
}

/// The error of a field of a line that is no number of a range.
pub fn no_number(
    column: &ReadColumn,
    range: NumberRange,
    decimal: Decimal,
    (line, field): (usize, &str),
) -> ContentError {
    let given = if field.is_empty() { String::new() } else { format!("\"{}\"", shortened(field)) };
    let dimension = column.unit.dimension;
    let is_plain = column.unit.is_si() || dimension == Dimension::Number;
    let mut expected = if is_plain { range.to_string() } else { format!("{range} in {}", Unit::si(dimension)) };
    if decimal.read(field).is_none() && super::numbers::is_number(field) {
        expected = "numbers with decimal points or with decimal commas, not both in one file".to_owned();
    }
    ContentError::value(Some(line), &column.label(), &given, &expected)
}

/// Finds the columns of the roles.
struct Choice<'c, 'a> {
    kind: &'c FileKind,
    roles: &'c [Role],
    given: &'c GivenColumns,
    block: &'c Block<'a>,
    head: &'c Head<'a>,
}

impl Choice<'_, '_> {
    fn refuse(&self, key: &str, given: &str, expected: &str) -> ContentError {
        ContentError::value(self.head.line.or(Some(self.block.first)), key, given, expected)
    }

    fn name(&self, index: usize) -> &str {
        self.head.names.get(index).map_or("", |name| name.trim())
    }

    fn unit_below(&self, index: usize) -> &str {
        self.head.units.get(index).map_or("", |unit| unit)
    }

    /// The names in messages.
    fn names(&self) -> String {
        let names: Vec<&str> = self.head.names.iter().map(|name| name.trim()).collect();
        format!("\"{}\"", shortened(&names.join(", ")))
    }

    /// The columns by what is said of them, and by their names.
    fn by_names(&self) -> Result<Vec<ReadColumn>, ContentError> {
        let mut columns = Vec::new();
        for (key, name) in self.given {
            columns.push(self.given_column(key, name)?);
        }
        // An empty last column, with a name and without values, is none.
        let free = (0..self.head.names.len().min(self.block.columns))
            .filter(|index| columns.iter().all(|column| column.index != *index));
        let found: Vec<_> = free.map(|i| (i, names::find(self.name(i), self.unit_below(i), self.roles))).collect();
        for (place, role) in self.roles.iter().enumerate() {
            if self.given.iter().any(|(key, _)| key == role.key) {
                continue;
            }
            let of_role = |(index, found): &(usize, _)| match found {
                Ok(Some(Heading { role, unit })) if *role == place => Some((*index, *unit)),
                _ => None,
            };
            let places: Vec<(usize, Option<Unit>)> = found.iter().filter_map(of_role).collect();
            match places[..] {
                [] => self.check_refused(place, &found)?,
                [(index, unit)] => columns.push(self.column(role, index, unit)?),
                [(first, _), (second, _), ..] => {
                    let given = format!("\"{}\" and \"{}\"", self.name(first), self.name(second));
                    let way = format!("columns = {{ {} = \"NAME\" }} (--column {0}=NAME)", role.key);
                    return Err(self.refuse(
                        "columns",
                        &given,
                        &format!("one of them, or {way}: {}", self.kind.expected),
                    ));
                }
            }
        }
        self.take_one(&mut columns);
        self.check_missing(&columns)?;
        for column in &columns {
            self.check_beside(column, &columns)?;
        }
        Ok(columns)
    }

    /// A column that is said to be that of a role.
    fn given_column(&self, key: &str, name: &str) -> Result<ReadColumn, ContentError> {
        let Some(role) = self.roles.iter().find(|role| role.key == key) else {
            let known: Vec<&str> = self.roles.iter().map(|role| role.key).collect();
            return Err(ContentError::value(
                None,
                "columns",
                &format!("\"{key}\""),
                &format!("one of {}", known.join(", ")),
            ));
        };
        let index = chosen(name, &self.head.names, self.block.columns, self.head.line)?;
        let unit = unit_beside(self.name(index), self.unit_below(index), role.dimension);
        let unit = unit.map_err(|found| {
            self.refuse(&self.unit_key(index), &format!("\"{found}\""), &format!("one of {}", role.dimension.units()))
        })?;
        self.column(role, index, unit)
    }

    /// Refuses a table in which the only heading of a role is one that cannot be it.
    fn check_refused(
        &self,
        place: usize,
        found: &[(usize, Result<Option<Heading>, names::RefusedHeading>)],
    ) -> Result<(), ContentError> {
        let of_role = |(index, found): &(usize, Result<_, names::RefusedHeading>)| match found {
            Err(refused) if refused.role == place => Some((*index, refused.clone())),
            _ => None,
        };
        match found.iter().find_map(of_role) {
            Some((index, refused)) => {
                let given = format!("\"{}\"", shortened(&refused.found));
                Err(self.refuse(&self.unit_key(index), &given, &refused.expected))
            }
            None => Ok(()),
        }
    }

    fn label(&self, index: usize) -> String {
        match self.name(index) {
            "" => format!("column {}", index + 1),
            name => format!("column {} \"{}\"", index + 1, shortened(name)),
        }
    }

    fn unit_key(&self, index: usize) -> String {
        format!("unit of {}", self.label(index))
    }

    /// The column of a role in a unit, where one is named.
    fn column(&self, role: &Role, index: usize, unit: Option<Unit>) -> Result<ReadColumn, ContentError> {
        let unit = match role.unit {
            UnitRule::Ignored => Some(Unit::ONE),
            _ if role.dimension == Dimension::Number => Some(unit.unwrap_or(Unit::ONE)),
            UnitRule::Named if unit.is_none() => {
                let expected = format!("it beside the name: one of {}", role.dimension.units());
                return Err(self.refuse(&self.unit_key(index), "", &expected));
            }
            _ => unit,
        };
        let names_unit = unit.is_some();
        let unit = unit.unwrap_or(Unit::si(role.dimension));
        let text = self.name(index).to_owned();
        let column = ReadColumn { names_unit, text, ..ReadColumn::new(role, index, unit) };
        self.check_assumed(&column)?;
        Ok(column)
    }

    /// Of roles of which a file has one, the first.
    fn take_one(&self, columns: &mut Vec<ReadColumn>) {
        for keys in self.kind.one_of {
            let has = |key: &&&str| columns.iter().any(|column| column.key == **key);
            let first = keys.iter().find(has).copied();
            columns.retain(|column| !keys.contains(&column.key) || Some(column.key) == first);
        }
    }

    fn check_missing(&self, columns: &[ReadColumn]) -> Result<(), ContentError> {
        let has = |key: &str| columns.iter().any(|column| column.key == key);
        let required = |role: &&Role| role.presence == Presence::Required;
        let missing = self.roles.iter().filter(required).map(|role| role.key).find(|key| !has(key));
        let none = || self.kind.one_of.iter().find(|keys| !keys.iter().any(|key| has(key))).map(|keys| keys[0]);
        let Some(key) = missing.or_else(none) else { return Ok(()) };
        let way = format!("or columns = {{ {key} = \"NAME\" }} (--column {key}=NAME)");
        let names = if self.head.names.is_empty() { "no names".to_owned() } else { self.names() };
        Err(self.refuse("columns", &names, &format!("{}; {way}", self.kind.expected)))
    }

    /// The columns of a table without names in their order, in SI units.
    fn by_position(&self) -> Result<Vec<ReadColumn>, ContentError> {
        if !self.kind.by_position {
            return Err(self.refuse("columns", "no names", self.kind.expected));
        }
        let is_one = |role: &&Role| self.kind.one_of.iter().any(|keys| keys[0] == role.key);
        let has = |role: &&Role| matches!(role.presence, Presence::Required | Presence::Unnamed) || is_one(role);
        let roles: Vec<&Role> = self.roles.iter().filter(has).collect();
        if self.block.columns != roles.len() {
            let expected = format!("{}; without names {} columns in this order", self.kind.expected, roles.len());
            return Err(self.refuse("columns", &self.block.columns.to_string(), &expected));
        }
        let column = |(index, role): (usize, &&Role)| {
            let unit = self.head.units.get(index).and_then(|unit| Unit::parse(unit));
            let unit = unit.filter(|unit| unit.is_of(role.dimension));
            self.column(role, index, unit)
        };
        roles.iter().enumerate().map(column).collect()
    }

    /// Refuses to assume a unit where a line above speaks of another one.
    fn check_assumed(&self, column: &ReadColumn) -> Result<(), ContentError> {
        let Some(assumed) = assumed_unit(column) else { return Ok(()) };
        let stated = self.block.stated_unit(assumed.dimension, self.head.line);
        match stated.filter(|(_, unit)| unit.name != assumed.name) {
            Some(((line, text), unit)) => {
                let name = if column.text.is_empty() { column.key } else { &column.text };
                let expected = format!("the unit beside the name of its column, as in {name} [{unit}]");
                Err(ContentError::value(Some(line), "unit", &format!("\"{}\"", shortened(text)), &expected))
            }
            None => Ok(()),
        }
    }

    /// Refuses to assume a unit beside another column of the same quantity, lengths and areas being one, that names one.
    fn check_beside(&self, column: &ReadColumn, all: &[ReadColumn]) -> Result<(), ContentError> {
        let quantity = |unit: &Unit| if unit.dimension == Dimension::Area { Dimension::Length } else { unit.dimension };
        let Some(assumed) = assumed_unit(column) else { return Ok(()) };
        let is_other = |other: &&ReadColumn| {
            other.names_unit && quantity(&other.unit) == quantity(&assumed) && !other.unit.is_si()
        };
        let Some(other) = all.iter().find(is_other) else { return Ok(()) };
        let expected = format!(
            "the unit beside its name, as in {} [{assumed}], for {} names {}",
            column.text,
            other.label(),
            other.unit
        );
        Err(self.refuse(&self.unit_key(column.index), "", &expected))
    }

    /// Refuses other columns, and other lines than comments below the names.
    fn check_others(&self, text: &str, left_out: &[String]) -> Result<(), ContentError> {
        if !left_out.is_empty() {
            let expected = format!("{} alone", self.kind.expected);
            return Err(self.refuse("columns", &format!("{} too", left_out.join(", ")), &expected));
        }
        let line = self.block.stray_line(self.head).or_else(|| self.block.below(text).next());
        line.map_or(Ok(()), |(line, text)| {
            Err(ContentError::value(Some(line), "row", &format!("\"{}\"", shortened(text)), "numbers"))
        })
    }
}

/// The unit that is assumed, where none is named.
pub fn assumed_unit(column: &ReadColumn) -> Option<Unit> {
    (!column.names_unit && column.unit.dimension != Dimension::Number).then_some(column.unit)
}

/// The headings of columns that are not read.
fn left_out(names: &[Cow<'_, str>], columns: &[ReadColumn]) -> Vec<String> {
    let is_out = |index: &usize| columns.iter().all(|column| column.index != *index);
    let text = |index: usize| match names[index].trim() {
        "" => format!("column {} without a name", index + 1),
        name => shortened(name),
    };
    // A column without a name and without values is none.
    (0..names.len()).filter(is_out).map(text).collect()
}

/// How a table was read, in a line.
pub fn told(columns: &[ReadColumn], rows: usize, left_out: &[String]) -> ReadingNote {
    let column = |column: &ReadColumn| match assumed_unit(column) {
        Some(unit) => format!("{} = {} in {unit}, assumed", column.key, column.label()),
        None => format!("{} = {}", column.key, column.label()),
    };
    let read: Vec<String> = columns.iter().map(column).collect();
    let text = format!("{}; {rows} rows{}", read.join(", "), left_out_words(left_out));
    ReadingNote { text, assumed: columns.iter().any(|column| assumed_unit(column).is_some() || column.text.is_empty()) }
}

/// `; left out: Flag, remark`
pub fn left_out_words(left_out: &[String]) -> String {
    const MOST: usize = 12;
    let more = if left_out.len() > MOST { format!(" and {} more", left_out.len() - MOST) } else { String::new() };
    let few: Vec<&str> = left_out.iter().take(MOST).map(String::as_str).collect();
    if few.is_empty() { String::new() } else { format!("; left out: {}{more}", few.join(", ")) }
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
    use asperity::tables::POSITIVE;

    use super::*;

    const ROLES: [Role; 3] = [
        Role::new("time", "t", Dimension::Time),
        Role::new("load", "F, force", Dimension::Force).optional().within(POSITIVE),
        Role::new("pressure", "p", Dimension::Pressure).optional().within(POSITIVE),
    ];
    const LOADS: FileKind = FileKind {
        one_of: &[&["pressure", "load"]],
        ..FileKind::new("loads", &ROLES, "time [s] and pressure [Pa] or load [N]")
    };

    fn refusal(kind: &FileKind, text: &str) -> (Option<usize>, String) {
        match read(text, kind, &[]) {
            Ok((table, _)) => (None, format!("{table:?}")),
            Err(error) => (error.line, format!("{} = {}", error.key, error.given)),
        }
    }

    #[test]
    fn columns_are_read_and_all_else_is_said() {
        let text = "# a drum\nrun;t [ms];force [kN];p [bar]\n1;5;9;0,5\n2;7,5;9;1\n\nmean;6\n";
        let (table, _) = read(text, &LOADS, &[]).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!((table.values("time"), table.values("pressure")), (&[0.005, 0.0075][..], &[5e4, 1e5][..]));
        assert_eq!(table.lines, [3, 4]);
        let notes: Vec<&str> = table.notes.iter().map(|note| note.text.as_str()).collect();
        let told = "time = column 2 \"t [ms]\", pressure = column 4 \"p [bar]\"; 2 rows; left out: run, force [kN]";
        assert_eq!(notes, [told, "line 6, behind the table, is left out"]);
    }

    #[test]
    fn columns_may_be_said() {
        let given = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
            pairs.iter().map(|(key, name)| ((*key).to_owned(), (*name).to_owned())).collect()
        };
        let text = "t [s],t_2 [ms],p1 [bar]\n1,2,3\n";
        let (table, _) = read(text, &LOADS, &given(&[("time", "t_2"), ("pressure", "3")])).unwrap_or_default();
        assert_eq!((table.values("time"), table.values("pressure")), (&[0.002][..], &[3e5][..]));
        let error = read(text, &LOADS, &given(&[("time", "t_3")])).map_or_else(|error| error.key, |_| String::new());
        assert_eq!(error, "columns");
    }

    /// Rows that stand there twice are one; a jump is refused.
    #[test]
    fn rows_of_one_time_are_one_or_refused() {
        let kind = FileKind { rises: true, ..LOADS };
        let read = |text: &str| read(text, &kind, &[]).map(|(table, _)| table.values("time").to_vec());
        assert_eq!(read("t,p\n1,2\n1,2\n3,4\n"), Ok(vec![1.0, 3.0]));
        assert_eq!(read("t,p\n1,2\n1,3\n3,4\n").map_err(|error| error.line), Err(Some(3)));
    }

    /// An empty last column is left out; all else must be as many.
    #[test]
    fn there_are_as_many_names_as_columns() {
        for text in [
            "t,p,note\n1,2,\n2,3,\n",
            "t,p,\n1,2,\n2,3,wet\n",
            "t,p\n1,2,\n2,3,\n",
            "t,p,note\n1,2,\n2,3,wet\n",
            "n,t,p\n,1,2\na,2,3\n",
        ] {
            let (table, _) = read(text, &LOADS, &[]).unwrap_or_else(|error| unreachable!("{text}: {error}"));
            assert_eq!((table.values("time"), table.values("pressure")), (&[1.0, 2.0][..], &[2.0, 3.0][..]), "{text}");
        }
        for text in ["t,p\n1,1,2\n2,2,3\n", "t,p,note\n1,2\n2,3\n", "t,p\n1,0,1,2\n2,0,1,4\n"] {
            assert!(refusal(&LOADS, text).1.starts_with("columns = "), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_refused_at_its_line() {
        let strict = FileKind { others: Others::Refused, by_position: false, ..LOADS };
        for (text, line, found) in [
            ("t,load,x\n1,2,3\n", 1, "columns = x too"),
            ("t,load\n1,2\nend\n", 3, "row = \"end\""),
            ("1,2\n", 1, "columns = no names"),
            ("t,load [kN]\n1,2\n1,-2\n", 3, "column 2 \"load [kN]\" = \"-2\""),
            ("t,load\n1,2\n1,\n", 3, "column 2 \"load\" = "),
            ("t,load [bar]\n1,2\n", 1, "unit of column 2 \"load [bar]\" = \"bar\""),
            ("t,time,load\n1,2,3\n", 1, "columns = \"t\" and \"time\""),
            ("# all forces in kN\nt,load\n1,2\n", 1, "unit = \"all forces in kN\""),
            ("t;load\n1,5;2\n2.5;3\n", 3, "column 1 \"t\" = \"2.5\""),
        ] {
            assert_eq!(refusal(&strict, text), (Some(line), found.to_owned()), "{text}");
        }
        let two = "t [s],load [N]\n1,2\n2,2\n# rest\nt [s],load [N]\n1,2\n";
        assert_eq!(refusal(&LOADS, two).0, Some(6));
        assert_eq!(refusal(&LOADS, "t\n1\n"), (Some(1), "columns = \"t\"".to_owned()));
        assert_eq!(refusal(&LOADS, "1,2,3\n"), (Some(1), "columns = 3".to_owned()));
    }

    /// Beside a column in another unit SI is no guess.
    #[test]
    fn a_unit_is_not_assumed_beside_another_one() {
        const POINTS: [Role; 2] = [Role::new("x", "", Dimension::Length), Role::new("area", "", Dimension::Area)];
        let kind = FileKind::new("points", &POINTS, "x, area");
        assert_eq!(refusal(&kind, "x [mm],area\n1,2\n"), (Some(1), "unit of column 2 \"area\" = ".to_owned()));
        assert!(read("x [m],area\n1,2\n", &kind, &[]).is_ok() && read("x,area\n1,2\n", &kind, &[]).is_ok());
    }
}
