//! The carrier's motion: prescribed along an axis, or that of a body there.

use serde::{Deserialize, Serialize};

use super::{EndForces, Forces, Model};
use crate::math::Spline;
use crate::scene::{Axis, ByAxis, Force, Path, Scene};

/// The carrier on a smooth piece of its motion. Displacements are counted from the start of the piece, so that a carrier
/// far away loses no digits but those of u itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Carrier {
    /// Time at the start of the piece, s.
    pub time: f64,
    /// u at the start of the piece, m.
    pub u: f64,
    /// w at the start of the piece, m.
    pub w: f64,
    /// u at the start of the piece as a position on the profile, m: reduced to its period if it is periodic.
    pub profile_position: f64,
    /// The path of u, or that of the drive of a body.
    u_path: Path,
    /// The path of w, or that of the drive of a body.
    w_path: Path,
    /// The bodies along x and z; `None` where the displacement is prescribed.
    bodies: ByAxis<Option<BodyMotion>>,
    /// What acts on the ends of a part of a layer; `None` for a whole layer.
    #[serde(skip)]
    pub ends: Option<EndForces>,
}

/// The carrier at one instant of a piece.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CarrierPoint {
    /// u minus u at the start of the piece, m.
    pub du: f64,
    /// w minus w at the start of the piece, m.
    pub dw: f64,
    /// u̇, m/s.
    pub u_rate: f64,
    /// ẇ, m/s.
    pub w_rate: f64,
    /// ü, m/s².
    pub u_acceleration: f64,
    /// ẅ, m/s².
    pub w_acceleration: f64,
    /// What acts on the first and on the last mass from beyond a part of a layer, along x and z, N; 0 for a whole
    /// layer.
    #[serde(skip)]
    pub ends: [[f64; 2]; 2],
}

impl CarrierPoint {
    /// Displacement since the start of the piece (m), speed (m/s) and acceleration (m/s²) along an axis.
    pub fn along(&self, axis: Axis) -> [f64; 3] {
        match axis {
            Axis::X => [self.du, self.u_rate, self.u_acceleration],
            Axis::Z => [self.dw, self.w_rate, self.w_acceleration],
        }
    }

    /// Sets the same.
    pub fn set_along(&mut self, axis: Axis, [displacement, rate, acceleration]: [f64; 3]) {
        match axis {
            Axis::X => (self.du, self.u_rate, self.u_acceleration) = (displacement, rate, acceleration),
            Axis::Z => (self.dw, self.w_rate, self.w_acceleration) = (displacement, rate, acceleration),
        }
    }
}

/// Position of the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarrierPosition {
    /// u as a position on the profile, reduced to its period, m.
    pub profile_position: f64,
    /// w, m.
    pub w: f64,
}

/// The carrier as a body along one axis: what does not change through a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Mass M, kg.
    pub mass: f64,
    /// Stiffness K of the spring to the drive, N/m.
    pub stiffness: f64,
    /// Damping D of the damper to the drive, N s/m.
    pub damping: f64,
    /// Constant part of the tangential force P or of the load N, N.
    pub force: f64,
}

impl Body {
    /// The bodies of `scene` along x and z.
    pub(super) fn along_axes(scene: &Scene) -> ByAxis<Option<Self>> {
        ByAxis::from_fn(|axis| {
            let body = scene.carrier[axis].as_ref()?;
            let force = match axis {
                Axis::X => body.pull,
                Axis::Z => body.load,
            };
            let or_zero = |value: Option<f64>| value.unwrap_or(0.0);
            let (stiffness, damping) = (or_zero(body.stiffness), or_zero(body.damping));
            Some(Self { mass: body.mass, stiffness, damping, force: or_zero(force) })
        })
    }
}

/// The motion of a body along one axis on a smooth piece: where it stands at the start of a step, how it moves through
/// the step tried last, and what acts on it from outside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct BodyMotion {
    /// Start of the step, s after the start of the piece.
    s: f64,
    /// Displacement since the start of the piece (m), speed (m/s) and acceleration (m/s²) there.
    start: [f64; 3],
    /// The step tried last; none between motions.
    #[serde(skip)]
    step: BodyStep,
    /// Displacement of the drive at the start of the piece, m.
    drive: f64,
    /// Load or tangential force at the start of the piece without its constant part, N.
    force: f64,
    /// Its change from there, N.
    force_path: Path,
}

/// A body's motion through a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyStep {
    /// No step was tried from here.
    #[default]
    None,
    /// Its speed as a polynomial in the fraction of a step.
    Polynomial {
        /// Length of the step, s.
        length: f64,
        /// Coefficients of 1, θ, … θ⁴, m/s.
        speed: [f64; 5],
    },
    /// Its displacement as a parabola, and its speed linear from the start to a first stage and from there to the end.
    TwoStages {
        /// Length of the step, s.
        length: f64,
        /// The fraction of the step at which the first stage lies.
        node: f64,
        /// Coefficients of θ and θ² of the displacement, m.
        displacement: [f64; 2],
        /// Speed at the first stage and at the end, m/s.
        speed: [f64; 2],
    },
}

/// What acts on a body from outside the layer at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outside {
    /// P or -N along the axis, N.
    pub force: f64,
    /// Displacement of the drive since the start of the piece, m, and its speed, m/s.
    pub drive: [f64; 2],
    /// Displacement of the body from where the drive was at the start of the piece, m, and its speed, m/s.
    pub body: [f64; 2],
}

/// Energies of the bodies, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyEnergy {
    /// T_c = ½ M_x u̇² + ½ M_z ẇ².
    pub kinetic: f64,
    /// V_c, of the springs to the drives.
    pub elastic: f64,
}

impl BodyEnergy {
    /// T_c + V_c, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic
    }
}

impl Outside {
    /// Elongation of the drive's spring, m, and its rate, m/s: those of the body less the drive's.
    pub fn stretch(&self) -> [f64; 2] {
        [self.body[0] - self.drive[0], self.body[1] - self.drive[1]]
    }

    /// R, the drive's force on the body, N.
    pub fn drive_force(&self, body: &Body) -> f64 {
        let [stretch, rate] = self.stretch();
        -(body.stiffness * stretch + body.damping * rate)
    }

    /// The power of the load and of the drive into the body, W.
    pub fn input(&self, body: &Body) -> f64 {
        self.force * self.body[1] + self.drive_force(body) * self.drive[1]
    }

    /// The power lost in the damper to the drive, W.
    pub fn lost(&self, body: &Body) -> f64 {
        body.damping * self.stretch()[1].powi(2)
    }
}

impl BodyMotion {
    fn motion(&self, s: f64) -> [f64; 3] {
        let [displacement, rate, acceleration] = self.start;
        let of_step = |length: f64| ((s - self.s) / length, length);
        match self.step {
            _ if s <= self.s => self.start,
            BodyStep::None => [displacement + (s - self.s) * rate, rate, acceleration],
            BodyStep::Polynomial { length, speed } => {
                let (theta, h) = of_step(length);
                let sum = |term: fn(usize, f64) -> f64| {
                    (0..speed.len()).rev().fold(0.0, |sum, power| sum * theta + term(power, speed[power]))
                };
                let moved = h * theta * sum(|power, c| c / (power + 1) as f64);
                let slope = (1..speed.len()).rev().fold(0.0, |sum, power| sum * theta + power as f64 * speed[power]);
                [displacement + moved, sum(|_, c| c), slope / h]
            }
            BodyStep::TwoStages { length, node, displacement: [linear, square], speed } => {
                let (theta, h) = of_step(length);
                let moved = theta * (linear + theta * square);
                let (from, to, share, span) = if theta < node {
                    (rate, speed[0], theta / node, node)
                } else {
                    (speed[0], speed[1], (theta - node) / (1.0 - node), 1.0 - node)
                };
                [displacement + moved, from + share * (to - from), (to - from) / (span * h)]
            }
        }
    }

    /// All its numbers, to be checked.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let Path { rate, amplitude, frequency } = self.force_path;
        let others = [self.s, self.drive, self.force, rate, amplitude, frequency];
        self.start.into_iter().chain(others)
    }
}

/// A new piece of the carrier's motion.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// The paths of u and w, or of the drives of a body.
    pub paths: (Path, Path),
    /// The tangential force on a body along x and the load on one along z, without their constant parts.
    pub forces: (Force, Force),
}

/// Where a body starts.
#[derive(Clone, Copy, Debug)]
pub struct BodyStart {
    /// Displacement, m.
    pub displacement: f64,
    /// Speed, m/s.
    pub rate: f64,
    /// Displacement of the drive, m.
    pub drive: f64,
    /// Load or tangential force without its constant part, N.
    pub force: f64,
}

impl Carrier {
    /// A piece that starts at `time` (s) from `u`, `w` (m) over `profile`, with the displacement prescribed along both
    /// axes.
    pub fn new(time: f64, (u, w): (f64, f64), (u_path, w_path): (Path, Path), profile: &Spline) -> Self {
        Self { time, u, w, profile_position: profile.reduce(u), u_path, w_path, bodies: ByAxis::default(), ends: None }
    }

    /// The same with a body along an axis, whose drive follows the path there.
    pub fn start_body(&mut self, axis: Axis, start: &BodyStart, profile: &Spline) {
        let BodyStart { displacement, rate, drive, force } = *start;
        match axis {
            Axis::X => self.u = displacement,
            Axis::Z => self.w = displacement,
        }
        let (start, step) = ([0.0, rate, 0.0], BodyStep::None);
        self.bodies[axis] = Some(BodyMotion { s: 0.0, start, step, drive, force, force_path: Path::default() });
        self.find_profile_position(profile);
    }

    /// Begins another `piece` at the time `s` after the start of this one, s. Returns whether the acceleration of a body
    /// jumps there.
    pub fn begin(&mut self, s: f64, piece: &Piece, model: &Model) -> bool {
        let (before, here) = (*self, self.at(s));
        let paths = piece.paths;
        *self = Self::new(before.time + s, (before.u + here.du, before.w + here.dw), paths, &model.profile);
        for (axis, force) in Axis::ALL.into_iter().zip([piece.forces.0, piece.forces.1]) {
            let Some(body) = &before.bodies[axis] else { continue };
            let [_, rate, acceleration] = here.along(axis);
            let reached = body.force + body.force_path.at(s);
            self.bodies[axis] = Some(BodyMotion {
                s: 0.0,
                start: [0.0, rate, acceleration],
                step: BodyStep::None,
                drive: body.drive + before.path(axis).at(s),
                force: force.start.unwrap_or(reached),
                force_path: force.change,
            });
        }
        Axis::ALL.into_iter().any(|axis| self.jumps_from(&before, s, axis, model))
    }

    /// Whether what acts on a body along `axis` at the start of this piece has jumped from what acted at the time `s` of the
    /// piece `before`, s.
    fn jumps_from(&self, before: &Self, s: f64, axis: Axis, model: &Model) -> bool {
        let Some((body, was)) = before.outside(model, axis, s) else { return false };
        let Some((_, is)) = self.outside(model, axis, 0.0) else { return false };
        is.force != was.force || (body.damping > 0.0 && is.drive[1] != was.drive[1])
    }

    fn path(&self, axis: Axis) -> &Path {
        match axis {
            Axis::X => &self.u_path,
            Axis::Z => &self.w_path,
        }
    }

    /// Whether it is a body along an axis.
    pub fn has_bodies(&self) -> bool {
        self.bodies.any()
    }

    /// Whether it is a body along `axis`.
    pub fn is_body(&self, axis: Axis) -> bool {
        self.bodies[axis].is_some()
    }

    /// The carrier at the time `s` after the start of the piece, s.
    pub fn at(&self, s: f64) -> CarrierPoint {
        let [du, u_rate, u_acceleration] = self.motion(Axis::X, s);
        let [dw, w_rate, w_acceleration] = self.motion(Axis::Z, s);
        let ends = self.ends.as_ref().map_or([[0.0; 2]; 2], |ends| ends.at(s));
        CarrierPoint { du, dw, u_rate, w_rate, u_acceleration, w_acceleration, ends }
    }

    #[inline]
    fn motion(&self, axis: Axis, s: f64) -> [f64; 3] {
        match &self.bodies[axis] {
            None => self.path(axis).motion(s),
            Some(body) => body.motion(s),
        }
    }

    /// The carrier's position at the time `s` after the start of the piece, s.
    pub fn position(&self, s: f64) -> CarrierPosition {
        let point = self.at(s);
        CarrierPosition { profile_position: self.profile_position + point.du, w: self.w + point.dw }
    }

    /// Computes the position on the profile anew from u.
    pub fn find_profile_position(&mut self, profile: &Spline) {
        self.profile_position = profile.reduce(self.u);
    }

    /// The changes of u and w from the time `s` on over `span`, m; both in s.
    pub fn moved(&self, s: f64, span: f64) -> (f64, f64) {
        let change = |axis: Axis| match &self.bodies[axis] {
            None => self.path(axis).change(s, span),
            Some(body) => body.motion(s + span)[0] - body.motion(s)[0],
        };
        (change(Axis::X), change(Axis::Z))
    }

    /// The shortest period of the sines, s; infinite if there is none.
    pub fn shortest_period(&self) -> f64 {
        let of_forces = self.bodies.iter().flatten().map(|body| body.force_path.period());
        of_forces.fold(self.u_path.period().min(self.w_path.period()), f64::min)
    }

    /// The amplitude of the sine of w, m; 0 for a body.
    pub fn amplitude_w(&self) -> f64 {
        if self.is_body(Axis::Z) { 0.0 } else { self.w_path.amplitude.abs() }
    }

    /// The body of `model` along `axis` and what acts on it from outside at the time `s` after the start of the piece, s.
    pub fn outside<'a>(&self, model: &'a Model, axis: Axis, s: f64) -> Option<(&'a Body, Outside)> {
        let [displacement, rate, _] = self.motion(axis, s);
        self.outside_at(model, axis, s, [displacement, rate])
    }

    /// The same with the body displaced since the start of the piece (m) and at a speed (m/s) as given.
    pub fn outside_at<'a>(
        &self,
        model: &'a Model,
        axis: Axis,
        s: f64,
        [displacement, rate]: [f64; 2],
    ) -> Option<(&'a Body, Outside)> {
        let (body, motion) = (model.bodies[axis].as_ref()?, self.bodies[axis].as_ref()?);
        let [drive, drive_rate, _] = self.path(axis).motion(s);
        let (sign, start) = match axis {
            Axis::X => (1.0, self.u),
            Axis::Z => (-1.0, self.w),
        };
        let force = sign * (body.force + (motion.force + motion.force_path.at(s)));
        // The difference of the displacements at the start of the piece keeps the digits of what has moved since.
        let offset = start - motion.drive;
        Some((body, Outside { force, drive: [drive, drive_rate], body: [offset + displacement, rate] }))
    }

    /// Ṙ of the drive along `axis` at the time `s` after the start of the piece, s, N/s; 0 where there is none.
    pub fn drive_force_rate(&self, model: &Model, axis: Axis, s: f64) -> f64 {
        let Some(body) = &model.bodies[axis] else { return 0.0 };
        let ([_, rate, acceleration], drive) = (self.motion(axis, s), self.path(axis).motion(s));
        -(body.stiffness * (rate - drive[1]) + body.damping * (acceleration - drive[2]))
    }

    /// Displacement of the drive of a body along `axis` at the time `s` after the start of the piece, s, m; `None` where it
    /// is no body.
    pub fn drive(&self, axis: Axis, s: f64) -> Option<f64> {
        Some(self.bodies[axis].as_ref()?.drive + self.path(axis).at(s))
    }

    /// The changing part of the load or of the tangential force at the time `s` after the start of the piece, s, N; 0 where
    /// the axis is no body.
    pub fn force(&self, axis: Axis, s: f64) -> f64 {
        self.bodies[axis].as_ref().map_or(0.0, |body| body.force + body.force_path.at(s))
    }

    /// Sets the accelerations of the bodies at the time `s` of the piece, where a step starts, from the `forces` there.
    pub fn accelerate(&mut self, model: &Model, s: f64, forces: &Forces) {
        for (axis, of_layer) in Axis::ALL.into_iter().zip([Forces::on_carrier_x, Forces::on_carrier_z]) {
            let Some((body, outside)) = self.outside(model, axis, s) else { continue };
            let acceleration = (of_layer(forces) + outside.force + outside.drive_force(body)) / body.mass;
            if let Some(motion) = &mut self.bodies[axis] {
                motion.start[2] = acceleration;
            }
        }
    }

    /// Sets how a body along `axis` moves through the step tried last.
    pub fn set_step(&mut self, axis: Axis, step: BodyStep) {
        if let Some(body) = &mut self.bodies[axis] {
            body.step = step;
        }
    }

    /// Ends a step at the time `s` of the piece with the carrier at `point`: the next one starts there.
    pub fn take_step(&mut self, s: f64, point: &CarrierPoint) {
        for axis in Axis::ALL {
            if let Some(body) = &mut self.bodies[axis] {
                (body.s, body.start, body.step) = (s, point.along(axis), BodyStep::None);
            }
        }
    }

    /// Changes the bodies' speeds at `point` by impulses along x and z, N s.
    pub fn push(&self, point: &mut CarrierPoint, model: &Model, impulse: ByAxis<f64>) {
        for axis in Axis::ALL {
            if let Some(body) = &model.bodies[axis] {
                let [displacement, rate, acceleration] = point.along(axis);
                point.set_along(axis, [displacement, rate + impulse[axis] / body.mass, acceleration]);
            }
        }
    }

    /// The bodies' energies at the time `s` after the start of the piece, s.
    pub fn energy(&self, model: &Model, s: f64) -> BodyEnergy {
        let mut energy = BodyEnergy::default();
        for axis in Axis::ALL {
            if let Some((body, outside)) = self.outside(model, axis, s) {
                energy.kinetic += 0.5 * body.mass * outside.body[1].powi(2);
                energy.elastic += 0.5 * body.stiffness * outside.stretch()[0].powi(2);
            }
        }
        energy
    }

    /// All numbers of the piece, to be checked.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let Self { time, u, w, profile_position, u_path, w_path, ref bodies, ends: _ } = *self;
        let of_path = |Path { rate, amplitude, frequency }: Path| [rate, amplitude, frequency];
        let paths = [u_path, w_path].into_iter().flat_map(of_path);
        [time, u, w, profile_position]
            .into_iter()
            .chain(paths)
            .chain(bodies.iter().flatten().flat_map(|body| body.numbers().collect::<Vec<_>>()))
    }
}
