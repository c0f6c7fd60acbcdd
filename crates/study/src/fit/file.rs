//! The file that moduli are in: a text, or a sheet of a workbook.

use std::f64::consts::TAU;

use asperity::scene::Wlf;
use asperity::tables::{ContentError, Dimension, Unit};
use asperity_formats::text::number;
use asperity_formats::workbook;

use super::error::FitError;
use super::heading::{Condition, find_quantity};
use super::measured::MeasuredModuli;
use super::options::FitOptions;
use super::reading::{GivenUnits, Reading};
use super::stated_temperature::{Setting, setting};
use crate::decimals::short;
use crate::files::{self, name_of};

/// What is wrong in the file of the moduli.
pub(super) fn in_data(options: &FitOptions, error: ContentError) -> FitError {
    FitError::Moduli { path: options.data.clone(), error }
}

/// The moduli in a text or in a sheet of a workbook.
pub(super) fn read_moduli(options: &FitOptions) -> Result<MeasuredModuli, FitError> {
    let bytes = files::bytes(&options.data)?;
    let reading = Reading {
        ignored: &options.ignored,
        columns: &options.columns,
        units: &options.units,
        frequency: options.frequency,
        poisson_ratio: options.poisson_ratio,
        shear: options.shear,
    };
    if !workbook::is_workbook(&bytes) {
        return MeasuredModuli::parse(&bytes, &reading).map_err(|error| in_data(options, error));
    }
    let in_workbook = |error| FitError::Workbook { path: options.data.clone(), error: Box::new(error) };
    let sheets = workbook::sheets(&bytes).map_err(in_workbook)?;
    read_sheets(options, &sheets, &reading)
}

/// The moduli in a sheet of a workbook, or in several that are named by their temperatures or frequencies.
fn read_sheets(
    options: &FitOptions,
    sheets: &[(String, String)],
    reading: &Reading<'_>,
) -> Result<MeasuredModuli, FitError> {
    let names: Vec<String> = sheets.iter().map(|(name, _)| name.clone()).collect();
    let wanted = |(name, _): &&(String, String)| options.sheet.as_ref().is_none_or(|wanted| wanted == name);
    let chosen: Vec<&(String, String)> = sheets.iter().filter(wanted).collect();
    let refuse = |expected| FitError::Sheets { path: options.data.clone(), found: names.clone(), expected };
    let conditions = conditions_of(&chosen.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), reading.units);
    let read = chosen.iter().zip(&conditions).map(|((name, text), condition)| Sheet {
        name,
        condition: *condition,
        measured: MeasuredModuli::parse_text(text, &under(*reading, condition.as_ref())),
    });
    let mut read: Vec<Sheet<'_>> = read.collect();
    if read.len() > 1 {
        // One that is named as the others is no sheet of something else.
        let series = read.iter().filter(|sheet| sheet.measured.is_ok() && sheet.condition.is_some()).count();
        read.retain(|sheet| sheet.measured.is_ok() || (series > 0 && sheet.condition.is_some()));
    }
    match read.len() {
        0 if chosen.is_empty() => Err(refuse("one of them for `sheet`")),
        0 => Err(refuse("moduli in one of them; `sheet` NAME says what one lacks")),
        1 => {
            let sheet = read.remove(0);
            let name = sheet.name;
            let mut measured = sheet.with_condition().map_err(|error| in_data(options, error))?;
            measured.notes.insert(0, format!("sheet {name} of {}", name_of(&options.data)));
            Ok(measured)
        }
        _ if read.iter().all(|sheet| sheet.condition.is_some()) => {
            together(read).map_err(|error| in_data(options, error))
        }
        _ => {
            Err(refuse("moduli in one of them alone, or in sheets named by their temperatures, 20 °C, or `sheet` NAME"))
        }
    }
}

/// A sheet with what its name says of all its rows.
struct Sheet<'a> {
    name: &'a str,
    condition: Option<Condition>,
    measured: Result<MeasuredModuli, ContentError>,
}

impl Sheet<'_> {
    /// Its moduli at the temperature of its name, where the rows have none of their own.
    fn with_condition(self) -> Result<MeasuredModuli, ContentError> {
        let mut measured = self.measured.map_err(|error| error.in_sheet(self.name))?;
        if let Some(Condition { dimension: Dimension::Temperature, value }) = self.condition {
            let rows = measured.points.iter_mut().filter(|point| point.temperature.is_none());
            rows.for_each(|point| point.temperature = Some(value));
        }
        Ok(measured)
    }
}

/// How a sheet is read whose name may be a frequency.
fn under<'a>(reading: Reading<'a>, condition: Option<&Condition>) -> Reading<'a> {
    let of_name = condition.filter(|found| found.dimension == Dimension::Frequency).map(|found| found.value);
    Reading { frequency: of_name.or(reading.frequency), ..reading }
}

/// The moduli of several sheets.
fn together(sheets: Vec<Sheet<'_>>) -> Result<MeasuredModuli, ContentError> {
    let said: Vec<String> = sheets.iter().filter_map(Sheet::said).collect();
    let mut all: Option<MeasuredModuli> = None;
    for sheet in sheets {
        let name = sheet.name.to_owned();
        let measured = sheet.with_condition()?;
        match &mut all {
            None => all = Some(measured),
            Some(all) if (all.test, all.reduced) != (measured.test, measured.reduced) => {
                let expected = "tables of one kind in a file: all of oscillation, or all of relaxation";
                return Err(ContentError::value(None, &format!("sheet {name}"), "another kind of table", expected));
            }
            Some(all) => all.points.extend(measured.points),
        }
    }
    let mut all = all.ok_or_else(|| ContentError::value(None, "sheets", "none", "one"))?;
    all.notes.insert(0, format!("sheets by their names: {}", said.join(", ")));
    Ok(all)
}

impl Sheet<'_> {
    /// Its name, and what is taken from that.
    fn said(&self) -> Option<String> {
        let Condition { dimension, value } = self.condition?;
        let taken = match dimension {
            Dimension::Frequency => format!("{} Hz", short(value / TAU, 6)),
            _ => format!("{} K", short(value, 6)),
        };
        Some(format!("{} at {taken}", self.name))
    }
}

/// What the names of sheets say of all their rows: `20C`, `-10 °C`, `T=25`, `1 Hz`. A temperature without a unit is in °C
/// where one of them is too cold for rubber in K.
fn conditions_of(names: &[&str], units: &GivenUnits) -> Vec<Option<Condition>> {
    let settings: Vec<Option<Setting>> = names.iter().map(|name| setting(name, units)).collect();
    let bare = |found: &Option<Setting>| match found {
        Some(Setting::Bare(text)) => {
            text.split_once(['=', ':']).or_else(|| text.split_once(' ')).and_then(|(_, value)| number(value.trim()))
        }
        _ => None,
    };
    let in_celsius = settings.iter().filter_map(bare).any(|value| value < Wlf::COLDEST);
    let unit = Unit::parse(if in_celsius { "°C" } else { "K" });
    let temperature = |value| Some(Condition { dimension: Dimension::Temperature, value });
    let of_name = |(name, found): (&&str, &Option<Setting>)| {
        let named = [Dimension::Temperature, Dimension::Frequency].into_iter();
        let named = named
            .filter_map(|dimension| find_quantity(name, dimension).map(|(_, value)| Condition { dimension, value }));
        match found {
            Some(Setting::Kelvin(value)) => temperature(*value),
            Some(Setting::Bare(_)) => bare(found).zip(unit).and_then(|(value, unit)| temperature(unit.to_si(value))),
            None => named.into_iter().next(),
        }
    };
    names.iter().zip(&settings).map(of_name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_sheets_say_their_temperature() {
        let of = |names: &[&str]| {
            conditions_of(names, &[]).into_iter().map(|found| found.map(|found| found.value)).collect::<Vec<_>>()
        };
        assert_eq!(of(&["20C", "-10 °C", "T=25", "E at 300 K"]), [293.15, 263.15, 298.15, 300.0].map(Some));
        assert_eq!(of(&["T=250", "T = 300", "20 degC"]), [250.0, 300.0, 293.15].map(Some));
        assert_eq!(of(&["Sheet1", "1", "Data", "20"]), [None; 4]);
        assert_eq!(of(&["1 Hz"]), [Some(TAU)]);
    }
}
