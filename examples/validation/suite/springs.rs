//! Patches of independent springs: closed forms of Winkler's contact.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;

use asperity::patch::{Patch, PatchMotion, PatchOutput, PatchRun, PatchStart, Pose};

use super::row::{Claim, Comparison, Curve, Entry, Picture, Row};

pub const SPRINGS: Entry = Entry {
    title: "Slope, grip, drilling torque and rolling of a bed of springs",
    reference: "closed forms of Winkler's contact",
    source: "K. L. Johnson, Contact Mechanics, 1985, 4.3 and 8.6; H. B. Pacejka, Tire and Vehicle Dynamics, 2012, \
             3.2 (brush); the spin is that of C. Cattaneo, Ann. Sc. Norm. Sup. Pisa 6, 1952, with springs in place \
             of a half-space",
    file: "examples/validation/suite/springs.rs",
    quick: true,
    compare: springs,
};

/// Pa/m of approach, μ, and Pa/m along the plane.
const SLOPE: f64 = 5e9;
const FRICTION: f64 = 0.9;
const STIFFNESS: f64 = 1.5e9;
/// Of discs and of the wheel, m; turns per time of what spins, 1/s.
const RADIUS: f64 = 0.01;
const WHEEL: f64 = 0.3;
const SPIN: f64 = 1e-3;

/// The table of the bed: the same friction at all speeds, from 1 Pa on.
fn table() -> String {
    let mut text = "# asperity sweep = 1\n# nominal_area = 1 m2\n# rest_separation = 0 m\nspeed [m/s],pressure [Pa],\
                    temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]\n"
        .to_owned();
    for pressure in (0..=56).map(|i| 10.0_f64.powf(f64::from(i) / 8.0)) {
        for speed in ["1e-12", "50"] {
            let separation = -pressure / SLOPE;
            writeln!(text, "{speed},{pressure:e},,steady,{FRICTION},{separation:e},{STIFFNESS:e}").unwrap();
        }
    }
    text
}

/// A patch with this face, whose points (x, y, z, area) stand in a file beside it.
fn patch(face: &str, points: &[[f64; 4]]) -> Patch {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("springs.csv"), table()).unwrap();
    let lines: Vec<String> = points.iter().map(|[x, y, z, a]| format!("{x:e},{y:e},{z:e},{a:e}")).collect();
    fs::write(folder.path().join("points.csv"), format!("x,y,z,area\n{}\n", lines.join("\n"))).unwrap();
    let text =
        format!("name = 'springs'\n[table]\npath = 'springs.csv'\n[patch]\n{face}\n[fmu]\noutputs = ['forces']\n");
    Patch::parse(&text, &folder.path().join("patch.toml")).unwrap()
}

/// A disc of rings of equal width, whose points lie at `height` of the radius as a share of the disc's.
fn disc(rings: usize, height: impl Fn(f64) -> f64) -> Patch {
    const SPOKES: usize = 8;
    let mut points = Vec::new();
    for (ring, spoke) in (0..rings).flat_map(|ring| (0..SPOKES).map(move |spoke| (ring, spoke))) {
        let (inner, outer) = (ring as f64 / rings as f64, (ring + 1) as f64 / rings as f64);
        let middle = 0.5 * (inner + outer);
        let area = PI * RADIUS * RADIUS * (outer * outer - inner * inner) / SPOKES as f64;
        let angle = 2.0 * PI * (spoke as f64 + 0.5) / SPOKES as f64;
        points.push([RADIUS * middle * angle.cos(), RADIUS * middle * angle.sin(), height(middle), area]);
    }
    patch("shape = 'points'\npath = 'points.csv'", &points)
}

fn start(patch: &Patch, height: f64, rates: [f64; 6], transport_speed: f64) -> PatchRun {
    let pose = Pose::from_coordinates([0.0, 0.0, height, 0.0, 0.0, 0.0]);
    PatchRun::new(patch, &PatchStart { time: 0.0, pose, rates, transport_speed, temperature: patch.temperature() })
        .unwrap()
}

fn go(run: &mut PatchRun, patch: &Patch, duration: f64, rates: [f64; 6], transport_speed: f64) {
    run.advance(&PatchMotion { duration, rates, transport_speed, temperature: patch.temperature() }).unwrap();
}

/// Forces along and moments about x, y and z.
fn wrench(run: &mut PatchRun, patch: &Patch) -> [f64; 6] {
    std::array::from_fn(|i| {
        let output = if i < 3 { PatchOutput::Force(i) } else { PatchOutput::Moment(i - 3) };
        let variables: Vec<_> = patch.variables().into_iter().filter(|variable| variable.output == output).collect();
        let mut values = [f64::NAN];
        run.evaluate(&variables, &mut values);
        values[0]
    })
}

/// The moment of a disc that is pressed to `height` and has turned by an angle, over μNa.
fn moment(patch: &Patch, height: f64, angle: f64) -> f64 {
    let rates = [0.0, 0.0, 0.0, 0.0, 0.0, SPIN];
    let mut run = start(patch, height, rates, 0.0);
    (0..20).for_each(|_| go(&mut run, patch, angle / SPIN / 20.0, rates, 0.0));
    let [_, _, normal, _, _, moment] = wrench(&mut run, patch);
    -moment / (FRICTION * normal * RADIUS)
}

/// Largest pressure of the discs, Pa.
const PRESSURE: f64 = 4e5;
/// Far beyond the angle at which the last spring slips.
const WHOLE_SLIP: f64 = 10.0;

fn springs() -> Comparison {
    let mut rows = slope_and_grip();
    let claim = Claim::Share(1e-3);
    let even = disc(200, |_| 0.0);
    let depth = -PRESSURE / SLOPE;
    // The angle, over that at which the rim of the even disc slips.
    let unit = FRICTION * PRESSURE / (STIFFNESS * RADIUS);
    let drilling = moment(&even, depth, WHOLE_SLIP);
    rows.push(Row::new("drilling torque of a disc under even pressure, over μNa", [2.0 / 3.0, drilling], "", claim));
    let hertz = disc(400, |share| -PRESSURE * (1.0 - share * share).sqrt() / SLOPE);
    let exact = 3.0 * PI / 16.0;
    rows.push(Row::new("the same under Hertz's pressure", [exact, moment(&hertz, 0.0, WHOLE_SLIP)], "", claim));
    let paraboloid = disc(400, |share| -PRESSURE * (1.0 - share * share) / SLOPE);
    let mut found = Vec::new();
    for part in [0.2, 0.5, 1.0, 2.0, 5.0] {
        found.push((part, moment(&paraboloid, 0.0, part * unit)));
        let what = format!("spin of a paraboloid by {part} μp_0/ka, moment over μNa");
        rows.push(Row::new(what, [spin(part), found[found.len() - 1].1], "", claim));
    }
    rows.extend(brush());
    Comparison {
        about: "Springs of their own along and across the plane, with Coulomb's friction, μ = 0.9, as a table of 5e9 \
                Pa/m and 1.5e9 Pa/m. Discs of 200 and 400 rings; a wheel of 0.3 m pressed by 60 µm, of 640 cells."
            .into(),
        rows,
        pictures: vec![Picture {
            file: "spin.svg",
            caption: "Moment of a paraboloid on springs that spins, from stick to slip",
            x: "angle over μp₀/(ka)",
            y: "moment over μNa",
            is_logarithmic: false,
            curves: vec![
                Curve::line("closed form", (0..=100).map(|i| 0.05 * f64::from(i)).map(|x| (x, spin(x))).collect()),
                Curve::marks("asperity", found),
            ],
        }],
        ..Comparison::default()
    }
}

/// Under p_0 (1 - r²/a²) springs slip beyond the radius c where kθc = μp_0 (1 - c²/a²).
fn spin(part: f64) -> f64 {
    let c = -0.5 * part + (0.25 * part * part + 1.0).sqrt();
    let slipping = |r: f64| r.powi(3) / 3.0 - r.powi(5) / 5.0;
    // Over μ N a with N = π a² p_0/2.
    4.0 * (part * c.powi(4) / 4.0 + slipping(1.0) - slipping(c))
}

/// A block on a slope creeps by Q/kA and slides at tan α = μ; two pads hold 2μN.
fn slope_and_grip() -> Vec<Row> {
    let patch = patch("shape = 'flat'\nlength = 0.02\nwidth = 0.01\nnx = 5\nny = 3", &[]);
    let area = 2e-4;
    let rates = [1e-6, 0.0, 0.0, 0.0, 0.0, 0.0];
    let drag = |way: f64| {
        let mut run = start(&patch, -2e5 / SLOPE, rates, 0.0);
        go(&mut run, &patch, way / 1e-6, rates, 0.0);
        let [x, _, z, ..] = wrench(&mut run, &patch);
        [-x, z]
    };
    let ([held, _], [slid, normal]) = (drag(1e-5), drag(1e-3));
    let degrees = [FRICTION, slid / normal].map(|tangent| tangent.atan().to_degrees());
    vec![
        Row::new("force of a block drawn by 10 µm", [STIFFNESS * area * 1e-5, held], "N", Claim::Share(1e-3)),
        Row::new("slope on which a block slides", degrees, "°", Claim::Share(1e-3)),
        Row::new(
            "load that two pads hold, pressed at 0.2 MPa",
            [2.0 * FRICTION * 2e5 * area, 2.0 * slid],
            "N",
            Claim::Share(1e-3),
        ),
    ]
}

/// The brush on a parabola of pressure, half of whose length is a: μN(3q - 3q² + q³), q = 2ka²bσ/(3μN). The tread of a
/// drive runs on the arc, by x²/2R² slower along x, which counts as slip.
fn brush() -> Vec<Row> {
    let (width, depth, speed) = (0.01_f64, 6e-5_f64, 2.0);
    let half = (WHEEL * WHEEL - (WHEEL - depth) * (WHEEL - depth)).sqrt();
    let length = 2.1 * half;
    let face = format!(
        "shape = 'cylinder'\nradius = {WHEEL}\nlength = {length}\nwidth = {width}\nnx = 640\nny = 1\ntransport = true"
    );
    let patch = patch(&face, &[]);
    let mut rows = Vec::new();
    for (slip, side) in [(0.01_f64, 0.0_f64), (0.03, 0.0), (0.0, 0.02), (0.0, 0.045)] {
        let rates = [speed * (1.0 + slip), speed * side, 0.0, 0.0, 0.0, 0.0];
        let mut run = start(&patch, WHEEL - depth, rates, speed);
        // A whole number of cells, so that the face ends as it began.
        let cell = length / 640.0 / speed;
        (0..30).for_each(|_| go(&mut run, &patch, 64.0 * cell, rates, speed));
        let [x, y, normal, _, _, moment] = wrench(&mut run, &patch);
        let most = FRICTION * normal;
        if side == 0.0 {
            let exact = most * driven(slip, half, most / width);
            rows.push(Row::new(
                format!("drive slip of {} %, force", 100.0 * slip),
                [exact, -x],
                "N",
                Claim::Share(1e-3),
            ));
            continue;
        }
        let q = (2.0 * STIFFNESS * half * half * width * side / (3.0 * most)).min(1.0);
        let force = most * (3.0 * q - 3.0 * q * q + q * q * q);
        let exact = most * half * q * (1.0 - q).powi(3);
        let what = format!("side slip of {} %", 100.0 * side);
        rows.push(Row::new(format!("{what}, force"), [force, -y], "N", Claim::Share(1e-3)));
        let largest = 1e3 * most * half * 27.0 / 256.0;
        let moments = [1e3 * exact, 1e3 * moment];
        rows.push(Row::new(format!("{what}, moment"), moments, "mN m", Claim::Of(largest, 1e-3)));
    }
    rows
}

/// The force of the brush over μN (`most`, N/m of width): bristles bend by σ(a - x) + (a³ - x³)/6R² until they slip.
fn driven(slip: f64, half: f64, most: f64) -> f64 {
    let parts = 100_000;
    let traction = |i: usize| {
        let x = half * (1.0 - 2.0 * (i as f64 + 0.5) / parts as f64);
        let bend = slip * (half - x) + (half.powi(3) - x.powi(3)) / (6.0 * WHEEL * WHEEL);
        let limit = 0.75 * most / half * (1.0 - x * x / (half * half));
        limit.min(STIFFNESS * bend)
    };
    (0..parts).map(traction).sum::<f64>() * 2.0 * half / parts as f64 / most
}
