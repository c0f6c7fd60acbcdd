//! `asperity slip --fit stribeck|lugre`: laws of friction fitted to a table of friction in steady motion.

use std::path::Path;

use asperity_study::Error;
use asperity_study::decimals::{percent, short, temperature_as_given};
use asperity_study::friction_law::{FrictionData, FrictionFit, FrictionLaw, friction_table};

use super::files::{check_outputs, default_output, name_of, named, print_beside, write};
use super::terminal::{LabelledLine, lines, note};

/// Fits the law to the table at each of its temperatures, writes the numbers and prints them.
pub(crate) fn fit_friction(path: &Path, law: FrictionLaw, output: Option<&Path>) -> Result<(), Error> {
    let ending = if law == FrictionLaw::LuGre { "lugre.csv" } else { "stribeck.csv" };
    let output = &output.map_or_else(|| default_output(path, ending), Path::to_owned);
    check_outputs([output], vec![path.to_owned()])?;
    let data = FrictionData::read(path)?;
    let fits = data.fit(law)?;
    write(output, friction_table(&fits, path).text())?;
    if data.left_out > 0 {
        note(&format!("{} rows without steady friction at a speed above 0 are left out", data.left_out));
    }
    if law == FrictionLaw::LuGre {
        note("sigma_0 and sigma_1 show in no steady motion: fit them to one that starts from rest");
    }
    let mut rows = vec![("Data", format!("{}, {} rows", name_of(path), data.rows.len()))];
    rows.extend(fits.iter().flat_map(|fit| fit_lines(fit, data.unit)));
    rows.push(("Written", named(output)));
    print_beside([output], &lines(&rows))
}

fn fit_lines(fit: &FrictionFit, unit: &str) -> Vec<LabelledLine> {
    let place = fit.temperature.map_or(String::new(), |kelvin| format!("at {}, ", temperature_as_given(kelvin)));
    let (rms, share) = (short(fit.rms, 3), percent(fit.rms / fit.largest, 2));
    let mut rows = vec![("Fit", format!("{place}off by {rms} {unit} rms, {share} of the largest friction"))];
    rows.extend(fit.numbers.iter().map(|(name, unit, number)| {
        let unit = if number.numbers().0.is_some() { unit } else { "" };
        ("", format!("{name:<24}{number} {unit}").trim_end().to_owned())
    }));
    rows
}
