//! `asperity fit`: fits Prony terms to measured moduli.

mod header;
mod measured;
mod nnls;
mod search;

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity::scene::PronyTerm;

use super::cli::{Fit, WlfConstants};
use super::figure::{Curve, Figure as _, Panel, Stacked, Stroke};
use super::files::{self, FileError, check_outputs, name_of, named, picture_beside, print_beside};
use super::terminal::{decimal, lines, note, rounded};
use measured::{MeasuredModuli, ModuliError};
use search::{Compound, FitErrors, RelativeError, Sample, Target, search};

/// `asperity fit` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FitError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}:{error}", .path.display())]
    Moduli { path: PathBuf, error: ModuliError },
    #[error(
        "the error asked for, {wanted}, cannot be reached: {reached} is about the smallest of any series with moduli of 0 or \
         more, and {} has such a series; the data scatter too much for less, and --error sets what is enough",
        .output.display()
    )]
    NotReached { wanted: String, reached: String, output: PathBuf },
}

/// Points per decade of a plotted curve.
const POINTS_PER_DECADE: f64 = 20.0;

/// Reads the moduli, fits, writes the terms and the plot, and prints a summary. Where the requested error cannot be
/// reached, the best fit is written, but the command fails: a script must not take it for the requested one.
pub(crate) fn fit(command: &Fit) -> Result<(), FitError> {
    let picture = picture_beside(&command.output, command.plot.as_ref());
    check_outputs([&command.output].into_iter().chain(&picture), vec![command.data.clone()])?;
    let bytes = files::read(&command.data)?;
    let in_file = |error: ModuliError| FitError::Moduli { path: command.data.clone(), error };
    let measured = MeasuredModuli::parse(&bytes, &command.ignore).map_err(in_file)?;
    measured.notes.iter().for_each(|text| note(text));
    let samples = measured.at_reference(command.wlf).map_err(in_file)?;
    let result = FitResult::new(command, &measured, samples);
    files::write(&command.output, result.file())?;
    if let Some(picture) = &picture {
        result.picture().write(picture)?;
    }
    print_beside([&command.output], &result.text(picture.as_deref()))?;
    let reached = result.errors.both.rms;
    if reached > command.error {
        let (wanted, reached) = (percent(command.error), percent(reached));
        return Err(FitError::NotReached { wanted, reached, output: command.output.clone() });
    }
    Ok(())
}

#[derive(Debug)]
struct FitResult<'a> {
    command: &'a Fit,
    measured: &'a MeasuredModuli,
    /// At the reference temperature.
    samples: Vec<Sample>,
    compound: Compound,
    errors: FitErrors,
}

impl<'a> FitResult<'a> {
    fn new(command: &'a Fit, measured: &'a MeasuredModuli, samples: Vec<Sample>) -> Self {
        let exact = search(&samples, &Target { error: command.error, viscosity: command.viscosity });
        let compound = exact.rounded(FitErrors::of(&exact, &samples).both.rms);
        let errors = FitErrors::of(&compound, &samples);
        Self { command, measured, samples, compound, errors }
    }

    /// The file of Prony terms, with the fit's figures as comments.
    fn file(&self) -> String {
        let mut text =
            String::from("# A generalised Maxwell model: Prony terms fitted to measured moduli by `asperity fit`\n");
        for (name, value) in self.facts() {
            text += &format!("# {name} = {value}\n");
        }
        text += "relaxation_time,modulus\n";
        let row = |term: &PronyTerm| format!("{},{}\n", written(term.relaxation_time), written(term.modulus));
        text + &self.compound.terms.iter().map(row).collect::<String>()
    }

    fn facts(&self) -> Vec<(&'static str, String)> {
        let both = self.errors.both;
        let (rms, largest) = (percent(both.rms), percent(both.largest));
        let mut facts = vec![
            ("equilibrium_modulus", format!("{} Pa", written(self.compound.equilibrium_modulus))),
            ("units", "relaxation_time in s, modulus in Pa".into()),
            ("source", name_of(&self.command.data)),
            ("data", self.data()),
            ("options", self.options()),
            ("error", format!("{rms} (root mean square of the relative errors of E' and E'' at all rows)")),
            ("largest_error", format!("{largest} at {}", self.frequency(both.at))),
        ];
        if self.command.viscosity {
            facts.insert(1, ("viscosity", format!("{} Pa s", written(self.compound.viscosity))));
        }
        facts
    }

    fn data(&self) -> String {
        let (low, high) = range(self.measured.points.iter().map(|point| point.sample.omega));
        let rows = format!("{} rows, {} to {}", self.samples.len(), self.frequency(low), self.frequency(high));
        let Some(wlf) = self.shift() else { return rows };
        let (cold, hot) = range(self.measured.points.iter().filter_map(|point| point.temperature));
        let (low, high) = range(self.samples.iter().map(|sample| sample.omega));
        format!(
            "{rows}, {cold:.2} to {hot:.2} K, shifted to {} K: {} to {}",
            wlf.reference_temperature,
            self.frequency(low),
            self.frequency(high)
        )
    }

    /// The constants by which the data were shifted, if they were.
    fn shift(&self) -> Option<WlfConstants> {
        self.command.wlf.filter(|_| self.measured.temperature.is_some())
    }

    fn options(&self) -> String {
        let mut text = format!("--error {}", written(self.command.error));
        if let Some(wlf) = self.command.wlf {
            text += &format!(" --wlf {},{},{}", written(wlf.c1), written(wlf.c2), written(wlf.reference_temperature));
        }
        if self.command.viscosity {
            text += " --viscosity";
        }
        text + &self.command.ignore.iter().map(|name| format!(" --ignore '{name}'")).collect::<String>()
    }

    /// The printed summary, and the lines for a scene.
    fn text(&self, picture: Option<&Path>) -> String {
        let (compound, errors) = (&self.compound, &self.errors);
        let mut rows = vec![("Data", self.data()), ("E_inf", format!("{} Pa", written(compound.equilibrium_modulus)))];
        if self.command.viscosity {
            rows.push(("Viscosity", format!("{} Pa s", written(compound.viscosity))));
        }
        let glassy: f64 = compound.terms.iter().map(|term| term.modulus).sum::<f64>() + compound.equilibrium_modulus;
        rows.push(("Glassy", format!("{} Pa, the sum of all moduli", short(glassy))));
        rows.push(("Terms", self.terms()));
        let (rms, requested) = (percent(errors.both.rms), percent(self.command.error));
        rows.push(("Error", format!("{rms} rms of E' and E'' together; {requested} requested")));
        rows.push(("", format!("{:<11}{:<11}{:<11}at", "", "rms", "largest")));
        let row = |name: &str, error: &RelativeError| {
            let (rms, largest) = (percent(error.rms), percent(error.largest));
            ("", format!("{name:<11}{rms:<11}{largest:<11}{}", self.frequency(error.at)))
        };
        rows.extend([row("E'", &errors.storage), row("E''", &errors.loss), row("tan delta", &errors.loss_tangent)]);
        let written = [Some(self.command.output.as_path()), picture].into_iter().flatten().map(named);
        rows.push(("Written", written.collect::<Vec<_>>().join(", ")));
        let figures = lines(&rows);
        format!("{figures}\nFor a scene in the folder of {}:\n\n{}", name_of(&self.command.output), self.scene())
    }

    fn terms(&self) -> String {
        match &self.compound.terms[..] {
            [] => "none".into(),
            [only] => format!("1, at {} s", short(only.relaxation_time)),
            [first, .., last] => {
                let [first, last] = [first, last].map(|term| short(term.relaxation_time));
                format!("{}, from {first} s to {last} s", self.compound.terms.len())
            }
        }
    }

    fn scene(&self) -> String {
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
            _ => format!("prony = {:?}", name_of(&self.command.output)),
        });
        if let Some(wlf) = self.command.wlf {
            let reference = written(wlf.reference_temperature);
            let (c1, c2) = (written(wlf.c1), written(wlf.c2));
            lines.push(format!(
                "wlf = {{ c1 = {c1}, c2 = {c2}, reference_temperature = {reference}, temperature = {reference} }}"
            ));
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    /// The plot: data as rings, the fit as lines.
    fn picture(&self) -> Stacked {
        let unit = if self.measured.in_hertz { TAU } else { 1.0 };
        let omegas = between(&self.samples);
        let curves = |name: &str, look: usize, measured: fn(&Sample) -> f64, fitted: fn((f64, f64)) -> f64| {
            let points = self.samples.iter().map(|sample| (sample.omega / unit, measured(sample))).collect();
            let line =
                omegas.iter().map(|&omega| (omega / unit, fitted(self.compound.complex_modulus(omega)))).collect();
            [
                Curve { name: format!("{name} measured"), look, stroke: Stroke::Rings, points },
                Curve { name: format!("{name} fitted"), look, stroke: Stroke::Line, points: line },
            ]
        };
        let storage = curves("E'", 0, |sample| sample.storage, |(storage, _)| storage);
        let loss = curves("E''", 1, |sample| sample.loss, |(_, loss)| loss);
        let tangent = curves("tan δ", 2, |sample| sample.loss / sample.storage, |(storage, loss)| loss / storage);
        Stacked {
            title: format!(
                "{}: {} terms, {} rms",
                name_of(&self.command.data),
                self.compound.terms.len(),
                percent(self.errors.both.rms)
            ),
            x_title: self.x_title(),
            panels: vec![
                Panel { title: "modulus in Pa".into(), curves: [storage, loss].concat() },
                Panel { title: "tan δ".into(), curves: tangent.to_vec() },
            ],
        }
    }

    fn x_title(&self) -> String {
        let quantity = if self.measured.in_hertz { "frequency in Hz" } else { "angular frequency in rad/s" };
        let shifted = |wlf: WlfConstants| format!("{quantity}, shifted to {} K", wlf.reference_temperature);
        self.shift().map_or_else(|| quantity.into(), shifted)
    }

    /// A frequency in the unit of the data.
    fn frequency(&self, omega: f64) -> String {
        if self.measured.in_hertz { format!("{} Hz", short(omega / TAU)) } else { format!("{} rad/s", short(omega)) }
    }
}

/// Angular frequencies over the range of `samples`, evenly spaced in the logarithm.
fn between(samples: &[Sample]) -> Vec<f64> {
    let (low, high) = range(samples.iter().map(|sample| sample.omega.log10()));
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
