//! Comparing two runs of what should be the same, where that has a meaning.
//!
//! Masses that strike and slip may be sensitive: of two runs whose errors are within the tolerance one strikes an
//! asperity that the other one passes, and from there on they are different motions, both right. So a run is compared
//! only as far as it agrees with itself when it is computed a little otherwise.

use std::cell::Cell;
use std::f64::consts::TAU;

use asperity::model::Model;
use asperity::outputs::Output;
use asperity::scene::Path;
use asperity::simulation::SimulationError;
use proptest::test_runner::{TestCaseError, TestCaseResult};

use crate::common::largest;
use crate::physics::invariants::case::{Case, Record};

/// By how many units two runs of the same motion may differ: errors of single steps, of the tolerance each, add up.
const AGREE: f64 = 30.0;

/// By how many units a run and its transformed twin may differ: both have errors, and what is sure of either is sure
/// only within [`AGREE`].
const SAME: f64 = 4.0 * AGREE;

/// What of a run is compared: columns by row, and the unit of each, the error that one step may make of it.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// F_x, F_z, N: they may jump, at an impact or where friction turns.
    pub(crate) forces: Vec<Vec<f64>>,
    pub(crate) force_unit: f64,
    /// Energy lost and put in, J: they go steadily but for impacts.
    pub(crate) energies: Vec<Vec<f64>>,
    pub(crate) energy_unit: f64,
    /// Elongations of the horizontal links, m, and of the vertical ones, by mass: they never jump.
    pub(crate) along_x: Vec<Vec<f64>>,
    pub(crate) along_z: Vec<Vec<f64>>,
    pub(crate) length_unit: f64,
}

/// How large the errors are that the tolerances allow of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units {
    relative: f64,
    /// m.
    absolute: f64,
    /// Largest stiffness against which the absolute tolerance counts, of the whole layer, N/m.
    stiffness: f64,
}

impl Units {
    pub(crate) fn of(case: &Case) -> Self {
        let model = Model::new(&case.scene);
        let frequency = model.stiffest_frequency();
        let damping: f64 = model.links.iter().map(|link| link.damping).sum();
        let one = model.mass_stiffness().max(model.mass * frequency * frequency) + damping * frequency;
        Self {
            relative: case.scene.solver.relative_tolerance,
            absolute: case.scene.absolute_tolerance(),
            stiffness: case.scene.layer.masses as f64 * one,
        }
    }

    /// Of a length of this size, m.
    pub(crate) fn length(&self, size: f64) -> f64 {
        self.relative * size + self.absolute
    }

    /// Of a force of this size, N.
    pub(crate) fn force(&self, size: f64) -> f64 {
        self.relative * size + self.stiffness * self.absolute
    }

    /// Of an energy E of this size, J: a spring K that holds it is off by √(2EK) for every metre.
    pub(crate) fn energy(&self, size: f64) -> f64 {
        let Self { relative, absolute, stiffness } = self;
        relative * size + (2.0 * size * stiffness).sqrt() * absolute + 0.5 * stiffness * absolute * absolute
    }
}

/// The largest energy of a run, J: also what the layer would have if it moved as the carrier does, for speeds are as
/// good as the relative tolerance against the carrier, which need not carry the layer along.
pub(crate) fn largest_energy(case: &Case, record: &Record) -> f64 {
    let energies = [Output::InputEnergy, Output::DissipatedEnergy, Output::KineticEnergy, Output::ElasticEnergy];
    let speed = |path: &Path| path.rate.abs() + (TAU * path.frequency * path.amplitude).abs();
    let fastest = case.motions.iter().flat_map(|motion| [speed(&motion.u), speed(&motion.w)]).fold(0.0, f64::max);
    let carried = case.moving(fastest);
    energies.into_iter().map(|output| record.largest(output)).fold(carried, f64::max)
}

impl Series {
    pub(crate) fn of(case: &Case, record: &Record) -> Self {
        let units = Units::of(case);
        let forces = vec![record.column(Output::ForceX), record.column(Output::ForceZ)];
        let energies = vec![record.column(Output::DissipatedEnergy), record.column(Output::InputEnergy)];
        let elongations = |place: fn(usize) -> Output, rest: &dyn Fn(usize) -> f64, moved: fn(&(f64, f64)) -> f64| {
            let of = |i| {
                let column = record.column(place(i));
                column.iter().zip(&record.carrier).map(|(x, carrier)| x - rest(i) - moved(carrier)).collect()
            };
            (0..case.scene.layer.masses).map(of).collect::<Vec<Vec<f64>>>()
        };
        let layer = &case.scene.layer;
        let along_x = elongations(Output::ElementX, &|i| layer.rest_position(i), |carrier| carrier.0);
        let height = |i: usize| layer.clearance + layer.roughness.get(i).copied().unwrap_or(0.0);
        let along_z = elongations(Output::ElementZ, &height, |carrier| carrier.1);
        let most = |columns: &[Vec<f64>]| columns.iter().map(|column| largest(column)).fold(0.0, f64::max);
        // Of places far away some digits are lost.
        let far = record.carrier.iter().map(|carrier| carrier.0.abs()).fold(layer.origin.abs(), f64::max);
        Self {
            force_unit: units.force(most(&forces)),
            energy_unit: units.energy(largest_energy(case, record)),
            length_unit: units.length(most(&along_x).max(most(&along_z))) + f64::EPSILON * far,
            forces,
            energies,
            along_x,
            along_z,
        }
    }

    fn rows(&self) -> usize {
        self.forces[0].len()
    }

    /// Whether what cannot jump is the same in a row, within `allowed` units.
    fn agrees_in(&self, other: &Self, row: usize, allowed: f64) -> bool {
        let near = |a: &[Vec<f64>], b: &[Vec<f64>], unit: f64| {
            a.iter().zip(b).all(|(a, b)| (a[row] - b[row]).abs() <= allowed * unit)
        };
        near(&self.energies, &other.energies, self.energy_unit.max(other.energy_unit))
            && near(&self.along_x, &other.along_x, self.length_unit.max(other.length_unit))
            && near(&self.along_z, &other.along_z, self.length_unit.max(other.length_unit))
    }

    /// The same of the forces.
    fn forces_agree_in(&self, other: &Self, row: usize, allowed: f64) -> bool {
        let unit = allowed * self.force_unit.max(other.force_unit);
        self.forces.iter().zip(&other.forces).all(|(a, b)| (a[row] - b[row]).abs() <= unit)
    }
}

/// A run, and how far it is to be trusted.
#[derive(Debug)]
pub(crate) struct Trusted {
    pub(crate) series: Series,
    /// Rows from the start on.
    sure: usize,
    /// Of these, where the forces are sure too.
    forces: Vec<bool>,
}

/// How a slightly perturbed run is perturbed: by tolerances this many times as large. Its steps fall elsewhere and its
/// errors are others, the motion is the same.
const PERTURBED: [f64; 3] = [0.7, 0.4, 0.15];

impl Trusted {
    /// Runs `case` by `run`, and again perturbed: what comes after the first row in which a slightly perturbed run does
    /// not agree with the unperturbed one is another motion, and a force is sure only where it does not jump
    /// in one run before a row and in the other after it.
    pub(crate) fn where_a_perturbed_run_agrees(
        case: &Case,
        run: impl Fn(&Case) -> Result<Record, SimulationError>,
    ) -> Result<Self, SimulationError> {
        let series = Series::of(case, &run(case)?);
        let (mut sure, mut forces) = (series.rows(), vec![true; series.rows()]);
        for factor in PERTURBED {
            let perturbed = case.with_tolerances_times(factor);
            let other = Series::of(&perturbed, &run(&perturbed)?);
            sure = (0..sure).find(|&row| !series.agrees_in(&other, row, AGREE)).unwrap_or(sure);
            for (row, agree) in forces.iter_mut().enumerate() {
                *agree &= series.forces_agree_in(&other, row, AGREE);
            }
        }
        Ok(Self { series, sure, forces })
    }
}

/// What came of comparing, over all cases.
#[derive(Debug, Default)]
pub(crate) struct Compared {
    rows: Cell<usize>,
    sure: Cell<usize>,
}

impl Compared {
    /// Fails where `other`, what `one` should be, is not in a row that is sure in both.
    pub(crate) fn same(&self, one: &Trusted, other: &Trusted) -> TestCaseResult {
        let sure = one.sure.min(other.sure);
        self.rows.set(self.rows.get() + one.series.rows());
        self.sure.set(self.sure.get() + sure);
        for row in 0..sure {
            let forces = one.forces[row] && other.forces[row];
            let agree = one.series.agrees_in(&other.series, row, SAME)
                && (!forces || one.series.forces_agree_in(&other.series, row, SAME));
            if !agree {
                return Err(TestCaseError::fail(format!(
                    "row {row} of {sure}:\n{}",
                    report(&one.series, &other.series, row)
                )));
            }
        }
        Ok(())
    }

    /// Says how much was compared; fails where that is less than `share` of all rows, for then nothing is shown.
    pub(crate) fn report(&self, name: &str, share: f64) {
        let (sure, rows) = (self.sure.get(), self.rows.get());
        println!("{name}: {sure} of {rows} rows compared");
        assert!(sure as f64 >= share * rows as f64, "only {sure} of {rows} rows could be compared");
    }
}

/// How a row differs, in units.
fn report(one: &Series, other: &Series, row: usize) -> String {
    let off = |what: &str, a: &[Vec<f64>], b: &[Vec<f64>], unit: f64| {
        let off: Vec<String> =
            a.iter().zip(b).map(|(a, b)| format!("{:.1e} {:+.1e}", a[row], (b[row] - a[row]) / unit)).collect();
        format!("{what}: {}\n", off.join(", "))
    };
    off("forces", &one.forces, &other.forces, one.force_unit.max(other.force_unit))
        + &off("energies", &one.energies, &other.energies, one.energy_unit.max(other.energy_unit))
        + &off("along x", &one.along_x, &other.along_x, one.length_unit.max(other.length_unit))
        + &off("along z", &one.along_z, &other.along_z, one.length_unit.max(other.length_unit))
}
