//! Time-temperature superposition: rows of other temperatures become rows of other frequencies.

use super::compound::Sample;
use super::measured::{Measured, Refusal, Row};
use crate::program::cli::WlfConstants;

/// The rows as measured at the reference temperature: at a_T ω, with the moduli that they have. Without temperatures,
/// all are taken to be of it.
pub(super) fn to_reference(measured: &Measured, wlf: Option<WlfConstants>) -> Result<Vec<Sample>, Refusal> {
    match (&measured.temperature, wlf) {
        (Some(column), None) => Err(Refusal {
            line: measured.header_line,
            column: Some(column.clone()),
            given: column.1.clone(),
            expected: "the constants to shift by as well: --wlf C1,C2,TREF (C2 and TREF in K); or, for rows of one \
                       temperature, --ignore with this header"
                .into(),
        }),
        (Some(column), Some(wlf)) => measured.rows.iter().map(|row| shifted(row, column, wlf)).collect(),
        (None, _) => Ok(measured.rows.iter().map(|row| row.sample).collect()),
    }
}

fn shifted(row: &Row, column: &(usize, String), wlf: WlfConstants) -> Result<Sample, Refusal> {
    /// Far more than any rubber's shift: closer to the pole, a fit would be one of nothing but the constants.
    const LARGEST: f64 = 1e60;
    let temperature = row.temperature.unwrap_or(wlf.reference_temperature);
    let wlf = wlf.at(temperature);
    let factor = wlf.shift_factor();
    if temperature > wlf.lowest_temperature() && (1.0 / LARGEST..=LARGEST).contains(&factor) {
        return Ok(Sample { omega: row.sample.omega * factor, ..row.sample });
    }
    Err(Refusal {
        line: row.line,
        column: Some(column.clone()),
        given: format!("{temperature} K"),
        expected: format!(
            "more than TREF - C2 = {:.2} K, and not close to it: there the shift has its pole",
            wlf.lowest_temperature()
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WLF: WlfConstants = WlfConstants { c1: 8.0, c2: 100.0, reference_temperature: 293.15 };

    fn at(temperature: f64) -> Measured {
        let sample = Sample { omega: 3.0, storage: 2.0, loss: 1.0 };
        let rows = vec![Row { line: 7, sample, temperature: Some(temperature) }];
        let temperature = Some((4, "T [K]".to_owned()));
        Measured { rows, in_hertz: true, temperature, header_line: 1, notes: Vec::new() }
    }

    fn omega(temperature: f64) -> f64 {
        to_reference(&at(temperature), Some(WLF)).unwrap()[0].omega
    }

    /// log10 a_T = -8·10/110 ten kelvin above, 8·10/90 ten below: what is hot is as slow motion.
    #[test]
    fn rows_are_shifted_by_wlf() {
        assert_eq!(omega(293.15), 3.0);
        assert!((omega(303.15) / 3.0 / 10.0_f64.powf(-80.0 / 110.0) - 1.0).abs() < 1e-12);
        assert!((omega(283.15) / 3.0 / 10.0_f64.powf(80.0 / 90.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn temperatures_at_and_near_the_pole_are_refused() {
        for temperature in [193.15, 150.0, 194.0] {
            let refusal = to_reference(&at(temperature), Some(WLF)).unwrap_err().to_string();
            let wanted = format!("7: column 4 (T [K]) = \"{temperature} K\": expected more than TREF - C2 = 193.15");
            assert!(refusal.starts_with(&wanted), "{refusal}");
        }
    }

    #[test]
    fn temperatures_need_constants() {
        let refusal = to_reference(&at(293.15), None).unwrap_err().to_string();
        assert!(
            refusal.starts_with("1: column 4 = \"T [K]\": expected the constants to shift by as well: --wlf"),
            "{refusal}"
        );
    }
}
