//! `asperity material`: the moduli of a scene's compound over frequency, at its temperature; in the direct form, the
//! stiffnesses of its links.

mod response;

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use asperity::scene::Scene;

use super::arguments::Material;
use super::error::ProgramError;
use super::plot::{Curve, Panel, Stacked, Stroke};
use super::text;
use response::{Band, Response, band, evenly, responses};

/// Points of a decade in files and pictures.
const POINTS: f64 = 20.0;

/// Prints the figures and a table; writes the outputs, or, where none is named, a picture.
pub(crate) fn material(command: &Material) -> Result<(), ProgramError> {
    let mut scene = super::load(&command.scene)?;
    super::set_parameters(&mut scene, &command.set)?;
    if let Some(temperature) = command.temperature {
        set_temperature(&mut scene, temperature)?;
    }
    let outputs = if command.output.is_empty() { vec![default_output(&command.scene)] } else { command.output.clone() };
    check_outputs(command, &scene, &outputs)?;
    let shown = Shown::new(&scene, command.frequencies.map(|range| range.0))?;
    for output in &outputs {
        if super::ends_in(output, "csv") {
            fs::write(output, shown.file()).map_err(ProgramError::file("write", output))?;
        } else {
            shown.picture().write(output)?;
        }
    }
    let names: Vec<String> = outputs.iter().map(|output| output.display().to_string()).collect();
    let text = format!("{}Written     {}\n", shown.text(), names.join(", "));
    text::print(&text)
}

/// Beside where the program runs, by the scene's file name.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str()).to_string_lossy();
    PathBuf::from(format!("{stem}-material.svg"))
}

fn check_outputs(command: &Material, scene: &Scene, outputs: &[PathBuf]) -> Result<(), ProgramError> {
    let mut taken = super::sources(&command.scene, scene);
    outputs.iter().try_for_each(|output| {
        super::check_output(output, &taken)?;
        taken.push(output.clone());
        Ok(())
    })
}

fn set_temperature(scene: &mut Scene, temperature: f64) -> Result<(), ProgramError> {
    let wlf = scene.material.as_mut().and_then(|material| material.wlf.as_mut());
    wlf.ok_or(ProgramError::NoTemperature)?.temperature = temperature;
    scene.check().map_err(|refusal| ProgramError::Temperature { option: "--temperature", refusal })
}

/// What is shown of a scene.
struct Shown<'a> {
    scene: &'a Scene,
    responses: Vec<Response>,
    band: Band,
}

impl<'a> Shown<'a> {
    fn new(scene: &'a Scene, asked: Option<Band>) -> Result<Self, ProgramError> {
        let responses = responses(scene);
        if responses.is_empty() {
            return Err(ProgramError::NoLinks);
        }
        let band = asked.unwrap_or_else(|| band(&responses));
        Ok(Self { scene, responses, band })
    }

    fn is_material(&self) -> bool {
        self.scene.material.is_some()
    }

    /// E or K, and its unit.
    fn symbol(&self) -> (&'static str, &'static str) {
        if self.is_material() { ("E", "Pa") } else { ("K", "N/m") }
    }

    /// The figures and a table of some rows.
    fn text(&self) -> String {
        let mut rows = vec![("Scene", self.scene.name.clone())];
        rows.extend(self.temperature().into_iter().map(|text| ("Temperature", text)));
        rows.extend(self.responses.iter().map(|response| (self.kind(), self.figures(response))));
        format!("{}\n{}\n", text::lines(&rows), self.table())
    }

    fn kind(&self) -> &'static str {
        if self.is_material() { "Material" } else { "Link" }
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

    fn figures(&self, response: &Response) -> String {
        let (symbol, unit) = self.symbol();
        let name = if response.name.is_empty() { String::new() } else { format!("{:<12}", response.name) };
        let glassy = if response.has_damper() {
            "grows without end with the damper".into()
        } else {
            format!("{} {unit}", short(response.glassy()))
        };
        let lossy = response.most_lossy(self.band).map_or_else(
            || "nothing is lost".into(),
            |(omega, tangent)| {
                let end = if omega == self.band.0 || omega * (1.0 + 1e-9) >= self.band.1 {
                    ", the end of the range"
                } else {
                    ""
                };
                format!("tan δ at most {} at {} rad/s ({} Hz){end}", short(tangent), short(omega), short(omega / TAU))
            },
        );
        format!("{name}equilibrium {symbol} {} {unit}, glassy {symbol} {glassy}, {lossy}", short(response.spring))
    }

    /// The columns' names: of the file with units, as `asperity fit` reads them.
    fn names(&self, units: bool) -> Vec<String> {
        let (symbol, unit) = self.symbol();
        let with = |unit: &str| if units { format!(" [{unit}]") } else { String::new() };
        let mut names = vec![format!("omega{}", with("rad/s"))];
        for response in &self.responses {
            let prefix = if response.name.is_empty() { String::new() } else { format!("{} ", response.name) };
            names.push(format!("{prefix}{symbol}'{}", with(unit)));
            names.push(format!("{prefix}{symbol}''{}", with(unit)));
            names.push(format!("{prefix}tan delta{}", with("1")));
        }
        names
    }

    fn row(&self, omega: f64) -> Vec<f64> {
        let values = self.responses.iter().flat_map(|response| {
            let (storage, loss) = response.at(omega);
            [storage, loss, response.loss_tangent(omega)]
        });
        std::iter::once(omega).chain(values).collect()
    }

    /// Some rows for reading.
    fn table(&self) -> String {
        let decades = (self.band.1 / self.band.0).log10();
        let steps = if decades > 8.0 {
            1.0
        } else if decades > 3.0 {
            2.0
        } else {
            5.0
        };
        let names = self.names(false);
        let widths: Vec<usize> = names.iter().map(|name| name.chars().count().max(11) + 2).collect();
        let line = |fields: Vec<String>| {
            let fields = fields.iter().zip(&widths).map(|(field, width)| format!("{field:<width$}"));
            fields.collect::<String>().trim_end().to_owned() + "\n"
        };
        let rows = evenly(self.band, steps)
            .into_iter()
            .map(|omega| line(self.row(omega).into_iter().map(|value| format!("{value:.3e}")).collect()));
        std::iter::once(line(names.clone())).chain(rows).collect()
    }

    fn file(&self) -> String {
        let mut text = format!("# {} of {} by `asperity material`\n", self.quantity(), self.scene.name);
        if let Some(temperature) = self.temperature() {
            text += &format!("# temperature: {temperature}\n");
        }
        text += &(self.names(true).join(",") + "\n");
        let line = |omega: f64| {
            self.row(omega).into_iter().map(|value| format!("{value:e}")).collect::<Vec<_>>().join(",") + "\n"
        };
        text + &evenly(self.band, POINTS).into_iter().map(line).collect::<String>()
    }

    fn quantity(&self) -> &'static str {
        if self.is_material() { "moduli" } else { "stiffnesses of the links" }
    }

    fn picture(&self) -> Stacked {
        let omegas = evenly(self.band, POINTS);
        let curve = |look: usize, name: String, value: &dyn Fn(f64) -> f64| Curve {
            name,
            look,
            stroke: Stroke::Line,
            points: omegas.iter().map(|&omega| (omega, value(omega))).collect(),
        };
        let of_all = |value: fn(&Response, f64) -> f64| -> Vec<Curve> {
            let all = self.responses.iter().enumerate();
            all.map(|(i, response)| curve(i, response.name.into(), &|omega| value(response, omega))).collect()
        };
        let panel = |title: &str, curves: Vec<Curve>| Panel { title: title.into(), curves };
        let panels = if self.is_material() {
            let response = &self.responses[0];
            let moduli = vec![
                curve(0, "E'".into(), &|omega| response.at(omega).0),
                curve(1, "E''".into(), &|omega| response.at(omega).1),
            ];
            let tangent = curve(2, "tan δ".into(), &|omega| response.loss_tangent(omega));
            vec![panel("modulus in Pa", moduli), panel("tan δ", vec![tangent])]
        } else {
            vec![
                panel("K' in N/m", of_all(|response, omega| response.at(omega).0)),
                panel("K'' in N/m", of_all(|response, omega| response.at(omega).1)),
                panel("tan δ", of_all(Response::loss_tangent)),
            ]
        };
        let temperature = self.scene.material.as_ref().and_then(|material| material.wlf);
        let temperature = temperature.map_or_else(String::new, |wlf| format!(" at {} K", short(wlf.temperature)));
        let title = format!("{}: {}{temperature}", self.scene.name, self.quantity());
        Stacked { title, x_title: "angular frequency in rad/s".into(), panels }
    }
}

/// Five digits.
fn short(value: f64) -> String {
    text::decimal(text::rounded(value, 5), 1e-3..1e5)
}
