//! `asperity fit`: fits Prony terms to measured moduli.

use std::f64::consts::LN_10;
use std::path::{Path, PathBuf};

use asperity_study::Error;
use asperity_study::decimals::{percent, plain, short};
use asperity_study::fit::{
    Consistency, DecadeConsistency, FittedModuli, RelativeError, ShiftedCurve, Test, Weight, fit_moduli,
};

use super::cli::Fit;
use super::files::{self, check_outputs, name_of, named, picture_beside, print_beside};
use super::output::{NOT_REACHED, SUCCESS};
use super::picture;
use super::terminal::{LabelledLine, lines, warn, with_flags};

/// Reads the moduli, puts those of several temperatures together, fits, writes the terms and the plot, and prints a
/// summary. Where the requested error cannot be reached, the best fit is written, with a warning and an exit status of
/// its own.
pub(crate) fn fit(command: &Fit) -> Result<u8, Error> {
    let picture = picture_beside(&command.output, command.plot.as_ref());
    let read: Vec<PathBuf> = std::iter::once(&command.data).chain(&command.options.shifts).cloned().collect();
    check_outputs([&command.output].into_iter().chain(&picture), read)?;
    let fitted = fit_moduli(&command.data, &command.options)?;
    files::tell(fitted.notes());
    fitted.warnings().iter().for_each(|text| warn(text));
    files::write(&command.output, with_flags(&fitted.table().text()))?;
    if let Some(path) = &picture {
        let terms = fitted.terms().len();
        let title = format!("{}: {terms} terms, {} rms", name_of(&command.data), percent(fitted.error(), 3));
        picture::write(&fitted.picture().titled(title), path)?;
    }
    print_beside([&command.output], &summary(&fitted, command, picture.as_deref()))?;
    if fitted.error() <= command.options.fit_error {
        return Ok(SUCCESS);
    }
    warn(&not_reached(&fitted, command));
    Ok(NOT_REACHED)
}

/// Why the error asked for was not reached: the data scatter, or known constants do not put them together.
fn not_reached(fitted: &FittedModuli, command: &Fit) -> String {
    let (wanted, reached) = (percent(command.options.fit_error, 3), percent(fitted.error(), 3));
    let scatter = || "the data scatter too much for less, and --fit-error sets what is enough".to_owned();
    let contradiction = || fitted.consistency().filter(|found| found.is_contradiction()).map(contradiction);
    let why = fitted.blame().map(|why| with_flags(&why)).or_else(contradiction).unwrap_or_else(scatter);
    format!(
        "the error asked for, {wanted}, cannot be reached: {reached} is about the smallest of any series with moduli of 0 \
         or more, and {} has such a series; {why}",
        command.output.display()
    )
}

fn contradiction(found: &Consistency) -> String {
    format!(
        "E' and E'' contradict each other: by the relations of Kramers and Kronig they are {} apart, and no sum of Maxwell \
         elements comes nearer to both than {} rms; --weight storage or --weight loss fits one of them",
        percent(found.apart(), 2),
        percent(found.nearest, 3)
    )
}

/// How far E' and E'' are apart: in a line, and by decades where no series reaches the error asked for.
fn consistency(fitted: &FittedModuli, requested: f64) -> Vec<LabelledLine> {
    let Some(found) = fitted.consistency() else { return Vec::new() };
    let apart = percent(found.apart(), 2);
    let nearest = percent(found.nearest, 3);
    let mut rows = vec![
        ("Kramers-", format!("E'' is {apart} (rms of the means over decades) from what E' says it is")),
        ("Kronig", format!("no sum of Maxwell elements comes nearer to both than {nearest} rms")),
    ];
    if found.nearest <= requested {
        return rows;
    }
    rows.push(("", format!("{:<14}{:<7}{:<24}E', E'' off the nearest sum", "from", "rows", "E'' over that of E'")));
    rows.extend(found.decades.iter().map(|decade| {
        let DecadeConsistency { from, rows, ratio, storage, loss } = *decade;
        let off = format!("{}, {}", percent(storage, 2), percent(loss, 2));
        ("", format!("{:<14}{rows:<7}{ratio:<24.3}{off}", fitted.place(from)))
    }));
    rows
}

/// The printed summary, and the lines for a scene.
fn summary(fitted: &FittedModuli, command: &Fit, picture: Option<&Path>) -> String {
    let modulus = fitted.equilibrium_modulus();
    let mut rows = vec![("Data", fitted.data()), ("E_inf", format!("{} Pa", plain(modulus)))];
    if command.options.viscosity {
        rows.push(("Viscosity", format!("{} Pa s", plain(fitted.viscosity()))));
    }
    let glassy: f64 = fitted.terms().iter().map(|term| term.modulus).sum::<f64>() + modulus;
    rows.push(("Glassy", format!("{} Pa, the sum of all moduli", short(glassy, 4))));
    rows.push(("Terms", terms(fitted)));
    rows.extend(errors(fitted, command));
    rows.extend(consistency(fitted, command.options.fit_error));
    rows.extend(shifts(fitted));
    let written = [Some(command.output.as_path()), picture].into_iter().flatten().map(named);
    rows.push(("Written", written.collect::<Vec<_>>().join(", ")));
    let name = name_of(&command.output);
    format!("{}\nFor a scene in the folder of {name}:\n\n{}", lines(&rows), scene(fitted, &name))
}

fn terms(fitted: &FittedModuli) -> String {
    match fitted.terms() {
        [] => "none".into(),
        [only] => format!("1, at {} s", short(only.relaxation_time, 4)),
        [first, .., last] => {
            let [first, last] = [first, last].map(|term| short(term.relaxation_time, 4));
            format!("{}, from {first} s to {last} s", fitted.terms().len())
        }
    }
}

/// A table of the errors.
fn errors(fitted: &FittedModuli, command: &Fit) -> Vec<LabelledLine> {
    let errors = fitted.errors();
    let counted = match (fitted.test(), command.options.weight) {
        (Test::Relaxation, _) => "E(t)",
        (Test::Oscillation, Weight::Both) => "E' and E'' together",
        (Test::Oscillation, Weight::Storage) => "E' alone",
        (Test::Oscillation, Weight::Loss) => "E'' alone",
    };
    let (rms, requested) = (percent(fitted.error(), 3), percent(command.options.fit_error, 3));
    let mut rows = vec![
        ("Error", format!("{rms} rms of {counted}; {requested} requested")),
        ("", format!("{:<11}{:<11}{:<11}at", "", "rms", "largest")),
    ];
    let row = |name: &str, error: &RelativeError| {
        let (rms, largest) = (percent(error.rms, 3), percent(error.largest, 3));
        ("", format!("{name:<11}{rms:<11}{largest:<11}{}", fitted.place(error.at)))
    };
    match fitted.test() {
        Test::Oscillation => {
            let tangent = row("tan delta", &errors.loss_tangent);
            rows.extend([row("E'", &errors.storage), row("E''", &errors.loss), tangent]);
        }
        Test::Relaxation => rows.push(row("E(t)", &errors.storage)),
    }
    rows
}

/// Factors and errors by temperature, and the constants.
fn shifts(fitted: &FittedModuli) -> Vec<LabelledLine> {
    let curves = fitted.shifted_curves();
    if curves.is_empty() {
        return Vec::new();
    }
    let mut rows = Vec::new();
    if let Some((law, shifts)) = fitted.found_law() {
        let how = if shifts { "which shift the rows" } else { "fitted to the factors, which shift the rows" };
        let (c1, c2, reference) = (plain(law.c1), plain(law.c2), plain(law.reference_temperature));
        rows.push(("WLF", format!("C1 {c1}, C2 {c2} K about {reference} K, {how}")));
    }
    rows.push(("Shift", format!("{:<11}{:<8}{:<20}rms", "T, K", "rows", "log10 a_T")));
    rows.extend(curves.iter().map(|curve| ("", shifted(curve))));
    rows
}

fn shifted(curve: &ShiftedCurve) -> String {
    let ShiftedCurve { temperature, rows, ln_factor, ln_factor_error, rms } = *curve;
    let uncertain = if ln_factor_error > 0.0 { format!(" ± {:.4}", ln_factor_error / LN_10) } else { String::new() };
    // Without the sign of -0.
    let log = format!("{:.4}{uncertain}", (ln_factor / LN_10 * 1e4).round() / 1e4 + 0.0);
    format!("{temperature:<11.2}{rows:<8}{log:<20}{}", percent(rms, 3))
}

/// The lines for a scene in the folder of the terms, in the file of this `name`.
fn scene(fitted: &FittedModuli, name: &str) -> String {
    let mut lines = vec![
        "[material]".to_owned(),
        "# density (kg/m³) and poisson_ratio are not in the data".into(),
        format!("equilibrium_modulus = {}", plain(fitted.equilibrium_modulus())),
    ];
    if fitted.viscosity() > 0.0 {
        lines.push(format!("viscosity = {}", plain(fitted.viscosity())));
    }
    lines.push(if fitted.terms().is_empty() { "prony = []".into() } else { format!("prony = {name:?}") });
    if let Some(wlf) = fitted.wlf() {
        let reference = plain(wlf.reference_temperature);
        let (c1, c2) = (plain(wlf.c1), plain(wlf.c2));
        lines.push(format!(
            "wlf = {{ c1 = {c1}, c2 = {c2}, reference_temperature = {reference}, temperature = {reference} }}"
        ));
    }
    lines.iter().map(|line| format!("{line}\n")).collect()
}
