//! The layer's motion beside an independent program's: figure 7 of the paper, and six other cases.

use std::fs;

use asperity::scene::Scene;

use super::root;
use super::row::{Claim, Comparison, Curve, Entry, Picture, Row};
use crate::common::{Table, runs};

pub const CASES: Entry = Entry {
    title: "Figure 7 of the paper, impacts, stick and slip",
    reference: "explicit Runge-Kutta at 1e-11",
    source: "an independent program by explicit Runge-Kutta 8(5,3), events located, at 1e-11 (`tests/reference`); \
             model and figure 7 of F. Schulte, J. Neuhaus, W. Sextro, A mechanical model for the dynamical contact \
             of elastic rough bodies",
    file: "examples/validation/suite/reference.rs",
    quick: true,
    compare: cases,
};

/// The cases, and how far forces may be off over their largest value; of `rattle` the reference itself is no better.
const NAMES: [(&str, f64); 9] = [
    ("figure-7-low", 1e-6),
    ("figure-7-middle", 1e-6),
    ("figure-7-high", 1e-6),
    ("sinusoid", 1e-6),
    ("rattle", 2e-5),
    ("stuck-pair", 1e-6),
    ("rough-coulomb", 1e-6),
    ("rough-shear", 1e-6),
    ("free-chain", 1e-6),
];

fn cases() -> Comparison {
    let mut rows = Vec::new();
    let mut curves = Vec::new();
    let (mut miscounted, mut counted) = (0, 0);
    for (name, allowed) in NAMES {
        let path = root().join(format!("tests/reference/{name}.toml"));
        let text = fs::read_to_string(&path).unwrap();
        let mut scene = Scene::parse(&text, &path).unwrap();
        scene.set_by_name("solver.relative_tolerance", "1e-9").unwrap();
        let wanted = Table::read(&path.with_extension("csv"));
        let found = runs::along_excitation(&scene, ((wanted.len() - 1) / scene.excitation.len()) as u32);
        let off = |column: &str| {
            let (found, wanted) = (found.column(column), wanted.column(column));
            let largest = wanted.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            found.iter().zip(&wanted).map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max) / largest
        };
        let claim = Claim::Of(1.0, allowed);
        rows.push(Row::new(
            format!("{name}: largest error of F_x over its largest value"),
            [0.0, off("F_x")],
            "",
            claim,
        ));
        rows.push(Row::new(format!("{name}: of F_z"), [0.0, off("F_z")], "", claim));
        for column in ["contact.count", "contact.sticking"] {
            let pairs = found.column(column).into_iter().zip(wanted.column(column));
            miscounted += pairs.filter(|(found, wanted)| found != wanted).count();
            counted += wanted.len();
        }
        if let Some(pressed) = name.strip_prefix("figure-7-") {
            // The last phase of three, which draws along x.
            let from = 2 * (wanted.len() - 1) / 3;
            let points = |table: &Table| {
                let (u, force) = (wanted.column("u"), table.column("F_x"));
                u.iter().zip(force).skip(from).map(|(u, force)| (1e6 * u, -1e3 * force)).collect::<Vec<_>>()
            };
            curves.push(Curve::line(format!("{pressed}, reference"), points(&wanted)));
            curves.push(Curve::marks(format!("{pressed}, asperity"), points(&found).into_iter().step_by(5).collect()));
        }
    }
    let what = format!("rows with another number of masses in contact or stuck, of {counted}");
    rows.push(Row::new(what, [0.0, miscounted as f64], "", Claim::Of(counted as f64, 1e-2)));
    Comparison {
        about: "Three layers pressed on a rough profile and drawn along it as in figure 7, masses over a sine, a \
                mass that bounces 33 times, stick and break, Coulomb's and a constant shear strength, and a chain in \
                flight, with `relative_tolerance = 1e-9`."
            .into(),
        rows,
        pictures: vec![Picture {
            file: "figure-7.svg",
            caption: "Tangential force over the displacement at three pressures, as in figure 7 of the paper",
            x: "displacement in µm",
            y: "tangential force in mN",
            is_logarithmic: false,
            curves,
        }],
        remark: "A row right at an event may count otherwise. The paper gives no numbers: its figure is compared by \
                 its shape, stiffer the harder it is pressed, and flat in the end. SUNDIALS' CVODES and ARKODE run \
                 the larger scenes of [benches/peers](../benches/peers), which agree in forces and losses \
                 to 1e-6 before anything is timed there; they are not run for this page."
            .into(),
    }
}
