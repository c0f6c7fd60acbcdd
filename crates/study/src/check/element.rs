//! The element of a table against what was swept, at points between those of the table. Of a table that was solved for,
//! these points are solved for too.

use asperity::element::{Load, OperatingPoint, PointContact, SweepGrid};
use asperity::outputs::variable;
use asperity::scene::Scene;
use asperity::simulation::Start;
use rayon::prelude::*;

use super::drag::{LOOP_OUTPUTS, Loop, element_at};
use super::measure::{ERROR, SLIDING_DISTANCE, deviation, selected, swept_scene};
use crate::csv::text;
use crate::decimals::real;
use crate::error::{Context as _, Error};
use crate::progress::{Counter, Stopped, Watch};
use crate::summary::{LabelledLine, labelled};
use crate::sweep::{Method, NotSteady, StopBounds, Swept, SweptPoint};

/// What is compared in steady sliding.
pub const COMPARED: [&str; 3] = ["F_x", "F_z", "P_diss"];

/// An element, and what its table was swept of.
#[derive(Debug)]
pub struct ElementCheck<'a> {
    contact: &'a PointContact,
    scene: Scene,
    swept: Swept,
    /// The centres of the cells of the table.
    between: SweepGrid,
}

impl<'a> ElementCheck<'a> {
    /// The check of an element by the scene that its table was swept of.
    ///
    /// # Errors
    /// Where the table was swept of another scene.
    pub fn new(contact: &'a PointContact, scene: Scene) -> Result<Self, Error> {
        let scene = swept_scene(contact.table(), scene)?;
        let between = centres(&contact.table().grid);
        let swept = Swept::of_table(&scene, contact.table(), &between.temperatures).context("`check`")?;
        Ok(Self { contact, scene, swept, between })
    }

    /// Compares `count` points in steady sliding.
    ///
    /// # Errors
    /// Where `watch` stops it.
    pub fn points(&self, count: usize, watch: &Watch<'_>) -> Result<PointChecks, Stopped> {
        let points = selected(&self.between.points().collect::<Vec<_>>(), count);
        let counter = Counter::new(watch, "", points.len());
        let check = |point: &OperatingPoint| {
            let check = self.point(point);
            counter.step().map(|()| check)
        };
        let points = points.par_iter().with_max_len(1).map(check).collect::<Result<_, _>>()?;
        Ok(PointChecks { load: self.contact.table().load, swept: self.swept.name(), points })
    }

    fn point(&self, point: &OperatingPoint) -> PointCheck {
        let Self { contact, scene, swept, .. } = self;
        let found = swept.sliding(scene, point, contact.table().load, StopBounds { error: ERROR, distance: None });
        let element = found.as_ref().ok().map(|found| element_sliding(contact, point, found.w));
        let not_steady = |status| not_steady(swept, &status);
        PointCheck { point: *point, swept: found.map_err(not_steady), element }
    }

    /// Drags both to and fro from rest at the height and the speed of the middle one of the points that could be compared,
    /// the layer under the same load where something else was swept; `None` without such a point.
    pub fn to_and_fro(&self, points: &PointChecks) -> Option<(OperatingPoint, Result<Loop, Error>)> {
        let compared: Vec<_> = points.points.iter().filter(|check| check.errors().is_some()).collect();
        let &&PointCheck { point, swept: Ok(ref found), .. } = compared.get(compared.len() / 2)? else { return None };
        let rows = self.height_of_layer(&point, found).and_then(|of_layer| {
            Loop::run(self.contact, &self.scene, &point, [found.w, of_layer], matches!(self.swept, Swept::Layer))
        });
        Some((point, rows))
    }

    /// The displacement of the carrier (m) at which the layer bears what the element does at that of `found`.
    fn height_of_layer(&self, point: &OperatingPoint, found: &SweptPoint) -> Result<f64, Error> {
        if matches!(self.swept, Swept::Layer) {
            return Ok(found.w);
        }
        Method::Layer.check(&self.scene)?;
        let bounds = StopBounds { error: ERROR, distance: None };
        let layer = Swept::Layer.sliding(&self.scene, point, self.contact.table().load, bounds);
        layer.map(|layer| layer.w).map_err(|status| not_steady(&Swept::Layer, &status))
    }
}

/// What was swept, a layer or a solution, is not steady at a point.
pub(super) fn not_steady(swept: &Swept, status: &NotSteady) -> Error {
    Error::run(format!("{} {status}", swept.name()))
}

/// The grid of the centres of the cells of a grid; an axis of one value keeps it.
fn centres(grid: &SweepGrid) -> SweepGrid {
    let centres = |axis: &[f64], mean: fn(f64, f64) -> f64| match axis {
        [one] => vec![*one],
        _ => axis.windows(2).map(|ends| mean(ends[0], ends[1])).collect::<Vec<_>>(),
    };
    let geometric: fn(f64, f64) -> f64 = |a, b| (a * b).sqrt();
    SweepGrid {
        speeds: centres(&grid.speeds, geometric),
        loads: centres(&grid.loads, geometric),
        temperatures: centres(&grid.temperatures, f64::midpoint),
    }
}

fn element_sliding(contact: &PointContact, point: &OperatingPoint, w: f64) -> Result<[f64; 3], Error> {
    let mut element = element_at(contact, point, &Start { w, u_rate: point.speed, ..Start::default() })?;
    element.advance(SLIDING_DISTANCE / point.speed, point.speed, 0.0)?;
    let variables = LOOP_OUTPUTS[..3].iter().copied().filter_map(variable).collect::<Vec<_>>();
    let mut values = [0.0; 3];
    element.evaluate(&variables, &mut values);
    let [x, z, power] = values;
    Ok([-x, z, power])
}

/// Points in steady sliding.
#[derive(Debug)]
pub struct PointChecks {
    /// What the load of a point is.
    pub load: Load,
    /// What was swept, in a word.
    swept: &'static str,
    /// The points.
    pub points: Vec<PointCheck>,
}

/// What was swept and the element at a point between those of the table.
#[derive(Debug)]
pub struct PointCheck {
    /// The point.
    pub point: OperatingPoint,
    swept: Result<SweptPoint, Error>,
    /// |F_x|, F_z and P_diss of the element at the same w.
    element: Option<Result<[f64; 3], Error>>,
}

impl PointCheck {
    /// Errors of the element relative to what was swept, of what is [`COMPARED`]; `None` where one of them has no values.
    pub fn errors(&self) -> Option<[f64; 3]> {
        let (swept, element) = (self.swept_values()?, self.element.as_ref()?.as_ref().ok()?);
        Some(std::array::from_fn(|i| element[i] / swept[i] - 1.0))
    }

    fn swept_values(&self) -> Option<[f64; 3]> {
        self.swept.as_ref().ok().map(|swept| [swept.drag, swept.force_z, swept.power])
    }

    fn status(&self) -> String {
        match (&self.swept, &self.element) {
            (Err(status), _) => status.to_string(),
            (_, Some(Err(status))) => format!("element: {status}"),
            _ => "compared".into(),
        }
    }

    fn fields(&self) -> Vec<String> {
        let text = |value: Option<f64>| value.map(real).unwrap_or_default();
        let point = self.point;
        let w = self.swept.as_ref().ok().map(|swept| swept.w);
        let mut fields = vec![real(point.speed), real(point.load), text(point.temperature), self.status(), text(w)];
        let element = self.element.as_ref().and_then(|element| element.as_ref().ok());
        for i in 0..COMPARED.len() {
            fields.push(text(self.swept_values().map(|values| values[i])));
            fields.push(text(element.map(|values| values[i])));
            fields.push(text(self.errors().map(|errors| errors[i])));
        }
        fields
    }
}

impl PointChecks {
    /// The largest and the root mean square errors, and what could not be compared.
    pub fn lines(&self) -> Vec<LabelledLine> {
        let checks = &self.points;
        let errors: Vec<[f64; 3]> = checks.iter().filter_map(PointCheck::errors).collect();
        let mut texts =
            vec![format!("{} of {} points between the table's, in steady sliding", errors.len(), checks.len())];
        for (i, name) in COMPARED.iter().enumerate().filter(|_| !errors.is_empty()) {
            texts.push(deviation(name, errors.iter().map(|error| error[i])));
        }
        let failed = checks.iter().filter(|check| check.errors().is_none());
        texts.extend(
            failed.map(|check| format!("{:.3e} m/s, {:.3e}: {}", check.point.speed, check.point.load, check.status())),
        );
        labelled("Checked", texts)
    }

    /// The table of all points.
    pub fn table(&self) -> String {
        let mut head = vec!["speed [m/s]".to_owned(), format!("{} [{}]", self.load.name(), self.load.unit())];
        head.extend(["temperature [K]", "status", "w [m]"].map(String::from));
        head.extend(COMPARED.iter().flat_map(|name| [self.swept, "element", "error"].map(|of| format!("{name} {of}"))));
        text(head.iter().map(String::as_str), self.points.iter().map(PointCheck::fields))
    }
}
