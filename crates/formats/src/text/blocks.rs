//! Where the tables stand in a text: runs of lines of numbers, and the lines above them.

use super::lines::{Form, Kind, Line, Row, Separator, is_comment, kind, trimmed, without_sign};

/// A run of lines of numbers with the same number of fields, and what stands above it.
#[derive(Clone, Debug)]
pub struct Block<'a> {
    /// Parts its fields.
    pub separator: Separator,
    /// Fields of a line, empty ones at its end among them.
    pub width: usize,
    /// Columns that hold something: fields up to the last that is not empty in some row.
    pub columns: usize,
    /// The lines between the block before it and its first row, blank ones left out; comments without their sign.
    pub above: Vec<Line<'a>>,
    /// The lines of its rows.
    pub first: usize,
    /// The line of its last row.
    pub last: usize,
    /// Number of its rows.
    pub rows: usize,
    /// Where its first row begins in the text, in bytes.
    pub start: usize,
    /// Some fields of its first row are empty before the last that is not.
    gaps: bool,
    /// The lines above that are comments.
    pub(super) comments: Vec<usize>,
}

/// The blocks of a text so far.
struct Blocks<'a> {
    text: &'a str,
    blocks: Vec<Block<'a>>,
    /// The lines since the last row, and the numbers of those that are comments.
    above: Vec<Line<'a>>,
    comments: Vec<usize>,
    /// Whether a row may belong to the last block.
    is_open: bool,
}

impl<'a> Blocks<'a> {
    /// Adds a row, its line and where that begins, to the last block or to a new one.
    fn add_row(&mut self, (line, start): (usize, usize), form: Form) {
        let is_open = self.is_open;
        let goes_on =
            |block: &&mut Block<'_>| is_open && (block.separator, block.width) == (form.separator, form.width);
        if let Some(block) = self.blocks.last_mut().filter(goes_on) {
            (block.last, block.rows, block.columns) = (line, block.rows + 1, block.columns.max(form.columns));
            self.above.clear();
            return;
        }
        let mut above = std::mem::take(&mut self.above);
        // A row of numbers with gaps, and words below it: they are a header of the columns.
        if let Some(row) = self.blocks.pop_if(|block| block.gaps && block.rows == 1 && !above.is_empty()) {
            let text = trimmed(self.text[row.start..].lines().next().unwrap_or_default());
            above = row.above.into_iter().chain([(row.first, text)]).chain(above).collect();
        }
        let Form { separator, width, columns, gaps } = form;
        let comments = std::mem::take(&mut self.comments);
        let (first, last, rows) = (line, line, 1);
        self.blocks.push(Block { separator, width, columns, above, first, last, rows, start, gaps, comments });
        self.is_open = true;
    }
}

impl<'a> Block<'a> {
    /// The blocks of a text. Comments (`#`, `%`, `!`, `//`) end one where `comments_part`.
    pub fn all(text: &'a str, comments_part: bool) -> Vec<Self> {
        let mut found = Blocks { text, blocks: Vec::new(), above: Vec::new(), comments: Vec::new(), is_open: false };
        let mut start = 0;
        for (number, line) in (1..).zip(text.split_inclusive('\n')) {
            let bare = trimmed(line);
            match kind(bare, found.blocks.last().filter(|_| found.is_open).map(|block| (block.separator, block.width)))
            {
                Kind::Blank => (),
                Kind::Comment => {
                    found.is_open &= !comments_part;
                    found.comments.push(number);
                    found.above.push((number, without_sign(bare)));
                }
                Kind::Data(form) => found.add_row((number, start), form),
                Kind::Other => {
                    found.is_open = false;
                    found.above.push((number, bare));
                }
            }
            start += line.len();
        }
        found.blocks
    }

    /// The block with more lines above it: the header of another one.
    pub fn with_header(&self, lines: &[Line<'a>]) -> Self {
        Self { above: lines.iter().chain(&self.above).copied().collect(), ..self.clone() }
    }

    /// The block with other lines above it.
    pub fn under(&self, above: Vec<Line<'a>>) -> Self {
        Self { above, ..self.clone() }
    }

    /// The rows of the block, from its first to its last.
    pub fn rows(&self, text: &'a str) -> impl Iterator<Item = Row<'a>> {
        let separator = self.separator;
        self.lines(text).map(move |(line, row)| Row { line, fields: separator.split(row) })
    }

    /// The lines behind the block that are neither blank nor comments.
    pub fn below(&self, text: &'a str) -> impl Iterator<Item = Line<'a>> {
        let lines = (1..).zip(text.lines()).skip(self.last).map(|(number, line)| (number, trimmed(line)));
        lines.filter(|(_, line)| !line.trim().is_empty() && !is_comment(line))
    }

    /// The numbered lines of the rows of the block.
    pub fn lines(&self, text: &'a str) -> impl Iterator<Item = Line<'a>> {
        let lines = text[self.start..].lines().zip(self.first..).take(self.last + 1 - self.first);
        lines.map(|(line, number)| (number, trimmed(line))).filter(|(_, line)| !line.is_empty() && !is_comment(line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns, first and last line, lines above.
    type Found = (usize, usize, usize, usize);

    fn found(text: &str) -> Vec<Found> {
        let blocks = Block::all(text, true);
        blocks.iter().map(|block| (block.columns, block.first, block.last, block.above.len())).collect()
    }

    #[test]
    fn blocks_are_runs_of_numbers() {
        let cases: [(&str, &[Found]); 10] = [
            ("x,z\n0,1\n1,2\n", &[(2, 2, 3, 1)]),
            ("Sample\t5\nVariables\ta\tb\nData point\t1\t2\nData point\t3\t4\n", &[(3, 3, 4, 2)]),
            ("0 1\n1 2\nRa 0.19\n", &[(2, 1, 2, 0)]),
            ("a;b\n1;2\n\n3;4\n[next]\na;b\n5;6\n", &[(2, 2, 4, 1), (2, 7, 7, 2)]),
            ("# T = 20\n1 2\n# T = 40\n3 4\n", &[(2, 2, 2, 1), (2, 4, 4, 1)]),
            ("0,5 1,5\n1 -2,5e-1\n", &[(2, 1, 2, 0)]),
            ("1\n2\n", &[(1, 1, 2, 0)]),
            ("---\nx\n", &[]),
            ("1;2;\n3;;\n", &[(2, 1, 2, 0)]),
            (",20,,40,\nf,a,b,a,b\n1,2,3,4,5\n", &[(5, 3, 3, 2)]),
        ];
        for (text, expected) in cases {
            assert_eq!(found(text), expected, "{text:?}");
        }
    }
}
