//! The motion of a patch over a step: its pose runs straight, its tread evenly.

use crate::math::Number;

/// Largest turn of a part of a step, rad.
const MAX_TURN: f64 = 0.1;

/// The coordinates of a pose, x, y, z (m), roll, pitch, yaw (rad), as they run straight over a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<T> {
    pub(super) start: [f64; 6],
    /// What they change by, m and rad.
    pub(super) change: [T; 6],
    /// s.
    pub(super) duration: f64,
}

/// A body at an instant of its motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant<T> {
    /// Displacement since the start of the step along x and y, m.
    pub(super) moved: [T; 2],
    /// z, m.
    pub(super) height: T,
    /// From the body's axes to the ground's: R_z(ψ) R_y(θ) R_x(φ).
    pub(super) rotation: [[T; 3]; 3],
    /// Velocity along x and y, m/s.
    velocity: [T; 2],
    /// Angular velocity in the ground's axes, rad/s.
    spin: [T; 3],
}

impl<T: Number> Path<T> {
    /// The body after a share of the step.
    #[inline(always)]
    pub(super) fn at(&self, share: f64) -> Instant<T> {
        let changed = self.change.map(|change| change.times(share));
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
        Instant {
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

impl<T: Number> Instant<T> {
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

/// Where a tread stands and how far it goes, in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Run {
    pub(super) from: f64,
    pub(super) by: f64,
}

impl Run {
    /// The cells that have entered since the start after a share of the step, negative where it goes the other way.
    pub(super) fn at(self, share: f64) -> f64 {
        self.from + self.by * share
    }

    /// The whole cells that enter in the step.
    pub(super) fn entered(self) -> f64 {
        self.at(1.0).floor()
    }

    /// The number of cuts within the step, where a cell begins to enter, and the first and the way to the next.
    fn cuts(self) -> (f64, f64, f64) {
        let to = self.at(1.0);
        if self.by > 0.0 {
            let first = self.from.floor() + 1.0;
            ((to.ceil() - first).max(0.0), first, 1.0)
        } else if self.by < 0.0 {
            let first = self.from.ceil() - 1.0;
            ((first - to.floor()).max(0.0), first, -1.0)
        } else {
            (0.0, 0.0, 0.0)
        }
    }
}

/// The parts of a step: between the instants at which a cell of the tread begins to enter, even parts that turn little.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    run: Run,
    cuts: (f64, f64, f64),
    turn: f64,
    refine: f64,
}

impl Parts {
    pub(super) fn new(run: Run, turn: f64, refine: u32) -> Self {
        Self { run, cuts: run.cuts(), turn, refine: f64::from(refine) }
    }

    /// The share of the step at the end of stretch `i`, counted from 0, between the cuts.
    fn end_of_stretch(&self, i: f64) -> f64 {
        let (count, first, way) = self.cuts;
        if i >= count { 1.0 } else { ((first + way * i - self.run.from) / self.run.by).clamp(0.0, 1.0) }
    }

    fn in_stretch(&self, from: f64, to: f64) -> f64 {
        self.refine * (self.turn * (to - from) / MAX_TURN).ceil().max(1.0)
    }

    /// The number of parts; where that is more than `most`, a lower bound above `most`.
    pub(super) fn count(&self, most: f64) -> f64 {
        let least = self.refine * (self.cuts.0 + 1.0).max(self.turn / MAX_TURN);
        if least.is_nan() || least > most {
            return least;
        }
        let stretch = |i: u32| {
            let from = if i == 0 { 0.0 } else { self.end_of_stretch(f64::from(i) - 1.0) };
            self.in_stretch(from, self.end_of_stretch(f64::from(i)))
        };
        (0..=self.cuts.0 as u32).map(stretch).sum()
    }

    /// The shares of the step at which the parts begin and end.
    pub(super) fn iter(&self) -> impl Iterator<Item = (f64, f64)> {
        let parts = *self;
        let mut stretch = 0.0;
        let (mut from, mut to) = (0.0, parts.end_of_stretch(0.0));
        let (mut done, mut count) = (0.0, parts.in_stretch(from, to));
        std::iter::from_fn(move || {
            if done == count {
                if stretch == parts.cuts.0 {
                    return None;
                }
                stretch += 1.0;
                (from, to) = (to, parts.end_of_stretch(stretch));
                (done, count) = (0.0, parts.in_stretch(from, to));
            }
            let at = |part: f64| if part == count { to } else { from + (to - from) * (part / count) };
            done += 1.0;
            Some((at(done - 1.0), at(done)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Dual;

    fn shares(run: Run, turn: f64, refine: u32) -> Vec<(f64, f64)> {
        let parts = Parts::new(run, turn, refine);
        let shares: Vec<_> = parts.iter().collect();
        assert_eq!(shares.len() as f64, parts.count(1e5));
        shares
    }

    #[test]
    fn parts_end_where_cells_enter_and_follow_each_other() {
        assert_eq!(shares(Run::default(), 0.0, 1), [(0.0, 1.0)]);
        assert_eq!(shares(Run::default(), 0.15, 2).len(), 4);
        assert_eq!(shares(Run { from: 0.5, by: 1.0 }, 0.0, 1), [(0.0, 0.5), (0.5, 1.0)]);
        assert_eq!(shares(Run { from: 0.5, by: -1.0 }, 0.0, 1), [(0.0, 0.5), (0.5, 1.0)]);
        assert_eq!(shares(Run { from: 0.0, by: 2.0 }, 0.0, 1), [(0.0, 0.5), (0.5, 1.0)]);
        assert_eq!(shares(Run { from: 0.25, by: -0.25 }, 0.0, 1), [(0.0, 1.0)]);
        let parts = shares(Run { from: 0.3, by: 7.9 }, 1.3, 3);
        assert!(parts.windows(2).all(|pair| pair[0].1 == pair[1].0 && pair[0].1 > pair[0].0));
        assert_eq!((parts[0].0, parts[parts.len() - 1].1), (0.0, 1.0));
    }

    /// Velocities against difference quotients of positions, at large angles.
    #[test]
    fn velocities_are_those_of_the_path() {
        let path =
            Path { start: [0.1, -0.2, 0.3, 0.7, -0.9, 2.0], change: [0.4, 0.5, -0.1, 0.6, 0.8, -0.7], duration: 0.5 };
        let (r, h) = ([0.3, -0.4, 0.2], 1e-5);
        let place = |share: f64| {
            let at = path.at(share);
            let [x, y, _] = at.turned(r);
            [at.moved[0] + x, at.moved[1] + y]
        };
        let now = path.at(0.4);
        let found = now.velocity(now.turned(r));
        for i in 0..2 {
            let quotient = (place(0.4 + h)[i] - place(0.4 - h)[i]) / (2.0 * h * path.duration);
            // h² times a third derivative of some 1.
            assert!((found[i] - quotient).abs() < 1e-8, "{found:?} {quotient}");
        }
    }

    /// Derivatives by the targets: what a target moves shows in proportion to the share of the step.
    #[test]
    fn targets_move_the_body() {
        let dual = |i| Dual::<6>::variable(0.1, i);
        let path = Path { start: [0.0; 6], change: std::array::from_fn(dual), duration: 2.0 };
        let at = path.at(0.25);
        assert_eq!(at.height.slopes, [0.0, 0.0, 0.25, 0.0, 0.0, 0.0]);
        assert_eq!(at.velocity[1].slopes, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    }
}
