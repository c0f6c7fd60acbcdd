//! Elements beside their layers in steady sliding, at several speeds.

use asperity::element::OperatingPoint;
use rayon::prelude::*;

use super::element::not_steady;
use super::measure::{ERROR, SLIDING_DISTANCE, Wrench, WrenchSeries, percentages, wrench};
use super::patch::{Elements, PatchCheck, point};
use super::tilt::{TiltedElement, TiltedFace};
use crate::csv;
use crate::decimals::real;
use crate::error::Error;
use crate::progress::{Counter, Stopped, Watch};
use crate::sweep::StopBounds;

/// What is compared of an element: along and across the plane.
pub const COMPARED: [(&str, usize); 2] = [("force.x", 0), ("force.z", 2)];
/// Columns before those of what is compared.
const HEAD: [&str; 9] =
    ["speed [m/s]", "element", "x [m]", "y [m]", "z [m]", "area [m2]", "separation [m]", "pressure [Pa]", "status"];

/// Steady sliding at all speeds.
#[derive(Debug)]
pub struct Sliding<'a> {
    check: &'a PatchCheck,
    speeds: Vec<SlidingAtSpeed<'a>>,
}

/// Steady sliding at a speed.
#[derive(Debug)]
struct SlidingAtSpeed<'a> {
    face: &'a TiltedFace,
    /// Forces on the elements, N.
    elements: Vec<[f64; 3]>,
    /// Forces on their layers, N; the status of one that was not steady.
    layers: Vec<Result<[f64; 3], Error>>,
}

impl<'a> Sliding<'a> {
    /// Slides the elements and their layers.
    ///
    /// # Errors
    /// Where the patch cannot be moved, or `watch` stops it.
    pub fn run(check: &'a PatchCheck, watch: &Watch<'_>) -> Result<Self, Error> {
        let steps = check.faces.iter().map(|face| face.tilted_elements.len()).sum();
        let counter = Counter::new(watch, "of the layers in steady sliding", steps);
        let speeds = check.faces.iter().map(|face| SlidingAtSpeed::run(check, face, &counter));
        Ok(Self { check, speeds: speeds.collect::<Result<_, _>>()? })
    }

    /// The wrenches of the layers and of the elements, by speed.
    pub fn pair(&self) -> WrenchSeries {
        let (layers, other): (Vec<_>, Vec<_>) = self.speeds.iter().map(SlidingAtSpeed::wrenches).unzip();
        let (reference, sizes): (Vec<_>, Vec<_>) = layers.into_iter().unzip();
        WrenchSeries::new(reference, other, &sizes, self.check.lever)
    }

    /// Differences by speed, and what could not be compared.
    pub fn summary(&self) -> Vec<String> {
        let pressures: Vec<f64> = self.speeds.iter().flat_map(SlidingAtSpeed::pressures).collect();
        let (least, largest) = pressures.iter().fold((f64::INFINITY, 0.0), |(low, high), p| (p.min(low), p.max(high)));
        let all: usize = self.speeds.iter().map(|sliding| sliding.elements.len()).sum();
        let range =
            if pressures.is_empty() { String::new() } else { format!(" from {least:.3e} to {largest:.3e} Pa,") };
        let (compared, name) = (pressures.len(), self.check.swept.name());
        let mut texts =
            vec![format!("{compared} of {all} elements beside their {name}s,{range} over the {name}s' largest values")];
        let shares = self.pair().shares();
        texts.extend(self.speeds.iter().zip(shares).map(|(sliding, share)| sliding.line(share)));
        texts.extend(self.speeds.iter().flat_map(SlidingAtSpeed::failed));
        texts
    }

    /// The table of all elements.
    pub fn table(&self) -> String {
        let swept = self.check.swept.name();
        let of_each =
            COMPARED.iter().flat_map(|(name, _)| [swept, "element", "error"].map(|of| format!("{name} {of}")));
        let head: Vec<String> = HEAD.map(String::from).into_iter().chain(of_each).collect();
        csv::text(head.iter().map(String::as_str), self.speeds.iter().flat_map(SlidingAtSpeed::rows))
    }

    /// The errors of the elements whose layers were steady, by speed.
    pub fn errors(&self) -> Vec<ElementErrors> {
        let error = |(tilted, layer, element): (&TiltedElement, [f64; 3], [f64; 3])| {
            (element[2] / tilted.element.area, COMPARED.map(|(_, axis)| element[axis] / layer[axis] - 1.0))
        };
        let errors = |at: &SlidingAtSpeed<'_>| ElementErrors {
            speed: at.face.speed,
            errors: at.compared().map(error).collect(),
        };
        self.speeds.iter().map(errors).collect()
    }
}

/// The errors of elements at a speed.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementErrors {
    /// The speed, m/s.
    pub speed: f64,
    /// The pressure on each, Pa, and the errors relative to its layer, of what is [`COMPARED`].
    pub errors: Vec<(f64, [f64; COMPARED.len()])>,
}

impl<'a> SlidingAtSpeed<'a> {
    fn run(check: &PatchCheck, face: &'a TiltedFace, counter: &Counter<'_>) -> Result<Self, Error> {
        let mut run = Elements::new(&check.patch, face, face.speed)?;
        run.advance((SLIDING_DISTANCE / face.speed, face.speed))?;
        let elements = run.forces();
        let pairs: Vec<_> = face.tilted_elements.iter().zip(&elements).collect();
        let layer = |(tilted, force): &(&TiltedElement, &[f64; 3])| {
            let found = layer_force(check, face.speed, tilted, force[2]);
            counter.step().map(|()| found)
        };
        let layers = pairs.par_iter().with_max_len(1).map(layer).collect::<Result<_, Stopped>>()?;
        Ok(Self { face, layers, elements })
    }

    /// The elements whose layers were steady, with the forces on layer and element, N.
    fn compared(&self) -> impl Iterator<Item = (&TiltedElement, [f64; 3], [f64; 3])> {
        let all = self.face.tilted_elements.iter().zip(&self.layers).zip(&self.elements);
        all.filter_map(|((tilted, layer), element)| Some((tilted, *layer.as_ref().ok()?, *element)))
    }

    /// The pressures on the elements, Pa.
    fn pressures(&self) -> impl Iterator<Item = f64> {
        self.compared().map(|(tilted, _, element)| element[2] / tilted.element.area)
    }

    /// The wrench of the layers with the sums of magnitudes, and that of the elements.
    fn wrenches(&self) -> ((Wrench, Wrench), Wrench) {
        let of = |which: fn([f64; 3], [f64; 3]) -> [f64; 3]| {
            wrench(self.compared().map(|(tilted, layer, element)| (tilted.arm, which(layer, element))))
        };
        (of(|layer, _| layer), of(|_, element| element).0)
    }

    fn line(&self, share: Wrench) -> String {
        format!("at {} m/s: {}", real(self.face.speed), percentages(share))
    }

    fn failed(&self) -> impl Iterator<Item = String> {
        let all = self.face.tilted_elements.iter().zip(&self.layers);
        let failed = all.filter_map(|(tilted, layer)| Some((tilted, layer.as_ref().err()?)));
        failed.map(|(tilted, status)| {
            format!("element {} at {} m/s: {status}", tilted.element.index + 1, real(self.face.speed))
        })
    }

    fn rows(&self) -> impl Iterator<Item = Vec<String>> {
        let all = self.face.tilted_elements.iter().zip(&self.layers).zip(&self.elements);
        all.map(|((tilted, layer), element)| {
            let status = layer.as_ref().map_or_else(ToString::to_string, |_| "compared".into());
            let mut row = vec![real(self.face.speed), (tilted.element.index + 1).to_string()];
            row.extend(
                tilted
                    .element
                    .place
                    .into_iter()
                    .chain([tilted.element.area, tilted.separation, element[2] / tilted.element.area])
                    .map(real),
            );
            row.push(status);
            for (_, axis) in COMPARED {
                let of = |value: &dyn Fn(&[f64; 3]) -> f64| {
                    layer.as_ref().map(|layer| real(value(layer))).unwrap_or_default()
                };
                row.extend([
                    of(&|layer| layer[axis]),
                    real(element[axis]),
                    of(&|layer| element[axis] / layer[axis] - 1.0),
                ]);
            }
            row
        })
    }
}

/// The force on a layer of the area of an element in its place, N, where it is near `force_z`.
fn layer_force(check: &PatchCheck, speed: f64, tilted: &TiltedElement, force_z: f64) -> Result<[f64; 3], Error> {
    let PatchCheck { patch, scene, swept, .. } = check;
    let (load, share) = (patch.table().load, tilted.element.area / patch.nominal_area());
    let at = OperatingPoint { load: load.at_force(force_z / share), ..point(patch, speed) };
    let w = tilted.separation - patch.table().rest_separation;
    let found = swept.sliding_at(scene, &at, w, load, StopBounds { error: ERROR, distance: None });
    let found = found.map_err(|status| not_steady(swept, &status))?;
    Ok([-share * found.drag, 0.0, share * found.force_z])
}
