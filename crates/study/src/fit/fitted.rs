//! A Prony series that was fitted: its figures, and its file.

use std::f64::consts::TAU;

use asperity::scene::PronyTerm;

use super::compound::{Compound, FitErrors};
use super::consistency::Consistency;
use super::error::FitError;
use super::file::{in_data, read_moduli};
use super::measured::MeasuredModuli;
use super::options::{FitOptions, Vertical, Weight, WlfConstants};
use super::sample::{Sample, Test};
use super::search::{Target, search};
use super::temperatures::{Shift, ShiftedCurve};
use super::vertical::VerticalShift;
use crate::decimals::{percent, plain, rounded, short};
use crate::files::name_of;

/// Reads the moduli, puts those of several temperatures together and fits a Prony series.
///
/// # Errors
/// Where the table cannot be read, or its temperatures cannot be put together.
pub fn fit_moduli(options: &FitOptions) -> Result<FittedModuli, FitError> {
    let mut measured = read_moduli(options)?;
    if measured.test == Test::Relaxation && options.weight != Weight::Both {
        return Err(FitError::Weight(options.weight.word()));
    }
    let mut vertical = VerticalShift::apply(options, &mut measured)?;
    let shift = Shift::of(options, &measured)?;
    vertical.finish(&mut measured, shift.reference());
    let samples = shift.samples(&measured).map_err(|error| in_data(options, error))?;
    Ok(FittedModuli::new(options.clone(), measured, (shift, vertical), samples))
}

/// A Prony series fitted to measured moduli.
#[derive(Debug)]
pub struct FittedModuli {
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
        options: FitOptions,
        measured: MeasuredModuli,
        (shift, vertical): (Shift, VerticalShift),
        samples: Vec<Sample>,
    ) -> Self {
        let test = measured.test;
        let FitOptions { error, viscosity, weight, .. } = options;
        let exact = search(&samples, &Target { error, viscosity, test, weight });
        let compound = exact.rounded(FitErrors::of(&exact, &samples, test).both.rms);
        let errors = FitErrors::of(&compound, &samples, test);
        let is_oscillation = test == Test::Oscillation;
        let consistency = is_oscillation.then(|| Consistency::of(&samples, measured.in_hertz));
        Self { options, measured, shift, vertical, samples, compound, errors, consistency }
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

    /// The file of Prony terms, with the fit's figures as comments.
    pub fn file(&self) -> String {
        let mut text =
            String::from("# A generalised Maxwell model: Prony terms fitted to measured moduli by `asperity fit`\n");
        for (name, value) in self.facts() {
            text += &format!("# {name} = {value}\n");
        }
        text += "relaxation_time [s],modulus [Pa]\n";
        let row = |term: &PronyTerm| format!("{},{}\n", plain(term.relaxation_time), plain(term.modulus));
        text + &self.compound.terms.iter().map(row).collect::<String>()
    }

    fn facts(&self) -> Vec<(&'static str, String)> {
        let both = self.errors.both;
        let (rms, largest) = (percent(self.error(), 3), percent(both.largest, 3));
        let mut facts = vec![
            ("equilibrium_modulus", format!("{} Pa", plain(self.compound.equilibrium_modulus))),
            ("units", "relaxation_time in s, modulus in Pa".into()),
            ("source", name_of(&self.options.data)),
            ("data", self.data()),
            ("options", self.options_in_words()),
            ("error", format!("{rms} (root mean square of the relative errors of {} at all rows)", self.quantities())),
            ("largest_error", format!("{largest} at {}", self.place(both.at))),
        ];
        if let Some(found) = &self.consistency {
            let (apart, nearest) = (percent(found.apart(), 2), percent(found.nearest, 3));
            let text =
                format!("E'' is {apart} from what E' says it is; no sum of terms is nearer to both than {nearest} rms");
            facts.push(("kramers_kronig", text));
        }
        if self.options.viscosity {
            facts.insert(1, ("viscosity", format!("{} Pa s", plain(self.compound.viscosity))));
        }
        facts
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
        let mut text = format!("`fit_error` {}", plain(self.options.error));
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
            text += &format!(" `weight` {}", self.options.weight.word());
        }
        match self.options.vertical {
            Vertical::Divide => (),
            Vertical::Multiply => text += " `vertical` multiply",
            Vertical::Density(expansion) => text += &format!(" `vertical` density `expansion` {}", plain(expansion)),
            Vertical::None => text += " `vertical` none",
        }
        if let Some(frequency) = self.options.frequency {
            text += &format!(" `frequency` {}Hz", plain(frequency / TAU));
        }
        if self.options.shear {
            text += " `shear`";
        }
        text + &self.options.ignored.iter().map(|name| format!(" `ignore` '{name}'")).collect::<String>()
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
