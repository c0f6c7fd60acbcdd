//! The masses of a layer over the rows of a run: collected for arrays, for pictures of an instant and for animations.

mod arrays;
mod page;

use asperity::outputs::{Output, OutputType, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Scene, Surface};

pub(crate) use arrays::ArraysError;

/// What the masses did, row by row.
#[derive(Debug)]
pub(crate) struct ElementHistory {
    /// The scene's name.
    name: String,
    surface: Surface,
    /// Positions of the masses at rest for u = 0, m.
    rest: Vec<f64>,
    /// Area that a mass stands for, m²; in the material form alone.
    area: Option<f64>,
    variables: Vec<Variable>,
    fields: Vec<Field>,
    rows: Vec<Instant>,
}

/// An output of every mass, for all rows: the masses of the first row first.
#[derive(Debug)]
struct Field {
    /// The output of the first mass.
    output: Output,
    name: String,
    kind: OutputType,
    values: Vec<f64>,
}

/// What a row says of the layer as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Instant {
    /// s.
    pub(crate) time: f64,
    /// The carrier's displacement, m.
    pub(crate) u: f64,
    pub(crate) w: f64,
    /// On the carrier, N.
    pub(crate) force_x: f64,
    pub(crate) force_z: f64,
}

/// What a mass does with the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Touch {
    Free,
    Slips,
    Sticks,
}

/// A mass at a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// m.
    pub(crate) x: f64,
    pub(crate) z: f64,
    /// Of the contact: F_N over the area that a mass stands for, Pa; F_N itself, N, where the scene gives none.
    pub(crate) load: f64,
    pub(crate) touch: Touch,
    /// Flash temperature, K; 0 in a scene without one.
    pub(crate) flash: f64,
}

impl ElementHistory {
    pub(crate) fn new(scene: &Scene) -> Self {
        let variables = variables(&Scene { outputs: vec![OutputGroup::Elements], ..scene.clone() });
        let of_mass = &variables[..variables.len() / scene.layer.masses];
        let field = |variable: &Variable| Field {
            output: variable.output,
            name: variable.name.rsplit('.').next().unwrap_or_default().to_owned(),
            kind: variable.kind,
            values: Vec::new(),
        };
        Self {
            name: scene.name.clone(),
            surface: scene.surface.clone(),
            rest: (0..scene.layer.masses).map(|i| scene.layer.rest_position(i)).collect(),
            area: scene.layer.element_area(),
            fields: of_mass.iter().map(field).collect(),
            variables,
            rows: Vec::new(),
        }
    }

    pub(crate) fn add(&mut self, time: f64, snapshot: &Snapshot<'_>) {
        let mut values = vec![0.0; self.variables.len()];
        snapshot.evaluate(&self.variables, &mut values);
        let count = self.fields.len();
        for (i, field) in self.fields.iter_mut().enumerate() {
            field.values.extend(values.iter().skip(i).step_by(count));
        }
        let (displacement, force) = (&snapshot.displacement, &snapshot.on_carrier);
        self.rows.push(Instant { time, u: displacement.x, w: displacement.z, force_x: force.x, force_z: force.z });
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn surface(&self) -> &Surface {
        &self.surface
    }

    pub(crate) fn rows(&self) -> &[Instant] {
        &self.rows
    }

    /// The row nearest to a time (s); none of a run without rows.
    pub(crate) fn row_at(&self, time: f64) -> Option<usize> {
        let distance = |row: &usize| (self.rows[*row].time - time).abs();
        (0..self.rows.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The rows nearest to the ends of even parts of the time of the run, at most `most` of them; one row may be nearest
    /// to several.
    pub(crate) fn evenly_in_time(&self, most: usize) -> Vec<usize> {
        let (Some(first), Some(last)) = (self.rows.first(), self.rows.last()) else { return Vec::new() };
        let parts = (self.rows.len().min(most) - 1).max(1);
        let time = |part: usize| first.time + (last.time - first.time) * (part as f64 / parts as f64);
        (0..=parts).filter_map(|part| self.row_at(time(part))).collect()
    }

    /// Of `most` rows those at even parts of the run, the first and the last among them; all where there are fewer.
    pub(crate) fn spread(&self, most: usize) -> Vec<usize> {
        let last = self.rows.len().saturating_sub(1);
        let parts = last.min(most.max(2) - 1).max(1);
        let mut rows: Vec<usize> = (0..=parts).map(|part| part * last / parts).collect();
        rows.dedup();
        rows
    }

    /// What is seen along x while u = 0: a little more than the layer at rest, m.
    pub(crate) fn ends(&self) -> (f64, f64) {
        let (first, last) = (self.rest[0], self.rest[self.rest.len() - 1]);
        let margin = self.spacing() / 2.0 + 0.02 * (last - first);
        (first - margin, last + margin)
    }

    /// The distance of the masses at rest, m; a single one has a tenth of a millimetre for itself.
    pub(crate) fn spacing(&self) -> f64 {
        if self.rest.len() > 1 { self.rest[1] - self.rest[0] } else { 1e-4 }
    }

    /// What [`Element::load`] is, and its unit.
    pub(crate) fn load_unit(&self) -> (&'static str, &'static str) {
        if self.area.is_some() { ("pressure", "Pa") } else { ("normal force", "N") }
    }

    /// Whether the scene has flash temperatures.
    pub(crate) fn has_flash(&self) -> bool {
        self.values(Output::ElementFlash(0)).is_some()
    }

    pub(crate) fn elements(&self, row: usize) -> impl Iterator<Item = Element> {
        let masses = self.rest.len();
        let of = move |output: Output| self.values(output).map(|values| &values[row * masses..(row + 1) * masses]);
        let [x, z, force, mode] =
            [Output::ElementX(0), Output::ElementZ(0), Output::ElementNormalForce(0), Output::ElementMode(0)].map(of);
        let (x, z, force, mode) = (x.into_iter().flatten(), z.into_iter().flatten(), force, mode);
        let flash = of(Output::ElementFlash(0));
        let contacts = force.into_iter().flatten().zip(mode.into_iter().flatten());
        x.zip(z).zip(contacts).enumerate().map(move |(i, ((&x, &z), (force, &mode)))| Element {
            x,
            z,
            load: force / self.area.unwrap_or(1.0),
            touch: Touch::new(mode),
            flash: flash.map_or(0.0, |flash| flash[i]),
        })
    }

    fn values(&self, output: Output) -> Option<&[f64]> {
        self.fields.iter().find(|field| field.output == output).map(|field| field.values.as_slice())
    }
}

impl Touch {
    /// By the number of a mode.
    fn new(mode: f64) -> Self {
        match mode {
            0.0 => Self::Free,
            2.0 => Self::Sticks,
            _ => Self::Slips,
        }
    }

    /// Its name in legends.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Slips => "slips",
            Self::Sticks => "sticks",
        }
    }
}

/// The span of what is drawn of some rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// Of the profile below the layer and of the masses, m.
    pub(crate) heights: (f64, f64),
    /// From 0 to the largest of [`Element::load`], and of the flash temperatures.
    pub(crate) load: f64,
    pub(crate) flash: f64,
}

impl Span {
    /// A layer that is far above the profile is left out where others are in contact: only a contact is to be seen.
    pub(crate) fn over(history: &ElementHistory, rows: &[usize]) -> Self {
        let touches = |row: &usize| history.elements(*row).any(|element| element.touch != Touch::Free);
        let touching: Vec<usize> = rows.iter().copied().filter(touches).collect();
        let (mut low, mut high, mut load, mut flash) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64, 0.0_f64);
        for &row in if touching.is_empty() { rows } else { &touching } {
            for element in history.elements(row) {
                // Below the mass, and half-way to its neighbours.
                for aside in [-0.5, 0.0, 0.5] {
                    let height = history.surface.spline().evaluate(element.x + aside * history.spacing()).0;
                    (low, high) = (low.min(element.z.min(height)), high.max(element.z.max(height)));
                }
                (load, flash) = (load.max(element.load), flash.max(element.flash));
            }
        }
        let margin = if high > low { 0.06 * (high - low) } else { 0.1 * history.spacing() };
        Self { heights: (low - margin, high + margin), load, flash }
    }
}
