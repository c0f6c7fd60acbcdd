//! Shear strength that depends on the speed: A τ_f(v) = A τ_f0 exp(-c [log10(v/v_0)]²), held below v_c.

use std::path::Path as FilePath;

use asperity::scene::{Method, OutputGroup, Path, Scene};
use asperity::simulation::{Motion, Start};

use crate::common::near::assert_near;
use crate::common::runs::even_times;
use crate::common::scenes::{Law, SceneText};
use crate::common::{difference, largest};
use crate::physics::exact::run::{REST, Run, rate, steps, uneven_layer};

const MASS: f64 = 1.0e-7;
const STIFFNESS: f64 = 2.0e3;
const PRESSED: f64 = 1.0e-5;
const COULOMB: f64 = 0.3;
const SHEAR: f64 = 2.0e-4;
/// A τ_f0, v_0, c and v_c.
const RUBBER: Strength = Strength { force: 5.0e-3, reference: 6.0e-3, sharpness: 0.1, creep: 6.0e-9 };
/// One whose slopes an explicit method can follow.
const BLUNT: Strength = Strength { force: 4.0e-3, reference: 1.0e-2, sharpness: 1.0, creep: 1.0e-3 };

/// The law, and what goes with it.
#[derive(Clone, Copy)]
struct Strength {
    force: f64,
    reference: f64,
    sharpness: f64,
    creep: f64,
}

impl Strength {
    /// A τ_f(v), N.
    fn at(&self, speed: f64) -> f64 {
        let decades = (speed.max(self.creep) / self.reference).log10();
        self.force * (-self.sharpness * decades * decades).exp()
    }

    /// T(v) of a mass that is pressed by PRESSED, N.
    fn limit(&self, speed: f64) -> f64 {
        COULOMB * STIFFNESS * PRESSED + SHEAR + self.at(speed)
    }

    /// A scene with this law, Coulomb friction and a constant shear.
    fn on(&self, scene: SceneText) -> SceneText {
        let Self { force, reference, sharpness, creep } = *self;
        scene
            .coulomb(COULOMB)
            .set("friction.shear_force", SHEAR)
            .set("friction.rate_shear.force", force)
            .set("friction.rate_shear.reference_speed", reference)
            .set("friction.rate_shear.sharpness", sharpness)
            .set("friction.rate_shear.creep_speed", creep)
    }
}

/// A mass pressed on the flat, under a link to the carrier along x.
fn pressed(strength: &Strength, horizontal: &Law, u_rate: f64) -> Run {
    let mass = SceneText::new(1, 1e-4, MASS).vertical(STIFFNESS).horizontal(horizontal).tolerances(1e-9, 1e-14);
    Run::new(&strength.on(mass), Start { w: -PRESSED, u_rate, ..Start::default() })
}

/// At a steady speed all masses slip at it, whatever it is: |F_x| = μ F_z + k A τ_0 + k A τ_f(v), over twelve decades.
#[test]
fn slides_over_twelve_decades() {
    for method in ["event", "step"] {
        slides(method);
    }
}

fn slides(method: &str) {
    let strength = Strength { creep: 1.0e-11, ..RUBBER };
    let scene = strength.on(uneven_layer()).tolerances(1e-6, 1e-11).method(method);
    for decade in -8..=4 {
        for direction in [1.0, -1.0] {
            let v = direction * strength.reference * 10.0_f64.powi(decade);
            let mut run = Run::new(&scene, Start { w: -2.0e-5, u_rate: v, ..Start::default() });
            // Ten times the longest relaxation time, and three times the way on which springs of 1000 N/m come to the
            // friction.
            run.drive(1e-3_f64.max(2e-4 / v.abs()), rate(v), REST);
            let drag = COULOMB * run.get("F_z") + 5.0 * (SHEAR + strength.at(v.abs()));
            // What is left of the swings at the tolerance of 1e-6 where friction hardly damps them, roundings
            // elsewhere.
            assert_near("F_x", run.get("F_x"), -drag.copysign(v), 1e-7 * drag);
            assert_near("F_adhesion", run.get("friction.F_adhesion"), -drag.copysign(v), 1e-7 * drag);
            assert_near("P_friction", run.get("P_diss"), drag * v.abs(), 1e-6 * drag * v.abs());
        }
    }
}

/// A mass thrown with U that nothing pulls slides to rest: ∫ m dv/T long and ∫ m v dv/T far, from 0 to U, and all of ½
/// m U² is lost to friction.
#[test]
fn a_thrown_mass_slides_to_rest() {
    for strength in [RUBBER, BLUNT] {
        for speed in [0.2, -0.2_f64] {
            let mut run = pressed(&strength, &Law::default(), speed);
            assert_near("F_T", run.get("element[1].F_T"), strength.limit(0.2).copysign(speed), 1e-12 * RUBBER.force);
            run.drive(1.0e-4, REST, REST);
            let events = run.events();
            assert_eq!(events.len(), 1, "{events:?}");
            assert_eq!((events[0].from, events[0].to), (speed.signum() as i8, 2));
            let (time, way) = slide(&strength, speed.abs());
            // Some hundred times the tolerance: near rest the friction changes with every decade of the speed, or has a
            // kink, and the steps follow it as far as the speeds' tolerance lets them see it.
            assert_near("stop", events[0].time, time, 3e-7 * time);
            assert_near("way", run.get("element[1].x"), way.copysign(speed), 1e-8 * way);
            let energy = 0.5 * MASS * speed * speed;
            assert_near("friction", run.get("dissipation.E_friction"), energy, 1e-7 * energy);
            assert_eq!(run.get("energy.kinetic"), 0.0);
        }
    }
}

/// Simpson's rule over y = ln v down to the creep speed, below which T stays.
fn slide(strength: &Strength, speed: f64) -> (f64, f64) {
    const PARTS: usize = 20_000;
    let range = (speed / strength.creep).ln();
    let (mut time, mut way) = (0.0, 0.0);
    for i in 0..=PARTS {
        let v = strength.creep * (range * i as f64 / PARTS as f64).exp();
        let weight = if i == 0 || i == PARTS { 1.0 } else { [2.0, 4.0][i % 2] } * range / (3.0 * PARTS as f64);
        time += weight * MASS * v / strength.limit(v);
        way += weight * MASS * v * v / strength.limit(v);
    }
    let held = MASS * strength.creep / strength.limit(0.0);
    (time + held, way + 0.5 * held * strength.creep)
}

/// At rest T(0) = μ F_N + A τ_0 + A τ_f(v_c) holds: a mass that is pulled by less sticks, and breaks loose where c_x U
/// t + d_x U passes it. It then creeps, and what pulls it is no more than its friction at the speed of the carrier.
#[test]
fn a_pulled_mass_breaks_loose_at_the_limit_at_rest() {
    let horizontal = Law::new(1.0e3, 2.0e-2);
    let limit = RUBBER.limit(0.0);
    assert!(limit < 0.7 * RUBBER.limit(1e-4));
    for speed in [1e-4, -1e-4_f64] {
        let mut run = pressed(&RUBBER, &horizontal, 0.0);
        let broken = (limit - horizontal.damping * speed.abs()) / (horizontal.stiffness * speed.abs());
        run.drive(0.999 * broken, rate(speed), REST);
        assert_eq!(run.mode(1), 2.0);
        assert_eq!(run.events().len(), 0);
        run.drive(broken, rate(speed), REST);
        let events = run.events();
        assert_eq!(events.len(), 1, "it creeps: {events:?}");
        assert_eq!((events[0].from, events[0].to), (2, speed.signum() as i8));
        // The tolerance of positions, 1e-13 m, over the speed.
        assert_near("break", events[0].time, broken, 1e-9);
        run.drive(2.0 * broken, rate(speed), REST);
        let drag = RUBBER.limit(speed.abs());
        assert_near("F_T", run.get("element[1].F_T"), drag.copysign(speed), 1e-6 * drag);
    }
}

/// A mass on a spring that its carrier draws where friction falls with the speed: sticks and slips. Against Runge and
/// Kutta's explicit method with small steps, each mode change found by halving.
#[test]
fn sticks_and_slips_as_an_explicit_method_has_it() {
    let (horizontal, speed, duration) = (Law::new(1.0e3, 2.0e-3), 0.05, 2.0e-3);
    let mut run = pressed(&BLUNT, &horizontal, 0.0);
    let explicit = Explicit { law: BLUNT, horizontal: horizontal.clone(), speed };
    let motion = Motion { duration, u: rate(speed), w: Path::default(), ..Motion::default() };
    let times = even_times(duration, 40);
    let found = run.sample(&motion, &times, &["element[1].x", "F_x", "dissipation.E_friction"]);
    let (expected, changes) = explicit.run(&times);
    let events = run.events();
    assert!(changes.len() >= 20, "it sticks and slips: {changes:?}");
    assert_eq!(events.len(), changes.len());
    for (event, change) in events.iter().zip(&changes) {
        assert_near("change", event.time, *change, 1e-6 * duration);
    }
    for (name, (found, expected)) in ["x", "F_x", "E_friction"].iter().zip(found.iter().zip(&expected)) {
        let most = largest(expected);
        for (found, expected) in found.iter().zip(expected) {
            // The explicit method passes the kink at the creep speed in steps of 1e-8 s.
            assert_near(name, *found, *expected, 1e-6 * most);
        }
    }
}

/// m ẍ = c (Ut - x) + d (U - ẋ) - T(ẋ) sign ẋ, by the classical method of order 4.
struct Explicit {
    law: Strength,
    horizontal: Law,
    speed: f64,
}

impl Explicit {
    const STEP: f64 = 1.0e-8;

    fn pull(&self, t: f64, [x, v, _]: [f64; 3]) -> f64 {
        self.horizontal.stiffness * (self.speed * t - x) + self.horizontal.damping * (self.speed - v)
    }

    /// ẋ, ẍ and the power of friction; `sigma` is 0 where the mass sticks.
    fn rates(&self, t: f64, y: [f64; 3], sigma: f64) -> [f64; 3] {
        if sigma == 0.0 {
            return [0.0; 3];
        }
        let friction = sigma * self.law.limit(sigma * y[1]);
        [y[1], (self.pull(t, y) - friction) / MASS, friction * y[1]]
    }

    fn step(&self, t: f64, y: [f64; 3], h: f64, sigma: f64) -> [f64; 3] {
        let plus = |k: [f64; 3], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
        let k1 = self.rates(t, y, sigma);
        let k2 = self.rates(t + 0.5 * h, plus(k1, 0.5 * h), sigma);
        let k3 = self.rates(t + 0.5 * h, plus(k2, 0.5 * h), sigma);
        let k4 = self.rates(t + h, plus(k3, h), sigma);
        std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// What is left before the mode changes.
    fn margin(&self, t: f64, y: [f64; 3], sigma: f64) -> f64 {
        if sigma == 0.0 { self.law.limit(0.0) - self.pull(t, y).abs() } else { sigma * y[1] }
    }

    /// x, F_x and the energy lost to friction at `times`, and when the modes changed.
    fn run(&self, times: &[f64]) -> ([Vec<f64>; 3], Vec<f64>) {
        let (mut columns, mut changes) = ([const { Vec::new() }; 3], Vec::new());
        let (mut t, mut y, mut sigma) = (0.0, [0.0; 3], 0.0);
        for &time in times {
            while t < time {
                let h = Self::STEP.min(time - t);
                let after = self.step(t, y, h, sigma);
                if self.margin(t + h, after, sigma) >= 0.0 {
                    (t, y) = (t + h, after);
                    continue;
                }
                let (mut low, mut high) = (0.0, h);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    let holds = self.margin(t + middle, self.step(t, y, middle, sigma), sigma) >= 0.0;
                    if holds { low = middle } else { high = middle }
                }
                (t, y) = (t + high, self.step(t, y, high, sigma));
                y[1] = 0.0;
                let pull = self.pull(t, y);
                let breaks = sigma == 0.0 || pull.abs() > self.law.limit(0.0);
                sigma = if breaks { pull.signum() } else { 0.0 };
                changes.push(t);
            }
            for (column, value) in columns.iter_mut().zip([y[0], -self.pull(t, y), y[2]]) {
                column.push(value);
            }
        }
        (columns, changes)
    }
}

/// On a wave, with masses that lift, touch, stick and slip: the energies close, and events and time steps give the
/// same.
#[test]
fn energies_close_on_a_wave_and_both_drivers_agree() {
    let scene = RUBBER.on(uneven_layer()).sinusoid(3e-6, 2.3e-4);
    let run = |method: &str, tolerance: f64| {
        let mut run =
            Run::new(&scene.clone().method(method).relative(tolerance), Start { w: -6.0e-6, ..Start::default() });
        let mut columns = [const { Vec::new() }; 3];
        let wave = Path { rate: 0.0, amplitude: 2.0e-5, frequency: 1000.0 };
        for (duration, u, w) in
            [(2e-4, rate(0.1), REST), (2e-4, rate(1e-4), REST), (1e-3, wave, rate(2e-3)), (1e-3, rate(-1e-6), REST)]
        {
            let motion = Motion { duration, u, w, ..Motion::default() };
            let found = run.sample(&motion, &steps((0.0, duration), 40), &["F_x", "F_z", "E_diss"]);
            columns.iter_mut().zip(found).for_each(|(column, found)| column.extend(found));
        }
        let (energy, residual) = (run.get("E_diss"), run.get("energy.residual"));
        (columns, residual.abs() / energy)
    };
    let (exact, residual) = run("event", 1e-9);
    assert!(residual < 1e-8, "{residual:e}");
    let cases = [("event", 1e-6, 1e-4, 1e-5), ("step", 1e-4, 1e-3, 1e-4), ("auto", 1e-4, 1e-2, 1e-3)];
    for (method, tolerance, forces, energies) in cases {
        let (found, residual) = run(method, tolerance);
        assert!(residual < energies, "{method}: {residual:e}");
        for (found, exact) in found.iter().zip(&exact) {
            let error = difference(found, exact) / largest(exact);
            assert!(error < forces, "{method}: {error:e}");
        }
    }
}

/// A layer of rubber on the flat at a temperature (K): its friction at a speed (m/s), N.
fn drag_of_rubber(temperature: f64, speed: f64) -> f64 {
    let scene = SceneText::rubber(3, 1e-4, 1e-3, 1e-2)
        .with("material.equilibrium_modulus = 2e6\nmaterial.viscosity = 1e2")
        .prony(&[])
        .wlf([7.52, 119.75, 293.15], temperature)
        .coulomb(0.2)
        .set("friction.rate_shear.strength", STRENGTH)
        .with("friction.rate_shear.reference_speed = 6e-3\nfriction.rate_shear.sharpness = 0.1");
    let mut run = Run::new(&scene, Start { w: -1.0e-5, u_rate: speed, ..Start::default() });
    run.drive(2e-2 / speed, rate(speed), REST);
    assert_eq!(run.get("contact.count"), 3.0);
    -run.get("F_x") - 0.2 * run.get("F_z")
}

/// τ_f0, Pa, and A = B Δx, m².
const STRENGTH: f64 = 6.5e5;
const AREA: f64 = 1e-2 * 1e-4;

/// In the material form the strength works on the area of an element, and moves with temperature: τ_f(v, T) = τ_f(a_T
/// v, T_ref).
#[test]
fn strength_of_rubber_moves_with_temperature() {
    let strength = Strength { force: STRENGTH * AREA, reference: 6e-3, sharpness: 0.1, creep: 6e-9 };
    for temperature in [283.15_f64, 293.15, 313.15] {
        let above = temperature - 293.15;
        let shift = 10.0_f64.powf(-7.52 * above / (119.75 + above));
        // Slower than where the strength is largest: beyond that, sliding is not steady.
        for speed in [1e-6, 1e-4, 1e-3] {
            let expected = 3.0 * strength.at(shift * speed);
            // What is left of the swings at the tolerance of 1e-6.
            assert_near("drag", drag_of_rubber(temperature, speed), expected, 1e-6 * expected);
        }
    }
}

/// The steps and F_z after 0.2 s of a slow slide over a wave, where masses fall from creep into a slip and
/// are to come to creep again. The curve's maximum, at 2e-5 m/s, is far below the tolerance of velocities.
fn slow_slide(tolerance: f64) -> (f64, f64) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/physics/scenes/wave.toml");
    let mut scene = Scene::load(FilePath::new(file)).unwrap();
    scene.set_by_name("material.wlf.temperature", "283.15").unwrap();
    scene.solver.method = Method::Event;
    scene.solver.relative_tolerance = tolerance;
    scene.outputs = vec![OutputGroup::Forces, OutputGroup::Solver];
    let mut run = Run::of(&scene, Start { w: -1.9e-5, u_rate: 1e-5, ..Start::default() });
    run.drive(0.2, rate(1e-5), REST);
    (run.get("solver.steps"), run.get("F_z"))
}

/// A coarse tolerance costs no more than a fine one, though it does not resolve the friction of creep.
#[test]
fn masses_come_to_creep_again_at_any_tolerance() {
    let (fine_steps, fine) = slow_slide(1e-5);
    for tolerance in [1e-3, 1e-4] {
        let (steps, force) = slow_slide(tolerance);
        assert!(steps <= fine_steps, "{tolerance:e}: {steps} steps, {fine_steps} at 1e-5");
        // Which mass falls when is left to chance; the layer bears the same.
        assert_near("F_z", force, fine, 0.01 * fine);
    }
}
