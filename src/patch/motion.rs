//! The motion of a patch over a step: its pose runs straight, its tread evenly.

use crate::math::Number;

/// Largest turn of a substep, rad.
const MAX_TURN: f64 = 0.1;

/// The coordinates of a pose, x, y, z (m), roll, pitch, yaw (rad), as they run straight over a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseMotion<T> {
    /// The coordinates at the start of the step, m and rad.
    pub(super) start: [f64; 6],
    /// What they change by over the step, m and rad.
    pub(super) change: [T; 6],
    /// How long the step takes, s.
    pub(super) duration: f64,
}

/// A body at an instant of its motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyKinematics<T> {
    /// Displacement since the start of the step along x and y, m.
    pub(super) moved: [T; 2],
    /// z of the pose's point, m.
    pub(super) height: T,
    /// From the body's axes to the ground's: R_z(ψ) R_y(θ) R_x(φ).
    pub(super) rotation: [[T; 3]; 3],
    /// Velocity along x and y, m/s.
    velocity: [T; 2],
    /// Angular velocity in the ground's axes, rad/s.
    spin: [T; 3],
}

impl<T: Number> PoseMotion<T> {
    /// The body after a fraction of the step.
    #[inline(always)]
    pub(super) fn at(&self, fraction: f64) -> BodyKinematics<T> {
        let changed = self.change.map(|change| change.times(fraction));
        let [roll, pitch, yaw] = [3, 4, 5].map(|i| T::constant(self.start[i]) + changed[i]);
        let (sin_roll, cos_roll) = roll.sin_cos();
        let (sin_pitch, cos_pitch) = pitch.sin_cos();
        let (sin_yaw, cos_yaw) = yaw.sin_cos();
        let rotation = [
            [
                cos_yaw * cos_pitch,
                cos_yaw * sin_pitch * sin_roll - sin_yaw * cos_roll,
                cos_yaw * sin_pitch * cos_roll + sin_yaw * sin_roll,
            ],
            [
                sin_yaw * cos_pitch,
                sin_yaw * sin_pitch * sin_roll + cos_yaw * cos_roll,
                sin_yaw * sin_pitch * cos_roll - cos_yaw * sin_roll,
            ],
            [-sin_pitch, cos_pitch * sin_roll, cos_pitch * cos_roll],
        ];
        let [v_x, v_y, _, roll_rate, pitch_rate, yaw_rate] =
            self.change.map(|change| change.times(1.0 / self.duration));
        BodyKinematics {
            moved: [changed[0], changed[1]],
            height: T::constant(self.start[2]) + changed[2],
            velocity: [v_x, v_y],
            spin: [
                rotation[0][0] * roll_rate - sin_yaw * pitch_rate,
                rotation[1][0] * roll_rate + cos_yaw * pitch_rate,
                yaw_rate + rotation[2][0] * roll_rate,
            ],
            rotation,
        }
    }

    /// How far it turns, rad: |Δφ| + |Δθ| + |Δψ|.
    pub(super) fn turn(&self) -> f64 {
        self.change[3..].iter().map(|change| change.value().abs()).sum()
    }
}

impl<T: Number> BodyKinematics<T> {
    /// A vector of the body's axes in the ground's.
    #[inline(always)]
    pub(super) fn turned(&self, r: [f64; 3]) -> [T; 3] {
        let [a, b, c] = &self.rotation;
        let row = |row: &[T; 3]| row[0].times(r[0]) + row[1].times(r[1]) + row[2].times(r[2]);
        [row(a), row(b), row(c)]
    }

    /// The velocity along the plane of what is fixed to the body at `arm` (m), in the ground's axes.
    #[inline(always)]
    pub(super) fn velocity(&self, arm: [T; 3]) -> [T; 2] {
        let [spin_x, spin_y, spin_z] = self.spin;
        let [x, y, z] = arm;
        [self.velocity[0] + spin_y * z - spin_z * y, self.velocity[1] + spin_z * x - spin_x * z]
    }
}

/// How a tread runs through its face over a step, in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TreadMotion {
    /// The part of a cell that has entered at the start.
    pub(super) start: f64,
    /// By how many cells the tread goes on, negative where it runs backwards.
    pub(super) travel: f64,
}

impl TreadMotion {
    /// The cells that have entered after a fraction of the step, negative where the tread runs backwards.
    pub(super) fn entered_at(self, fraction: f64) -> f64 {
        self.start + self.travel * fraction
    }

    /// The whole cells that enter in the step.
    pub(super) fn whole_cells(self) -> f64 {
        self.entered_at(1.0).floor()
    }

    fn cuts(self) -> Cuts {
        let end = self.entered_at(1.0);
        if self.travel > 0.0 {
            let first = self.start.floor() + 1.0;
            Cuts { count: (end.ceil() - first).max(0.0), first, spacing: 1.0 }
        } else if self.travel < 0.0 {
            let first = self.start.ceil() - 1.0;
            Cuts { count: (first - end.floor()).max(0.0), first, spacing: -1.0 }
        } else {
            Cuts { count: 0.0, first: 0.0, spacing: 0.0 }
        }
    }
}

/// The instants within a step at which a cell of the tread begins to enter, by the cells that have entered then.
#[derive(Clone, Copy, Debug)]
struct Cuts {
    count: f64,
    first: f64,
    /// From one to the next: 1, or -1 where the tread runs backwards.
    spacing: f64,
}

/// A substep from one fraction of the step to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Substep {
    pub(super) begin: f64,
    pub(super) end: f64,
}

impl Substep {
    /// The fraction of the step that it takes.
    pub(super) fn length(self) -> f64 {
        self.end - self.begin
    }
}

/// The substeps of a step: it is cut where a cell of the tread begins to enter, and each stretch between two cuts is
/// divided evenly, so that the body turns little in a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Substeps {
    tread: TreadMotion,
    cuts: Cuts,
    /// How far the body turns over the step, rad.
    turn: f64,
    /// How many times as many substeps as needed are taken.
    refine: f64,
}

impl Substeps {
    pub(super) fn new(tread: TreadMotion, turn: f64, refine: u32) -> Self {
        Self { tread, cuts: tread.cuts(), turn, refine: f64::from(refine) }
    }

    /// The fraction of the step at the end of stretch `i`, counted from 0.
    fn end_of_stretch(&self, i: f64) -> f64 {
        let Cuts { count, first, spacing } = self.cuts;
        if i >= count { 1.0 } else { ((first + spacing * i - self.tread.start) / self.tread.travel).clamp(0.0, 1.0) }
    }

    /// The number of substeps of a stretch.
    fn count_in(&self, stretch: Substep) -> f64 {
        self.refine * (self.turn * stretch.length() / MAX_TURN).ceil().max(1.0)
    }

    /// The number of substeps; where that is more than `most`, a lower bound above `most`.
    pub(super) fn count(&self, most: f64) -> f64 {
        let least = self.refine * (self.cuts.count + 1.0).max(self.turn / MAX_TURN);
        if least.is_nan() || least > most {
            return least;
        }
        let count = |i: u32| {
            let begin = if i == 0 { 0.0 } else { self.end_of_stretch(f64::from(i) - 1.0) };
            self.count_in(Substep { begin, end: self.end_of_stretch(f64::from(i)) })
        };
        (0..=self.cuts.count as u32).map(count).sum()
    }

    /// The substeps in their order.
    pub(super) fn iter(&self) -> impl Iterator<Item = Substep> {
        let all = *self;
        let mut index = 0.0;
        let mut stretch = Substep { begin: 0.0, end: all.end_of_stretch(0.0) };
        let (mut done, mut count) = (0.0, all.count_in(stretch));
        std::iter::from_fn(move || {
            if done == count {
                if index == all.cuts.count {
                    return None;
                }
                index += 1.0;
                stretch = Substep { begin: stretch.end, end: all.end_of_stretch(index) };
                (done, count) = (0.0, all.count_in(stretch));
            }
            let at = |i: f64| if i == count { stretch.end } else { stretch.begin + stretch.length() * (i / count) };
            done += 1.0;
            Some(Substep { begin: at(done - 1.0), end: at(done) })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Dual;

    fn substeps(start: f64, travel: f64, turn: f64, refine: u32) -> Vec<(f64, f64)> {
        let substeps = Substeps::new(TreadMotion { start, travel }, turn, refine);
        let found: Vec<_> = substeps.iter().map(|substep| (substep.begin, substep.end)).collect();
        assert_eq!(found.len() as f64, substeps.count(1e5));
        found
    }

    #[test]
    fn substeps_end_where_cells_enter_and_follow_each_other() {
        assert_eq!(substeps(0.0, 0.0, 0.0, 1), [(0.0, 1.0)]);
        assert_eq!(substeps(0.0, 0.0, 0.15, 2).len(), 4);
        assert_eq!(substeps(0.5, 1.0, 0.0, 1), [(0.0, 0.5), (0.5, 1.0)]);
        assert_eq!(substeps(0.5, -1.0, 0.0, 1), [(0.0, 0.5), (0.5, 1.0)]);
        assert_eq!(substeps(0.0, 2.0, 0.0, 1), [(0.0, 0.5), (0.5, 1.0)]);
        assert_eq!(substeps(0.25, -0.25, 0.0, 1), [(0.0, 1.0)]);
        let many = substeps(0.3, 7.9, 1.3, 3);
        assert!(many.windows(2).all(|pair| pair[0].1 == pair[1].0 && pair[0].1 > pair[0].0));
        assert_eq!((many[0].0, many[many.len() - 1].1), (0.0, 1.0));
    }

    /// Velocities against difference quotients of positions, at large angles.
    #[test]
    fn velocities_are_those_of_the_motion() {
        let motion = PoseMotion {
            start: [0.1, -0.2, 0.3, 0.7, -0.9, 2.0],
            change: [0.4, 0.5, -0.1, 0.6, 0.8, -0.7],
            duration: 0.5,
        };
        let (r, h) = ([0.3, -0.4, 0.2], 1e-5);
        let position = |fraction: f64| {
            let at = motion.at(fraction);
            let [x, y, _] = at.turned(r);
            [at.moved[0] + x, at.moved[1] + y]
        };
        let now = motion.at(0.4);
        let found = now.velocity(now.turned(r));
        for i in 0..2 {
            let quotient = (position(0.4 + h)[i] - position(0.4 - h)[i]) / (2.0 * h * motion.duration);
            // h² times a third derivative of some 1.
            assert!((found[i] - quotient).abs() < 1e-8, "{found:?} {quotient}");
        }
    }

    /// Derivatives by the targets: what a target moves shows in proportion to the fraction of the step.
    #[test]
    fn targets_move_the_body() {
        let dual = |i| Dual::<6>::variable(0.1, i);
        let motion = PoseMotion { start: [0.0; 6], change: std::array::from_fn(dual), duration: 2.0 };
        let at = motion.at(0.25);
        assert_eq!(at.height.slopes, [0.0, 0.0, 0.25, 0.0, 0.0, 0.0]);
        assert_eq!(at.velocity[1].slopes, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    }
}
