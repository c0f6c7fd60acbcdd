//! The complex modulus of a scene's compound over frequency, at its temperature; in the direct form, the complex stiffness
//! of its links.

use std::f64::consts::TAU;

use asperity::scene::{Link, LinkKind, MaxwellElement, Scene};
use asperity::table::{Cell, Column, Header, Table};
use clap::Args;
use serde::Deserialize;

use crate::decimals::short;
use crate::error::{Context as _, Error};
use crate::picture::{Mark, Picture};
use crate::values::{ends, temperature};

/// A range of angular frequencies, rad/s.
pub type FrequencyBand = (f64, f64);

// What is shown of a compound. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Args)]
#[serde(default)]
pub struct MaterialOptions {
    /// The range of the angular frequency in rad/s, or of the frequency if Hz is appended. Default: derived from the
    /// relaxation times.
    #[arg(long, value_name = "A..B[Hz]", value_parser = frequencies)]
    pub frequencies: Option<FrequencyBand>,
    /// The compound's temperature in K, in place of the scene's.
    #[arg(long, value_name = "T", value_parser = temperature, allow_hyphen_values = true)]
    pub temperature: Option<f64>,
}

fn frequencies(text: &str) -> Result<FrequencyBand, String> {
    let (numbers, unit) = text.trim().strip_suffix("Hz").map_or((text, 1.0), |numbers| (numbers, TAU));
    // Hz may be appended to both ends.
    let numbers = numbers.replace("Hz", "");
    let allowed = |(low, high): &(f64, f64)| *low >= 1e-30 && high > low && *high <= 1e30;
    let message = || "expected A..B, such as 1..1e5 in rad/s or 0.1..1e4Hz, from 1e-30 to 1e30, A below B".to_owned();
    ends(&numbers).filter(allowed).map(|(low, high)| (low * unit, high * unit)).ok_or_else(message)
}

/// The scene at another temperature, K.
fn at_temperature(scene: &Scene, temperature: f64) -> Result<Scene, Error> {
    let wlf = scene.material.as_ref().and_then(|material| material.wlf);
    if wlf.is_none() {
        return Err(Error::scene(
            "`temperature`: the scene has no material.wlf, so nothing in it depends on temperature",
        ));
    }
    scene.at_temperature(temperature).context("`temperature`")
}

/// Decades by which a band exceeds the rates 1/τ of its responses.
const MARGIN: f64 = 1.0;
/// The band of responses without any rate.
const DEFAULT_BAND: FrequencyBand = (1.0, 1e4);
/// Points per decade in files and plots.
pub const POINTS: f64 = 20.0;
/// Points per decade in the search for the maximum of tan δ, which a parabola then refines.
const SEARCH_POINTS: f64 = 500.0;

/// Angular frequencies over `band`, even in the logarithm, about `points` per decade.
pub fn evenly((low, high): FrequencyBand, points: f64) -> Vec<f64> {
    let decades = (high / low).log10();
    let intervals = (decades * points).round().max(1.0);
    (0..=intervals as usize).map(|i| low * 10.0_f64.powf(decades * i as f64 / intervals)).collect()
}

/// A complex modulus (Pa) or stiffness (N/m) over frequency: a spring, a dashpot and Maxwell elements in parallel.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// The kind of link; empty for the compound.
    pub name: &'static str,
    /// The constants; for the compound its moduli (Pa) and its viscosity (Pa s), at the temperature.
    link: Link,
}

/// The compound's modulus at the scene's temperature; in the direct form, the stiffnesses of the links.
fn responses(scene: &Scene) -> Vec<Response> {
    let Some(material) = &scene.material else {
        let links = LinkKind::ALL.into_iter().filter_map(|kind| Some((kind, scene.link(kind)?)));
        return links.map(|(kind, link)| Response { name: kind.name(), link }).collect();
    };
    let shift = material.shift_factor();
    let shifted =
        |element: MaxwellElement| MaxwellElement { relaxation_time: shift * element.relaxation_time, ..element };
    let link = Link {
        stiffness: Some(material.equilibrium_modulus),
        damping: material.viscosity.map(|viscosity| shift * viscosity),
        maxwell: material.prony.iter().map(|term| shifted(term.element())).collect(),
    };
    vec![Response { name: "", link }]
}

/// The band in which `responses` change, rounded outwards to powers of ten.
fn band(responses: &[Response]) -> FrequencyBand {
    let rates = || responses.iter().flat_map(Response::rates).map(f64::log10);
    let (low, high) = (rates().fold(f64::MAX, f64::min), rates().fold(f64::MIN, f64::max));
    if low > high {
        return DEFAULT_BAND;
    }
    (10.0_f64.powf((low - MARGIN).floor()), 10.0_f64.powf((high + MARGIN).ceil()))
}

impl Response {
    /// Storage and loss part at ω, Pa or N/m.
    pub fn at(&self, omega: f64) -> (f64, f64) {
        self.link.complex_stiffness(omega)
    }

    /// E_∞ or c, Pa or N/m.
    pub fn equilibrium(&self) -> f64 {
        self.link.stiffness.unwrap_or(0.0)
    }

    /// η or d, Pa s or N s/m.
    pub fn damper(&self) -> f64 {
        self.link.damping.unwrap_or(0.0)
    }

    /// tan δ at ω.
    pub fn loss_tangent(&self, omega: f64) -> f64 {
        let (storage, loss) = self.at(omega);
        loss / storage
    }

    /// E_∞ and all Maxwell elements, Pa or N/m.
    pub fn glassy(&self) -> f64 {
        self.equilibrium() + self.link.maxwell.iter().map(|element| element.stiffness).sum::<f64>()
    }

    /// The rates at which it changes: 1/τ_j, and c/d.
    fn rates(&self) -> impl Iterator<Item = f64> {
        let (spring, damper) = (self.equilibrium(), self.damper());
        let creep = (damper > 0.0 && spring > 0.0).then(|| spring / damper);
        let elements = self.link.maxwell.iter().filter(|element| element.stiffness > 0.0);
        elements.map(|element| 1.0 / element.relaxation_time).chain(creep)
    }

    /// The maximum of tan δ in `band`: ω and tan δ; `None` without any loss.
    pub fn maximum_loss(&self, band: FrequencyBand) -> Option<(f64, f64)> {
        let all: Vec<(f64, f64)> =
            evenly(band, SEARCH_POINTS).into_iter().map(|omega| (omega, self.loss_tangent(omega))).collect();
        let lossy = (0..all.len()).filter(|&i| all[i].1 > 0.0 && all[i].1.is_finite());
        let largest = lossy.max_by(|&i, &j| all[i].1.total_cmp(&all[j].1))?;
        let around = largest.checked_sub(1).and_then(|before| all.get(before..largest + 2));
        Some(match around {
            Some(&[(_, a), (omega, b), (after, c)]) if a + c < 2.0 * b => {
                // The vertex of the parabola through the three points over ln ω.
                let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
                let omega = omega * (after / omega).powf(shift);
                (omega, self.loss_tangent(omega))
            }
            _ => all[largest],
        })
    }
}

/// The responses of a scene and the band to show them in.
#[derive(Clone, Debug)]
pub struct Responses {
    /// At the temperature that is asked for.
    pub scene: Scene,
    /// The compound's, or those of the links.
    pub responses: Vec<Response>,
    /// Where they are shown.
    pub band: FrequencyBand,
}

impl Responses {
    /// Of a scene, at the temperature and over the band that are asked for, or where they change.
    ///
    /// # Errors
    /// Where the scene has none, cannot have this temperature, or nothing in it depends on that.
    pub fn new(mut scene: Scene, options: &MaterialOptions) -> Result<Self, Error> {
        if let Some(temperature) = options.temperature {
            scene = at_temperature(&scene, temperature)?;
        }
        let responses = responses(&scene);
        if responses.is_empty() {
            return Err(Error::scene(
                "the scene has neither a material nor a link, so it has no modulus or stiffness to show",
            ));
        }
        let band = options.frequencies.unwrap_or_else(|| band(&responses));
        Ok(Self { scene, responses, band })
    }

    /// Whether it is the modulus of a material.
    pub fn is_material(&self) -> bool {
        self.scene.material.is_some()
    }

    /// Symbol and unit of a response.
    pub fn symbol_and_unit(&self) -> (&'static str, &'static str) {
        if self.is_material() { ("E", "Pa") } else { ("K", "N/m") }
    }

    /// What they are, in words.
    pub fn quantity(&self) -> &'static str {
        if self.is_material() { "moduli" } else { "stiffnesses of the links" }
    }

    /// The temperature of the scene, and what it makes of times; `None` without a material.
    pub fn temperature(&self) -> Option<String> {
        let material = self.scene.material.as_ref()?;
        Some(material.wlf.map_or_else(
            || "none in the scene: times as they are given".into(),
            |wlf| {
                format!(
                    "{} K: all times are a_T = {} times those given, at {} K",
                    short(wlf.temperature, 5),
                    short(wlf.shift_factor(), 5),
                    short(wlf.reference_temperature, 5)
                )
            },
        ))
    }

    /// The columns of the table.
    pub fn columns(&self) -> Vec<Column> {
        let (symbol, unit) = self.symbol_and_unit();
        let mut columns = vec![Column::numbers("omega", "rad/s")];
        for response in &self.responses {
            let prefix = if response.name.is_empty() { String::new() } else { format!("{} ", response.name) };
            columns.push(Column::numbers(format!("{prefix}{symbol}'"), unit));
            columns.push(Column::numbers(format!("{prefix}{symbol}''"), unit));
            columns.push(Column::numbers(format!("{prefix}tan delta"), "1"));
        }
        columns
    }

    /// The numbers of the columns at ω, rad/s.
    pub fn row(&self, omega: f64) -> impl Iterator<Item = f64> {
        let values = self.responses.iter().flat_map(move |response| {
            let (storage, loss) = response.at(omega);
            [storage, loss, response.loss_tangent(omega)]
        });
        std::iter::once(omega).chain(values)
    }

    /// The moduli of a compound with its loss tangent, or the stiffnesses of the links with theirs, at `omegas` (rad/s).
    pub fn picture(&self, omegas: &[f64]) -> Picture {
        let curve = |look: usize, name: &str, value: &dyn Fn(f64) -> f64| {
            Mark::line(name, look, omegas.iter().map(|&omega| [omega, value(omega)]).collect())
        };
        let of_all = |value: fn(&Response, f64) -> f64| -> Vec<Mark> {
            let all = self.responses.iter().enumerate();
            all.map(|(i, response)| curve(i, response.name, &|omega| value(response, omega))).collect()
        };
        let panels = if self.is_material() {
            let response = &self.responses[0];
            let storage = curve(0, "E'", &|omega| response.at(omega).0);
            let loss = curve(1, "E''", &|omega| response.at(omega).1);
            let tangent = curve(2, "tan δ", &|omega| response.loss_tangent(omega));
            vec![(("modulus", "Pa"), vec![storage, loss]), (("tan δ", ""), vec![tangent])]
        } else {
            vec![
                (("K'", "N/m"), of_all(|response, omega| response.at(omega).0)),
                (("K''", "N/m"), of_all(|response, omega| response.at(omega).1)),
                (("tan δ", ""), of_all(Response::loss_tangent)),
            ]
        };
        Picture::stacked(("angular frequency", "rad/s"), panels)
    }

    /// The table, whose columns have units as `asperity fit` reads them.
    pub fn table(&self) -> Table {
        let header = Header::default()
            .with(self.quantity(), &format!("{}, by `asperity material`", self.scene.name))
            .with_some("temperature", self.temperature());
        let mut table = Table::new(header, self.columns());
        for omega in evenly(self.band, POINTS) {
            table.push(self.row(omega).map(Cell::Number));
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring of 2 and Maxwell elements (τ_j, c_j).
    fn response(elements: &[(f64, f64)]) -> Response {
        let element = |&(relaxation_time, stiffness): &(f64, f64)| MaxwellElement { stiffness, relaxation_time };
        let maxwell = elements.iter().map(element).collect();
        Response { name: "", link: Link { stiffness: Some(2.0), damping: None, maxwell } }
    }

    fn zener() -> Response {
        response(&[(0.1, 6.0)])
    }

    /// Of one element, tan δ = E_1 x/(E_∞ + (E_∞ + E_1) x²) with x = ωτ: largest at x² = E_∞/(E_∞ + E_1) = 1/4.
    #[test]
    fn the_maximum_of_tan_delta_is_where_theory_has_it() {
        let (omega, tangent) = zener().maximum_loss((1e-2, 1e4)).unwrap();
        // A parabola over a step of 0.5 % errs by the cube of that, times the curve's asymmetry; the value by its
        // square.
        assert!((omega / 5.0 - 1.0).abs() < 1e-6 && (tangent / 0.75 - 1.0).abs() < 1e-12, "{omega} {tangent}");
    }

    #[test]
    fn parts_have_the_limits_of_spring_and_glass() {
        let (storage, loss) = zener().at(1e-9);
        assert!((storage - 2.0).abs() < 1e-15 && loss < 1e-9);
        assert!((zener().at(1e12).0 - zener().glassy()).abs() < 1e-15);
    }

    #[test]
    fn the_band_holds_every_rate() {
        let two = response(&[(0.1, 6.0), (1e-4, 1.0), (1e9, 0.0)]);
        assert_eq!(band(&[zener(), two]), (1.0, 1e5));
        assert_eq!(band(&[response(&[])]), DEFAULT_BAND);
    }

    #[test]
    fn frequencies_are_angular_unless_in_hertz() {
        assert_eq!(frequencies("1..1e5"), Ok((1.0, 1e5)));
        for hertz in ["0.5..10Hz", "0.5Hz..10 Hz"] {
            assert_eq!(frequencies(hertz), Ok((0.5 * TAU, 10.0 * TAU)), "{hertz}");
        }
        for wrong in ["1", "2..1", "0..1", "1..inf", "a..b"] {
            assert!(frequencies(wrong).unwrap_err().contains("1..1e5"), "{wrong}");
        }
    }

    #[test]
    fn without_loss_there_is_no_maximum() {
        assert_eq!(response(&[]).maximum_loss((1.0, 10.0)), None);
    }
}
