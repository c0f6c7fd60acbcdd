//! SDF, the surface data file of ISO 25178-71: heights as text (`aISO-1.0`, `aBCR-1.0`) or binary (`b…`), in m after
//! scaling.

use super::binary::Binary;
use super::{Areal, check_size, check_step, refuse};
use asperity::tables::ContentError;

use crate::text::{is_missing, number};

const KIND: &str = "an SDF file";
/// Bytes of the binary header.
const HEADER: usize = 81;

pub(super) fn is_sdf(bytes: &[u8]) -> bool {
    ["ISO-", "BCR-"]
        .iter()
        .any(|name| matches!(bytes.first(), Some(b'a' | b'b')) && bytes[1..].starts_with(name.as_bytes()))
}

pub(super) fn read(bytes: &[u8]) -> Result<Areal, ContentError> {
    if bytes.starts_with(b"a") { read_text(bytes) } else { read_binary(bytes) }
}

fn read_text(bytes: &[u8]) -> Result<Areal, ContentError> {
    let text: String = bytes.iter().copied().map(char::from).collect();
    // A line with an asterisk alone ends each of the three parts: header, heights, trailer.
    let mut lines = text.lines().skip(1);
    let header: Vec<&str> = lines.by_ref().take_while(|line| line.trim() != "*").collect();
    let value = |name: &str| {
        let found = header
            .iter()
            .filter_map(|line| line.split_once('='))
            .find(|(key, _)| key.trim().eq_ignore_ascii_case(name));
        let number = found.and_then(|(_, value)| value.trim().parse::<f64>().ok());
        number.ok_or_else(|| {
            ContentError::value(None, name, found.map_or("not given", |(_, value)| value.trim()), "a number")
        })
    };
    let size = [value("NumPoints")? as usize, value("NumProfiles")? as usize];
    check_size(KIND, size)?;
    let z_scale = value("Zscale")?;
    let mut heights = Vec::new();
    for field in lines.take_while(|line| line.trim() != "*").flat_map(str::split_whitespace) {
        let height = number(field).or_else(|| is_missing(field).then_some(f64::NAN));
        heights.push(z_scale * height.ok_or_else(|| ContentError::value(None, "z", field, "a height or BAD"))?);
    }
    if heights.len() != size[0] * size[1] {
        let expected = format!("{} × {}, as its header says", size[0], size[1]);
        return Err(ContentError::value(None, "heights", &heights.len().to_string(), &expected));
    }
    let y_scale = if size[1] > 1 { check_step(KIND, value("Yscale")?)? } else { 1.0 };
    Ok(Areal::even(KIND, size, [check_step(KIND, value("Xscale")?)?, y_scale], heights))
}

fn read_binary(bytes: &[u8]) -> Result<Areal, ContentError> {
    let file = Binary { kind: KIND, bytes };
    let size = [file.u16(42)?, file.u16(44)?];
    check_size(KIND, size)?;
    let [x_scale, y_scale, z_scale] = [file.f64(46)?, file.f64(54)?, file.f64(62)?];
    let types = file.slice(78, 3)?;
    if types[0] != 0 {
        return Err(refuse("a compressed SDF file", "heights that are not compressed"));
    }
    let kind = types[1];
    let width = match kind {
        0 | 4 => 1,
        1 | 5 => 2,
        2 | 3 | 6 => 4,
        7 => 8,
        other => return Err(ContentError::value(None, "DataType", &other.to_string(), "0 to 7")),
    };
    let data = file.slice(HEADER, size[0] * size[1] * width)?;
    // The end of the range of whole numbers marks a height that is missing.
    let height = |bytes: &[u8]| match (kind, bytes) {
        (0, &[a]) => f64::from(a),
        (4, &[a]) => f64::from(a as i8),
        (1, &[a, b]) => marked(u16::from_le_bytes([a, b]).into(), u16::MAX.into()),
        (5, &[a, b]) => marked(i16::from_le_bytes([a, b]).into(), i16::MIN.into()),
        (2, &[a, b, c, d]) => marked(u32::from_le_bytes([a, b, c, d]).into(), u32::MAX.into()),
        (6, &[a, b, c, d]) => marked(i32::from_le_bytes([a, b, c, d]).into(), i32::MIN.into()),
        (3, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]).into(),
        (7, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    };
    let heights = data.chunks_exact(width).map(|bytes| z_scale * height(bytes)).collect();
    let y_scale = if size[1] > 1 { check_step(KIND, y_scale)? } else { 1.0 };
    Ok(Areal::even(KIND, size, [check_step(KIND, x_scale)?, y_scale], heights))
}

fn marked(value: f64, mark: f64) -> f64 {
    if value == mark { f64::NAN } else { value }
}
