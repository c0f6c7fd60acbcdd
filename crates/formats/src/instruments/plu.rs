//! PLU of Sensofar: a header of 500 bytes without a mark of its own, then heights in µm as numbers of 32 bits.

use super::binary::Binary;
use super::{Areal, check_size, check_step, refuse};
use asperity::scene::ContentError;

const KIND: &str = "a PLU file";
const HEADER: usize = 500;
/// Bytes of the date as text, its end and the time.
const DATE: usize = 128;
/// Where the calibration stands, and the kind of measurement.
const CALIBRATION: usize = 388;
const MEASUREMENT: usize = 428;
/// A height that was not measured.
const NOT_MEASURED: f64 = 1_000_001.0;
const MICROMETRES: f64 = 1e6;

/// A date as text, filled up with zeros, before a header with a size that fits the file.
pub(super) fn is_plu(bytes: &[u8]) -> bool {
    if bytes.len() < HEADER {
        return false;
    }
    let end = bytes[..DATE].iter().position(|&byte| byte == 0).unwrap_or(DATE);
    let date = &bytes[..end];
    let is_date = (8..60).contains(&end)
        && date.iter().all(|byte| byte.is_ascii_graphic() || matches!(byte, b' ' | b'\r' | b'\n'))
        && date.iter().filter(|byte| byte.is_ascii_digit()).count() >= 5
        && date.iter().any(|byte| matches!(byte, b':' | b'/' | b'-'));
    let file = Binary { kind: KIND, bytes };
    let fits = || {
        let kind = file.u32(MEASUREMENT)?;
        let size = [file.u32(CALIBRATION + 4)?, file.u32(CALIBRATION)?];
        Ok::<bool, ContentError>(kind <= 16 && size.iter().all(|&count| (1..1 << 20).contains(&count)))
    };
    is_date && fits().unwrap_or(false)
}

pub(super) fn read(bytes: &[u8]) -> Result<Areal, ContentError> {
    let file = Binary { kind: KIND, bytes };
    let steps = [file.f32(CALIBRATION + 16)?, file.f32(CALIBRATION + 20)?];
    match file.u32(MEASUREMENT)? {
        // A topography, whose size stands before its heights once more.
        3 => (),
        other => {
            let given = format!("a PLU file with a measurement of type {other}");
            return Err(refuse(&given, "a topography (3): export a profile as text"));
        }
    }
    let size = [file.u32(HEADER + 4)?, file.u32(HEADER)?];
    check_size(KIND, size)?;
    let data = file.slice(HEADER + 8, 4 * size[0] * size[1])?;
    let height = |bytes: &[u8]| match *bytes {
        [a, b, c, d] => match f64::from(f32::from_le_bytes([a, b, c, d])) {
            NOT_MEASURED => f64::NAN,
            height => height / MICROMETRES,
        },
        _ => f64::NAN,
    };
    let heights = data.chunks_exact(4).map(height).collect();
    let y_step = if size[1] > 1 { check_step(KIND, steps[1])? } else { 1.0 };
    Ok(Areal::even(KIND, size, [check_step(KIND, steps[0])? / MICROMETRES, y_step / MICROMETRES], heights))
}
