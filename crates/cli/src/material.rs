//! `asperity material`: the complex modulus of a scene's compound over frequency, at its temperature; in the direct
//! form, the complex stiffness of its links.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity::scene::{Link, LinkKind, MaxwellElement, ParameterError, Scene};

use super::cli::Material;
use super::figure::{Curve, Figure as _, Panel, Stacked, Stroke};
use super::files::{
    self, FileError, check_outputs, ends_in, is_standard_output, load_without_run, named, print_beside,
};
use super::terminal::{LabelledLine, lines};
use asperity_study::decimals::{decimal, rounded};

/// `asperity material` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum MaterialError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("--temperature: {0}")]
    Temperature(ParameterError),
    #[error("--temperature: the scene has no material.wlf, so nothing in it depends on temperature")]
    NoTemperature,
    #[error("the scene has neither a material nor a link, so it has no modulus or stiffness to show")]
    NoLinks,
}

/// Prints a summary and a table; writes the outputs or, if none is given, a plot.
pub(crate) fn material(command: &Material) -> Result<(), MaterialError> {
    let mut scene = load_without_run(&command.scene, &command.set, |_| false)?;
    if let Some(temperature) = command.temperature {
        let wlf = scene.material.as_ref().and_then(|material| material.wlf);
        wlf.ok_or(MaterialError::NoTemperature)?;
        scene = scene.at_temperature(temperature).map_err(MaterialError::Temperature)?;
    }
    let outputs = if command.output.is_empty() { vec![default_output(&command.scene)] } else { command.output.clone() };
    check_outputs(&outputs, scene.sources(&command.scene))?;
    let responses = Responses::new(&scene, command.frequencies.map(|range| range.0))?;
    for output in &outputs {
        if ends_in(output, "csv") || is_standard_output(output) {
            files::write(output, responses.file())?;
        } else {
            responses.picture().write(output)?;
        }
    }
    let names: Vec<String> = outputs.iter().map(|output| named(output)).collect();
    Ok(print_beside(&outputs, &format!("{}Written     {}\n", responses.text(), names.join(", ")))?)
}

/// In the working directory, named after the scene file.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str()).to_string_lossy();
    PathBuf::from(format!("{stem}-material.svg"))
}

/// A range of angular frequencies, rad/s.
type FrequencyBand = (f64, f64);

/// Decades by which a band exceeds the rates 1/τ of its responses.
const MARGIN: f64 = 1.0;
/// The band of responses without any rate.
const DEFAULT_BAND: FrequencyBand = (1.0, 1e4);
/// Points per decade in files and plots.
const POINTS: f64 = 20.0;
/// Points per decade in the search for the maximum of tan δ, which a parabola then refines.
const SEARCH_POINTS: f64 = 500.0;

/// Angular frequencies over `band`, even in the logarithm, about `points` per decade.
fn evenly((low, high): FrequencyBand, points: f64) -> Vec<f64> {
    let decades = (high / low).log10();
    let intervals = (decades * points).round().max(1.0);
    (0..=intervals as usize).map(|i| low * 10.0_f64.powf(decades * i as f64 / intervals)).collect()
}

/// A complex modulus (Pa) or stiffness (N/m) over frequency: a spring, a dashpot and Maxwell elements in parallel.
#[derive(Clone, Debug, PartialEq)]
struct Response {
    /// The kind of link; empty for the compound.
    name: &'static str,
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
    fn at(&self, omega: f64) -> (f64, f64) {
        self.link.complex_stiffness(omega)
    }

    /// E_∞ or c, Pa or N/m.
    fn equilibrium(&self) -> f64 {
        self.link.stiffness.unwrap_or(0.0)
    }

    /// η or d, Pa s or N s/m.
    fn damper(&self) -> f64 {
        self.link.damping.unwrap_or(0.0)
    }

    fn loss_tangent(&self, omega: f64) -> f64 {
        let (storage, loss) = self.at(omega);
        loss / storage
    }

    fn glassy(&self) -> f64 {
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
    fn maximum_loss(&self, band: FrequencyBand) -> Option<(f64, f64)> {
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
struct Responses<'a> {
    scene: &'a Scene,
    responses: Vec<Response>,
    band: FrequencyBand,
}

impl<'a> Responses<'a> {
    fn new(scene: &'a Scene, asked: Option<FrequencyBand>) -> Result<Self, MaterialError> {
        let responses = responses(scene);
        if responses.is_empty() {
            return Err(MaterialError::NoLinks);
        }
        let band = asked.unwrap_or_else(|| band(&responses));
        Ok(Self { scene, responses, band })
    }

    fn is_material(&self) -> bool {
        self.scene.material.is_some()
    }

    fn symbol_and_unit(&self) -> (&'static str, &'static str) {
        if self.is_material() { ("E", "Pa") } else { ("K", "N/m") }
    }

    fn quantity(&self) -> &'static str {
        if self.is_material() { "moduli" } else { "stiffnesses of the links" }
    }

    /// The summary and a table of some rows.
    fn text(&self) -> String {
        let kind = if self.is_material() { "Material" } else { "Link" };
        let mut rows: Vec<LabelledLine> = vec![("Scene", self.scene.name.clone())];
        rows.extend(self.temperature().map(|text| ("Temperature", text)));
        rows.extend(self.responses.iter().map(|response| (kind, self.figures(response))));
        rows.extend(self.heat().map(|text| ("Heat", text)));
        rows.extend(files::table_lines(self.scene));
        format!("{}\n{}\n", lines(&rows), self.table())
    }

    fn temperature(&self) -> Option<String> {
        let material = self.scene.material.as_ref()?;
        Some(material.wlf.map_or_else(
            || "none in the scene: times as they are given".into(),
            |wlf| {
                format!(
                    "{} K: all times are a_T = {} times those given, at {} K",
                    short(wlf.temperature),
                    short(wlf.shift_factor()),
                    short(wlf.reference_temperature)
                )
            },
        ))
    }

    /// How it takes up the heat of friction.
    fn heat(&self) -> Option<String> {
        let material = self.scene.material.as_ref()?;
        let heat = material.heat?;
        let diffusivity = heat.conductivity / (material.density * heat.capacity);
        Some(format!(
            "conductivity {} W/(m K), capacity {} J/(kg K), diffusivity {} m²/s; takes {} of the power of friction",
            short(heat.conductivity),
            short(heat.capacity),
            short(diffusivity),
            short(heat.share)
        ))
    }

    fn figures(&self, response: &Response) -> String {
        let (symbol, unit) = self.symbol_and_unit();
        let name = if response.name.is_empty() { String::new() } else { format!("{:<12}", response.name) };
        let glassy = if response.damper() > 0.0 {
            "unbounded because of the damper".into()
        } else {
            format!("{} {unit}", short(response.glassy()))
        };
        let loss = response.maximum_loss(self.band).map_or_else(
            || "no loss".into(),
            |(omega, tangent)| {
                let is_end = omega == self.band.0 || omega * (1.0 + 1e-9) >= self.band.1;
                let end = if is_end { ", the end of the range" } else { "" };
                format!("tan δ at most {} at {} rad/s ({} Hz){end}", short(tangent), short(omega), short(omega / TAU))
            },
        );
        format!("{name}equilibrium {symbol} {} {unit}, glassy {symbol} {glassy}, {loss}", short(response.equilibrium()))
    }

    /// The columns' names and units.
    fn columns(&self) -> Vec<(String, &'static str)> {
        let (symbol, unit) = self.symbol_and_unit();
        let mut columns = vec![("omega".to_owned(), "rad/s")];
        for response in &self.responses {
            let prefix = if response.name.is_empty() { String::new() } else { format!("{} ", response.name) };
            columns.push((format!("{prefix}{symbol}'"), unit));
            columns.push((format!("{prefix}{symbol}''"), unit));
            columns.push((format!("{prefix}tan delta"), "1"));
        }
        columns
    }

    fn row(&self, omega: f64) -> Vec<f64> {
        let values = self.responses.iter().flat_map(|response| {
            let (storage, loss) = response.at(omega);
            [storage, loss, response.loss_tangent(omega)]
        });
        std::iter::once(omega).chain(values).collect()
    }

    fn table(&self) -> String {
        let points = match (self.band.1 / self.band.0).log10() {
            decades if decades > 8.0 => 1.0,
            decades if decades > 3.0 => 2.0,
            _ => 5.0,
        };
        let names: Vec<String> = self.columns().into_iter().map(|(name, _)| name).collect();
        let widths: Vec<usize> = names.iter().map(|name| name.chars().count().max(11) + 2).collect();
        let line = |fields: Vec<String>| {
            let fields = fields.iter().zip(&widths).map(|(field, width)| format!("{field:<width$}"));
            fields.collect::<String>().trim_end().to_owned() + "\n"
        };
        let rows = evenly(self.band, points)
            .into_iter()
            .map(|omega| line(self.row(omega).into_iter().map(|value| format!("{value:.3e}")).collect()));
        std::iter::once(line(names.clone())).chain(rows).collect()
    }

    fn file(&self) -> String {
        let mut text = format!("# {} of {} by `asperity material`\n", self.quantity(), self.scene.name);
        if let Some(temperature) = self.temperature() {
            text += &format!("# temperature: {temperature}\n");
        }
        // With units, as `asperity fit` reads them.
        let names: Vec<String> = self.columns().iter().map(|(name, unit)| format!("{name} [{unit}]")).collect();
        text += &(names.join(",") + "\n");
        let line = |omega: f64| {
            self.row(omega).into_iter().map(|value| format!("{value:e}")).collect::<Vec<_>>().join(",") + "\n"
        };
        text + &evenly(self.band, POINTS).into_iter().map(line).collect::<String>()
    }

    fn picture(&self) -> Stacked {
        let omegas = evenly(self.band, POINTS);
        let curve = |look: usize, name: &str, value: &dyn Fn(f64) -> f64| Curve {
            name: name.into(),
            look,
            stroke: Stroke::Line,
            points: omegas.iter().map(|&omega| (omega, value(omega))).collect(),
        };
        let of_all = |value: fn(&Response, f64) -> f64| -> Vec<Curve> {
            let all = self.responses.iter().enumerate();
            all.map(|(i, response)| curve(i, response.name, &|omega| value(response, omega))).collect()
        };
        let panel = |title: &str, curves: Vec<Curve>| Panel { title: title.into(), curves };
        let panels = if self.is_material() {
            let response = &self.responses[0];
            let storage = curve(0, "E'", &|omega| response.at(omega).0);
            let loss = curve(1, "E''", &|omega| response.at(omega).1);
            let tangent = curve(2, "tan δ", &|omega| response.loss_tangent(omega));
            vec![panel("modulus in Pa", vec![storage, loss]), panel("tan δ", vec![tangent])]
        } else {
            vec![
                panel("K' in N/m", of_all(|response, omega| response.at(omega).0)),
                panel("K'' in N/m", of_all(|response, omega| response.at(omega).1)),
                panel("tan δ", of_all(Response::loss_tangent)),
            ]
        };
        let wlf = self.scene.material.as_ref().and_then(|material| material.wlf);
        let temperature = wlf.map_or_else(String::new, |wlf| format!(" at {} K", short(wlf.temperature)));
        let title = format!("{}: {}{temperature}", self.scene.name, self.quantity());
        Stacked { title, x_title: "angular frequency in rad/s".into(), panels }
    }
}

/// Five digits.
fn short(value: f64) -> String {
    decimal(rounded(value, 5), 1e-3..1e5)
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
    fn without_loss_there_is_no_maximum() {
        assert_eq!(response(&[]).maximum_loss((1.0, 10.0)), None);
    }
}
