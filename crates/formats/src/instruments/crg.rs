//! OpenCRG (ASAM, formerly Daimler): a road as long sections beside each other, heights along a reference line, as text
//! or binary. A long section is read as a line along x; a slope or a bank of the reference line is left out, and said.

use asperity::tables::{ContentError, ReadingNote};

use super::shared::{check_size, check_step, refuse};
use crate::profile::Areal;
use crate::text::number;

const KIND: &str = "an OpenCRG file";
/// A record of text or of binary data is filled up to a multiple of these bytes, where records are long ones.
const RECORD: usize = 80;
/// The increment along the reference line where none is given, m.
const INCREMENT: f64 = 0.01;

pub(super) fn is_crg(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1 << 16)];
    let marks: [&[u8]; 2] = [b"$ROAD_CRG", b"$KD_Definition"];
    let begins =
        |at: usize, mark: &[u8]| head[at..].get(..mark.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(mark));
    let sections = head.iter().enumerate().filter(|(_, byte)| **byte == b'$').map(|(at, _)| at);
    sections.into_iter().any(|at| marks.iter().any(|mark| begins(at, mark)))
}

/// How numbers are written: `LRFI`, `LDFI` as text of 10 or 20 letters, `KRBI`, `KDBI` binary, big endian; L begins
/// each record anew.
#[derive(Clone, Copy, Debug)]
struct Format {
    long: bool,
    double: bool,
    binary: bool,
}

#[derive(Debug, Default)]
struct Definition {
    format: Option<Format>,
    /// What the values of a record are: the position of a long section across, as far as it is one.
    columns: Vec<Option<f64>>,
    others: Vec<String>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Areal, ContentError> {
    let (header, data) = parts(bytes)?;
    let value = |name: &str| {
        let is_it = |line: &&String| line.split_once('=').is_some_and(|(key, _)| key.trim().eq_ignore_ascii_case(name));
        let text = header.iter().find(is_it).and_then(|line| line.split_once('=')).map(|(_, value)| value);
        text.and_then(|text| number(text.split('!').next().unwrap_or(text).trim()))
    };
    if header.iter().any(|line| line.to_ascii_uppercase().starts_with("$ROAD_CRG_FILE")) {
        return Err(refuse("an OpenCRG file that names another", "the file with the heights"));
    }
    let definition = Definition::read(&header)?;
    let Some(format) = definition.format else { return Err(refuse(KIND, "its format, such as #:LRFI")) };
    let width = definition.columns.len();
    let values = if format.binary { binary(data, format, width) } else { text(data, format, width)? };
    let step = check_step(KIND, value("REFERENCE_LINE_INCREMENT").unwrap_or(INCREMENT))?;
    let mut records = values.len() / width.max(1);
    if format.binary {
        let (start, end) = (value("REFERENCE_LINE_START_U").unwrap_or(0.0), value("REFERENCE_LINE_END_U"));
        let expected = "REFERENCE_LINE_END_U, which says where binary data end";
        let end = end.ok_or_else(|| refuse(KIND, expected))?;
        let named = ((end - start) / step + 0.5).floor().max(0.0) as usize + 1;
        if named > records {
            let given = format!("{records} of {named} cross sections");
            return Err(ContentError::value(
                None,
                "",
                &given,
                "as many as REFERENCE_LINE_END_U of the OpenCRG file says",
            ));
        }
        records = named;
    }
    let mut sections: Vec<(usize, f64)> =
        definition.columns.iter().enumerate().filter_map(|(i, position)| Some((i, (*position)?))).collect();
    sections.sort_by(|a, b| a.1.total_cmp(&b.1));
    check_size(KIND, [records, sections.len()])?;
    let values = &values;
    let heights =
        sections.iter().flat_map(|&(column, _)| (0..records).map(move |i| values[i * width + column])).collect();
    // The places across only order the lines.
    let mut areal = Areal::even(KIND, [records, sections.len()], [step, 1.0], heights);
    let slopes = ["REFERENCE_LINE_START_Z", "REFERENCE_LINE_END_Z", "REFERENCE_LINE_START_S", "REFERENCE_LINE_START_B"];
    let sloped =
        slopes.iter().any(|name| value(name).is_some_and(|value| value != 0.0)) || !definition.others.is_empty();
    if sloped {
        let others =
            if definition.others.is_empty() { String::new() } else { format!(" ({})", definition.others.join(", ")) };
        let text = format!("heights are above the reference line, whose course, slope and bank{others} are left out");
        areal.notes.push(ReadingNote { text, assumed: true });
    }
    Ok(areal)
}

/// The lines of the header, and the bytes behind the line of four dollar signs.
fn parts(bytes: &[u8]) -> Result<(Vec<String>, &[u8]), ContentError> {
    let (mut lines, mut rest, mut comment) = (Vec::new(), bytes, false);
    while !rest.is_empty() {
        let end = rest.iter().position(|&byte| byte == b'\n').map_or(rest.len(), |end| end + 1);
        let line: String = rest[..end].iter().copied().map(char::from).collect();
        let line = line.trim().to_owned();
        rest = &rest[end..];
        if line.starts_with("$$$$") {
            return Ok((lines, rest));
        }
        comment = if line.starts_with('$') { line.to_ascii_uppercase().starts_with("$CT") } else { comment };
        if !comment && !line.is_empty() && !line.starts_with('*') {
            lines.push(line);
        }
    }
    Err(refuse("an OpenCRG file without heights", "a line $$$$ and heights behind it"))
}

impl Definition {
    fn read(header: &[String]) -> Result<Self, ContentError> {
        let mut definition = Self::default();
        for line in header {
            let (kind, body) = (line.get(..2).unwrap_or_default(), line.get(2..).unwrap_or_default());
            match kind {
                "#:" => definition.format = Some(Format::parse(body.trim())?),
                "D:" | "d:" => definition.add(body.split('!').next().unwrap_or(body).trim())?,
                _ => (),
            }
        }
        if definition.columns.iter().all(Option::is_none) {
            return Err(refuse("an OpenCRG file without long sections", "D:long section 1,m"));
        }
        Ok(definition)
    }

    /// `long section 1,m`, `long section at v = -1.5,m`, or another value of a record.
    fn add(&mut self, text: &str) -> Result<(), ContentError> {
        let lower = text.to_ascii_lowercase();
        let Some((_, place)) = lower.split_once("long section") else {
            self.others.push(lower.split(',').next().unwrap_or(&lower).to_owned());
            self.columns.push(None);
            return Ok(());
        };
        let (place, unit) = place.rsplit_once(',').unwrap_or((place, ""));
        let place = place.rsplit('=').next().unwrap_or(place).trim();
        let (position, unit) = (number(place), unit.trim());
        match position {
            Some(position) if unit == "m" => {
                self.columns.push(Some(position));
                Ok(())
            }
            _ => Err(ContentError::value(
                None,
                "D",
                &format!("`{text}`"),
                "a long section with its number or place, in m",
            )),
        }
    }
}

impl Format {
    fn parse(code: &str) -> Result<Self, ContentError> {
        let letters: Vec<char> = code.to_ascii_uppercase().chars().collect();
        match letters[..] {
            [record @ ('L' | 'K'), size @ ('R' | 'D'), form @ ('F' | 'B'), 'I', ..] => {
                Ok(Self { long: record == 'L', double: size == 'D', binary: form == 'B' })
            }
            _ => Err(refuse(
                &format!("an OpenCRG file in the format {code}"),
                "one of LRFI, LDFI, KRBI, KDBI, LRBI, LDBI",
            )),
        }
    }
}

/// Values as text of fixed width; asterisks where there is none.
fn text(data: &[u8], format: Format, width: usize) -> Result<Vec<f64>, ContentError> {
    let letters = if format.double { 20 } else { 10 };
    let per_line = RECORD / letters;
    let mut values = Vec::new();
    let text: String = data.iter().copied().map(char::from).collect();
    for line in text.lines().map(str::trim_end).filter(|line| !line.is_empty()) {
        let line: Vec<char> = line.chars().collect();
        for field in line.chunks(letters) {
            let field: String = field.iter().collect::<String>().trim().to_owned();
            let is_gap = field.is_empty() || field.contains('*') || field.eq_ignore_ascii_case("nan");
            let value = number(&field).or(is_gap.then_some(f64::NAN));
            values.push(value.ok_or_else(|| {
                ContentError::value(None, "z", &format!("\"{field}\""), "a height of an OpenCRG file")
            })?);
        }
        // Lines may end before their last values.
        let in_record = if width == 0 { 0 } else { values.len() % width };
        if format.long && in_record > 0 && in_record % per_line != 0 {
            let given = format!("{in_record} values at the end of a line");
            return Err(ContentError::value(
                None,
                "record",
                &given,
                &format!("{per_line} in a line, {width} in a record"),
            ));
        }
    }
    if width > 0 && values.len() % width != 0 {
        return Err(ContentError::value(
            None,
            "values",
            &values.len().to_string(),
            &format!("a multiple of {width}, the values of a record"),
        ));
    }
    Ok(values)
}

fn binary(data: &[u8], format: Format, width: usize) -> Vec<f64> {
    let size = if format.double { 8 } else { 4 };
    let record = if format.long { (width * size).div_ceil(RECORD) * RECORD } else { width * size };
    let value = |bytes: &[u8]| match *bytes {
        [a, b, c, d] => f32::from_be_bytes([a, b, c, d]).into(),
        [a, b, c, d, e, f, g, h] => f64::from_be_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    };
    let records = data.chunks_exact(record.max(1));
    records.flat_map(|record| record[..width * size].chunks_exact(size).map(value).collect::<Vec<_>>()).collect()
}
