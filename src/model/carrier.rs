//! The carrier's motion: prescribed along an axis, or that of a body there.

use serde::{Deserialize, Serialize};

use super::{CarrierPoint, DrivenBody, EndForces, Forces, Model};
use crate::math::{Jet, Spline};
use crate::scene::{Axis, ByAxis, Motion, Path};

/// The carrier on a smooth segment of its motion. Displacements are counted from the start of the segment, so that a
/// carrier far away loses no digits but those of u itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Carrier {
    /// Time at the start of the segment, s.
    pub time: f64,
    /// u and w at the start of the segment, m.
    pub start: ByAxis<f64>,
    /// u at the start of the segment as a position on the profile, m: reduced to its period if it is periodic.
    pub profile_position: f64,
    /// The paths of u and w, or of the drives of a body.
    paths: ByAxis<Path>,
    /// The bodies; `None` where the displacement is prescribed.
    bodies: ByAxis<Option<BodyMotion>>,
    /// What acts on the ends of a part of a layer; `None` for a whole layer.
    #[serde(skip)]
    pub ends: Option<EndForces>,
}

/// Position of the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarrierPosition {
    /// u as a position on the profile, reduced to its period, m.
    pub profile_position: f64,
    /// w, m.
    pub w: f64,
}

/// The motion of a body along one axis on a smooth segment: where it stands at the start of a step, how it moves
/// through the step tried last, and what acts on it from outside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct BodyMotion {
    /// Start of the step, s after the start of the segment.
    s: f64,
    /// Displacement there since the start of the segment (m), speed and acceleration.
    start: Jet,
    /// The step tried last; none between motions.
    #[serde(skip)]
    interpolant: BodyInterpolant,
    /// Displacement of the drive at the start of the segment, m.
    drive: f64,
    /// Load or tangential force at the start of the segment without its constant part, N.
    force: f64,
    /// Its change from there, N.
    force_path: Path,
}

/// A body's motion through a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyInterpolant {
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
    /// Displacement of the drive since the start of the segment (m), its speed and acceleration.
    pub drive: Jet,
    /// Displacement of the body from where the drive was at the start of the segment (m), its speed and acceleration.
    pub body: Jet,
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
    /// Elongation of the drive's spring (m), its rate and the rate's change: those of the body less the drive's.
    pub fn stretch(&self) -> Jet {
        self.body - self.drive
    }

    /// R, the drive's force on the body, N.
    pub fn drive_force(&self, body: &DrivenBody) -> f64 {
        let stretch = self.stretch();
        -(body.stiffness * stretch.position + body.damping * stretch.speed)
    }

    /// Ṙ, N/s.
    pub fn drive_force_rate(&self, body: &DrivenBody) -> f64 {
        let stretch = self.stretch();
        -(body.stiffness * stretch.speed + body.damping * stretch.acceleration)
    }

    /// The power of the load and of the drive into the body, W.
    pub fn input(&self, body: &DrivenBody) -> f64 {
        self.force * self.body.speed + self.drive_force(body) * self.drive.speed
    }

    /// The power lost in the damper to the drive, W.
    pub fn lost(&self, body: &DrivenBody) -> f64 {
        body.damping * self.stretch().speed.powi(2)
    }
}

impl BodyMotion {
    fn at(&self, s: f64) -> Jet {
        let Jet { position, speed: start_speed, .. } = self.start;
        let in_step = |length: f64| ((s - self.s) / length, length);
        match self.interpolant {
            _ if s <= self.s => self.start,
            BodyInterpolant::None => Jet { position: position + (s - self.s) * start_speed, ..self.start },
            BodyInterpolant::Polynomial { length, speed } => {
                let (theta, h) = in_step(length);
                let sum = |term: fn(usize, f64) -> f64| {
                    (0..speed.len()).rev().fold(0.0, |sum, power| sum * theta + term(power, speed[power]))
                };
                let moved = h * theta * sum(|power, c| c / (power + 1) as f64);
                let slope = (1..speed.len()).rev().fold(0.0, |sum, power| sum * theta + power as f64 * speed[power]);
                Jet { position: position + moved, speed: sum(|_, c| c), acceleration: slope / h }
            }
            BodyInterpolant::TwoStages { length, node, displacement: [linear, square], speed } => {
                let (theta, h) = in_step(length);
                let moved = theta * (linear + theta * square);
                let (from, to, fraction, span) = if theta < node {
                    (start_speed, speed[0], theta / node, node)
                } else {
                    (speed[0], speed[1], (theta - node) / (1.0 - node), 1.0 - node)
                };
                let change = to - from;
                let (speed, acceleration) = (from + fraction * change, change / (span * h));
                Jet { position: position + moved, speed, acceleration }
            }
        }
    }

    /// The changing part of the load or of the tangential force at the time `s` of the segment, N.
    fn force_at(&self, s: f64) -> f64 {
        self.force + self.force_path.at(s).position
    }
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
    /// A segment that starts at `time` (s) from `start`, u and w (m), over `profile`, with the displacement prescribed
    /// along both axes.
    pub fn new(time: f64, start: ByAxis<f64>, paths: ByAxis<Path>, profile: &Spline) -> Self {
        Self { time, start, profile_position: profile.reduce(start.x), paths, bodies: ByAxis::default(), ends: None }
    }

    /// Makes it a body along an axis, whose drive follows the path there.
    pub fn start_body(&mut self, axis: Axis, start: &BodyStart, profile: &Spline) {
        let BodyStart { displacement, rate, drive, force } = *start;
        self.start[axis] = displacement;
        self.bodies[axis] = Some(BodyMotion {
            s: 0.0,
            start: Jet { speed: rate, ..Jet::default() },
            interpolant: BodyInterpolant::None,
            drive,
            force,
            force_path: Path::default(),
        });
        self.find_profile_position(profile);
    }

    /// Begins another segment, that of `motion`, at the time `s` after the start of this one, s. Returns whether the
    /// acceleration of a body jumps there.
    pub fn begin(&mut self, s: f64, motion: &Motion, model: &Model) -> bool {
        let (before, here) = (*self, self.at(s));
        let start = ByAxis::from_fn(|axis| before.start[axis] + here[axis].position);
        *self = Self::new(before.time + s, start, ByAxis::from_fn(|axis| motion.path(axis)), &model.profile);
        self.bodies = ByAxis::from_fn(|axis| {
            let (body, force) = (before.bodies[axis].as_ref()?, motion.force(axis));
            Some(BodyMotion {
                s: 0.0,
                start: Jet { position: 0.0, ..here[axis] },
                interpolant: BodyInterpolant::None,
                drive: body.drive + before.paths[axis].at(s).position,
                force: force.start.unwrap_or(body.force_at(s)),
                force_path: force.change,
            })
        });
        Axis::ALL.into_iter().any(|axis| self.jumps_from(&before, s, axis, model))
    }

    /// Whether what acts on a body along `axis` at the start of this segment has jumped from what acted at the time `s`
    /// of the segment `before`, s.
    fn jumps_from(&self, before: &Self, s: f64, axis: Axis, model: &Model) -> bool {
        let Some((body, was)) = before.outside(model, axis, s) else { return false };
        let Some((_, is)) = self.outside(model, axis, 0.0) else { return false };
        is.force != was.force || (body.damping > 0.0 && is.drive.speed != was.drive.speed)
    }

    /// Whether it is a body along an axis.
    pub fn has_bodies(&self) -> bool {
        self.bodies.any()
    }

    /// Whether it is a body along `axis`.
    pub fn is_body(&self, axis: Axis) -> bool {
        self.bodies[axis].is_some()
    }

    /// The carrier at the time `s` after the start of the segment, s.
    pub fn at(&self, s: f64) -> CarrierPoint {
        let ends = self.ends.as_ref().map_or_else(Default::default, |ends| ends.at(s));
        CarrierPoint { x: self.along(Axis::X, s), z: self.along(Axis::Z, s), ends }
    }

    #[inline]
    fn along(&self, axis: Axis, s: f64) -> Jet {
        match &self.bodies[axis] {
            None => self.paths[axis].at(s),
            Some(body) => body.at(s),
        }
    }

    /// u and w at the time `s` after the start of the segment (s), m.
    pub fn displacement(&self, s: f64) -> ByAxis<f64> {
        let point = self.at(s);
        ByAxis { x: self.start.x + point.x.position, z: self.start.z + point.z.position }
    }

    /// The carrier's position at the time `s` after the start of the segment, s.
    pub fn position(&self, s: f64) -> CarrierPosition {
        let point = self.at(s);
        CarrierPosition {
            profile_position: self.profile_position + point.x.position,
            w: self.start.z + point.z.position,
        }
    }

    /// Computes the position on the profile anew from u.
    pub fn find_profile_position(&mut self, profile: &Spline) {
        self.profile_position = profile.reduce(self.start.x);
    }

    /// The changes of u and w from the time `s` on over `span`, m; both in s.
    pub fn moved(&self, s: f64, span: f64) -> ByAxis<f64> {
        ByAxis::from_fn(|axis| match &self.bodies[axis] {
            None => self.paths[axis].change(s, span),
            Some(body) => body.at(s + span).position - body.at(s).position,
        })
    }

    /// The shortest period of the sines, s; infinite if there is none.
    pub fn shortest_period(&self) -> f64 {
        let forces = self.bodies.iter().flatten().map(|body| &body.force_path);
        self.paths.iter().chain(forces).map(Path::period).fold(f64::INFINITY, f64::min)
    }

    /// The amplitude of the sine of w, m; 0 for a body.
    pub fn amplitude_w(&self) -> f64 {
        if self.is_body(Axis::Z) { 0.0 } else { self.paths.z.amplitude.abs() }
    }

    /// The body of `model` along `axis` and what acts on it from outside at the time `s` after the start of the
    /// segment, s.
    pub fn outside<'a>(&self, model: &'a Model, axis: Axis, s: f64) -> Option<(&'a DrivenBody, Outside)> {
        self.outside_at(model, axis, s, self.along(axis, s))
    }

    /// What acts from outside on the body of `model` along `axis`, displaced since the start of the segment as `at`
    /// says, at the time `s` (s).
    pub fn outside_at<'a>(&self, model: &'a Model, axis: Axis, s: f64, at: Jet) -> Option<(&'a DrivenBody, Outside)> {
        let (body, motion) = (model.bodies[axis].as_ref()?, self.bodies[axis].as_ref()?);
        let sign = match axis {
            Axis::X => 1.0,
            Axis::Z => -1.0,
        };
        let force = sign * (body.force + motion.force_at(s));
        // The difference of the displacements at the start of the segment keeps the digits of what has moved since.
        let offset = self.start[axis] - motion.drive;
        Some((
            body,
            Outside { force, drive: self.paths[axis].at(s), body: Jet { position: offset + at.position, ..at } },
        ))
    }

    /// Displacement of the drive of a body along `axis` at the time `s` after the start of the segment, s, m; `None`
    /// where it is no body.
    pub fn drive(&self, axis: Axis, s: f64) -> Option<f64> {
        Some(self.bodies[axis].as_ref()?.drive + self.paths[axis].at(s).position)
    }

    /// The changing part of the load or of the tangential force at the time `s` after the start of the segment, s, N; 0
    /// where the axis is no body.
    pub fn force(&self, axis: Axis, s: f64) -> f64 {
        self.bodies[axis].as_ref().map_or(0.0, |body| body.force_at(s))
    }

    /// Sets the accelerations of the bodies at the time `s` of the segment, where a step starts, from the `forces`
    /// there.
    pub fn accelerate(&mut self, model: &Model, s: f64, forces: &Forces) {
        for axis in Axis::ALL {
            let Some((body, outside)) = self.outside(model, axis, s) else { continue };
            let acceleration = (forces.on_carrier(axis) + outside.force + outside.drive_force(body)) / body.mass;
            if let Some(motion) = &mut self.bodies[axis] {
                motion.start.acceleration = acceleration;
            }
        }
    }

    /// Sets how a body along `axis` moves through the step tried last.
    pub fn set_interpolant(&mut self, axis: Axis, interpolant: BodyInterpolant) {
        if let Some(body) = &mut self.bodies[axis] {
            body.interpolant = interpolant;
        }
    }

    /// Ends a step at the time `s` of the segment with the carrier at `point`: the next one starts there.
    pub fn take_step(&mut self, s: f64, point: &CarrierPoint) {
        for axis in Axis::ALL {
            if let Some(body) = &mut self.bodies[axis] {
                (body.s, body.start, body.interpolant) = (s, point[axis], BodyInterpolant::None);
            }
        }
    }

    /// Changes the bodies' speeds at `point` by impulses, N s.
    pub fn push(&self, point: &mut CarrierPoint, model: &Model, impulse: ByAxis<f64>) {
        for axis in Axis::ALL {
            if let Some(body) = &model.bodies[axis] {
                point[axis].speed += impulse[axis] / body.mass;
            }
        }
    }

    /// The bodies' energies at the time `s` after the start of the segment, s.
    pub fn energy(&self, model: &Model, s: f64) -> BodyEnergy {
        let mut energy = BodyEnergy::default();
        for (body, outside) in Axis::ALL.into_iter().filter_map(|axis| self.outside(model, axis, s)) {
            energy.kinetic += 0.5 * body.mass * outside.body.speed.powi(2);
            energy.elastic += 0.5 * body.stiffness * outside.stretch().position.powi(2);
        }
        energy
    }
}
