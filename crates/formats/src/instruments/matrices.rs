//! Heights of a matrix with a header: SDF, the surface data file of ISO 25178-71, as text (`aISO-1.0`, `aBCR-1.0`) or
//! binary (`b…`), in m after scaling; SUR and PRO of Digital Surf (MountainsMap), with a header of 512 bytes, a comment and
//! whole numbers of 16 or 32 bits; and the text of a Gwyddion field, below comments with its size.

use asperity::tables::ContentError;

use super::shared::{Binary, check_size, check_step, length_unit, refuse};
use crate::profile::Areal;
use crate::text::{decode, is_missing, number};

const SDF: &str = "an SDF file";
/// Bytes of the binary header.
const SDF_HEADER: usize = 81;

pub(super) fn is_sdf(bytes: &[u8]) -> bool {
    ["ISO-", "BCR-"]
        .iter()
        .any(|name| matches!(bytes.first(), Some(b'a' | b'b')) && bytes[1..].starts_with(name.as_bytes()))
}

pub(super) fn read_sdf(bytes: &[u8]) -> Result<Areal, ContentError> {
    if bytes.starts_with(b"a") { read_sdf_text(bytes) } else { read_sdf_binary(bytes) }
}

fn read_sdf_text(bytes: &[u8]) -> Result<Areal, ContentError> {
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
    check_size(SDF, size)?;
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
    let y_scale = if size[1] > 1 { check_step(SDF, value("Yscale")?)? } else { 1.0 };
    Ok(Areal::even(SDF, size, [check_step(SDF, value("Xscale")?)?, y_scale], heights))
}

fn read_sdf_binary(bytes: &[u8]) -> Result<Areal, ContentError> {
    let file = Binary { kind: SDF, bytes };
    let size = [file.u16(42)?, file.u16(44)?];
    check_size(SDF, size)?;
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
    let data = file.slice(SDF_HEADER, size[0] * size[1] * width)?;
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
    let y_scale = if size[1] > 1 { check_step(SDF, y_scale)? } else { 1.0 };
    Ok(Areal::even(SDF, size, [check_step(SDF, x_scale)?, y_scale], heights))
}

fn marked(value: f64, mark: f64) -> f64 {
    if value == mark { f64::NAN } else { value }
}

const SUR: &str = "a SUR file";
const SUR_HEADER: usize = 512;

pub(super) fn is_sur(bytes: &[u8]) -> bool {
    bytes.starts_with(b"DIGITAL SURF")
}

pub(super) fn read_sur(bytes: &[u8]) -> Result<Areal, ContentError> {
    let file = Binary { kind: SUR, bytes };
    let (objects, object) = (file.u16(14)?, file.u16(18)?);
    // 1: a profile, 2: a surface.
    if objects != 1 || !(1..=2).contains(&object) {
        let given = format!("a SUR file with {objects} objects of type {object}");
        return Err(refuse(&given, "one profile or one surface: export it by itself"));
    }
    let has_gaps = file.u16(86)? == 1;
    let (bits, least) = (file.u16(98)?, file.i32(100)?);
    let size = [file.u32(108)?, file.u32(112)?];
    check_size(SUR, size)?;
    let steps = [file.f32(120)?, file.f32(124)?, file.f32(128)?];
    let unit = |at: usize, what: &str| length_unit(what, &file.text(at, 16)?);
    let [x_unit, z_unit] = [unit(180, "unit of x")?, unit(212, "unit of z")?];
    let y_unit = if size[1] > 1 { unit(196, "unit of y")? } else { x_unit };
    // The height of the number 0; in the unit of the axis.
    let offset = match file.f32(474)? {
        0.0 => 0.0,
        offset => unit(260, "unit of the heights' offset")?.to_si(offset),
    };
    let start = SUR_HEADER + file.u16(334)? + file.u16(336)?;
    let width = match bits {
        16 => 2,
        32 => 4,
        other => return Err(ContentError::value(None, "size of a point", &other.to_string(), "16 or 32 bits")),
    };
    let data = file.slice(start, size[0] * size[1] * width)?;
    let height = |bytes: &[u8]| {
        let number = match *bytes {
            [a, b] => i32::from(i16::from_le_bytes([a, b])),
            [a, b, c, d] => i32::from_le_bytes([a, b, c, d]),
            _ => least,
        };
        // Two below the least is a point that was not measured.
        let missing = has_gaps && i64::from(number) == i64::from(least) - 2;
        if missing { f64::NAN } else { z_unit.to_si(steps[2] * f64::from(number)) + offset }
    };
    let heights = data.chunks_exact(width).map(height).collect();
    let spacing = [x_unit.to_si(steps[0]), if size[1] > 1 { y_unit.to_si(steps[1]) } else { 1.0 }];
    Ok(Areal::even(SUR, size, [check_step(SUR, spacing[0])?, check_step(SUR, spacing[1])?], heights))
}

const GWYDDION: &str = "a Gwyddion text file";

/// A matrix below `# Width:` and `# Value units:`.
pub(super) fn is_gwyddion(bytes: &[u8]) -> bool {
    let Ok(text) = decode(&bytes[..bytes.len().min(2048)]) else { return false };
    let has = |name: &str| setting(&text, name).is_some();
    has("Width") && has("Height") && (has("Value units") || has("Channel"))
}

fn setting<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let comments = text.lines().take_while(|line| line.starts_with('#'));
    let mut pairs = comments.filter_map(|line| line.trim_start_matches(['#', ' ']).split_once(':'));
    pairs.find(|(key, _)| key.trim().eq_ignore_ascii_case(name)).map(|(_, value)| value.trim())
}

pub(super) fn read_gwyddion(bytes: &[u8]) -> Result<Areal, ContentError> {
    let text = decode(bytes)?;
    let length = |key: &str| {
        let value = setting(&text, key).unwrap_or_default();
        let parted = value.split_once(char::is_whitespace).unwrap_or((value, "m"));
        let number = number(parted.0).filter(|number| *number > 0.0);
        let number =
            number.ok_or_else(|| ContentError::value(None, key, &format!("\"{value}\""), "a length and its unit"))?;
        Ok::<f64, ContentError>(length_unit(key, parted.1)?.to_si(number))
    };
    let unit = length_unit("Value units", setting(&text, "Value units").unwrap_or_default())?;
    let (mut heights, mut columns, mut rows) = (Vec::new(), 0, 0);
    for (line, row) in (1..).zip(text.lines()).filter(|(_, row)| !row.starts_with('#') && !row.trim().is_empty()) {
        let before = heights.len();
        for field in row.split([' ', '\t', ';']).filter(|field| !field.is_empty()) {
            let height = number(field).or_else(|| is_missing(field).then_some(f64::NAN));
            let refuse = || ContentError::value(Some(line), "z", &format!("\"{field}\""), "a height");
            heights.push(unit.to_si(height.ok_or_else(refuse)?));
        }
        rows += 1;
        let found = heights.len() - before;
        if rows > 1 && found != columns {
            return Err(ContentError::value(
                Some(line),
                "columns",
                &found.to_string(),
                &format!("{columns}, as above"),
            ));
        }
        columns = found;
    }
    check_size(GWYDDION, [columns, rows])?;
    // Each height is that of a pixel: as many pixels as heights make the width.
    let spacing = [length("Width")? / columns as f64, length("Height")? / rows as f64];
    Ok(Areal::even(
        GWYDDION,
        [columns, rows],
        [check_step(GWYDDION, spacing[0])?, check_step(GWYDDION, spacing[1])?],
        heights,
    ))
}
