//! The file that moduli are in: a text, or a sheet of a workbook.

use asperity::tables::ContentError;
use asperity_formats::workbook;

use super::error::FitError;
use super::measured::MeasuredModuli;
use super::options::FitOptions;
use super::reading::Reading;
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
        units: &options.units,
        frequency: options.frequency,
        poisson_ratio: options.poisson_ratio,
        shear: options.shear,
    };
    if !workbook::is_workbook(&bytes, &options.data) {
        return MeasuredModuli::parse(&bytes, &reading).map_err(|error| in_data(options, error));
    }
    let in_workbook = |error| FitError::Workbook { path: options.data.clone(), error: Box::new(error) };
    let sheets = workbook::sheets(&bytes).map_err(in_workbook)?;
    let names: Vec<String> = sheets.iter().map(|(name, _)| name.clone()).collect();
    let wanted = |(name, _): &&(String, String)| options.sheet.as_ref().is_none_or(|wanted| wanted == name);
    let chosen: Vec<&(String, String)> = sheets.iter().filter(wanted).collect();
    let refuse = |expected| FitError::Sheets { path: options.data.clone(), found: names.clone(), expected };
    let mut read: Vec<(&str, Result<MeasuredModuli, ContentError>)> =
        chosen.iter().map(|(name, text)| (name.as_str(), MeasuredModuli::parse_text(text, &reading))).collect();
    if read.len() > 1 {
        read.retain(|(_, measured)| measured.is_ok());
    }
    match read.len() {
        0 if chosen.is_empty() => Err(refuse("one of them for `sheet`")),
        0 => Err(refuse("moduli in one of them; `sheet` NAME says what one lacks")),
        1 => {
            let (name, measured) = read.remove(0);
            let mut measured = measured.map_err(|error| in_data(options, error))?;
            measured.notes.insert(0, format!("sheet {name} of {}", name_of(&options.data)));
            Ok(measured)
        }
        _ => Err(refuse("moduli in one of them alone, or `sheet` NAME")),
    }
}
