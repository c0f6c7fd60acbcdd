//! Files as people, instruments and spreadsheets write them, read for the engine.
//!
//! What a column is is never guessed: a table has a row of names or none, a role is a documented name or said, a unit
//! stands beside its name, and all that two readings are left of is asked for. Each file is told in a line.
//!
//! | module | uses | contents |
//! |---|---|---|
//! | `text` | | tables of text: dialects, names, units, numbers, and the table of a kind |
//! | [`profile`] | text | lines of x and z, matrices, points on a grid, and what is done to them before they are a surface |
//! | `series`, `spectrum` | text | Prony series and cards of them, power spectra |
//! | `instruments` | profile, text | SDF, SUR, OpenCRG, text of Gwyddion; formats that are known and not read |
//! | `x3p` | profile, text | ISO 5436-2 (ISO 25178-72) |
//! | [`workbook`] | | sheets as text |

mod instruments;
pub mod profile;
mod series;
mod spectrum;
pub mod text;
pub mod workbook;
mod x3p;

use asperity::scene::{Convention, ElasticConstants, FileFormats, LoadedProfile, ProfileOptions};
use asperity::tables::{ContentError, FileKind, GivenColumns, ReadTable};

pub use series::SERIES;
pub use spectrum::SPECTRUM;

/// All formats that are read.
#[derive(Clone, Copy, Debug)]
pub struct Instruments;

impl FileFormats for Instruments {
    fn surface(&self, bytes: &[u8], options: &ProfileOptions) -> Result<LoadedProfile, ContentError> {
        if bytes.starts_with(b"PK\x03\x04") && !workbook::is_workbook(bytes) {
            return profile::of_measured(x3p::read(bytes, options)?, options);
        }
        match instruments::read(bytes) {
            Some(areal) => profile::of_measured(areal?.surface(options)?, options),
            None => in_text(bytes, |bytes| profile::read_text(bytes, options), |read| &mut read.notes),
        }
    }

    fn table(&self, bytes: &[u8], kind: &FileKind, columns: &GivenColumns) -> Result<ReadTable, ContentError> {
        let read = |bytes: &[u8]| text::read(&text::decode(bytes)?, kind, columns).map(|(table, _)| table);
        in_text(bytes, read, |table| &mut table.notes)
    }

    fn series(
        &self,
        bytes: &[u8],
        elastic: ElasticConstants,
        columns: &GivenColumns,
    ) -> Result<ReadTable, ContentError> {
        in_text(bytes, |bytes| series::read_series(bytes, elastic, columns), |table| &mut table.notes)
    }

    fn spectrum(
        &self,
        bytes: &[u8],
        convention: Convention,
        columns: &GivenColumns,
    ) -> Result<ReadTable, ContentError> {
        in_text(bytes, |bytes| spectrum::read_spectrum(bytes, convention, columns), |table| &mut table.notes)
    }
}

/// What `read` makes of the bytes of a text, or of the only sheet of a workbook that it can read, of which its notes say
/// which that is.
fn in_text<T>(
    bytes: &[u8],
    read: impl Fn(&[u8]) -> Result<T, ContentError>,
    notes: impl Fn(&mut T) -> &mut Vec<asperity::tables::ReadingNote>,
) -> Result<T, ContentError> {
    if let Some(error) = instruments::foreign(bytes) {
        return Err(error);
    }
    if !workbook::is_workbook(bytes) {
        return read(bytes);
    }
    let (mut content, sheet) = workbook::only_sheet(&workbook::sheets(bytes)?, read)?;
    for note in notes(&mut content) {
        note.text = format!("sheet {sheet}: {}", note.text);
    }
    Ok(content)
}
