//! ERD files of the University of Michigan, in which road profiles are kept: lines of a header, then channels sampled
//! at an even step.

use super::{MeasuredPoints, ProfileOptions, length_unit, refuse};
use asperity::scene::ContentError;
use asperity::scene::ReadingNote;
use asperity::tables::{Unit, decode, is_missing, number};

const KIND: &str = "an ERD file";
/// The form of numbers that is text.
const TEXT: i64 = 5;
/// Letters of a short name and of a unit.
const NAME: usize = 8;
/// Letters of a long name.
const LONG_NAME: usize = 32;

pub(super) fn is_erd(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ERDFILE")
}

pub(super) fn read(bytes: &[u8], options: &ProfileOptions) -> Result<MeasuredPoints, ContentError> {
    let text =
        decode(bytes).map_err(|_| refuse("an ERD file with binary numbers", "one with numbers as text (KEYNUM 5)"))?;
    let mut lines = (1..).zip(text.lines()).skip(1);
    let (_, sizes) = lines.next().unwrap_or_default();
    let fields: Vec<&str> = sizes.split(',').map(str::trim).collect();
    let size = |i: usize, what: &str| {
        let value = fields.get(i).copied().unwrap_or_default();
        let number = value.parse::<f64>().ok();
        number.ok_or_else(|| {
            ContentError::value(Some(2), what, &format!("\"{value}\""), "a number, in line 2 of an ERD file")
        })
    };
    let (channels, form, step) = (size(0, "NCHAN")? as usize, size(4, "KEYNUM")? as i64, size(5, "STEP")?);
    if form != TEXT {
        return Err(refuse("an ERD file with binary numbers", "one with numbers as text (KEYNUM 5)"));
    }
    let header: Vec<&str> = lines.by_ref().map(|(_, line)| line).take_while(|line| line.trim() != "END").collect();
    let header = Header { lines: header };
    let channel = header.choose(channels, options)?;
    let unit = header.unit(channel)?;
    let x_unit = header.x_unit()?;
    let mut raw = MeasuredPoints { units: [x_unit, unit], ..MeasuredPoints::default() };
    for (line, row) in lines.filter(|(_, row)| !row.trim().is_empty()) {
        let mut fields = row.split([',', ' ', '\t']).filter(|field| !field.is_empty());
        let count = fields.clone().count();
        if count != channels {
            return Err(ContentError::value(
                Some(line),
                "columns",
                &count.to_string(),
                &format!("{channels} channels"),
            ));
        }
        let field = fields.nth(channel).unwrap_or_default();
        let height = number(field, false).or_else(|| is_missing(field).then_some(f64::NAN));
        let refuse = || ContentError::value(Some(line), "z", &format!("\"{field}\""), "a height");
        let height = height.ok_or_else(refuse)?;
        raw.push(line, step * raw.x.len() as f64, height);
    }
    let names = |unit: Option<Unit>| unit.map_or("m, which is assumed".to_owned(), |unit| unit.to_string());
    let text = format!(
        "{KIND}: {} in {}, every {step} in {}",
        header.name(channel).unwrap_or_else(|| format!("channel {}", channel + 1)),
        names(unit),
        names(x_unit)
    );
    raw.notes.push(ReadingNote { text, assumed: unit.is_none() || x_unit.is_none() });
    Ok(raw)
}

struct Header<'a> {
    lines: Vec<&'a str>,
}

impl Header<'_> {
    /// What stands behind a key word of eight letters.
    fn value(&self, key: &str) -> Option<&str> {
        self.lines.iter().find_map(|line| line.strip_prefix(key))
    }

    /// Part `i` of a line whose parts are `width` letters wide.
    fn part(&self, key: &str, i: usize, width: usize) -> Option<String> {
        let letters: Vec<char> = self.value(key)?.chars().collect();
        let part: String = letters.iter().skip(i * width).take(width).collect();
        Some(part.trim().to_owned()).filter(|part| !part.is_empty())
    }

    fn name(&self, channel: usize) -> Option<String> {
        self.part("SHORTNAM", channel, NAME).or_else(|| self.part("LONGNAME", channel, LONG_NAME))
    }

    /// The channel that `columns` name; or the only one.
    fn choose(&self, channels: usize, options: &ProfileOptions) -> Result<usize, ContentError> {
        let names: Vec<String> = (0..channels).map(|i| self.name(i).unwrap_or_else(|| (i + 1).to_string())).collect();
        let wanted = options.columns.last().map(|name| name.trim());
        let found = match wanted {
            None if channels == 1 => Some(0),
            None => None,
            Some(wanted) => {
                let is_it =
                    |name: &String| name.trim_end_matches('.').eq_ignore_ascii_case(wanted.trim_end_matches('.'));
                let number = || wanted.parse::<usize>().ok().filter(|number| (1..=channels).contains(number));
                names.iter().position(is_it).or_else(|| Some(number()? - 1))
            }
        };
        found.ok_or_else(|| {
            let given = wanted.map_or_else(|| format!("{channels} channels"), |name| format!("\"{name}\""));
            let expected = format!(
                "one of {}, by columns = [\"…\"] (--columns): of an ERD file one channel is read",
                names.join(", ")
            );
            ContentError::value(None, "columns", &given, &expected)
        })
    }

    fn unit(&self, channel: usize) -> Result<Option<Unit>, ContentError> {
        self.part("UNITSNAM", channel, NAME).map(|text| length_unit("UNITSNAM", &text)).transpose()
    }

    fn x_unit(&self) -> Result<Option<Unit>, ContentError> {
        let text = self.value("XUNITS").map(str::trim).filter(|text| !text.is_empty());
        text.map(|text| length_unit("XUNITS", text)).transpose()
    }
}
