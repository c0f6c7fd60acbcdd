//! What the masses of a layer did in a run, row by row, as pictures and animations show it.

use asperity::outputs::{Output, OutputType, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Scene, Surface, Unit};

/// An output of every mass, for all rows: the masses of the first row first.
#[derive(Clone, Debug)]
pub struct ElementField {
    /// The output of the first mass.
    pub output: Output,
    /// Its name, without that of the mass.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// Real or Integer.
    pub kind: OutputType,
    /// Row by row, those of all masses.
    pub values: Vec<f64>,
}

/// The outputs of all masses.
#[derive(Clone, Debug)]
pub struct ElementFields {
    variables: Vec<Variable>,
    /// Of the row under way.
    values: Vec<f64>,
    fields: Vec<ElementField>,
}

impl ElementFields {
    /// Those that the masses of a scene have, without rows.
    pub fn new(scene: &Scene) -> Self {
        let variables = variables(&Scene { outputs: vec![OutputGroup::Elements], ..scene.clone() });
        let of_mass = &variables[..variables.len() / scene.layer.masses];
        let field = |variable: &Variable| ElementField {
            output: variable.output,
            name: variable.name.rsplit('.').next().unwrap_or_default().to_owned(),
            unit: variable.unit,
            kind: variable.kind,
            values: Vec::new(),
        };
        Self { fields: of_mass.iter().map(field).collect(), values: vec![0.0; variables.len()], variables }
    }

    /// Adds a row.
    pub fn add(&mut self, snapshot: &Snapshot<'_>) {
        let mut values = std::mem::take(&mut self.values);
        snapshot.evaluate(&self.variables, &mut values);
        self.add_values(&values);
        self.values = values;
    }

    /// Adds a row with the outputs of all masses, all of the first mass first.
    pub fn add_values(&mut self, masses: &[f64]) {
        let count = self.fields.len();
        for (i, field) in self.fields.iter_mut().enumerate() {
            field.values.extend(masses.iter().skip(i).step_by(count));
        }
    }

    /// The fields, with the rows so far.
    pub fn fields(&self) -> &[ElementField] {
        &self.fields
    }

    /// The fields themselves.
    pub fn into_fields(self) -> Vec<ElementField> {
        self.fields
    }

    /// Values of an output of the first mass, and of the others; `None` where the masses have none such.
    pub fn values(&self, output: Output) -> Option<&[f64]> {
        self.fields.iter().find(|field| field.output == output).map(|field| field.values.as_slice())
    }
}

/// What the masses did, row by row.
#[derive(Debug)]
pub struct ElementHistory {
    /// The scene's name.
    name: String,
    surface: Surface,
    /// Positions of the masses at rest for u = 0, m.
    rest: Vec<f64>,
    spacing: f64,
    /// Area that a mass stands for, m²; in the material form alone.
    area: Option<f64>,
    fields: ElementFields,
    rows: Vec<Instant>,
    /// The least and the largest x - u of all masses in all rows, m.
    reach: (f64, f64),
}

/// What a row says of the layer as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Time, s.
    pub time: f64,
    /// The carrier's displacement, m.
    pub u: f64,
    /// The same along z, m.
    pub w: f64,
    /// On the carrier, N.
    pub force_x: f64,
    /// The same along z, N.
    pub force_z: f64,
}

/// What a mass does with the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// It is not in contact.
    Free,
    /// It slips on it.
    Slips,
    /// It sticks to it.
    Sticks,
}

/// A mass at a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Its place along x, m.
    pub x: f64,
    /// Its place along z, m.
    pub z: f64,
    /// Of the contact: F_N over the area that a mass stands for, Pa; F_N itself, N, where the scene gives none.
    pub load: f64,
    /// What it does with the surface.
    pub touch: Touch,
    /// Flash temperature, K; 0 in a scene without one.
    pub flash: f64,
}

impl ElementHistory {
    /// That of a run of `scene`, without rows.
    pub fn new(scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            surface: scene.surface.clone(),
            rest: (0..scene.layer.masses).map(|i| scene.layer.rest_position(i)).collect(),
            spacing: scene.layer.spacing,
            area: scene.layer.element_area(),
            fields: ElementFields::new(scene),
            rows: Vec::new(),
            reach: (f64::INFINITY, f64::NEG_INFINITY),
        }
    }

    /// Adds a row at a time (s).
    pub fn add(&mut self, time: f64, snapshot: &Snapshot<'_>) {
        self.fields.add(snapshot);
        let (displacement, force) = (&snapshot.displacement, &snapshot.on_carrier);
        self.count(Instant { time, u: displacement.x, w: displacement.z, force_x: force.x, force_z: force.z });
    }

    /// Adds a row with the outputs of all masses, the [fields](Self::fields) of the first mass first.
    pub fn add_values(&mut self, row: Instant, masses: &[f64]) {
        self.fields.add_values(masses);
        self.count(row);
    }

    fn count(&mut self, row: Instant) {
        self.rows.push(row);
        let places = self.elements(self.rows.len() - 1).map(|element| element.x - row.u);
        self.reach = places.fold(self.reach, |(low, high), x| (low.min(x), high.max(x)));
    }

    /// The rows and the outputs of the masses themselves.
    pub fn into_rows_and_fields(self) -> (Vec<Instant>, Vec<ElementField>) {
        (self.rows, self.fields.into_fields())
    }

    /// The outputs of the masses.
    pub fn fields(&self) -> &ElementFields {
        &self.fields
    }

    /// Positions of the masses at rest for u = 0, m.
    pub fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// Area that a mass stands for, m²; in the material form alone.
    pub fn area(&self) -> Option<f64> {
        self.area
    }

    /// The scene's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The scene's surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// What the rows say of the layer as a whole.
    pub fn rows(&self) -> &[Instant] {
        &self.rows
    }

    /// The row nearest to a time (s); none of a run without rows.
    pub fn row_at(&self, time: f64) -> Option<usize> {
        let distance = |row: &usize| (self.rows[*row].time - time).abs();
        (0..self.rows.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The rows nearest to the ends of even parts of the time of the run, at most `most` of them; one row may be nearest
    /// to several.
    pub fn evenly_in_time(&self, most: usize) -> Vec<usize> {
        let (Some(first), Some(last)) = (self.rows.first(), self.rows.last()) else { return Vec::new() };
        let parts = (self.rows.len().min(most) - 1).max(1);
        let time = |part: usize| first.time + (last.time - first.time) * (part as f64 / parts as f64);
        (0..=parts).filter_map(|part| self.row_at(time(part))).collect()
    }

    /// Of `most` rows those at even parts of the run, the first and the last among them; all where there are fewer.
    pub fn spread(&self, most: usize) -> Vec<usize> {
        let last = self.rows.len().saturating_sub(1);
        let parts = last.min(most.max(2) - 1).max(1);
        let mut rows: Vec<usize> = (0..=parts).map(|part| part * last / parts).collect();
        rows.dedup();
        rows
    }

    /// How far the carrier came along x within the row before, or of the first row comes within the next one, m: which
    /// way it slides there.
    pub fn slides(&self, row: usize) -> f64 {
        let (from, to) = (row.saturating_sub(1), row.max(1));
        self.rows.get(from..=to).map_or(0.0, |ends| ends[ends.len() - 1].u - ends[0].u)
    }

    /// What is seen along x while u = 0: a little more than where the masses are, m.
    pub fn ends(&self) -> (f64, f64) {
        let (low, high) = self.reach;
        let margin = (0.02 * (high - low)).max(self.spacing / 2.0);
        (low - margin, high + margin)
    }

    /// The distance of the masses at rest, m.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// What [`Element::load`] is, and its unit.
    pub fn load_unit(&self) -> (&'static str, &'static str) {
        if self.area.is_some() { ("pressure", "Pa") } else { ("normal force", "N") }
    }

    /// Whether the scene has flash temperatures.
    pub fn has_flash(&self) -> bool {
        self.fields.values(Output::ElementFlash(0)).is_some()
    }

    /// The masses at a row.
    pub fn elements(&self, row: usize) -> impl Iterator<Item = Element> {
        let masses = self.rest.len();
        let of =
            |output: Output| self.fields.values(output).map_or(&[][..], |all| &all[row * masses..(row + 1) * masses]);
        let [x, z] = [Output::ElementX(0), Output::ElementZ(0)].map(of);
        let [force, mode] = [Output::ElementNormalForce(0), Output::ElementMode(0)].map(of);
        let flash = of(Output::ElementFlash(0));
        (0..masses).map(move |i| Element {
            x: x[i],
            z: z[i],
            load: force[i] / self.area.unwrap_or(1.0),
            touch: Touch::new(mode[i]),
            flash: flash.get(i).copied().unwrap_or_default(),
        })
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
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Slips => "slips",
            Self::Sticks => "sticks",
        }
    }
}

/// The span of what is drawn of some rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Of the profile below the layer and of the masses, m.
    pub heights: (f64, f64),
    /// From 0 to the largest of [`Element::load`].
    pub load: f64,
    /// From 0 to the largest of the flash temperatures, K.
    pub flash: f64,
}

impl Span {
    /// A layer that is far above the profile is left out where others are in contact: only a contact is to be seen.
    pub fn over(history: &ElementHistory, rows: &[usize]) -> Self {
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
        // On a flat profile there are rounding errors alone.
        let margin = (0.06 * (high - low)).max(1e-3 * history.spacing());
        Self { heights: (low - margin, high + margin), load, flash }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run pressed within a tenth of its time and slid for the rest, with as many rows of both.
    fn history() -> ElementHistory {
        let text = "name = 'pair'\n[layer]\nmasses = 2\nspacing = 1e-4\nmass = 1e-7\n\
                    [layer.vertical]\nstiffness = 2e3\n[surface]\nkind = 'flat'\n";
        let scene = Scene::parse(text, "pair.toml".as_ref()).unwrap();
        let mut history = ElementHistory::new(&scene);
        let times = (0..=10).map(|i| 0.01 * f64::from(i)).chain((1..=10).map(|i| 0.1 + 0.09 * f64::from(i)));
        history.rows = times.map(|time| Instant { time, u: 0.0, w: 0.0, force_x: 0.0, force_z: 0.0 }).collect();
        history
    }

    #[test]
    fn rows_are_chosen_evenly_by_number_and_by_time() {
        let history = history();
        assert_eq!(history.spread(5), [0, 5, 10, 15, 20]);
        assert_eq!((history.spread(2), history.spread(1000).len()), (vec![0, 20], 21));
        // At 0, 0.25, 0.5, 0.75 and 1 s: the last four are among the ten rows after 0.1 s.
        assert_eq!(history.evenly_in_time(5), [0, 12, 14, 17, 20]);
        assert_eq!((history.row_at(0.033), history.row_at(9.0)), (Some(3), Some(20)));
    }

    #[test]
    fn a_layer_slides_as_its_carrier_came_there() {
        let mut history = history();
        (history.rows[1].u, history.rows[2].u) = (1e-3, -1e-3);
        assert_eq!([0, 1, 2, 3, 4].map(|row| history.slides(row)), [1e-3, 1e-3, -2e-3, 1e-3, 0.0]);
        history.rows.truncate(1);
        assert_eq!(history.slides(0), 0.0);
    }

    #[test]
    fn a_run_of_one_row_has_one_and_one_without_rows_none() {
        let mut history = history();
        history.rows.truncate(1);
        assert_eq!(history.spread(5), [0]);
        history.rows.clear();
        assert_eq!((history.row_at(0.0), history.evenly_in_time(5)), (None, vec![]));
    }

    #[test]
    fn fields_are_those_of_a_mass() {
        let names: Vec<String> = history().fields.into_fields().into_iter().map(|field| field.name).collect();
        assert_eq!(names, ["x", "z", "F_N", "F_T", "mode"]);
    }
}
