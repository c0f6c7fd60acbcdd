//! A part of a layer, some masses in a row, as a layer of its own.

use crate::model::{Model, State};

impl Model {
    /// A layer of the first `masses` of this one.
    #[must_use]
    pub fn part(&self, masses: usize) -> Self {
        let first = |values: &[f64]| values[..masses.min(values.len())].to_vec();
        let (rest_x, rest_z, frozen) = (first(&self.rest_x), first(&self.rest_z), first(&self.frozen));
        let mut part = Self { rest_x, rest_z, frozen, ..self.clone() };
        let mut start = 0;
        for row in &mut part.rows {
            row.range = start..start + row.kind.count(masses);
            start = row.range.end;
        }
        part
    }

    /// Takes over from `whole`, of which this is a part, what depends on the temperature.
    pub fn set_temperature_of(&mut self, whole: &Self) {
        (self.links, self.frozen_stiffness) = (whole.links, whole.frozen_stiffness);
        for (mine, theirs) in self.rows.iter_mut().zip(&whole.rows) {
            (mine.relaxation_time, mine.time_index) = (theirs.relaxation_time, theirs.time_index);
        }
        self.relaxation_times.clone_from(&whole.relaxation_times);
        self.friction.clone_from(&whole.friction);
    }

    /// Makes this part of `whole` the one from mass `first` on.
    pub fn move_part(&mut self, whole: &Self, first: usize) {
        let masses = first..first + self.masses();
        self.rest_x.copy_from_slice(&whole.rest_x[masses.clone()]);
        self.rest_z.copy_from_slice(&whole.rest_z[masses.clone()]);
        if !self.frozen.is_empty() {
            self.frozen.copy_from_slice(&whole.frozen[masses]);
        }
    }
}

impl State {
    /// Writes this state into the part of `whole` from mass `first` on; `models` are those of this state and of
    /// `whole`.
    pub fn write_part(&self, models: (&Model, &Model), whole: &mut Self, first: usize) {
        let masses = first..first + self.mode.len();
        whole.elongation_x[masses.clone()].copy_from_slice(&self.elongation_x);
        whole.elongation_z[masses.clone()].copy_from_slice(&self.elongation_z);
        whole.velocity_x[masses.clone()].copy_from_slice(&self.velocity_x);
        whole.velocity_z[masses.clone()].copy_from_slice(&self.velocity_z);
        whole.mode[masses.clone()].copy_from_slice(&self.mode);
        whole.surface[masses].copy_from_slice(&self.surface);
        for (mine, theirs) in models.0.rows.iter().zip(&models.1.rows) {
            let start = theirs.range.start + first;
            whole.maxwell[start..start + mine.range.len()].copy_from_slice(&self.maxwell[mine.range.clone()]);
        }
    }
}
