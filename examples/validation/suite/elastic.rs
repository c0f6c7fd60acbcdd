//! Contacts of elastic bodies: H. Hertz, H. M. Westergaard, and Johnson, Greenwood and Higginson.

use std::f64::consts::{PI, TAU};

use asperity_study::steady::{SlidingRubber, SteadySolver};

use super::row::{Claim, Comparison, Curve, Entry, Picture, Row};
use super::scenes::{largest_pressure, map, rubber, sine, slide};

const FILE: &str = "examples/validation/suite/elastic.rs";
/// E (Pa) and ν of the elastic rubber.
const MODULUS: f64 = 5e6;
const POISSON: f64 = 0.49;

/// E/(1-ν²).
fn plane_modulus() -> f64 {
    MODULUS / (1.0 - POISSON * POISSON)
}

pub const CYLINDER: Entry = Entry {
    title: "A cylinder on an elastic half-plane",
    reference: "Hertz 1882",
    source: "H. Hertz, J. reine angew. Math. 92, 1882, 156; K. L. Johnson, Contact Mechanics, 1985, 4.2",
    file: FILE,
    quick: true,
    compare: cylinder,
};

/// The half-width a under a force of πM a²/(4R) per width, which presses with M a/(2R) at most. The nearest images of
/// the period, 64 half-widths away, are worth 1.64/64² of the curvature.
fn cylinder() -> Comparison {
    let (length, radius) = (1e-2, 5e-3);
    let (half_width, modulus) = (length / 64.0, plane_modulus());
    let force = PI * modulus * half_width * half_width / (4.0 * radius);
    let surface = super::scenes::cylinder(65536, length, radius, half_width);
    let found = slide(&rubber(MODULUS, POISSON, &[]), surface, 1.0, force / length);
    let most = modulus * half_width / (2.0 * radius);
    Comparison {
        about: "A rigid cylinder of 5 mm radius in a period of 64 half-widths, on 65536 points.".into(),
        rows: vec![
            Row::new("half-width", [half_width, 0.5 * found.area * length].map(|x| 1e6 * x), "µm", Claim::Share(1e-3)),
            Row::new("largest pressure", [most, largest_pressure(&found)].map(|x| 1e-3 * x), "kPa", Claim::Share(1e-3)),
        ],
        ..Comparison::default()
    }
}

pub const SPHERE: Entry = Entry {
    title: "A sphere on an elastic half-space",
    reference: "Hertz 1882",
    source: "H. Hertz, J. reine angew. Math. 92, 1882, 156; K. L. Johnson, Contact Mechanics, 1985, 4.2",
    file: FILE,
    quick: true,
    compare: sphere,
};

/// In a square period of eight radii of the contact; the images press by 3.900 F/(πM L).
fn sphere() -> Comparison {
    let (length, radius) = (1e-3, 5e-3);
    let (a, modulus): (f64, f64) = (length / 8.0, plane_modulus());
    let force = 4.0 / 3.0 * modulus * a.powi(3) / radius;
    let surface = map(192, length, |x, y| -(x * x + y * y) / (2.0 * radius));
    let highest = surface.heights.iter().copied().fold(f64::MIN, f64::max);
    let found = slide(&rubber(MODULUS, POISSON, &[]), surface, 1.0, force / (length * length));
    let approach = highest - found.contact.separation + 3.9 * force / (PI * modulus * length);
    let alone = 2.0 * modulus * a / (length * length);
    let stiffness = 1.0 / (1.0 / alone - 3.9 * length / (PI * modulus));
    let factor = found.tangential_stiffness.unwrap() / found.normal_stiffness.unwrap();
    let micrometres = |values: [f64; 2]| values.map(|x| 1e6 * x);
    Comparison {
        about: "A rigid sphere of 5 mm radius in a square period of eight radii of the contact, on 192² points; \
                approach and stiffness with the images' part, 3.900 F/(πML)."
            .into(),
        rows: vec![
            Row::new(
                "radius of the contact",
                micrometres([a, (found.area * length * length / PI).sqrt()]),
                "µm",
                Claim::Share(2e-2),
            ),
            Row::new("approach", micrometres([a * a / radius, approach]), "µm", Claim::Share(2e-2)),
            Row::new(
                "stiffness dF/dδ over the area",
                [stiffness, found.normal_stiffness.unwrap()].map(|x| 1e-9 * x),
                "GPa/m",
                Claim::Share(3e-2),
            ),
            Row::new(
                "tangential over normal stiffness, 2(1-ν)/(2-ν)",
                [2.0 * (1.0 - POISSON) / (2.0 - POISSON), factor],
                "",
                Claim::Share(1e-9),
            ),
        ],
        remark: "The last row is Mindlin's factor, which the solver takes over for maps; it is not derived anew."
            .into(),
        ..Comparison::default()
    }
}

pub const WAVE: Entry = Entry {
    title: "A wavy surface, one-dimensional",
    reference: "Westergaard 1939",
    source: "H. M. Westergaard, J. Appl. Mech. 6, 1939, A-49; K. L. Johnson, Contact Mechanics, 1985, 13.2",
    file: FILE,
    quick: true,
    compare: wave,
};

fn wave() -> Comparison {
    let amplitude = 1e-5;
    let full = 0.5 * plane_modulus() * TAU / 1e-3 * amplitude;
    let exact = |share: f64| 2.0 / PI * share.sqrt().asin();
    let scene = rubber(MODULUS, POISSON, &[]);
    let shares = [0.01, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 0.99];
    let found = shares.map(|share| slide(&scene, sine(4096, amplitude), 1.0, share * full).area);
    let row = |(share, area): (f64, f64)| {
        Row::new(format!("area at p = {share} p*"), [exact(share), area], "", Claim::Of(1.0, 1e-3))
    };
    Comparison {
        about: "a cos qx pressed on an elastic half-plane touches over (2/π) asin √(p/p*), p* = Mqa/2; 4096 points."
            .into(),
        rows: shares.into_iter().zip(found).map(row).collect(),
        pictures: vec![Picture {
            file: "westergaard.svg",
            caption: "Area of contact over the pressure: Westergaard's line, and what was found",
            x: "p / p*",
            y: "area of contact over the whole",
            is_logarithmic: false,
            curves: vec![
                Curve::line("Westergaard", (0..=400).map(|i| f64::from(i) / 400.0).map(|x| (x, exact(x))).collect()),
                Curve::marks("asperity", shares.into_iter().zip(found).collect()),
            ],
        }],
        ..Comparison::default()
    }
}

pub const WAVES: Entry = Entry {
    title: "A wavy surface, two-dimensional",
    reference: "Johnson, Greenwood and Higginson 1985",
    source: "K. L. Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 1985, 383",
    file: FILE,
    quick: true,
    compare: waves,
};

/// The period along both directions, m, and the height of a wave, m.
const PERIOD: f64 = 1e-3;
const HEIGHT: f64 = 5e-6;

fn waves() -> Comparison {
    // |q| is √2 2π/λ, and p* = M |q| Δ/2.
    let full = 2.0_f64.sqrt() * PI * plane_modulus() * HEIGHT / PERIOD;
    let rubber = SlidingRubber::new(&rubber(MODULUS, POISSON, &[])).unwrap();
    let solver = |points: usize| {
        SteadySolver::new(map(points, PERIOD, |x, y| HEIGHT * (TAU * x / PERIOD).cos() * (TAU * y / PERIOD).cos()))
    };
    let few = |share: f64| PI * (3.0 * share / (8.0 * PI)).powf(2.0 / 3.0);
    let almost_all = |share: f64| 1.0 - 1.5 / PI * (1.0 - share);
    let mut fine = solver(512);
    let mut area = |share: f64| fine.slide(&rubber, 1.0, share * full).area;
    let mut rows: Vec<Row> = [5e-4, 1e-3, 2e-3]
        .map(|share| {
            Row::new(format!("area at p = {share} p*, Hertz's caps"), [few(share), area(share)], "", Claim::Share(3e-2))
        })
        .into();
    rows.extend([0.97, 0.98, 0.99].map(|share| {
        let values = [1.0 - almost_all(share), 1.0 - area(share)];
        Row::new(format!("area that is open at p = {share} p*, penny-shaped cracks"), values, "", Claim::Share(3e-2))
    }));
    let shares = [0.005, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98];
    let mut coarse = solver(256);
    let found: Vec<_> = shares.map(|share| (share, coarse.slide(&rubber, 1.0, share * full).area)).into();
    // The least pressure at which all of it touches.
    let (mut open, mut closed) = (0.5 * full, 2.0 * full);
    while closed - open > 1e-7 * full {
        let middle = 0.5 * (open + closed);
        *(if coarse.slide(&rubber, 1.0, middle).contact.is_full { &mut closed } else { &mut open }) = middle;
    }
    rows.push(Row::new("p*, pressure of full contact", [full, closed].map(|p| 1e-3 * p), "kPa", Claim::Share(1e-3)));
    let line = |of: &dyn Fn(f64) -> f64, from: i32, to: i32| -> Vec<_> {
        (from..=to).map(|i| f64::from(i) / 100.0).map(|share| (share, of(share))).collect()
    };
    Comparison {
        about:
            "Δ cos(2πx/λ) cos(2πy/λ) pressed on an elastic half-space, p* = √2 πMΔ/λ: area π(3p/8πp*)^⅔ where little \
                touches, 1 - (3/2π)(1 - p/p*) where nearly all does; 512² points."
                .into(),
        rows,
        pictures: vec![Picture {
            file: "johnson.svg",
            caption: "Area of contact of a two-dimensional wave over the pressure, with both asymptotes",
            x: "p / p*",
            y: "area of contact over the whole",
            is_logarithmic: false,
            curves: vec![
                Curve::line("small pressures", line(&few, 0, 40)),
                Curve::line("near full contact", line(&almost_all, 70, 100)),
                Curve::marks("asperity", found),
            ],
        }],
        remark:
            "Both are asymptotes: what is left of the error is theirs as well as the grid's. Just below p* the solver \
                 takes gaps of less than 10⁻⁷ of the height for closed."
                .into(),
    }
}
