//! One cell: a stressed scene run and judged.

use asperity::scene::Scene;
use cpu_time::ThreadTime;

use super::drive::{Bound, Course, Ran, Stop};
use super::quantity::Place;
use crate::program::report::reference::{DISPLACEMENT, parting};
use crate::program::report::runs::{Counts, at_tolerance, exact};

/// The tight run is so many times as tight.
pub(in crate::program::report) const TIGHTER: f64 = 100.0;
/// Errors of so many times the tolerance are within what was asked for: it bounds the error of a step, which adds up.
pub(in crate::program::report) const WITHIN: f64 = 10.0;
/// Those of more than so many times are looked into: the motion may be sensitive.
pub(in crate::program::report) const NOTABLE: f64 = 100.0;
/// Those of more than so many times are wrong, ...
pub(in crate::program::report) const WRONG: f64 = 1000.0;
/// ... and so is whatever is larger than this share of the largest force.
const WRONG_ANYHOW: f64 = 0.1;
/// What a moved start may do, over the error, for the error to say something of the run.
const SENSITIVE: f64 = 0.1;
/// A stressed scene, run.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::program::report) struct Cell {
    /// What became of the run.
    pub(in crate::program::report) fate: Fate,
    /// Processor time that it took to know, s.
    pub(super) cost: f64,
}

/// What became of a run.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::program::report) enum Fate {
    /// It came to its end.
    Ended {
        /// What it took.
        counts: Counts,
        /// The communication steps that it was to do: each needs one step at least.
        communication_steps: u64,
        /// How right it is.
        check: Check,
    },
    /// It stopped with an error.
    Stopped(String),
    /// It needs more work than its bound, used up at this time, s.
    TooExpensive(f64),
    /// There was no time for it.
    LeftOut,
}

/// The largest difference of F_x or F_z between two runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::program::report) struct Difference {
    /// Over the largest force.
    pub(in crate::program::report) share: f64,
    /// Of which force it is.
    pub(in crate::program::report) of: &'static str,
    /// When, s.
    pub(in crate::program::report) time: f64,
}

/// How right a run is.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::program::report) enum Check {
    /// The difference from the tight run.
    Error(Difference),
    /// The same where the tight run from a start moved by a trifle differs about as much: nobody can tell.
    Sensitive {
        /// The difference from the tight run.
        error: Difference,
        /// What the moved start changes, over the largest force.
        moved: f64,
    },
    /// The tight run did not come to its end, for this reason.
    Unknown(String),
}

/// A cell at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::program::report) enum Status {
    /// At most [`WITHIN`] times the tolerance.
    Within,
    /// At most [`NOTABLE`] times.
    Above,
    /// At most [`WRONG`] times.
    FarAbove,
    /// More than that.
    Wrong,
    /// Nobody can tell.
    Sensitive,
    /// There is nothing to compare with.
    Unknown,
    /// An error.
    Stopped,
    /// More work than the bound.
    TooExpensive,
    /// Not tried.
    LeftOut,
}

impl Cell {
    /// Not tried.
    pub(super) const LEFT_OUT: Self = Self { fate: Fate::LeftOut, cost: 0.0 };

    /// The cell at a glance, of a scene at this relative tolerance.
    pub(super) fn status(&self, tolerance: f64) -> Status {
        match &self.fate {
            Fate::Ended { check: Check::Error(error), .. } => grade(error.share, tolerance),
            Fate::Ended { check: Check::Sensitive { .. }, .. } => Status::Sensitive,
            Fate::Ended { check: Check::Unknown(_), .. } => Status::Unknown,
            Fate::Stopped(_) => Status::Stopped,
            Fate::TooExpensive(_) => Status::TooExpensive,
            Fate::LeftOut => Status::LeftOut,
        }
    }

    /// How right the run is, if it came to its end.
    pub(in crate::program::report) fn check(&self) -> Option<&Check> {
        match &self.fate {
            Fate::Ended { check, .. } => Some(check),
            _ => None,
        }
    }

    /// What the run took, if it came to its end.
    pub(in crate::program::report) fn counts(&self) -> Option<&Counts> {
        match &self.fate {
            Fate::Ended { counts, .. } => Some(counts),
            _ => None,
        }
    }
}

fn grade(error: f64, tolerance: f64) -> Status {
    match error {
        error if error <= WITHIN * tolerance => Status::Within,
        error if error > WRONG * tolerance || error > WRONG_ANYHOW || error.is_nan() => Status::Wrong,
        error if error <= NOTABLE * tolerance => Status::Above,
        _ => Status::FarAbove,
    }
}

impl Check {
    /// The difference from the tight run, if there is one.
    pub(in crate::program::report) fn error(&self) -> Option<Difference> {
        match self {
            Self::Error(error) | Self::Sensitive { error, .. } => Some(*error),
            Self::Unknown(_) => None,
        }
    }

    /// What a moved start changes, where that is as much.
    pub(in crate::program::report) fn moved(&self) -> Option<f64> {
        match self {
            Self::Sensitive { moved, .. } => Some(*moved),
            _ => None,
        }
    }
}

impl Status {
    /// In a word of the table.
    pub(in crate::program::report) fn name(self) -> &'static str {
        match self {
            Self::Within => "kept",
            Self::Above => "above",
            Self::FarAbove => "far above",
            Self::Wrong => "wrong",
            Self::Sensitive => "sensitive",
            Self::Unknown => "unknown",
            Self::Stopped => "stopped",
            Self::TooExpensive => "too expensive",
            Self::LeftOut => "left out",
        }
    }
}

/// What all cells share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Runner<'a> {
    /// The scene without stress; no force ends its phases.
    pub(super) scene: &'a Scene,
    /// Rows of a phase.
    pub(super) points: u32,
    /// The most work of a run, but for what a master's steps need.
    pub(super) bound: u64,
    /// How many times the bound the tight run may take.
    pub(super) patience: u64,
}

impl Runner<'_> {
    /// Runs the scene at a place.
    pub(super) fn run(&self, place: Place) -> Cell {
        let clock = ThreadTime::now();
        let fate = match place.stress(self.scene, self.points) {
            Ok((scene, course)) => self.fate(&scene, course),
            Err(refused) => Fate::Stopped(refused.to_string()),
        };
        Cell { fate, cost: clock.elapsed().as_secs_f64() }
    }

    fn fate(&self, scene: &Scene, course: Course) -> Fate {
        let communication_steps = course.steps(scene);
        let bound = self.bound.saturating_add(2 * communication_steps);
        match course.run(scene, 0.0, Bound(bound)) {
            Err(Stop::TooMuchWork(time)) => Fate::TooExpensive(time),
            Err(Stop::Failed(reason)) => Fate::Stopped(reason),
            Ok(ran) => {
                let check = self.check(scene, course, &ran, bound);
                Fate::Ended { counts: ran.counts, communication_steps, check }
            }
        }
    }

    /// Compares a run with a tight one.
    fn check(&self, scene: &Scene, course: Course, ran: &Ran, bound: u64) -> Check {
        let tolerance = scene.solver.relative_tolerance;
        let tight_scene = exact(&at_tolerance(scene, tolerance / TIGHTER));
        let bound = Bound(self.patience.saturating_mul(bound));
        let tight = match course.run(&tight_scene, 0.0, bound) {
            Ok(tight) => tight,
            Err(Stop::Failed(reason)) => return Check::Unknown(reason),
            Err(Stop::TooMuchWork(_)) => return Check::Unknown(format!("more than {} steps", bound.0)),
        };
        let error = Difference::new(ran, &tight);
        if error.share <= NOTABLE * tolerance {
            return Check::Error(error);
        }
        let moved = course.run(&tight_scene, DISPLACEMENT, bound);
        let moved = moved.map_or(0.0, |moved| Difference::new(&moved, &tight).share);
        let sensitive = moved > parting(scene).max(SENSITIVE * error.share);
        if sensitive { Check::Sensitive { error, moved } } else { Check::Error(error) }
    }
}

impl Difference {
    /// Between a run and a tight one that has the same rows.
    fn new(ran: &Ran, tight: &Ran) -> Self {
        let forces = ["F_x", "F_z"].into_iter().enumerate();
        let largest = tight.rows.iter().flat_map(|row| &row[..2]).fold(0.0, |most, force| larger(most, force.abs()));
        let mut found = Self { share: 0.0, of: "F_z", time: tight.times.first().copied().unwrap_or_default() };
        for ((row, wanted), &time) in ran.rows.iter().zip(&tight.rows).zip(&tight.times) {
            for (i, of) in forces.clone() {
                let difference = (row[i] - wanted[i]).abs();
                // What is not a number is infinitely wrong; two runs without forces are alike.
                let share = if difference == 0.0 { 0.0 } else { larger(0.0, difference / largest) };
                if share > found.share {
                    found = Self { share, of, time };
                }
            }
        }
        found
    }
}

/// What is not a number counts as infinite.
fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ran(rows: &[[f64; 3]]) -> Ran {
        let times = (0..rows.len()).map(|i| i as f64).collect();
        Ran { rows: rows.to_vec(), times, counts: Counts::default() }
    }

    #[test]
    fn a_difference_is_a_share_of_the_largest_force() {
        let wanted = [[0.0, 1.0, 5.0], [-4.0, 2.0, 6.0]];
        let between = |rows: &[[f64; 3]], tight: &[[f64; 3]]| Difference::new(&ran(rows), &ran(tight));
        let found = between(&[[0.0, 1.0, 9.0], [-4.0, 3.0, 9.0]], &wanted);
        assert_eq!(found, Difference { share: 0.25, of: "F_z", time: 1.0 });
        assert_eq!(between(&wanted, &wanted).share, 0.0);
        assert_eq!(between(&[[0.0; 3]; 2], &[[0.0; 3]; 2]).share, 0.0);
        assert_eq!(between(&[[1.0, 0.0, 0.0]], &[[0.0; 3]]).share, f64::INFINITY);
        let nowhere = between(&[[f64::NAN, 1.0, 5.0], wanted[1]], &wanted);
        assert_eq!(nowhere, Difference { share: f64::INFINITY, of: "F_x", time: 0.0 });
    }

    #[test]
    fn grades_follow_the_tolerance() {
        let grades = [9e-6, 9e-5, 9e-4, 1e-2, f64::INFINITY, f64::NAN].map(|error| grade(error, 1e-6));
        assert_eq!(
            grades,
            [Status::Within, Status::Above, Status::FarAbove, Status::Wrong, Status::Wrong, Status::Wrong]
        );
        // A loose tolerance asks for little, but not for nothing.
        assert_eq!([0.05, 0.2].map(|error| grade(error, 1e-2)), [Status::Within, Status::Wrong]);
        assert_eq!([0.05, 0.2].map(|error| grade(error, 3e-3)), [Status::Above, Status::Wrong]);
    }
}
