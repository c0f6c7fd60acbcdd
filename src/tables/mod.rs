//! Tables of text as people, instruments and spreadsheets write them: one reader of all that is read as columns.
//!
//! [`decode`] makes text of bytes. A file that begins with its header, as those of this project do, is a [`Csv`]. In the
//! output of instruments and people, which may begin with anything, [`Block`] finds the tables, and [`Header`] what their
//! columns hold by a vocabulary of [`Words`], in which [`Unit`]. A client names the columns that it wants by a [`Format`],
//! and gets a [`Table`] of numbers in SI units, notes of what was assumed, or a [`ContentError`].
//!
//! Where a new way to write tables belongs: encodings to `text`; separators, comments and rows to `lines`; signs in
//! numbers to `numbers`, between thousands to `thousands`; lines of names and units to `head`; names, units and what a
//! heading says of its whole column (wide tables) to `headings`; what is done about columns and rows, for all clients at once, to `columns` and `format`.

mod blocks;
mod columns;
mod error;
mod format;
mod head;
mod headings;
mod lines;
mod numbers;
mod range;
mod sheets;
mod text;
mod thousands;
mod units;

pub use blocks::Block;
pub use columns::{Column, Header, ReadingNote, UnitRule};
pub use error::{ContentError, NotText, assignment, shortened};
pub use format::{Choice, Format, Others, Table, Wanted, behind_note};
pub use head::Head;
pub use headings::{Condition, Heading, HeadingUnit, Words, find_quantity, plain, words};
pub use lines::{Line, Separator};
pub use numbers::{MISSING, MixedDecimals, NumberStyle, is_missing, number};
pub use range::{ABOVE_ZERO, ANY, FINITE, LARGEST, NOT_NEGATIVE, NumberRange, POSITIVE, SMALLEST};
pub use sheets::{Sheets, text_or_sheet};
pub use text::{Csv, Row, comments, decode, fields, quoted, rows};
pub use thousands::{DecimalSigns, UsedColumn};
pub use units::{Dimension, Unit, quantity, quantity_with_unit};
