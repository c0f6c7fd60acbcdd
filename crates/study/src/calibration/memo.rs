//! A model that remembers what it found.

use std::collections::HashMap;
use std::fmt::{self, Debug, Formatter};
use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity::element::OperatingPoint;

use super::error::{ModelError, NoSliding};
use super::model::{Done, FrictionModel, Outcome, Task};

/// What is done with an outcome that was not known before, from any thread; says whether to go on.
pub type NewOutcome<'a> = dyn Fn(&Task, &Outcome) -> ControlFlow<()> + Sync + 'a;

/// The bits of a task.
type Key = (Vec<u64>, [u64; 4]);

/// A model that finds nothing twice; what was found elsewhere can be given to it.
pub struct Memo<'a> {
    model: &'a dyn FrictionModel,
    new: &'a NewOutcome<'a>,
    known: Mutex<HashMap<Key, Outcome>>,
}

impl<'a> Memo<'a> {
    /// A model, what is known of it, and what is done with what is new.
    pub fn new(
        model: &'a dyn FrictionModel,
        known: impl IntoIterator<Item = (Task, Outcome)>,
        new: &'a NewOutcome<'a>,
    ) -> Self {
        let known = known.into_iter().map(|(task, outcome)| (key(&task), outcome)).collect();
        Self { model, new, known: Mutex::new(known) }
    }

    fn known(&self) -> MutexGuard<'_, HashMap<Key, Outcome>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn key(task: &Task) -> Key {
    let OperatingPoint { speed, load, temperature, way } = task.point;
    let point = [speed, load, temperature.unwrap_or(f64::NAN), way.unwrap_or(f64::NAN)];
    (task.parameters.iter().map(|value| value.to_bits()).collect(), point.map(f64::to_bits))
}

impl FrictionModel for Memo<'_> {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        // Of the same tasks one is found.
        let mut missing: Vec<usize> = Vec::new();
        let mut asked = std::collections::HashSet::new();
        for (index, task) in tasks.iter().enumerate() {
            let key = key(task);
            if !self.known().contains_key(&key) && asked.insert(key) {
                missing.push(index);
            }
        }
        let wanted: Vec<Task> = missing.iter().map(|&index| tasks[index].clone()).collect();
        self.model.evaluate(&wanted, &|index, outcome| {
            if (self.new)(&wanted[index], &outcome).is_break() {
                return Err(ModelError::Stopped);
            }
            self.known().insert(key(&wanted[index]), outcome);
            Ok(())
        })?;
        tasks.iter().enumerate().try_for_each(|(index, task)| {
            let found = self.known().get(&key(task)).cloned();
            let outcome = found.unwrap_or_else(|| Err(NoSliding::new("the model gave no friction")));
            done(index, outcome)
        })
    }

    fn step(&self) -> f64 {
        self.model.step()
    }
}

impl Debug for Memo<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Memo").field("known", &self.known().len()).finish_non_exhaustive()
    }
}
