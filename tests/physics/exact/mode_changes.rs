//! Mode changes at the roots of known functions: touch, impact and lift of one mass, and changes of several masses at one
//! instant.

use asperity::scene::LinkKind;
use asperity::simulation::{ModeChange, Start};

use crate::common::near::assert_near;
use crate::common::scenes::{Law, SceneText};
use crate::physics::exact::run::{REST, Run, rate, root};

const MASS: f64 = 1.0e-7;
/// c of the vertical spring.
const STIFFNESS: f64 = 2.0e3;
/// μ where there is friction.
const FRICTION: f64 = 0.3;

/// Events lie where a limit is passed by some hundredth of the absolute tolerance, 1e-14 m, and the steps before them
/// err by the tolerances, 1e-9: of times of 1e-5 to 1e-3 s, a millionth of a microsecond.
const TIME: f64 = 1.0e-12;

/// Of energies and positions: ten times the relative tolerance.
const SHARE: f64 = 1.0e-8;

struct One {
    clearance: f64,
    /// Slope of the profile, a straight line through the origin.
    slope: f64,
    vertical: Law,
    horizontal: Law,
    friction: &'static str,
}

impl Default for One {
    fn default() -> Self {
        let vertical = Law::new(STIFFNESS, 0.0);
        Self { clearance: 0.0, slope: 0.0, vertical, horizontal: Law::default(), friction: "" }
    }
}

impl One {
    fn start(&self, start: Start) -> Run {
        let scene = SceneText::new(1, 1e-4, MASS)
            .set("layer.clearance", self.clearance)
            .vertical(&self.vertical)
            .horizontal(&self.horizontal)
            .points(&[-1.0, 1.0], &[-self.slope, self.slope], false)
            .with(self.friction)
            .tolerances(1e-9, 1e-14);
        Run::new(&scene, start)
    }
}

/// The one mode change of a run: its time.
#[track_caller]
fn only(events: &[ModeChange], from: i8, to: i8) -> f64 {
    assert_eq!(events.len(), 1, "{events:?}");
    assert_eq!((events[0].mass, events[0].from, events[0].to), (0, from, to));
    events[0].time
}

fn square(x: f64) -> f64 {
    x * x
}

/// Carrier and mass move together towards a line of slope s from the height h: they touch at h/(V + sU). There
/// v_n = -(V + sU)/q is lost, v_t = (U - sV)/q falls by μ |v_n| towards 0, and ½ m (v_n² + v_t² - v_t⁺²) is gone.
fn strikes(slope: f64, u_rate: f64, w_rate: f64, mode: i8) {
    let (height, q) = (1.0e-6, slope.hypot(1.0));
    let one = One { clearance: height, slope, friction: "friction.coulomb = 0.3", ..One::default() };
    let mut run = one.start(Start { u_rate, w_rate, ..Start::default() });
    let touch = height / (slope * u_rate - w_rate);
    run.drive(touch + 1e-10, rate(u_rate), rate(w_rate));
    assert_near("touch", only(&run.events(), 0, mode), touch, TIME);
    let v_n = (w_rate - slope * u_rate) / q;
    let v_t = (u_rate + slope * w_rate) / q;
    let after = (v_t.abs() + FRICTION * v_n).max(0.0);
    let (kinetic, lost) = (0.5 * MASS * square(after), 0.5 * MASS * (square(v_n) + square(v_t) - square(after)));
    assert_near("lost in the impact", run.get("dissipation.E_impact"), lost, SHARE * lost);
    // In the 1e-10 s since, the spring has grown by c V 1e-10 s = 1e-8 N: nothing.
    assert_near("left after the impact", run.get("energy.kinetic"), kinetic, SHARE * lost);
}

#[test]
fn impacts_slip_on_or_stick() {
    for (slope, u_rate, w_rate, mode) in [
        (0.0, 0.03, -0.05, 1),
        (0.0, -0.03, -0.05, -1),
        (0.0, 0.0149, -0.05, 2),
        (0.0, 0.0, -0.05, 2),
        (0.5, 0.06, -0.02, 1),
        (-0.5, -0.06, -0.02, -1),
        (0.25, 0.01, -0.05, 2),
    ] {
        strikes(slope, u_rate, w_rate, mode);
    }
}

/// A mass thrown down with V under a carrier at rest swings as ζ = -(V/ω_d) e^{-δt} sin ω_d t, δ = d/2m, ω_d² = c/m -
/// δ². It touches at ζ = -h with ζ̇ and is stopped; the spring, drawn by h, lifts it off again at once, and damping
/// never lets it come back.
#[test]
fn a_swinging_mass_touches() {
    let (height, speed, damping) = (1.0e-6, 0.2, 2.0e-3);
    let one = One { clearance: height, vertical: Law::new(STIFFNESS, damping), ..One::default() };
    let decay = damping / (2.0 * MASS);
    let omega = (STIFFNESS / MASS - square(decay)).sqrt();
    let fall = |t: f64| (speed / omega) * (-decay * t).exp() * (omega * t).sin();
    let velocity = |t: f64| speed * (-decay * t).exp() * ((omega * t).cos() - decay / omega * (omega * t).sin());
    let touch = root(|t| fall(t) - height, (0.0, std::f64::consts::FRAC_PI_2 / omega * 0.9));
    let mut run = one.start(Start { w_rate: -speed, ..Start::default() });
    let mut before = run.clone();
    before.drive(touch - 2.0 * TIME, REST, REST);
    assert_eq!(before.get("dissipation.E_impact"), 0.0, "not touched yet");
    run.drive(touch + 2.0 * TIME, REST, REST);
    // The speed at the touch errs as the way there does, and counts twice.
    let (lost, share) = (0.5 * MASS * square(velocity(touch)), 3.0 * SHARE);
    assert_near("lost in the impact", run.get("dissipation.E_impact"), lost, share * lost);
    run.drive(5.0e-4, REST, REST);
    assert_eq!(run.mode(1), 0.0);
    assert_near("lost in all impacts", run.get("dissipation.E_impact"), lost, share * lost);
}

/// Grazing: an undamped mass thrown down with V swings to the depth V/ω. One a millionth higher than the profile passes
/// it; a millionth lower, it strikes with ½ m V² (1 - (hω/V)²) and bounces no more.
#[test]
fn a_grazing_mass() {
    let speed = 0.2;
    let depth = speed / (STIFFNESS / MASS).sqrt();
    let lost = |height: f64| {
        let mut run = One { clearance: height, ..One::default() }.start(Start { w_rate: -speed, ..Start::default() });
        run.drive(1.0e-4, REST, REST);
        assert!(run.get("solver.steps") < 5e3, "no trembling: {} steps", run.get("solver.steps"));
        run.get("dissipation.E_impact")
    };
    assert_eq!(lost(depth * (1.0 + 1e-6)), 0.0);
    let expected = 0.5 * MASS * square(speed) * (1.0 - square(1.0 - 1e-6));
    // The depth is right to the tolerance of a step, some 1e-8 of it, out of 1e-6.
    assert_near("grazing", lost(depth * (1.0 - 1e-6)), expected, 0.02 * expected);
}

/// A mass pressed by w_0, the carrier lifted at V: with the mass on the flat F_N = c (w_0 - V t) - d V
/// - c_1 V τ (1 - e^{-t/τ}), whose root is the lift.
#[test]
fn a_pressed_mass_lifts() {
    let (pressed, speed, (c_1, tau)) = (1.0e-5, 0.05, (800.0, 5.0e-5));
    let normal =
        |t: f64| STIFFNESS * (pressed - speed * t) - 2.0e-2 * speed - c_1 * speed * tau * (1.0 - (-t / tau).exp());
    let lift = root(normal, (0.0, 1.0e-3));
    let vertical = Law::with_maxwell(STIFFNESS, 2.0e-2, &[(c_1, tau)]);
    let mut run = One { vertical, ..One::default() }.start(Start { w: -pressed, ..Start::default() });
    run.drive(1.0e-4, REST, rate(speed));
    assert_near("F_N", run.get("element[1].F_N"), normal(1.0e-4), SHARE * STIFFNESS * pressed);
    run.drive(1.0e-3, REST, rate(speed));
    assert_near("lift", only(&run.events(), 1, 0), lift, TIME);
}

/// On a slope s, frictionless, the spring's r = ζ - w follows r̈ = -Ω² r, Ω² = c s²/(m q²), on the line, and lifts the
/// mass off at r = 0, with its velocity; from there r̈ = -ω² r, ω² = c/m, x goes on evenly, and the gap opens with t³.
#[test]
fn a_lift_keeps_the_velocity() {
    let (slope, pressed, speed) = (0.4_f64, 1.0e-5, 0.05);
    let (q2, omega) = (1.0 + square(slope), (STIFFNESS / MASS).sqrt());
    let omega_line = omega * slope / q2.sqrt();
    // The carrier's rate before t = 0 is that of the motion: of it the lifted mass keeps s ẇ/q² along x.
    let start_x = slope * speed / q2;
    let r = |t: f64| pressed * (omega_line * t).cos() + (slope * start_x - speed) / omega_line * (omega_line * t).sin();
    let r_rate =
        |t: f64| -pressed * omega_line * (omega_line * t).sin() + (slope * start_x - speed) * (omega_line * t).cos();
    let lift = root(r, (0.0, std::f64::consts::PI / omega_line));
    let mut run = One { slope, ..One::default() }.start(Start { w: -pressed, w_rate: speed, ..Start::default() });
    let after = 5.0e-6;
    run.drive(lift + after, REST, rate(speed));
    let events = run.events();
    assert_near("lift", events.last().unwrap().time, lift, TIME);
    assert_eq!(run.mode(1), 0.0);
    // Along the line s x = r + w, w = -w_0 + V t.
    let (x_lift, x_rate) = ((r(lift) - pressed + speed * lift) / slope, (r_rate(lift) + speed) / slope);
    assert_near("x", run.get("element[1].x"), x_lift + x_rate * after, SHARE * pressed);
    let w = -pressed + speed * (lift + after);
    let z = w + r_rate(lift) / omega * (omega * after).sin();
    assert_near("z", run.get("element[1].z"), z, SHARE * pressed);
}

/// The masses of a flat layer that comes down on the flat all touch at h/V, in one event, each with its own impact
/// ½ m (V² + U² - (U - μV)²).
#[test]
fn a_flat_layer_touches_as_one() {
    const MASSES: usize = 9;
    let (height, v, u) = (1.0e-6, 0.05, 0.03);
    let law = Law::with_maxwell(STIFFNESS, 2.0e-3, &[(1.0e3, 1.0e-4)]);
    let scene =
        LinkKind::ALL.into_iter().fold(SceneText::new(MASSES, 1e-4, MASS), |scene, kind| scene.link(kind, &law));
    let scene = scene.set("layer.clearance", height).coulomb(FRICTION).tolerances(1e-9, 1e-14);
    let mut run = Run::new(&scene, Start { u_rate: u, w_rate: -v, ..Start::default() });
    run.drive(height / v + 1e-10, rate(u), rate(-v));
    let events = run.events();
    assert_eq!(events.len(), MASSES);
    assert!(events.iter().all(|event| event.time == events[0].time && (event.from, event.to) == (0, 1)));
    assert_near("touch", events[0].time, height / v, TIME);
    assert_eq!(run.get("contact.count"), MASSES as f64);
    let lost = 0.5 * MASS * (v * v + u * u - (u - FRICTION * v).powi(2)) * MASSES as f64;
    assert_near("lost", run.get("dissipation.E_impact"), lost, 1e-8 * lost);
}

/// Two masses joined by a lateral damper along z: one sticks, pressed by w_0, the other hangs h - w_0 above the flat.
struct Pair {
    pressed: f64,
    height: f64,
    /// d of the lateral damper.
    damping: f64,
    /// The carrier's speed downwards, V.
    speed: f64,
}

impl Pair {
    /// The elongation r = ζ - w of the hanging mass's spring and its rate: m r̈ = -c r - d (ṙ - V), ζ̇ = ṙ - V, from
    /// r = 0, ζ̇ = 0. With δ = d/2m, ω² = c/m - δ² it swings about dV/c.
    fn hanging(&self, t: f64) -> (f64, f64) {
        let decay = self.damping / (2.0 * MASS);
        let omega = (STIFFNESS / MASS - decay * decay).sqrt();
        let centre = self.damping * self.speed / STIFFNESS;
        let (a, b) = (-centre, (self.speed - decay * centre) / omega);
        let (sine, cosine) = (omega * t).sin_cos();
        let swing = (-decay * t).exp();
        let r = centre + swing * (a * cosine + b * sine);
        (r, swing * ((b * omega - decay * a) * cosine - (a * omega + decay * b) * sine))
    }

    /// When the hanging mass touches: ζ = r + w = -h, w = -w_0 - V t.
    fn touch(&self) -> f64 {
        let gap = |t: f64| self.height + self.hanging(t).0 - self.pressed - self.speed * t;
        root(gap, (0.0, 4.0 * (self.height - self.pressed) / self.speed))
    }

    fn scene(&self, stiffness_x: f64) -> SceneText {
        SceneText::new(2, 1e-4, MASS)
            .roughness(&[0.0, self.height])
            .vertical(STIFFNESS)
            .horizontal(stiffness_x)
            .lateral_z((0.0, self.damping))
            .coulomb(FRICTION)
            .tolerances(1e-9, 1e-14)
    }
}

/// The falling neighbour presses a sticking mass down by d |ζ̇| through their damper, until it strikes and stops: then
/// T = μ (c w + d |ζ̇|) falls at once to μ c w. A pull c_x u between the two breaks the mass loose in that very event.
#[test]
fn the_impact_of_a_neighbour_breaks_a_stick() {
    let pair = Pair { pressed: 1.0e-5, height: 1.1e-5, damping: 5.0e-3, speed: 0.05 };
    let (stiffness, drawn, lead) = (1.0e3, 5.0e-6, 1.0e-5);
    let touch = pair.touch();
    let fall = pair.speed - pair.hanging(touch).1;
    let after = STIFFNESS * (pair.pressed + pair.speed * touch);
    // Half-way between the limits before and after.
    let pull = FRICTION * (after + 0.5 * pair.damping * fall);
    let u_rate = (pull / stiffness - drawn) / touch;
    let mut run = Run::new(&pair.scene(stiffness), Start { w: -pair.pressed, ..Start::default() });
    run.drive(lead, rate(drawn / lead), REST);
    assert_eq!((run.mode(1), run.mode(2)), (2.0, 0.0));
    run.drive(touch - 1e-9, rate(u_rate), rate(-pair.speed));
    let before = after + pair.damping * fall;
    // A nanosecond earlier: c V 1e-9 s and the change of the fall's speed, some 1e-6 of it.
    assert_near("F_N before", run.get("element[1].F_N"), before, 1e-5 * before);
    assert_eq!(run.events(), []);
    run.drive(2e-9, rate(u_rate), rate(-pair.speed));
    let events = run.events();
    assert_near("touch", events[0].time, lead + touch, 2.0 * TIME);
    assert_near("F_N after", run.get("element[1].F_N"), after, 1e-5 * after);
    let changes: Vec<_> = events.iter().map(|event| (event.mass, event.from, event.to)).collect();
    assert_eq!(changes, [(0, 2, 1), (1, 0, 1)], "the neighbour slips on, drawn along by its own spring");
    assert_eq!(events[0].time, events[1].time);
}

/// A carrier pulled up at once lifts a pressed mass at the kink where d V > c w_0, and does not below.
#[test]
fn a_kink_lifts_a_mass() {
    let (pressed, damping, kink) = (1.0e-5, 2.0e-2, 1.0e-5);
    let scene = SceneText::new(1, 1e-4, MASS).vertical((STIFFNESS, damping)).coulomb(0.3);
    for (share, lifted) in [(1.001, true), (0.99, false)] {
        let mut run = Run::new(&scene, Start { w: -pressed, ..Start::default() });
        run.drive(kink, REST, REST);
        run.drive(1e-9, REST, rate(share * STIFFNESS * pressed / damping));
        let events = run.events();
        assert_eq!(events.len(), usize::from(lifted), "{events:?}");
        if lifted {
            assert_eq!((events[0].time, events[0].from, events[0].to), (kink, 2, 0));
        }
    }
}
