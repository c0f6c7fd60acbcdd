//! Viscoelastic contacts: cylinders on a standard linear solid, and full contact.

use std::f64::consts::{PI, TAU};

use asperity_study::decimals::{percent, short};
use asperity_study::steady::SteadySlide;

use super::row::{Claim, Comparison, Curve, Entry, Picture, Row};
use super::scenes::{cylinder, largest_pressure, map, parse, rubber, sine, slide};

const FILE: &str = "examples/validation/suite/viscoelastic.rs";

/// A rigid cylinder on a half-plane of a standard linear solid, M = M_∞ (1 + r iωτ/(1 + iωτ)), in steady motion.
///
/// With l = vτ and L = l(1 + r) the fields U = u + L u' and P = p + l p' are those of an elastic half-plane of M_∞, so
/// P √(1-t²) = A_0 + A_1 T_1(t) + A_2 T_2(t) over the contact x = c + wt, with A_0 = F/(πw), A_1 = -(M_∞/2R)(c + L),
/// A_2 = -M_∞ w/(4R). That p vanishes where the rubber leaves is A_0 I_0 + A_1 I_1 + A_2 I_2 = 0 at w/l; that u' does
/// not jump where it comes in leaves one equation for w.
#[derive(Clone, Copy, Debug)]
struct Hunter {
    /// M_∞, Pa, and what the glass has more of it.
    modulus: f64,
    ratio: f64,
    /// R, m, and the force per width, N/m.
    radius: f64,
    force: f64,
    /// vτ, m.
    length: f64,
}

/// What comes out of it.
#[derive(Clone, Copy, Debug)]
struct Rolled {
    half_width: f64,
    /// Coefficient of friction.
    friction: f64,
    /// The largest pressure, Pa.
    pressure: f64,
}

/// I_0, I_1 and I_2 at z, times e^-z, by the trapezoidal rule on their integrals, which converges faster than any
/// power.
fn bessel(z: f64) -> [f64; 3] {
    let parts = 64 + (8.0 * z.sqrt()) as usize + z as usize;
    [0, 1, 2].map(|n| {
        let at = |i: usize| {
            let angle = PI * (i as f64 + 0.5) / parts as f64;
            (z * (angle.cos() - 1.0)).exp() * (f64::from(n) * angle).cos()
        };
        (0..parts).map(at).sum::<f64>() / parts as f64
    })
}

impl Hunter {
    /// A_0, A_1, A_2 and c at a half-width.
    fn parts(&self, w: f64) -> ([f64; 3], f64) {
        let [i_0, i_1, i_2] = bessel(w / self.length);
        let (a_0, a_2) = (self.force / (PI * w), -self.modulus * w / (4.0 * self.radius));
        let a_1 = -(a_0 * i_0 + a_2 * i_2) / i_1;
        ([a_0, a_1, a_2], -2.0 * self.radius * a_1 / self.modulus - self.length * (1.0 + self.ratio))
    }

    /// The slope of the rubber just before the contact less that of the cylinder.
    fn jump(&self, w: f64) -> f64 {
        let ([a_0, a_1, a_2], c) = self.parts(w);
        let retarded = self.length * (1.0 + self.ratio);
        let z = w / retarded;
        // ∫ over what lies before the contact, t = -cosh θ.
        let end = (1.0 + 60.0 / z).acosh();
        let parts = 20_000;
        let at = |i: usize| {
            let angle = end * (i as f64 + 0.5) / f64::from(parts);
            (-z * (angle.cosh() - 1.0)).exp() * (a_0 - a_1 * (-angle).exp() + a_2 * (-2.0 * angle).exp())
        };
        let integral = (0..parts as usize).map(at).sum::<f64>() * end / f64::from(parts);
        2.0 * w / (self.modulus * retarded) * integral - (w - c) / self.radius
    }

    fn solve(&self) -> Rolled {
        let soft = (4.0 * self.force * self.radius / (PI * self.modulus)).sqrt();
        let (mut low, mut high) = (0.9 * soft / (1.0 + self.ratio).sqrt(), 1.1 * soft);
        let sign = self.jump(low).signum();
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if self.jump(middle).signum() == sign { &mut low } else { &mut high }) = middle;
        }
        let w = 0.5 * (low + high);
        let ([_, a_1, _], c) = self.parts(w);
        let centre = c + self.length + w * w * PI * a_1 / (2.0 * self.force);
        Rolled { half_width: w, friction: -centre / self.radius, pressure: self.largest_pressure(w) }
    }

    /// p = ∫ e^((s-x)/l) P ds/l from where the rubber comes in, in angles, t = -cos φ.
    fn largest_pressure(&self, w: f64) -> f64 {
        let ([a_0, a_1, a_2], _) = self.parts(w);
        let (parts, z) = (200_000, w / self.length);
        let (mut pressure, mut most, mut before) = (0.0_f64, 0.0_f64, -1.0);
        for i in 0..parts {
            let angle = PI * (f64::from(i) + 0.5) / f64::from(parts);
            let t = -angle.cos();
            pressure *= (-z * (t - before)).exp();
            pressure += z * PI / f64::from(parts) * (a_0 + a_1 * t + a_2 * (2.0 * t * t - 1.0));
            (most, before) = (most.max(pressure), t);
        }
        most
    }
}

pub const ROLLING: Entry = Entry {
    title: "A cylinder sliding on a standard linear solid",
    reference: "Hunter 1961, Goryacheva 1973",
    source: "S. C. Hunter, J. Appl. Mech. 28, 1961, 611; I. G. Goryacheva, Contact Mechanics in Tribology, 1998, \
             chapter 5",
    file: FILE,
    quick: true,
    compare: rolling,
};

/// M_∞, Pa; the glass has five times as much. R and the half-width of the soft contact, m.
const SOFT: f64 = 1e6;
const GLASS: f64 = 4.0;
const RADIUS: f64 = 5e-3;
const HALF_WIDTH: f64 = 1e-4;
/// The relaxation time, s.
const TIME: f64 = 1e-3;

fn hunter(speed: f64) -> Hunter {
    let force = PI * SOFT * HALF_WIDTH * HALF_WIDTH / (4.0 * RADIUS);
    Hunter { modulus: SOFT, ratio: GLASS, radius: RADIUS, force, length: speed * TIME }
}

fn rolling() -> Comparison {
    let scene = rubber(SOFT * 0.75, 0.5, &[[GLASS * SOFT * 0.75, TIME]]);
    let base = 16.0 * HALF_WIDTH;
    let found = |speed: f64, periods: f64| {
        let length = periods * base;
        let surface = cylinder(1024 * periods as usize, length, RADIUS, HALF_WIDTH);
        slide(&scene, surface, speed, hunter(speed).force / length)
    };
    // vτ over the half-width of the soft contact.
    let speeds = [0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 2.0, 8.0].map(|part| part * HALF_WIDTH / TIME);
    let mut rows = Vec::new();
    let mut curves = [1.0, 4.0, 16.0].map(|periods| (periods, Vec::new()));
    for speed in speeds {
        let exact = hunter(speed).solve().friction;
        let part = speed * TIME / HALF_WIDTH;
        for (periods, points) in &mut curves {
            let friction = found(speed, *periods).friction().unwrap();
            points.push((part, friction));
            // The fastest remembers the cylinder before over a longer way.
            let (needed, friction) =
                if part > 4.0 { (64.0, found(speed, 64.0).friction().unwrap()) } else { (16.0, friction) };
            if *periods == 16.0 {
                let part = short(part, 2);
                let what = format!("friction at vτ = {part} a, a period of {} a", 16.0 * needed);
                rows.push(Row::new(what, [exact, friction], "", Claim::Share(1e-2)));
            }
        }
    }
    let fastest = hunter(speeds[7]).solve().friction;
    let [once, four_times, most_times] = curves.each_ref().map(|(_, points)| percent(1.0 - points[7].1 / fastest, 2));
    let line: Vec<_> = (0..=80).map(|i| 0.015 * 700.0_f64.powf(f64::from(i) / 80.0)).collect();
    let line: Vec<_> = line.into_iter().map(|part| (part, hunter(part * HALF_WIDTH / TIME).solve().friction)).collect();
    // The maximum by halving the three speeds around it.
    let most = |of: &dyn Fn(f64) -> f64| {
        let (mut at, mut step) = (0.25_f64, 1.3_f64);
        while step > 1.01 {
            at = [at / step, at, at * step].into_iter().max_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap();
            step = step.powf(0.6);
        }
        (at, of(at))
    };
    let exact = most(&|part| hunter(part * HALF_WIDTH / TIME).solve().friction);
    let ours = most(&|part| found(part * HALF_WIDTH / TIME, 16.0).friction().unwrap());
    rows.push(Row::new("the maximum", [exact.1, ours.1], "", Claim::Share(1e-2)));
    rows.push(Row::new("its place, vτ/a", [exact.0, ours.0], "", Claim::Share(5e-2)));
    let name = |periods: f64| format!("asperity, a period of {} a", 16.0 * periods);
    let [one, four, sixteen] = curves.map(|(periods, points)| Curve::marks(name(periods), points));
    Comparison {
        about: "A rigid cylinder over rubber of one relaxation time τ whose glass is five times as stiff; a is the \
                half-width of the contact at rest. The solver's surface is periodic: 1024 points in 16 a, and 4 and \
                16 times as much of both; the maximum is that with 16."
            .into(),
        rows,
        pictures: vec![Picture {
            file: "hunter.svg",
            caption: "Friction of a cylinder over the speed: the closed solution, and the solver with three periods",
            x: "vτ / a",
            y: "friction coefficient",
            is_logarithmic: true,
            curves: vec![Curve::line("Hunter", line), one, four, sixteen],
        }],
        remark: format!(
            "The images of a short period lie in rubber that has not come back from the cylinder before: at vτ = 8 a \
             friction is {once}, {four_times} and {most_times} too small with periods of 16, 64 and 256 a. Where \
             that matters double the length (`asperity converge`)."
        ),
    }
}

pub const CYLINDERS: Entry = Entry {
    title: "Rolling cylinders of viscoelastic rubber",
    reference: "Wang and Knothe 1993, by CONTACT",
    source: "G. Wang, K. Knothe, Wear 162-164, 1993, 1123; E. A. H. Vollebregt, CONTACT, example `visc_cylindr`",
    file: FILE,
    quick: true,
    compare: cylinders,
};

fn cylinders() -> Comparison {
    let (modulus, force, radius, length) = (952.5e6, 600e3, 0.05, 0.32);
    let half_width = 6.33e-3;
    let cases = [(None, 60.32, 12.66), (Some(9e-3), 78.74, 9.73), (Some(45e-3), 84.72, 8.98), (Some(2.0), 85.31, 8.95)];
    let mut rows = Vec::new();
    for (theirs, pressure, width) in cases {
        let terms: Vec<_> = theirs.map(|time| [0.75 * modulus, 0.5 * time]).into_iter().collect();
        let scene = rubber(0.75 * modulus, 0.5, &terms);
        let found = slide(&scene, cylinder(16384, length, radius, half_width), 1.0, force / length);
        let name = theirs.map_or("soft".to_owned(), |time| format!("{} ms", 1e3 * time));
        let found = [1e-6 * largest_pressure(&found), 1e3 * found.area * length];
        rows.push(Row::new(format!("largest pressure, {name}"), [pressure, found[0]], "MPa", Claim::Share(2e-3)));
        rows.push(Row::new(format!("width, {name}"), [width, found[1]], "mm", Claim::Share(1e-2)));
        if let Some(time) = theirs {
            let exact = Hunter { modulus, ratio: 1.0, radius, force, length: 0.5 * time }.solve();
            let [most, wide] = [1e-6 * exact.pressure, 2e3 * exact.half_width];
            rows.push(Row::new(
                format!("largest pressure, {name}, Hunter"),
                [most, found[0]],
                "MPa",
                Claim::Share(2e-3),
            ));
            rows.push(Row::new(format!("width, {name}, Hunter"), [wide, found[1]], "mm", Claim::Share(1e-2)));
        }
    }
    Comparison {
        about: "Two equal cylinders under 600 N/mm at 1 m/s, which as one are a rigid cylinder of 50 mm on rubber of \
                M_∞ = M_1 = 952.5 MPa; a period of 0.32 m, 16384 points. The times are theirs, of creep: of \
                relaxation they are half as long."
            .into(),
        rows,
        ..Comparison::default()
    }
}

pub const FULL: Entry = Entry {
    title: "A bonded layer in full contact",
    reference: "closed form",
    source: "K. L. Johnson, Contact Mechanics, 1985, 13.2; for the layer the solution of Navier's equations over its \
             depth",
    file: FILE,
    quick: true,
    compare: full,
};

/// p_q = M K h_q, and μp = Σ q |h_q|² K Im M(qv) over the waves of both signs, which have a/2 each.
fn full() -> Comparison {
    let (q, amplitude, pressure) = (TAU / 1e-3, 1e-5, 2e6);
    let poisson: f64 = 0.49;
    let loss = |speed: f64| {
        let x = q * speed * 1e-4;
        2e7 * x / (1.0 + x * x) / (1.0 - poisson * poisson)
    };
    let mut rows = Vec::new();
    for speed in [0.1, 1.6, 30.0] {
        let found = slide(&rubber(5e6, poisson, &[[2e7, 1e-4]]), sine(64, amplitude), speed, pressure);
        let exact = q * amplitude * amplitude * 0.5 * (0.5 * q) * loss(speed) / pressure;
        let what = format!("friction on a half-plane, {speed} m/s");
        rows.push(Row::new(what, [exact, found.friction().unwrap()], "", Claim::Share(1e-9)));
    }
    for (thickness, speed) in [(2e-4, 1.6), (5e-5, 1.6), (2e-4, 0.1)] {
        let scene = parse(&format!(
            "name = 'layer'\nlayer = {{ foundation = 'layer', thickness = {thickness:e}, masses = 100, spacing = 1e-5, \
             width = 1e-2 }}\nmaterial = {{ density = 1100.0, poisson_ratio = {poisson}, equilibrium_modulus = 5e6, \
             prony = [{{ modulus = 2e7, relaxation_time = 1e-4 }}] }}\n\
             surface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3 }}"
        ));
        let found = slide(&scene, sine(64, amplitude), speed, 1e9);
        assert!(found.contact.is_full);
        let exact = q * amplitude * amplitude * 0.5 * bonded(q, thickness, poisson) * loss(speed) / 1e9;
        let what = format!("friction on a layer of {} mm, {speed} m/s", 1e3 * thickness);
        rows.push(Row::new(what, [exact, found.friction().unwrap()], "", Claim::Share(1e-9)));
    }
    Comparison {
        about: "a cos qx in full contact: the pressure is MKh and μp = q a² K Im M(qv)/2, with K = q/2 of the \
                half-plane and that of a layer bonded to a rigid base."
            .into(),
        rows,
        ..Comparison::default()
    }
}

/// K of a bonded layer, 1/m: pressure over M times the height of the surface, by Papkovich and Neuber's harmonic
/// functions.
///
/// With 2G u_x = (ζB + φ) sin qx and 2G u_z = (κB - ζB' - φ') cos qx, ζ = qz, nothing moves at ζ = 0 where φ = D sh ζ
/// and B = (D/κ) ch ζ + E sh ζ; at ζ = a there is no shear, (1 - κ)B + 2ζB' + 2φ' = 0, and σ_z = q(2(1-ν)B' - ζB - φ)
/// cos qx.
fn bonded(q: f64, thickness: f64, poisson: f64) -> f64 {
    let (kappa, a) = (3.0 - 4.0 * poisson, q * thickness);
    let (sine, cosine) = (a.sinh(), a.cosh());
    let at = |d: f64, e: f64| {
        let (b, b_rate) = (d / kappa * cosine + e * sine, d / kappa * sine + e * cosine);
        let shear = (1.0 - kappa) * b + 2.0 * (a * b_rate + d * cosine);
        let normal = 2.0 * (1.0 - poisson) * b_rate - a * b - d * sine;
        [shear, normal, kappa * b - a * b_rate - d * cosine]
    };
    let e = -at(1.0, 0.0)[0] / at(0.0, 1.0)[0];
    let [_, normal, height] = at(1.0, e);
    // 2G/M is 1 - ν.
    q * (1.0 - poisson) * normal / height
}

pub const CONSTANT_LOSS: Entry = Entry {
    title: "Cylinder and sphere on rubber of a constant loss tangent",
    reference: "half-space, first order of the loss",
    source: "the losses of the waves of Hertz' pressures, π/2 tan δ |p_q|² a wave: J. A. Greenwood, H. Minshall and D. Tabor, \
             Proc. R. Soc. A 259, 1961, 480",
    file: FILE,
    quick: true,
    compare: constant_loss,
};

/// The loss tangent at the frequency of the contact.
const LOSS: f64 = 0.02;

fn constant_loss() -> Comparison {
    // Four terms a decade lose E'' = π/2 g/ln 10^(1/4), whatever the frequency within them.
    let (speed, step) = (1e-2, 10f64.powf(0.25));
    let frequency = speed / HALF_WIDTH;
    let term = LOSS * SOFT * step.ln() / (0.5 * PI);
    let terms: Vec<[f64; 2]> = (-24..=24).map(|i| [term, step.powi(i) / frequency]).collect();
    // E' at that frequency is the half of all terms above what is at rest.
    let scene = rubber(SOFT - 0.5 * term * terms.len() as f64, 0.5, &terms);
    let modulus = SOFT / 0.75;
    let over = |friction: f64| friction * RADIUS / (HALF_WIDTH * LOSS);

    let base = 16.0 * HALF_WIDTH;
    let force = PI * modulus * HALF_WIDTH * HALF_WIDTH / (4.0 * RADIUS);
    let line = slide(&scene, cylinder(4096, base, RADIUS, HALF_WIDTH), speed, force / base);

    // The period has no waves from none to one of it, of which half the first is a part of the integral over all waves; of
    // the sphere the sum of |q_x|/|q| |p_q|² over the waves of a period of 16 a is so much of its integral.
    let of_line = 0.5 * PI * HALF_WIDTH / base;
    let of_point = 0.6079 * (1.0 - 0.97637);

    let force = 4.0 * modulus * HALF_WIDTH.powi(3) / (3.0 * RADIUS);
    let ball = map(512, base, |x, y| -x.hypot(y).min(4.0 * HALF_WIDTH).powi(2) / (2.0 * RADIUS));
    let point = slide(&scene, ball, speed, force / (base * base));

    let row = |name: &str, expected: f64, slide: &SteadySlide| {
        let name = format!("friction of a {name} over tan δ a/R");
        Row::new(name, [expected, over(slide.friction().unwrap())], "", Claim::Share(0.01))
    };
    Comparison {
        about: format!(
            "Rubber with tan δ = {LOSS} at every frequency, as 49 terms have it; a is the half-width at E' there."
        ),
        rows: vec![row("cylinder", 8.0 / (3.0 * PI) - of_line, &line), row("sphere", 0.6079 - of_point, &point)],
        remark: "First order of tan δ; E' grows by 3 % a decade. On an infinite half-space the numbers are 8/(3π) = 0.8488 and \
                 0.6079: what is expected here lacks the long waves that a period of 16 a has not."
            .into(),
        ..Comparison::default()
    }
}
