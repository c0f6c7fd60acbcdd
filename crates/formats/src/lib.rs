//! Files that are no text, read for the engine: what instruments write, and workbooks of spreadsheets.
//!
//! It knows how bytes become points and cells, and nothing of scenes or of what is made of them.
//!
//! | module | uses | contents |
//! |---|---|---|
//! | `instruments` | | SDF, SUR, OpenCRG, text of Gwyddion; formats that are known and not read |
//! | `x3p` | | ISO 5436-2 (ISO 25178-72) |
//! | [`workbook`] | | sheets as text |

mod instruments;
pub mod workbook;
mod x3p;

use std::path::Path;

use asperity::scene::{FileFormats, MeasuredSurface, ProfileOptions};
use asperity::tables::{ContentError, Sheets};

/// The formats of instruments: X3P, SDF, SUR, OpenCRG and text of Gwyddion; and workbooks of tables.
#[derive(Clone, Copy, Debug)]
pub struct Instruments;

impl FileFormats for Instruments {
    fn read(&self, bytes: &[u8], options: &ProfileOptions) -> Option<Result<MeasuredSurface, ContentError>> {
        if bytes.starts_with(b"PK\x03\x04") {
            Some(x3p::read(bytes, options))
        } else {
            instruments::read(bytes, options)
        }
    }

    fn sheets(&self, bytes: &[u8]) -> Option<Result<Sheets, ContentError>> {
        let refused = |error: workbook::WorkbookError| {
            ContentError::value(None, "", "a workbook", &format!("one that can be read: {error}"))
        };
        workbook::is_workbook(bytes, Path::new("")).then(|| workbook::sheets(bytes).map_err(refused))
    }
}
