//! Mode changes of several masses at one instant.

use asperity::simulation::Start;

use crate::run::{Law, REST, Run, assert_near, link, rate, root, solver};

const MASS: f64 = 1.0e-7;
const STIFFNESS: f64 = 2.0e3;
const FRICTION: f64 = 0.3;

/// Events lie where a limit is passed by some hundredth of the absolute tolerance, 1e-14 m, and the steps before them
/// err by the tolerances, 1e-9: of times of 1e-5 s, a millionth of a microsecond.
const TIME: f64 = 1.0e-12;

/// The masses of a flat layer that comes down on the flat all touch at h/V, in one event, each with its own impact
/// ½ m (V² + U² - (U - μV)²).
#[test]
fn a_flat_layer_touches_as_one() {
    const MASSES: usize = 9;
    let (height, v, u) = (1.0e-6, 0.05, 0.03);
    let law = Law::with_maxwell(STIFFNESS, 2.0e-3, &[(1.0e3, 1.0e-4)]);
    let links: String =
        ["vertical", "horizontal", "lateral_x", "lateral_z"].iter().map(|kind| link(kind, &law)).collect();
    let solver = solver(1e-9, 1e-14);
    let text = format!(
        "[layer]\nmasses = {MASSES}\nspacing = 1e-4\nmass = {MASS:?}\nclearance = {height:?}\n{links}\
         [surface]\nkind = \"flat\"\n[friction]\ncoulomb = {FRICTION:?}\n{solver}"
    );
    let mut run = Run::new(&text, Start { u_rate: u, w_rate: -v, ..Start::default() });
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

    fn scene(&self, stiffness_x: f64) -> String {
        let links = link("vertical", &Law::new(STIFFNESS, 0.0))
            + &link("horizontal", &Law::new(stiffness_x, 0.0))
            + &link("lateral_z", &Law::new(0.0, self.damping));
        let (height, solver) = (self.height, solver(1e-9, 1e-14));
        format!(
            "[layer]\nmasses = 2\nspacing = 1e-4\nmass = {MASS:?}\n\
             roughness = {{ kind = \"points\", z = [0.0, {height:?}] }}\n{links}\
             [surface]\nkind = \"flat\"\n[friction]\ncoulomb = {FRICTION:?}\n{solver}"
        )
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
    let vertical = link("vertical", &Law::new(STIFFNESS, damping));
    for (share, lifted) in [(1.001, true), (0.99, false)] {
        let text = format!(
            "[layer]\nmasses = 1\nspacing = 1e-4\nmass = {MASS:?}\n{vertical}[surface]\nkind = \"flat\"\n\
             [friction]\ncoulomb = 0.3\n"
        );
        let mut run = Run::new(&text, Start { w: -pressed, ..Start::default() });
        run.drive(kink, REST, REST);
        run.drive(1e-9, REST, rate(share * STIFFNESS * pressed / damping));
        let events = run.events();
        assert_eq!(events.len(), usize::from(lifted), "{events:?}");
        if lifted {
            assert_eq!((events[0].time, events[0].from, events[0].to), (kink, 2, 0));
        }
    }
}
