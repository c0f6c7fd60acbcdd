//! The outputs of the masses, collected over the rows of a run.

use asperity::outputs::{Output, OutputType, Snapshot, Variable, variables};
use asperity::scene::{OutputGroup, Scene, Unit};

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
