//! `asperity fit`: fits Prony terms to measured moduli.

mod columns;
mod measured;
mod nnls;
mod search;
mod shift;
mod stated_temperature;
mod table;
mod temperatures;

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity::scene::PronyTerm;
use asperity::tables::{ContentError, Unit};

use super::cli::{Fit, WlfConstants};
use super::figure::{Curve, Figure as _, Panel, Stacked, Stroke};
use super::files::{self, FileError, check_outputs, name_of, named, picture_beside, print_beside};
use super::terminal::{lines, note, warn};
use super::{NOT_REACHED, SUCCESS};
use asperity_study::decimals::{decimal, rounded};
use measured::{MeasuredModuli, Reading};
use search::{Compound, FitErrors, RelativeError, Sample, Target, Test, search};
use temperatures::{Shift, ShiftError};

/// `asperity fit` failed.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum FitError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}", .error.within(.path))]
    Moduli { path: PathBuf, error: ContentError },
    #[error("{}: {error}", .path.display())]
    Shift { path: PathBuf, error: ShiftError },
    #[error("{}: the workbook cannot be read: {error}", .path.display())]
    Workbook { path: PathBuf, error: Box<asperity_formats::workbook::WorkbookError> },
    #[error("{}: {}", .path.display(), sheets(.found, .expected))]
    Sheets { path: PathBuf, found: Vec<String>, expected: &'static str },
}

fn sheets(found: &[String], expected: &str) -> String {
    format!("sheets {}: expected {expected}", found.join(", "))
}

/// Points per decade of a plotted curve.
const POINTS_PER_DECADE: f64 = 20.0;

/// How moduli are read and fitted.
#[derive(Clone, Debug)]
pub struct FitOptions {
    /// The file of the moduli: its name stands in messages and in what is written.
    pub data: PathBuf,
    /// The sheet of a workbook; `None`: the only one with moduli.
    pub sheet: Option<String>,
    /// Columns to ignore, by their headings.
    pub ignored: Vec<String>,
    /// Units of columns, by their headings.
    pub units: Vec<(String, Unit)>,
    /// The frequency of all rows where the table has no column of it, rad/s.
    pub frequency: Option<f64>,
    /// Poisson's ratio, by which moduli of shear become moduli of tension.
    pub poisson_ratio: f64,
    /// Whether moduli whose headings have no letter are of shear.
    pub shear: bool,
    /// The admissible root mean square of the relative errors.
    pub error: f64,
    /// Whether a viscosity in parallel to the terms is fitted too.
    pub viscosity: bool,
    /// Constants that shift rows at other temperatures.
    pub wlf: Option<WlfConstants>,
    /// A table of shift factors in their place.
    pub shifts: Option<PathBuf>,
    /// Where the master curve is made without either, K.
    pub reference: Option<f64>,
}

impl Default for FitOptions {
    /// Those of `asperity fit`, of no file.
    fn default() -> Self {
        Self {
            data: PathBuf::new(),
            sheet: None,
            ignored: Vec::new(),
            units: Vec::new(),
            frequency: None,
            poisson_ratio: 0.5,
            shear: false,
            error: 0.02,
            viscosity: false,
            wlf: None,
            shifts: None,
            reference: None,
        }
    }
}

impl From<&Fit> for FitOptions {
    fn from(command: &Fit) -> Self {
        Self {
            data: command.data.clone(),
            sheet: command.sheet.clone(),
            ignored: command.ignore.clone(),
            units: command.unit.clone(),
            frequency: command.frequency,
            poisson_ratio: command.poisson_ratio,
            shear: command.shear,
            error: command.error,
            viscosity: command.viscosity,
            wlf: command.wlf,
            shifts: command.shifts.clone(),
            reference: command.reference,
        }
    }
}

/// Reads the moduli, puts those of several temperatures together and fits a Prony series.
///
/// # Errors
/// Where the table cannot be read, or its temperatures cannot be put together.
pub fn fit_moduli(options: &FitOptions) -> Result<FittedModuli, FitError> {
    let measured = read_moduli(options)?;
    let shift = Shift::of(options, &measured)?;
    let samples = shift.samples(&measured).map_err(|error| in_data(options, error))?;
    Ok(FittedModuli::new(options.clone(), measured, shift, samples))
}

/// Reads the moduli, puts those of several temperatures together, fits, writes the terms and the plot, and prints a
/// summary. Where the requested error cannot be reached, the best fit is written, with a warning and an exit status of
/// its own.
pub(crate) fn fit(command: &Fit) -> Result<u8, FitError> {
    let picture = picture_beside(&command.output, command.plot.as_ref());
    let read: Vec<PathBuf> = std::iter::once(&command.data).chain(&command.shifts).cloned().collect();
    check_outputs([&command.output].into_iter().chain(&picture), read)?;
    let result = fit_moduli(&command.into())?;
    result.notes().iter().for_each(|text| note(text));
    result.warnings().iter().for_each(|text| warn(text));
    files::write(&command.output, result.file())?;
    if let Some(picture) = &picture {
        result.picture().write(picture)?;
    }
    print_beside([&command.output], &result.text(&command.output, picture.as_deref()))?;
    if result.errors.both.rms <= command.error {
        return Ok(SUCCESS);
    }
    warn(&result.not_reached(&command.output));
    Ok(NOT_REACHED)
}

fn in_data(options: &FitOptions, error: ContentError) -> FitError {
    FitError::Moduli { path: options.data.clone(), error }
}

/// The moduli in a text or in a sheet of a workbook.
fn read_moduli(options: &FitOptions) -> Result<MeasuredModuli, FitError> {
    let bytes = files::read(&options.data)?;
    let reading = Reading {
        ignored: &options.ignored,
        units: &options.units,
        frequency: options.frequency,
        poisson_ratio: options.poisson_ratio,
        shear: options.shear,
    };
    if !asperity_formats::workbook::is_workbook(&bytes, &options.data) {
        return MeasuredModuli::parse(&bytes, &reading).map_err(|error| in_data(options, error));
    }
    let in_workbook = |error| FitError::Workbook { path: options.data.clone(), error: Box::new(error) };
    let sheets = asperity_formats::workbook::sheets(&bytes).map_err(in_workbook)?;
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
        0 if chosen.is_empty() => Err(refuse("one of them for --sheet")),
        0 => Err(refuse("moduli in one of them; --sheet NAME says what one lacks")),
        1 => {
            let (name, measured) = read.remove(0);
            let mut measured = measured.map_err(|error| in_data(options, error))?;
            measured.notes.insert(0, format!("sheet {name} of {}", name_of(&options.data)));
            Ok(measured)
        }
        _ => Err(refuse("moduli in one of them alone, or --sheet NAME")),
    }
}

/// A Prony series fitted to measured moduli.
#[derive(Debug)]
pub struct FittedModuli {
    options: FitOptions,
    measured: MeasuredModuli,
    shift: Shift,
    /// At the reference temperature.
    samples: Vec<Sample>,
    compound: Compound,
    errors: FitErrors,
}

impl FittedModuli {
    fn new(options: FitOptions, measured: MeasuredModuli, shift: Shift, samples: Vec<Sample>) -> Self {
        let test = measured.test;
        let exact = search(&samples, &Target { error: options.error, viscosity: options.viscosity, test });
        let compound = exact.rounded(FitErrors::of(&exact, &samples, test).both.rms);
        let errors = FitErrors::of(&compound, &samples, test);
        Self { options, measured, shift, samples, compound, errors }
    }

    /// How the table was read, and what was assumed.
    pub fn notes(&self) -> &[String] {
        &self.measured.notes
    }

    /// What to look at in how temperatures were put together.
    pub fn warnings(&self) -> Vec<String> {
        self.shift.warnings()
    }

    /// E_∞, Pa.
    pub fn equilibrium_modulus(&self) -> f64 {
        self.compound.equilibrium_modulus
    }

    /// The viscosity in parallel, Pa s; 0 where none was asked for.
    pub fn viscosity(&self) -> f64 {
        self.compound.viscosity
    }

    /// The terms, from short to long relaxation times.
    pub fn terms(&self) -> &[PronyTerm] {
        &self.compound.terms
    }

    /// Root mean square of the relative errors of all moduli, 1.
    pub fn error(&self) -> f64 {
        self.errors.both.rms
    }

    /// The constants that put the temperatures together, where they are known.
    pub fn wlf(&self) -> Option<WlfConstants> {
        self.shift.constants().or(self.options.wlf)
    }

    /// The measured points at the reference temperature: angular frequency in rad/s, E' and E'' in Pa; or time in s, E(t)
    /// in Pa and 0.
    pub fn points(&self) -> Vec<[f64; 3]> {
        self.samples.iter().map(|sample| [sample.at, sample.storage, sample.loss]).collect()
    }

    /// E' and E'' at an angular frequency (rad/s), or E(t) at a time (s) and 0, Pa.
    pub fn response(&self, at: f64) -> (f64, f64) {
        self.compound.response(self.measured.test, at)
    }

    /// Why the error asked for was not reached: the data scatter, or known constants do not put them together.
    fn not_reached(&self, output: &Path) -> String {
        let (wanted, reached) = (percent(self.options.error), percent(self.errors.both.rms));
        let why = self
            .shift
            .blame(&self.measured)
            .unwrap_or_else(|| "the data scatter too much for less, and --error sets what is enough".to_owned());
        format!(
            "the error asked for, {wanted}, cannot be reached: {reached} is about the smallest of any series with \
             moduli of 0 or more, and {} has such a series; {why}",
            output.display()
        )
    }

    /// The file of Prony terms, with the fit's figures as comments.
    pub fn file(&self) -> String {
        let mut text =
            String::from("# A generalised Maxwell model: Prony terms fitted to measured moduli by `asperity fit`\n");
        for (name, value) in self.facts() {
            text += &format!("# {name} = {value}\n");
        }
        text += "relaxation_time [s],modulus [Pa]\n";
        let row = |term: &PronyTerm| format!("{},{}\n", written(term.relaxation_time), written(term.modulus));
        text + &self.compound.terms.iter().map(row).collect::<String>()
    }

    fn facts(&self) -> Vec<(&'static str, String)> {
        let both = self.errors.both;
        let (rms, largest) = (percent(both.rms), percent(both.largest));
        let mut facts = vec![
            ("equilibrium_modulus", format!("{} Pa", written(self.compound.equilibrium_modulus))),
            ("units", "relaxation_time in s, modulus in Pa".into()),
            ("source", name_of(&self.options.data)),
            ("data", self.data()),
            ("options", self.options()),
            ("error", format!("{rms} (root mean square of the relative errors of {} at all rows)", self.quantities())),
            ("largest_error", format!("{largest} at {}", self.place(both.at))),
        ];
        if self.options.viscosity {
            facts.insert(1, ("viscosity", format!("{} Pa s", written(self.compound.viscosity))));
        }
        facts
    }

    fn quantities(&self) -> &'static str {
        if self.measured.test == Test::Oscillation { "E' and E''" } else { "E(t)" }
    }

    fn data(&self) -> String {
        let (low, high) = range(self.measured.points.iter().map(|point| point.sample.at));
        let rows = format!("{} rows, {} to {}", self.samples.len(), self.place(low), self.place(high));
        let Some(reference) = self.shift.reference() else { return rows };
        let (cold, hot) = range(self.measured.points.iter().filter_map(|point| point.temperature));
        let (low, high) = range(self.samples.iter().map(|sample| sample.at));
        format!(
            "{rows}, {cold:.2} to {hot:.2} K, shifted to {} K: {} to {}",
            written(rounded(reference, 6)),
            self.place(low),
            self.place(high)
        )
    }

    fn options(&self) -> String {
        let mut text = format!("--error {}", written(self.options.error));
        if let Some(wlf) = self.options.wlf {
            text += &format!(" --wlf {},{},{}", written(wlf.c1), written(wlf.c2), written(wlf.reference_temperature));
        }
        if self.options.viscosity {
            text += " --viscosity";
        }
        if let Some(shifts) = &self.options.shifts {
            text += &format!(" --shifts {}", name_of(shifts));
        }
        if let Some(frequency) = self.options.frequency {
            text += &format!(" --frequency {}Hz", written(frequency / TAU));
        }
        if self.options.shear {
            text += " --shear";
        }
        text + &self.options.ignored.iter().map(|name| format!(" --ignore '{name}'")).collect::<String>()
    }

    /// The printed summary, and the lines for a scene.
    fn text(&self, output: &Path, picture: Option<&Path>) -> String {
        let (compound, errors) = (&self.compound, &self.errors);
        let mut rows = vec![("Data", self.data()), ("E_inf", format!("{} Pa", written(compound.equilibrium_modulus)))];
        if self.options.viscosity {
            rows.push(("Viscosity", format!("{} Pa s", written(compound.viscosity))));
        }
        let glassy: f64 = compound.terms.iter().map(|term| term.modulus).sum::<f64>() + compound.equilibrium_modulus;
        rows.push(("Glassy", format!("{} Pa, the sum of all moduli", short(glassy))));
        rows.push(("Terms", self.terms_in_words()));
        let (rms, requested) = (percent(errors.both.rms), percent(self.options.error));
        let together = if self.measured.test == Test::Oscillation { "E' and E'' together" } else { "E(t)" };
        rows.push(("Error", format!("{rms} rms of {together}; {requested} requested")));
        rows.push(("", format!("{:<11}{:<11}{:<11}at", "", "rms", "largest")));
        let row = |name: &str, error: &RelativeError| {
            let (rms, largest) = (percent(error.rms), percent(error.largest));
            ("", format!("{name:<11}{rms:<11}{largest:<11}{}", self.place(error.at)))
        };
        match self.measured.test {
            Test::Oscillation => {
                let tangent = row("tan delta", &errors.loss_tangent);
                rows.extend([row("E'", &errors.storage), row("E''", &errors.loss), tangent]);
            }
            Test::Relaxation => rows.push(row("E(t)", &errors.storage)),
        }
        rows.extend(self.shift.rows(&self.measured, &self.samples, &self.compound));
        let written = [Some(output), picture].into_iter().flatten().map(named);
        rows.push(("Written", written.collect::<Vec<_>>().join(", ")));
        let figures = lines(&rows);
        format!("{figures}\nFor a scene in the folder of {}:\n\n{}", name_of(output), self.scene(output))
    }

    fn terms_in_words(&self) -> String {
        match &self.compound.terms[..] {
            [] => "none".into(),
            [only] => format!("1, at {} s", short(only.relaxation_time)),
            [first, .., last] => {
                let [first, last] = [first, last].map(|term| short(term.relaxation_time));
                format!("{}, from {first} s to {last} s", self.compound.terms.len())
            }
        }
    }

    fn scene(&self, output: &Path) -> String {
        let mut lines = vec![
            "[material]".to_owned(),
            "# density (kg/m³) and poisson_ratio are not in the data".into(),
            format!("equilibrium_modulus = {}", written(self.compound.equilibrium_modulus)),
        ];
        if self.compound.viscosity > 0.0 {
            lines.push(format!("viscosity = {}", written(self.compound.viscosity)));
        }
        lines.push(match self.compound.terms[..] {
            [] => "prony = []".into(),
            _ => format!("prony = {:?}", name_of(output)),
        });
        if let Some(wlf) = self.wlf() {
            let reference = written(wlf.reference_temperature);
            let (c1, c2) = (written(wlf.c1), written(wlf.c2));
            lines.push(format!(
                "wlf = {{ c1 = {c1}, c2 = {c2}, reference_temperature = {reference}, temperature = {reference} }}"
            ));
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    /// The plot: data as rings, the fit as lines; of several temperatures the master curve.
    fn picture(&self) -> Stacked {
        let test = self.measured.test;
        let unit = if self.counts_cycles() { TAU } else { 1.0 };
        let places = between(&self.samples);
        let curves = |name: &str, look: usize, measured: fn(&Sample) -> f64, fitted: fn((f64, f64)) -> f64| {
            let points = self.samples.iter().map(|sample| (sample.at / unit, measured(sample))).collect();
            let line = places.iter().map(|&at| (at / unit, fitted(self.compound.response(test, at)))).collect();
            [
                Curve { name: format!("{name} measured"), look, stroke: Stroke::Rings, points },
                Curve { name: format!("{name} fitted"), look, stroke: Stroke::Line, points: line },
            ]
        };
        let panel = |title: &str, curves: Vec<Curve>| Panel { title: title.into(), curves };
        let panels = if test == Test::Oscillation {
            let storage = curves("E'", 0, |sample| sample.storage, |(storage, _)| storage);
            let loss = curves("E''", 1, |sample| sample.loss, |(_, loss)| loss);
            let tangent = curves("tan δ", 2, |sample| sample.loss / sample.storage, |(storage, loss)| loss / storage);
            vec![panel("modulus in Pa", [storage, loss].concat()), panel("tan δ", tangent.to_vec())]
        } else {
            let relaxed = curves("E(t)", 0, |sample| sample.storage, |(storage, _)| storage);
            vec![panel("modulus in Pa", relaxed.to_vec())]
        };
        Stacked {
            title: format!(
                "{}: {} terms, {} rms",
                name_of(&self.options.data),
                self.compound.terms.len(),
                percent(self.errors.both.rms)
            ),
            x_title: self.x_title(),
            panels,
        }
    }

    fn x_title(&self) -> String {
        let quantity = match (self.measured.test, self.measured.in_hertz) {
            (Test::Relaxation, _) => "time in s",
            (Test::Oscillation, true) => "frequency in Hz",
            (Test::Oscillation, false) => "angular frequency in rad/s",
        };
        let shifted = |reference: f64| format!("{quantity}, shifted to {} K", written(rounded(reference, 6)));
        self.shift.reference().map_or_else(|| quantity.into(), shifted)
    }

    fn counts_cycles(&self) -> bool {
        self.measured.in_hertz && self.measured.test == Test::Oscillation
    }

    /// A frequency or a time in the unit of the data.
    fn place(&self, at: f64) -> String {
        match self.measured.test {
            Test::Relaxation => format!("{} s", short(at)),
            Test::Oscillation if self.measured.in_hertz => format!("{} Hz", short(at / TAU)),
            Test::Oscillation => format!("{} rad/s", short(at)),
        }
    }
}

/// Angular frequencies or times over the range of `samples`, evenly spaced in the logarithm.
fn between(samples: &[Sample]) -> Vec<f64> {
    let (low, high) = range(samples.iter().map(|sample| sample.at.log10()));
    let intervals = ((high - low) * POINTS_PER_DECADE).ceil().max(1.0);
    (0..=intervals as usize).map(|i| 10.0_f64.powf(low + (high - low) * i as f64 / intervals)).collect()
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)))
}

/// A number as files have it.
fn written(value: f64) -> String {
    decimal(value, 1e-3..1e5)
}

/// Four digits.
fn short(value: f64) -> String {
    written(rounded(value, 4))
}

/// A relative error in per cent, with three digits.
fn percent(value: f64) -> String {
    format!("{} %", written(rounded(100.0 * value, 3)))
}
