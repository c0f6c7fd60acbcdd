//! Hysteresis friction: a frictionless layer slid over a sinusoid.

use std::f64::consts::TAU;

use asperity::simulation::{Motion, Start};

use crate::common::near::assert_near;
use crate::common::scenes::{Law, SceneText};
use crate::physics::exact::run::{REST, Run, mean, rate, steps};

const WAVELENGTH: f64 = 1.0e-3;
const AMPLITUDE: f64 = 1.0e-5;
/// Enough for the mass to stay down at every speed tried.
const PRESSED: f64 = 5.0e-5;
const MASS: f64 = 1.0e-8;
const TAU_1: f64 = 1.0e-4;
const Q: f64 = TAU / WAVELENGTH;

/// The speed at which one Maxwell element of relaxation time τ loses most: ω = qv = 1/τ.
const BEST_SPEED: f64 = 1.0 / (Q * TAU_1);

/// What the finite stiffness c_x along x leaves: the mass lags by F s/c_x, at most c (w_0 + â) qâ/(1e4 c) = 4e-10 m, a
/// phase of 2.4e-6 that swings about 0, so that of the loss less than half of it remains. The spline through 256 points
/// a wavelength is off by (2π/256)⁴/720 = 5e-10 in its first harmonic.
const ALLOWED: f64 = 1.0e-6;

/// Samples of F_x are as good as the dense output: this share of its peak c w_0 qâ, of which the mean is some 4 %.
const ALLOWED_SAMPLED: f64 = 5.0e-7;

#[derive(Clone)]
struct Chain {
    masses: usize,
    spacing: f64,
    vertical: Law,
    lateral_z: Law,
}

impl Chain {
    fn one(vertical: Law) -> Self {
        Self { masses: 1, spacing: 1e-4, vertical, lateral_z: Law::default() }
    }

    /// c_x = 1e4 c, critically damped so that it comes to rest.
    fn scene(&self) -> SceneText {
        let stiffness: f64 = 1e4 * self.vertical.stiffness;
        SceneText::new(self.masses, self.spacing, MASS)
            .vertical(&self.vertical)
            .horizontal((stiffness, 2.0 * (stiffness * MASS).sqrt()))
            .lateral_z(&self.lateral_z)
            .sinusoid(AMPLITUDE, WAVELENGTH)
            .set("surface.points_per_wavelength", 256)
            .tolerances(1e-8, 1e-17)
    }

    /// Mean F_x over one wavelength at the speed `v`: of samples, and as the carrier's work over the way.
    fn drag(&self, v: f64) -> [f64; 2] {
        let times = self.vertical.maxwell.iter().chain(&self.lateral_z.maxwell).map(|element| element.1);
        let slowest = times.fold(0.0, f64::max);
        let period = WAVELENGTH / v;
        // Whole periods until e^-20 = 2e-9 of the transient is left.
        let transient = period * (20.0 * slowest / period).ceil().max(1.0);
        let mut run = Run::new(&self.scene(), Start { w: -PRESSED, u_rate: v, ..Start::default() });
        let mut samples = steps((transient, transient + period), 256);
        samples.push(transient + period);
        let motion = Motion { duration: transient + period, u: rate(v), w: REST, ..Motion::default() };
        let columns = run.sample(&motion, &samples, &["F_x", "energy.input", "contact.count"]);
        assert!(columns[2].iter().all(|&count| count == self.masses as f64), "every mass stays down at {v} m/s");
        let work = columns[1][256] - columns[1][0];
        [mean(&columns[0][..256]), -work / WAVELENGTH]
    }

    /// -½ q â² Im[k K* + 4 (k-1) K_lz* sin²(qΔx/2)] at ω = qv.
    fn expected(&self, v: f64) -> f64 {
        let (k, omega) = (self.masses as f64, Q * v);
        let sine = (0.5 * Q * self.spacing).sin();
        let loss = k * self.vertical.complex_stiffness(omega).1
            + 4.0 * (k - 1.0) * self.lateral_z.complex_stiffness(omega).1 * sine * sine;
        -0.5 * Q * AMPLITUDE * AMPLITUDE * loss
    }

    /// The largest F_x, about, N.
    fn peak(&self) -> f64 {
        self.masses as f64 * self.vertical.stiffness * PRESSED * Q * AMPLITUDE
    }

    fn check(&self, v: f64) {
        let expected = self.expected(v);
        // What small losses are measured against: those of a loss angle of 1/10.
        let floor = 0.05 * Q * AMPLITUDE * AMPLITUDE * self.vertical.stiffness * self.masses as f64;
        let allowed = ALLOWED * expected.abs().max(floor);
        let [sampled, worked] = self.drag(v);
        assert_near(&format!("mean F_x at {v} m/s"), sampled, expected, allowed + ALLOWED_SAMPLED * self.peak());
        assert_near(&format!("work over the way at {v} m/s"), worked, expected, allowed);
    }
}

fn one_element() -> Chain {
    Chain::one(Law::with_maxwell(2.0e3, 0.0, &[(1.5e3, TAU_1)]))
}

/// The mass follows z = â sin(qvt), so its vertical link loses π â² Im K*(qv) a wavelength λ = 2π/q, all of it the
/// carrier's work -F_x λ: mean F_x = -½ q â² Im K*(qv), whatever the inertia.
#[test]
fn drag_is_the_loss_stiffness_over_three_decades_of_speed() {
    let chain = Chain::one(Law::with_maxwell(2.0e3, 1.0e-3, &[(1.5e3, TAU_1), (800.0, 1.0e-5)]));
    for factor in [0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0] {
        chain.check(factor * BEST_SPEED);
    }
}

/// The lateral link between neighbours stretches by â [sin q(x + Δx) - sin qx], a swing of 2 â sin(qΔx/2): k - 1 such
/// links lose π (2 â sin(qΔx/2))² Im K_lz* each.
#[test]
fn lateral_links_add_their_loss_in_an_open_chain() {
    let lateral_z = Law::with_maxwell(500.0, 1.0e-3, &[(900.0, 5.0e-5)]);
    for (masses, spacing) in [(2, 0.5 * WAVELENGTH), (3, 0.21 * WAVELENGTH), (5, 0.05 * WAVELENGTH)] {
        let chain = Chain { masses, spacing, lateral_z: lateral_z.clone(), ..one_element() };
        for factor in [0.2, 2.0] {
            chain.check(factor * BEST_SPEED);
        }
    }
}

/// Without a loss there is no drag: the hills that the mass climbs it also goes down.
#[test]
fn an_elastic_layer_has_no_drag() {
    let chain = Chain::one(Law::new(2.0e3, 0.0));
    for drag in chain.drag(0.2) {
        assert_near("drag", drag, 0.0, ALLOWED_SAMPLED * chain.peak());
    }
}
