//! Tables of text as people, instruments and spreadsheets write them.
//!
//! Encodings are told in `encoding`. What a line is stands in `lines`, where tables stand in a text in
//! `blocks`, their names and units in `head`, what a name says in `names`, signs in numbers in `numbers` and `decimals`; `reader` makes a
//! table of a kind of all that, and what is special of moduli is their client's.

mod blocks;
mod decimals;
mod encoding;
mod head;
mod lines;
mod names;
mod numbers;
mod reader;

pub use blocks::Block;
pub use decimals::{UsedColumn, decimal_of};
pub use encoding::{NotText, decode};
pub use head::Head;
pub use lines::{Line, Row, Separator};
pub use names::{Heading, RefusedHeading, chosen, find, plain, unit_beside};
pub use numbers::{Decimal, is_missing, is_number, number};
pub use reader::{assumed_unit, behind_note, left_out_words, no_number, number_of, read, told, used_column};
