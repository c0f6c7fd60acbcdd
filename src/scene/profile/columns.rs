//! The columns of a line, and the numbers in them.

/// The first columns of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::scene) struct Row<'a> {
    /// Up to three columns, without blanks around them; empty where there are fewer.
    pub(in crate::scene) fields: [&'a str; 3],
    /// The last column that is not empty.
    last: &'a str,
    /// How many columns there are: empty ones at the end count up to the second.
    pub(in crate::scene) count: usize,
    /// Whether a comma in a number stands before its decimals: where it separates no columns.
    decimal_comma: bool,
}

/// The columns of a line: separated by semicolon, tab or blanks, and else by commas. `tabs_count` where an empty column
/// between two tabs is one; otherwise any number of tabs and blanks separates.
pub(in crate::scene) fn split(line: &str, tabs_count: bool) -> Row<'_> {
    if line.contains(';') {
        Row::of(line.split(';'), true)
    } else if line.contains('\t') {
        let blanks = Row::of(line.split_whitespace(), true);
        if tabs_count || blanks.count < 2 { Row::of(line.split('\t'), true) } else { blanks }
    } else if line.contains(',') {
        let commas = Row::of(line.split(','), false);
        // `0,5 1,5` are two numbers with decimal commas, for `5 1` is none.
        let is_blank = |field: &&str| field.contains(' ');
        if !line.contains(' ') || !commas.fields.iter().any(is_blank) {
            return commas;
        }
        Some(Row::of(line.split_whitespace(), true)).filter(Row::starts_with_numbers).unwrap_or(commas)
    } else {
        Row::of(line.split_whitespace(), false)
    }
}

impl<'a> Row<'a> {
    fn of(fields: impl Iterator<Item = &'a str>, decimal_comma: bool) -> Self {
        let mut row = Self { decimal_comma, ..Self::default() };
        for (i, field) in fields.enumerate() {
            let field = field.trim();
            if let Some(place) = row.fields.get_mut(i) {
                *place = field;
            }
            if !field.is_empty() {
                row.last = field;
            }
            if !field.is_empty() || i < 2 {
                row.count = i + 1;
            }
        }
        row
    }

    /// The number in column `i`; not a number may be one too.
    pub(in crate::scene) fn number(&self, i: usize) -> Option<f64> {
        self.parse(self.fields[i])
    }

    fn parse(&self, field: &str) -> Option<f64> {
        field.parse().ok().or_else(|| self.written_otherwise(field))
    }

    /// In quotation marks, or with a comma before the decimals.
    fn written_otherwise(&self, field: &str) -> Option<f64> {
        let bare = field.trim_matches('"').trim();
        if self.decimal_comma && bare.contains(',') { bare.replace(',', ".").parse().ok() } else { bare.parse().ok() }
    }

    fn starts_with_numbers(&self) -> bool {
        self.count >= 2 && self.number(0).is_some() && (self.number(1).is_some() || self.is_missing(1))
    }

    /// Whether this can be a point: a place, and a height or none.
    pub(super) fn is_point(&self) -> bool {
        self.starts_with_numbers() && self.number(0).is_some_and(f64::is_finite)
    }

    /// Words alone, as the names of columns; one word among numbers is a mistake.
    pub(in crate::scene) fn is_header(&self) -> bool {
        self.number(0).is_none() && self.parse(self.last).is_none()
    }

    /// Whether column `i` says in one of the usual ways that there is no value.
    pub(super) fn is_missing(&self, i: usize) -> bool {
        const WORDS: [&str; 8] = ["nan", "n/a", "na", "#n/a", "null", "none", "bad", "missing"];
        let field = self.fields[i].trim_matches('"');
        let signs = field.chars().all(|sign| "*-".contains(sign));
        signs || WORDS.iter().any(|word| field.eq_ignore_ascii_case(word))
    }

    /// Whether column `i` is a mark that is set: neither empty nor 0, and no word that denies.
    pub(super) fn is_marked(&self, i: usize) -> bool {
        const UNSET: [&str; 7] = ["", "false", "no", "n", "f", "-", "off"];
        let field = self.fields[i].trim_matches('"');
        !UNSET.iter().any(|word| field.eq_ignore_ascii_case(word)) && self.number(i) != Some(0.0)
    }
}
