//! Random cases: one generator for all properties.
//!
//! A case's numbers are multiples of its own spacing, mass and stiffness, so that scenes of all sizes are alike; what
//! makes them differ, stiffness ratios, damping, relaxation times, slopes, speeds, is spread over decades.

use std::f64::consts::TAU;
use std::ops::Range;

use asperity::scene::{
    ByLink, CarrierBodies, CarrierBody, FmuOptions, Force, Friction, Initial, InputRule, Layer, Link, MaxwellElement,
    Method, Path, RateShear, Scene, Solver, Surface,
};
use asperity::simulation::{Motion, Start};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, GROUPS};

/// The steps that one motion may take: some ten times what the longest random one needs.
const MAX_STEPS: u64 = 1_000_000;

/// What a case's numbers are multiples of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scales {
    /// Spacing of the masses, m.
    spacing: f64,
    /// A point mass, kg.
    mass: f64,
    /// A typical spring, N/m.
    stiffness: f64,
    /// A typical height of the profile, m.
    height: f64,
}

impl Scales {
    /// 2π √(m/c), s.
    fn period(&self) -> f64 {
        TAU * (self.mass / self.stiffness).sqrt()
    }
}

/// 10 to a power evenly from `powers`.
fn decades(powers: Range<f64>) -> impl Strategy<Value = f64> + Clone {
    powers.prop_map(|power| 10.0_f64.powf(power))
}

/// As [`decades`], with either sign.
fn signed(powers: Range<f64>) -> impl Strategy<Value = f64> + Clone {
    (decades(powers), any::<bool>()).prop_map(|(value, negative)| if negative { -value } else { value })
}

fn scales() -> impl Strategy<Value = Scales> {
    (decades(-5.0..-3.0), decades(-9.0..-5.0), decades(1.0..5.0), decades(-2.5..-0.5))
        .prop_map(|(spacing, mass, stiffness, height)| Scales { spacing, mass, stiffness, height: height * spacing })
}

/// A case for any method, with everything that a scene may have or not.
pub(crate) fn cases() -> impl Strategy<Value = Case> {
    methods().prop_flat_map(cases_by)
}

/// Any method.
pub(crate) fn methods() -> impl Strategy<Value = Method> {
    prop_oneof![Just(Method::Event), Just(Method::Step), Just(Method::Auto)]
}

/// A case for this method.
pub(crate) fn cases_by(method: Method) -> impl Strategy<Value = Case> {
    scales().prop_flat_map(move |scales| cases_of(scales, method))
}

/// A case for any method whose carrier is a body along x, along z or both, under forces that jump, grow and swing.
pub(crate) fn cases_with_bodies() -> impl Strategy<Value = Case> {
    let axes = prop_oneof![Just((true, false)), Just((false, true)), Just((true, true))];
    (scales(), methods(), axes).prop_flat_map(|(scales, method, (along_x, along_z))| {
        let bodies = (body(scales), body(scales));
        let forces = vec((force(scales), force(scales)), 4);
        (cases_of(scales, method), bodies, forces).prop_map(move |(mut case, (x, z), forces)| {
            case.scene.carrier = CarrierBodies { x: along_x.then_some(x), z: along_z.then_some(z) };
            for (motion, (load, pull)) in case.motions.iter_mut().zip(forces) {
                (motion.load, motion.pull) = (load, pull);
            }
            case
        })
    })
}

/// From a hundredth of a point mass to thousands of them, on a drive or not.
fn body(scales: Scales) -> impl Strategy<Value = CarrierBody> {
    let critical = 2.0 * (scales.stiffness * scales.mass).sqrt();
    let stiffness = option::weighted(0.5, decades(-2.0..1.5).prop_map(move |part| part * scales.stiffness));
    let damping = option::weighted(0.7, decades(-1.0..1.5).prop_map(move |part| part * critical));
    let speed = scales.height / scales.period();
    let start_rate = option::weighted(0.3, signed(-2.0..0.0).prop_map(move |part| part * speed));
    (decades(-2.0..4.0), stiffness, damping, start_rate).prop_map(move |(mass, stiffness, damping, start_rate)| {
        CarrierBody { mass: mass * scales.mass, stiffness, damping, start_rate, ..CarrierBody::default() }
    })
}

/// Of the size of what some springs bear at the profile's height.
fn force(scales: Scales) -> impl Strategy<Value = Force> {
    let size = scales.stiffness * scales.height;
    let start = option::weighted(0.6, signed(-2.0..0.7).prop_map(move |part| part * size));
    let rate = option::weighted(0.3, signed(-2.0..0.3).prop_map(move |part| part * size / scales.period()));
    let sine = option::weighted(0.2, (signed(-2.0..0.0), decades(-1.0..0.5)));
    (start, rate, sine).prop_map(move |(start, rate, sine)| {
        let (amplitude, frequency) = sine.unwrap_or_default();
        let change = Path {
            rate: rate.unwrap_or_default(),
            amplitude: amplitude * size,
            frequency: frequency / scales.period(),
        };
        Force { start, change }
    })
}

fn cases_of(scales: Scales, method: Method) -> impl Strategy<Value = Case> {
    let parts = (layer(scales), surface(scales), option::weighted(0.75, friction(scales)), solver(scales, method));
    (parts, start(scales), vec(motion(scales), 1..=4)).prop_map(
        |((layer, surface, friction, solver), start, motions)| {
            let scene = Scene {
                name: "case".into(),
                description: None,
                layer,
                material: None,
                foundation: None,
                carrier: Default::default(),
                surface,
                fine: None,
                friction,
                default_memory: 0.0,
                solver,
                input_rule: InputRule::default(),
                temperature_input: false,
                outputs: GROUPS.to_vec(),
                fmu: FmuOptions::default(),
                excitation: Vec::new(),
                files: Vec::new(),
                warnings: Vec::new(),
                notes: Vec::new(),
                values: Default::default(),
            };
            Case { scene, start, motions }
        },
    )
}

fn layer(scales: Scales) -> impl Strategy<Value = Layer> {
    let links = [link(scales, 0.9), link(scales, 0.75), link(scales, 0.6), link(scales, 0.6)];
    let initial = prop_oneof![Just(Initial::Relaxed), Just(Initial::Undeformed)];
    (1_usize..=12, -20.0..20.0_f64, -0.5..1.0_f64, initial, links).prop_flat_map(
        move |(masses, origin, clearance, initial, links)| {
            let layer = Layer {
                masses,
                spacing: scales.spacing,
                origin: origin * scales.spacing,
                clearance: clearance * scales.height,
                mass: Some(scales.mass),
                foundation: None,
                kinematics: None,
                thickness: None,
                width: None,
                initial,
                roughness: Vec::new(),
                links: ByLink(links),
            };
            roughness(scales, masses).prop_map(move |roughness| Layer { roughness, ..layer.clone() })
        },
    )
}

fn roughness(scales: Scales, masses: usize) -> impl Strategy<Value = Vec<f64>> {
    let rough = (decades(-1.5..0.5), vec(-0.5..0.5_f64, masses))
        .prop_map(move |(size, heights)| heights.iter().map(|height| height * size * scales.height).collect());
    prop_oneof![Just(Vec::new()), rough]
}

/// Any link is there with the probability `share`; its spring, its damper and its Maxwell elements each or not.
fn link(scales: Scales, share: f64) -> impl Strategy<Value = Option<Link>> {
    let critical = 2.0 * (scales.stiffness * scales.mass).sqrt();
    let stiffness = option::weighted(0.85, decades(-2.0..1.0).prop_map(move |part| part * scales.stiffness));
    let damping = option::weighted(0.7, decades(-3.0..0.7).prop_map(move |part| part * critical));
    let element = (decades(-2.0..1.0), decades(-4.0..4.0)).prop_map(move |(stiffness, time)| MaxwellElement {
        stiffness: stiffness * scales.stiffness,
        relaxation_time: time * scales.period(),
    });
    let link = (stiffness, damping, vec(element, 0..=4)).prop_map(|(stiffness, damping, maxwell)| Link {
        stiffness,
        damping,
        maxwell,
    });
    option::weighted(share, link)
}

/// Flat, a sine, or points: even or not, coarse or fine, periodic or natural.
fn surface(scales: Scales) -> impl Strategy<Value = Surface> {
    let flat = Just(Surface::new(vec![0.0, 1.0], vec![0.0, 0.0], false));
    let sine = (decades(-0.5..1.5), 4_usize..=48).prop_map(move |(wavelength, points)| {
        let phase = |i: usize| i as f64 / points as f64;
        let x = (0..=points).map(|i| wavelength * scales.spacing * phase(i)).collect();
        let z = (0..=points).map(|i| 0.5 * scales.height * (TAU * phase(i % points)).sin()).collect();
        Surface::new(x, z, true)
    });
    let point = (0.3..1.7_f64, -0.5..0.5_f64);
    let points = (decades(-1.0..0.7), vec(point, 3..=40), any::<bool>(), any::<bool>(), -1.0..0.0_f64).prop_map(
        move |(step, points, even, periodic, from)| {
            let step = step * scales.spacing;
            let mut x = vec![from * step * points.len() as f64];
            x.extend(points.iter().scan(x[0], |x, (width, _)| {
                *x += step * if even { 1.0 } else { *width };
                Some(*x)
            }));
            x.pop();
            // A fine profile is no steeper than a coarse one: slopes of 1 or so at most.
            let height = scales.height.min(step);
            let mut z: Vec<f64> = points.iter().map(|(_, z)| z * height).collect();
            if periodic {
                z[points.len() - 1] = z[0];
            }
            Surface::new(x, z, periodic)
        },
    );
    prop_oneof![1 => flat, 2 => sine, 5 => points]
}

/// Coulomb's friction, adhesive shear, or both; and with one or the other a shear strength that depends on the speed.
fn friction(scales: Scales) -> impl Strategy<Value = Friction> {
    let coulomb = decades(-2.0..0.3);
    let shear = decades(-2.5..0.5).prop_map(move |part| part * scales.stiffness * scales.height);
    let both = (coulomb.clone(), shear.clone()).prop_map(|(mu, force)| (Some(mu), Some(force)));
    let constant =
        prop_oneof![coulomb.prop_map(|mu| (Some(mu), None)), shear.prop_map(|force| (None, Some(force))), both];
    let memory = option::weighted(0.4, decades(-3.0..1.0).prop_map(move |part| part * scales.height));
    let all = (constant, option::weighted(0.4, rate_shear(scales)), memory);
    all.prop_map(|((coulomb, shear_force), rate_shear, memory)| Friction {
        coulomb,
        shear_force,
        shear_strength: None,
        rate_shear,
        memory,
    })
}

/// Largest at speeds far below to far above those of the layer's own swings.
fn rate_shear(scales: Scales) -> impl Strategy<Value = RateShear> {
    let speed = scales.height / scales.period();
    (decades(-2.5..0.5), decades(-5.0..1.0), 0.0..0.5_f64, option::of(decades(-7.0..-1.0))).prop_map(
        move |(part, reference, sharpness, creep)| RateShear {
            force: Some(part * scales.stiffness * scales.height),
            strength: None,
            reference_speed: reference * speed,
            sharpness,
            creep_speed: creep.map(|creep| creep * reference * speed),
        },
    )
}

/// Tolerances as they are used with a method: time-stepping is for coarse ones.
fn solver(scales: Scales, method: Method) -> impl Strategy<Value = Solver> {
    let powers = if method == Method::Event { -8.0..-3.0 } else { -4.0..-2.0 };
    (decades(powers), decades(-1.5..0.3)).prop_map(move |(relative_tolerance, part)| Solver {
        method,
        relative_tolerance,
        absolute_tolerance: Some(relative_tolerance * part * scales.height),
        max_steps: Some(MAX_STEPS),
        ..Solver::default()
    })
}

/// Above the profile, on it or pressed into it; at rest or in motion.
fn start(scales: Scales) -> impl Strategy<Value = Start> {
    let speed = scales.height / scales.period();
    let rate = move || prop_oneof![Just(0.0), signed(-2.0..0.7).prop_map(move |part| part * speed)];
    (-0.5..2.0_f64, -30.0..30.0_f64, -2.0..1.0_f64, rate(), rate()).prop_map(move |(time, u, w, u_rate, w_rate)| {
        Start {
            time: time * scales.period(),
            u: u * scales.spacing,
            w: w * scales.height,
            u_rate,
            w_rate,
            ..Start::default()
        }
    })
}

/// Rest, a straight way, a sine, or both along each axis: up to six periods long, and over some masses' places.
fn motion(scales: Scales) -> impl Strategy<Value = Motion> {
    decades(-0.7..0.8).prop_flat_map(move |duration| {
        let duration = duration * scales.period();
        let path = (path(scales, scales.spacing, duration), path(scales, scales.height, duration));
        path.prop_map(move |(u, w)| Motion { duration, u, w, ..Motion::default() })
    })
}

/// A path of some `length`s (m) in `duration` (s).
fn path(scales: Scales, length: f64, duration: f64) -> impl Strategy<Value = Path> {
    let rate = signed(-2.5..0.2).prop_map(move |part| part * length / duration);
    let sine = (signed(-2.0..0.0), decades(-1.0..0.5))
        .prop_map(move |(amplitude, frequency)| (amplitude * length, frequency / scales.period()));
    (option::weighted(0.6, rate), option::weighted(0.4, sine)).prop_map(|(rate, sine)| {
        let (amplitude, frequency) = sine.unwrap_or_default();
        Path { rate: rate.unwrap_or_default(), amplitude, frequency }
    })
}
