//! A Prony series that was fitted: its figures, its file, and its picture.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity::scene::PronyTerm;
use asperity::table::{Column, Header, Table};

use super::compound::{Compound, FitErrors, Sample, Test};
use super::consistency::Consistency;
use super::measured::MeasuredModuli;
use super::options::{FitOptions, Vertical, Weight, WlfConstants, word};
use super::prony::PronyProblem;
use super::temperatures::{Shift, ShiftedCurve, VerticalShift};
use crate::decimals::{percent, plain, rounded, short};
use crate::error::Error;
use crate::files::{self, name_of};
use crate::picture::{Mark, Picture};

/// Reads the moduli in the file `data`, puts those of several temperatures together and fits a Prony series.
///
/// # Errors
/// Where the table cannot be read, or its temperatures cannot be put together.
pub fn fit_moduli(data: &Path, options: &FitOptions) -> Result<FittedModuli, Error> {
    if options.expansion.is_some() && options.vertical != Vertical::Density {
        return Err(Error::value("`expansion`: expected `vertical` density beside it"));
    }
    let mut measured = MeasuredModuli::read(&files::bytes(data)?, options).map_err(Error::content(data))?;
    if measured.test == Test::Relaxation && options.weight != Weight::Both {
        let weight = word(options.weight);
        return Err(Error::value(format!("`weight` {weight}: a relaxation has one modulus, which counts alone")));
    }
    let mut vertical = VerticalShift::apply(data, options, &mut measured)?;
    let shift = Shift::of(data, options, &measured)?;
    vertical.finish(options, &mut measured, shift.reference());
    let samples = shift.samples(&measured).map_err(Error::content(data))?;
    Ok(FittedModuli::new((data, options), measured, (shift, vertical), samples))
}

/// A Prony series fitted to measured moduli.
#[derive(Debug)]
pub struct FittedModuli {
    data: PathBuf,
    options: FitOptions,
    measured: MeasuredModuli,
    shift: Shift,
    vertical: VerticalShift,
    /// At the reference temperature.
    samples: Vec<Sample>,
    compound: Compound,
    errors: FitErrors,
    consistency: Option<Consistency>,
}

impl FittedModuli {
    fn new(
        (data, options): (&Path, &FitOptions),
        measured: MeasuredModuli,
        (shift, vertical): (Shift, VerticalShift),
        samples: Vec<Sample>,
    ) -> Self {
        let test = measured.test;
        let problem = PronyProblem::new(&samples, test, options.viscosity, options.weight);
        let exact = problem.fewest_terms(options.fit_error);
        let compound = exact.rounded(FitErrors::of(&exact, &samples, test).both.rms);
        let errors = FitErrors::of(&compound, &samples, test);
        let is_oscillation = test == Test::Oscillation;
        let consistency = is_oscillation.then(|| Consistency::of(&samples, measured.in_hertz));
        let (data, options) = (data.to_owned(), options.clone());
        Self { data, options, measured, shift, vertical, samples, compound, errors, consistency }
    }

    /// How the table was read, and what was assumed.
    pub fn notes(&self) -> &[String] {
        &self.measured.notes
    }

    /// What to look at in how temperatures were put together.
    pub fn warnings(&self) -> Vec<String> {
        self.shift.warnings().into_iter().chain(self.vertical.warning()).collect()
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

    /// Root mean square of the relative errors of the moduli that count, 1.
    pub fn error(&self) -> f64 {
        match self.options.weight {
            Weight::Storage => self.errors.storage.rms,
            Weight::Loss => self.errors.loss.rms,
            Weight::Both => self.errors.both.rms,
        }
    }

    /// The constants that put the temperatures together, where they are known.
    pub fn wlf(&self) -> Option<WlfConstants> {
        self.shift.constants().or(self.options.wlf)
    }

    /// E' and E'' at an angular frequency (rad/s), or E(t) at a time (s) and 0, Pa.
    pub fn response(&self, at: f64) -> (f64, f64) {
        self.compound.response(self.measured.test, at)
    }

    /// The kind of test that the data are of.
    pub fn test(&self) -> Test {
        self.measured.test
    }

    /// The measured points at the reference temperature.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The relative errors of the series at the measured points.
    pub fn errors(&self) -> &FitErrors {
        &self.errors
    }

    /// How far E' and E'' are apart; `None` of relaxation.
    pub fn consistency(&self) -> Option<&Consistency> {
        self.consistency.as_ref()
    }

    /// How the errors add up over frequency (or time): places and the root mean square of all relative errors up to there
    /// over the number of all points, of E' and of E''. The last ones are the errors of the fit.
    pub fn cumulative_errors(&self) -> Vec<[f64; 3]> {
        let mut sorted = self.samples.clone();
        sorted.sort_by(|a, b| a.at.total_cmp(&b.at));
        let (count, mut sums) = (sorted.len() as f64, [0.0; 2]);
        let mut up_to = |sample: &Sample| {
            let (storage, loss) = self.response(sample.at);
            sums[0] += (storage / sample.storage - 1.0).powi(2);
            sums[1] += if self.test() == Test::Oscillation { (loss / sample.loss - 1.0).powi(2) } else { 0.0 };
            [sample.at, (sums[0] / count).sqrt(), (sums[1] / count).sqrt()]
        };
        sorted.iter().map(&mut up_to).collect()
    }

    /// The temperature of the master curve, K; `None` where no rows are shifted.
    pub fn reference(&self) -> Option<f64> {
        self.shift.reference()
    }

    /// The constants that follow from the data, and whether they shift the rows: else they are fitted to the factors that
    /// do.
    pub fn found_law(&self) -> Option<(WlfConstants, bool)> {
        self.shift.found_law()
    }

    /// Factors and errors by temperature; empty where no rows are shifted.
    pub fn shifted_curves(&self) -> Vec<ShiftedCurve> {
        self.shift.curves(&self.measured, &self.samples, &self.compound)
    }

    /// What is to blame where the error asked for is not reached, other than scatter.
    pub fn blame(&self) -> Option<String> {
        self.shift.blame(&self.measured)
    }

    /// The table of Prony terms, with the fit's figures in its header.
    pub fn table(&self) -> Table {
        let columns = [Column::numbers("relaxation_time", "s"), Column::numbers("modulus", "Pa")];
        let mut table = Table::new(self.header(), columns);
        for term in &self.compound.terms {
            table.push([term.relaxation_time.into(), term.modulus.into()]);
        }
        table
    }

    fn header(&self) -> Header {
        let Self { compound, errors: FitErrors { both, .. }, .. } = self;
        let (rms, largest) = (percent(self.error(), 3), percent(both.largest, 3));
        let viscosity = self.options.viscosity.then(|| format!("{} Pa s", plain(compound.viscosity)));
        let consistency = self.consistency.as_ref().map(|found| {
            let (apart, nearest) = (percent(found.apart(), 2), percent(found.nearest, 3));
            format!("E'' is {apart} from what E' says it is; no sum of terms is nearer to both than {nearest} rms")
        });
        Header::default()
            .with("model", "a generalised Maxwell model: Prony terms fitted to measured moduli by `asperity fit`")
            .with_number("equilibrium_modulus", compound.equilibrium_modulus, "Pa")
            .with_some("viscosity", viscosity)
            .with("source", &name_of(&self.data))
            .with("data", &self.data())
            .with("options", &self.options_in_words())
            .with(
                "error",
                &format!("{rms} (root mean square of the relative errors of {} at all rows)", self.quantities()),
            )
            .with("largest_error", &format!("{largest} at {}", self.place(both.at)))
            .with_some("kramers_kronig", consistency)
    }

    fn quantities(&self) -> &'static str {
        match (self.measured.test, self.options.weight) {
            (Test::Relaxation, _) => "E(t)",
            (Test::Oscillation, Weight::Both) => "E' and E''",
            (Test::Oscillation, Weight::Storage) => "E'",
            (Test::Oscillation, Weight::Loss) => "E''",
        }
    }

    /// How many rows there are, and their range.
    pub fn data(&self) -> String {
        let (low, high) = range(self.measured.points.iter().map(|point| point.sample.at));
        let rows = format!("{} rows, {} to {}", self.samples.len(), self.place(low), self.place(high));
        let Some(reference) = self.shift.reference() else { return rows };
        let (cold, hot) = range(self.measured.points.iter().filter_map(|point| point.temperature));
        let (low, high) = range(self.samples.iter().map(|sample| sample.at));
        format!(
            "{rows}, {cold:.2} to {hot:.2} K, shifted to {} K: {} to {}",
            plain(rounded(reference, 6)),
            self.place(low),
            self.place(high)
        )
    }

    /// The options that were given.
    fn options_in_words(&self) -> String {
        let mut text = format!("`fit_error` {}", plain(self.options.fit_error));
        if let Some(wlf) = self.options.wlf {
            text += &format!(" `wlf` {},{},{}", plain(wlf.c1), plain(wlf.c2), plain(wlf.reference_temperature));
        }
        if self.options.viscosity {
            text += " `viscosity`";
        }
        if let Some(shifts) = &self.options.shifts {
            text += &format!(" `shifts` {}", name_of(shifts));
        }
        if self.options.weight != Weight::Both {
            text += &format!(" `weight` {}", word(self.options.weight));
        }
        if self.options.vertical != Vertical::Divide {
            text += &format!(" `vertical` {}", word(self.options.vertical));
        }
        if self.options.vertical == Vertical::Density {
            text += &format!(" `expansion` {}", plain(self.options.expansion()));
        }
        if let Some(frequency) = self.options.frequency {
            text += &format!(" `frequency` {}Hz", plain(frequency / TAU));
        }
        if self.options.shear {
            text += " `shear`";
        }
        text + &self.options.ignore.iter().map(|name| format!(" `ignore` '{name}'")).collect::<String>()
    }

    /// Whether the data are over frequencies in Hz.
    pub fn counts_cycles(&self) -> bool {
        self.measured.in_hertz && self.measured.test == Test::Oscillation
    }

    /// A frequency or a time in the unit of the data.
    pub fn place(&self, at: f64) -> String {
        match self.measured.test {
            Test::Relaxation => format!("{} s", short(at, 4)),
            Test::Oscillation if self.measured.in_hertz => format!("{} Hz", short(at / TAU, 4)),
            Test::Oscillation => format!("{} rad/s", short(at, 4)),
        }
    }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)))
}

/// Points of the fit's curves.
const POINTS_PER_DECADE: f64 = 20.0;

impl FittedModuli {
    /// The moduli, and how the errors add up.
    pub fn picture(&self) -> Picture {
        let unit = if self.counts_cycles() { TAU } else { 1.0 };
        let places = between(self.samples());
        let curves = |name: &str, look: usize, measured: fn(&Sample) -> f64, of_fit: fn((f64, f64)) -> f64| {
            let points = self.samples().iter().map(|sample| [sample.at / unit, measured(sample)]).collect();
            let line = places.iter().map(|&at| [at / unit, of_fit(self.response(at))]).collect();
            [Mark::rings(format!("{name} measured"), look, points), Mark::line(format!("{name} fitted"), look, line)]
        };
        let mut panels = if self.test() == Test::Oscillation {
            let storage = curves("E'", 0, |sample| sample.storage, |(storage, _)| storage);
            let loss = curves("E''", 1, |sample| sample.loss, |(_, loss)| loss);
            let tangent = curves("tan δ", 2, |sample| sample.loss / sample.storage, |(storage, loss)| loss / storage);
            vec![(("modulus", "Pa"), [storage, loss].concat()), (("tan δ", ""), tangent.to_vec())]
        } else {
            let relaxed = curves("E(t)", 0, |sample| sample.storage, |(storage, _)| storage);
            vec![(("modulus", "Pa"), relaxed.to_vec())]
        };
        panels.push((("rms error up to there, %", ""), self.misfit(unit)));
        Picture::stacked((&self.x_title(), ""), panels)
    }

    /// How the errors add up to those of the fit, in per cent, over frequencies in `unit`.
    fn misfit(&self, unit: f64) -> Vec<Mark> {
        /// Of the whole: what is less is not drawn.
        const LEAST: f64 = 0.01;
        let sums = self.cumulative_errors();
        let names: &[&str] = if self.test() == Test::Oscillation { &["E'", "E''"] } else { &["E(t)"] };
        let curve = |(look, name): (usize, &&str)| {
            let whole = sums.last().map_or(0.0, |sums| sums[1 + look]);
            let seen = sums.iter().filter(|sums| sums[1 + look] > LEAST * whole);
            let points = seen.map(|sums| [sums[0] / unit, 100.0 * sums[1 + look]]).collect();
            Mark::line(format!("{name} off the fit"), look, points)
        };
        names.iter().enumerate().map(curve).collect()
    }

    fn x_title(&self) -> String {
        let quantity = match (self.test(), self.counts_cycles()) {
            (Test::Relaxation, _) => "time in s",
            (Test::Oscillation, true) => "frequency in Hz",
            (Test::Oscillation, false) => "angular frequency in rad/s",
        };
        let shifted = |reference: f64| format!("{quantity}, shifted to {} K", plain(rounded(reference, 6)));
        self.reference().map_or_else(|| quantity.into(), shifted)
    }
}

/// Angular frequencies or times over the range of `samples`, evenly spaced in the logarithm.
fn between(samples: &[Sample]) -> Vec<f64> {
    let places = samples.iter().map(|sample| sample.at.log10());
    let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), place| (low.min(place), high.max(place)));
    let intervals = ((high - low) * POINTS_PER_DECADE).ceil().max(1.0);
    (0..=intervals as usize).map(|i| 10.0_f64.powf(low + (high - low) * i as f64 / intervals)).collect()
}
