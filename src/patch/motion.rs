//! The motion of a patch over a step: its pose runs straight, and so does the speed of its tread.
//!
//! The contact law sees that speed. The way of the tread is even where its speed changes by little, as given cases
//! have it, and of second order else.

use crate::math::Number;

/// Largest turn of a substep, rad.
const MAX_TURN: f64 = 0.1;

/// Largest change of the logarithm of the slip in a substep, where the tread's speed changes.
const MAX_SLIP_CHANGE: f64 = 0.5;

/// Share of its mean speed up to which the tread's speed may change in a step through which the tread runs evenly: no
/// cell is then off its way by more than a hundredth of the tread's way in the step.
const MAX_EVEN_CHANGE: f64 = 0.082;

/// Keeps quotients of numbers that vanish together finite.
pub(super) const TINY: f64 = 1e-300;

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
    /// Its mean speed, m/s.
    pub(super) mean_speed: f64,
    /// How much faster it is at the end than at the start, m/s.
    pub(super) speed_change: f64,
    /// Four times the number of cells by which it is behind an even motion in the middle of the step.
    pub(super) bend: f64,
}

impl TreadMotion {
    /// The tread's motion in a step of `duration` (s) from and to a speed (m/s), in cells of a length (m), of which the
    /// part `start` has entered. One that turns within the step runs evenly, as does one whose speed changes by little.
    pub(super) fn new(start: f64, speeds: [f64; 2], duration: f64, cell: f64) -> Self {
        let mean_speed = 0.5 * (speeds[0] + speeds[1]);
        let speed_change = speeds[1] - speeds[0];
        let is_even = speed_change.abs() <= MAX_EVEN_CHANGE * mean_speed.abs() || speeds[0] * speeds[1] < 0.0;
        let bend = if is_even { 0.0 } else { 0.5 * speed_change * duration / cell };
        Self { start, travel: mean_speed * duration / cell, mean_speed, speed_change, bend }
    }

    /// The cells that have entered after a fraction of the step, negative where the tread runs backwards.
    pub(super) fn entered_at(self, fraction: f64) -> f64 {
        self.start + self.travel * fraction - self.bend * fraction * (1.0 - fraction)
    }

    /// The speed after a fraction of the step, m/s.
    pub(super) fn speed_at(self, fraction: f64) -> f64 {
        self.mean_speed + self.speed_change * (fraction - 0.5)
    }

    /// By how many cells the tread goes on in a part of the step.
    pub(super) fn travel_in(self, part: Substep) -> f64 {
        self.travel * part.length() + self.bend * part.length() * (part.begin + part.end - 1.0)
    }

    /// The fraction of the step after which so many cells have entered since its start.
    fn fraction_of(self, cells: f64) -> f64 {
        if self.bend == 0.0 {
            return cells / self.travel;
        }
        // bend f² + (travel - bend) f = cells, both terms of one sign.
        let first = self.travel - self.bend;
        let root = (first * first + 4.0 * self.bend * cells).max(0.0).sqrt().copysign(self.travel);
        2.0 * cells / (first + root)
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
    const WHOLE: Self = Self { begin: 0.0, end: 1.0 };

    /// The fraction of the step that it takes.
    pub(super) fn length(self) -> f64 {
        self.end - self.begin
    }
}

/// How the slip of a tread runs over a step in which its speed changes: friction follows the logarithm of it, down to a
/// speed below which it is the same or the slip across is what counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlipCourse {
    /// The slip along the tread at the start and at the end, m/s.
    pub(super) speeds: [f64; 2],
    /// That speed, m/s.
    pub(super) least: f64,
}

impl SlipCourse {
    /// ln of the slip where that is large, the slip over the least one where it is small.
    fn scale_at(self, fraction: f64) -> f64 {
        let [start, end] = self.speeds;
        ((start + (end - start) * fraction) / self.least).asinh()
    }

    fn scale_in(self, stretch: Substep) -> f64 {
        (self.scale_at(stretch.end) - self.scale_at(stretch.begin)).abs()
    }

    /// The fraction of the step at which a share of the change of the scale over a stretch is done.
    fn between(self, stretch: Substep, share: f64) -> f64 {
        let [start, end] = self.speeds;
        let (from, to) = (self.scale_at(stretch.begin), self.scale_at(stretch.end));
        let slip = self.least * (from + (to - from) * share).sinh();
        ((slip - start) / (end - start)).clamp(stretch.begin, stretch.end)
    }
}

/// The substeps of a step: it is cut where a cell of the tread begins to enter, and each stretch between two cuts is
/// divided evenly, so that the body turns little in a substep, or as the slip changes, so that friction changes little.
#[derive(Clone, Copy, Debug)]
pub(super) struct Substeps {
    tread: TreadMotion,
    cuts: Cuts,
    /// How far the body turns over the step, rad.
    turn: f64,
    /// The slip of the tread, where it changes.
    slip: Option<SlipCourse>,
    /// How many times as many substeps as needed are taken.
    refine: f64,
}

impl Substeps {
    pub(super) fn new(tread: TreadMotion, turn: f64, slip: Option<SlipCourse>, refine: u32) -> Self {
        Self { tread, cuts: tread.cuts(), turn, slip, refine: f64::from(refine) }
    }

    /// The fraction of the step at the end of stretch `i`, counted from 0.
    fn end_of_stretch(&self, i: f64) -> f64 {
        let Cuts { count, first, spacing } = self.cuts;
        if i >= count { 1.0 } else { self.tread.fraction_of(first + spacing * i - self.tread.start).clamp(0.0, 1.0) }
    }

    /// The number of substeps of a stretch.
    fn count_in(&self, stretch: Substep) -> f64 {
        let by_slip = self.slip.map_or(0.0, |slip| slip.scale_in(stretch) / MAX_SLIP_CHANGE);
        self.refine * (self.turn * stretch.length() / MAX_TURN).max(by_slip).ceil().max(1.0)
    }

    /// The end of substep `i` of `count` of a stretch, from 0: evenly or, where the slip changes, as the slip does.
    fn end_in(&self, stretch: Substep, i: f64, count: f64) -> f64 {
        match self.slip {
            _ if i == count => stretch.end,
            Some(slip) => slip.between(stretch, i / count),
            None => stretch.begin + stretch.length() * (i / count),
        }
    }

    /// The number of substeps; where that is more than `most`, a lower bound above `most`.
    pub(super) fn count(&self, most: f64) -> f64 {
        let by_slip = self.slip.map_or(0.0, |slip| slip.scale_in(Substep::WHOLE) / MAX_SLIP_CHANGE);
        let least = self.refine * (self.cuts.count + 1.0).max(self.turn / MAX_TURN).max(by_slip);
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
            let begin = if done == 0.0 { stretch.begin } else { all.end_in(stretch, done, count) };
            done += 1.0;
            Some(Substep { begin, end: all.end_in(stretch, done, count) })
        })
    }
}

/// Whether a velocity turns by more than a right angle: it has been at rest, or nearly, where friction may be another.
#[inline(always)]
pub(super) fn reverses<T: Number>(from: [T; 2], to: [T; 2]) -> bool {
    (from[0] * to[0] + from[1] * to[1]).value() < 0.0
}

/// The size of a vector.
#[inline(always)]
pub(super) fn size<T: Number>(v: [T; 2]) -> T {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

/// The tangent of half the angle between two velocities, at most 1: where a motion turns by more than a right angle it
/// passes near a stop, and which way it points meanwhile is not known.
#[inline(always)]
pub(super) fn half_turn<T: Number>(from: [T; 2], to: [T; 2]) -> T {
    let cross = from[0] * to[1] - from[1] * to[0];
    let dot = from[0] * to[0] + from[1] * to[1];
    let square = |v: [T; 2]| v[0] * v[0] + v[1] * v[1];
    let sizes = (square(from) * square(to)).sqrt();
    let tangent = cross / (dot + sizes + T::constant(TINY));
    tangent.larger(T::constant(-1.0)).smaller(T::constant(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Dual;

    fn substeps(start: f64, travel: f64, turn: f64, refine: u32) -> Vec<(f64, f64)> {
        let tread = TreadMotion { start, travel, ..TreadMotion::default() };
        let substeps = Substeps::new(tread, turn, None, refine);
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

    /// A tread whose speed goes from 1 to 3 m/s: cells enter where its way says, and its slip to a body at 3 m/s falls by
    /// the same factor in all substeps but those near rest.
    #[test]
    fn a_speed_that_changes_is_followed_straight() {
        let tread = TreadMotion::new(0.25, [1.0, 3.0], 2.0, 0.5);
        assert_eq!(
            (tread.travel, tread.entered_at(1.0), tread.speed_at(0.0), tread.speed_at(1.0)),
            (8.0, 8.25, 1.0, 3.0)
        );
        // ∫ (1 + 2 f) 2 s df / 0.5 m at a half: 3 cells.
        assert!((tread.entered_at(0.5) - 3.25).abs() < 1e-14);
        let slip = SlipCourse { speeds: [2.0, 0.0], least: 1e-3 };
        let all: Vec<_> = Substeps::new(tread, 0.0, Some(slip), 1).iter().collect();
        assert!(all.windows(2).all(|pair| pair[0].end == pair[1].begin && pair[0].begin < pair[0].end));
        for whole in 1..=8 {
            let cut = all
                .iter()
                .map(|part| tread.entered_at(part.end))
                .find(|entered| (entered - f64::from(whole)).abs() < 1e-12);
            assert!(cut.is_some(), "{whole}");
        }
        assert!(all.iter().all(|&part| slip.scale_in(part) <= MAX_SLIP_CHANGE * (1.0 + 1e-9)));
        let way: f64 = all.iter().map(|&part| tread.travel_in(part)).sum();
        assert!((way - tread.travel).abs() < 1e-13);
        // One that turns, and one whose speed changes by little, run evenly; the law sees their speeds.
        for speeds in [[-1.0, 1.0], [1.0, 1.08]] {
            let tread = TreadMotion::new(0.0, speeds, 1.0, 1.0);
            assert_eq!((tread.bend, tread.speed_at(0.0)), (0.0, speeds[0]));
            assert!((tread.speed_at(1.0) - speeds[1]).abs() < 1e-15);
        }
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
