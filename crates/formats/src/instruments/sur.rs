//! SUR and PRO of Digital Surf (MountainsMap): a header of 512 bytes, a comment, whole numbers of 16 or 32 bits.

use super::binary::Binary;
use super::{Areal, check_size, check_step, length_unit, refuse};
use asperity::tables::ContentError;

const KIND: &str = "a SUR file";
const HEADER: usize = 512;

pub(super) fn is_sur(bytes: &[u8]) -> bool {
    bytes.starts_with(b"DIGITAL SURF")
}

pub(super) fn read(bytes: &[u8]) -> Result<Areal, ContentError> {
    let file = Binary { kind: KIND, bytes };
    let (objects, object) = (file.u16(14)?, file.u16(18)?);
    // 1: a profile, 2: a surface.
    if objects != 1 || !(1..=2).contains(&object) {
        let given = format!("a SUR file with {objects} objects of type {object}");
        return Err(refuse(&given, "one profile or one surface: export it by itself"));
    }
    let has_gaps = file.u16(86)? == 1;
    let (bits, least) = (file.u16(98)?, file.i32(100)?);
    let size = [file.u32(108)?, file.u32(112)?];
    check_size(KIND, size)?;
    let steps = [file.f32(120)?, file.f32(124)?, file.f32(128)?];
    let unit = |at: usize, what: &str| length_unit(what, &file.text(at, 16)?);
    let [x_unit, z_unit] = [unit(180, "unit of x")?, unit(212, "unit of z")?];
    let y_unit = if size[1] > 1 { unit(196, "unit of y")? } else { x_unit };
    // The height of the number 0; in the unit of the axis.
    let offset = match file.f32(474)? {
        0.0 => 0.0,
        offset => unit(260, "unit of the heights' offset")?.to_si(offset),
    };
    let start = HEADER + file.u16(334)? + file.u16(336)?;
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
    Ok(Areal::even(KIND, size, [check_step(KIND, spacing[0])?, check_step(KIND, spacing[1])?], heights))
}
