//! A tread on a road: the layer beside the steady solver, and both beside what is measured.

use asperity::element::{Load, OperatingPoint};
use asperity::scene::Scene;
use asperity_study::decimals::short;
use asperity_study::steady::{SlidingRubber, SteadySolver, SurfaceGrid};
use asperity_study::sweep::{StopBounds, steady_sliding};

use super::root;
use super::row::{Claim, Comparison, Curve, Entry, Picture, Row};

const FILE: &str = "examples/validation/suite/road.rs";
/// Pa.
const PRESSURE: f64 = 3e5;

fn road() -> Scene {
    Scene::load(&root().join("scenes/road/road.toml")).unwrap()
}

/// Friction of a scene by the solver at some speeds, m/s.
fn solved(scene: &Scene, speeds: &[f64]) -> Vec<f64> {
    let rubber = SlidingRubber::new(scene).unwrap();
    let points = SurfaceGrid::points_of_profile(&scene.surface);
    let mut solver = SteadySolver::new(SurfaceGrid::of_profile(&scene.surface, points));
    speeds.iter().map(|&speed| solver.slide(&rubber, speed, PRESSURE).friction().unwrap()).collect()
}

pub const LAYER: Entry = Entry {
    title: "The layer of an FMU and the steady solver on one road",
    reference: "each other",
    source: "the layer as a sweep slides it, which is what its FMU computes (`tests/fmu`: the same bits), and the \
             solver of steady sliding ([steady.md](steady.md)): two models of one thing",
    file: FILE,
    quick: false,
    compare: layer,
};

fn layer() -> Comparison {
    let scene = road();
    let speeds = [1e-3, 3e-2, 1.0];
    let by_solver = solved(&scene, &speeds);
    let area = scene.layer.element_area().unwrap() * scene.layer.masses as f64;
    let temperature = scene.material.as_ref().and_then(|material| material.wlf).map(|wlf| wlf.temperature);
    let by_layer = speeds.map(|speed| {
        let point = OperatingPoint { speed, load: PRESSURE, temperature, way: None };
        let bounds = StopBounds { error: 5e-3, distance: None };
        steady_sliding(&scene, &point, Load::Pressure { area }, bounds).unwrap().friction()
    });
    let row = |((speed, solver), layer): ((f64, f64), f64)| {
        Row::new(format!("friction at {} m/s", short(speed, 2)), [solver, layer], "", Claim::Share(3e-2))
    };
    Comparison {
        about: "`scenes/road`, cold, under 3 bar: 64 masses with fitted links and contacts of the default memory, \
                slid until the standard error of friction is 0.5 %, and the solver on the same profile. Expected is \
                the solver's."
            .into(),
        rows: speeds.into_iter().zip(by_solver).zip(by_layer).map(row).collect(),
        remark: "Slopes count in both. The parts differ more than the whole: friction drags the layer's surface \
                 along, and its links are fitted ([steady.md](steady.md), \"What it is for\"). On rough profiles \
                 resolved by the masses alone the layer's friction is within 20 % of the solver's, its area up to 68 \
                 % too large."
            .into(),
        ..Comparison::default()
    }
}

pub const TREAD: Entry = Entry {
    title: "Friction of a tread on a road",
    reference: "measured magnitudes 1963 to 2019",
    source: "K. A. Grosch, Proc. R. Soc. A 274, 1963, 21; B. Lorenz et al., J. Phys.: Condens. Matter 25, 2013, \
             095007; B. Lorenz, Y. R. Oh, S. K. Nam, S. H. Jeon, B. N. J. Persson, J. Chem. Phys. 142, 2015, 194701; \
             T. V. Tolpekina, B. N. J. Persson, Lubricants 7(3), 2019, 20",
    file: FILE,
    quick: true,
    compare: tread,
};

fn tread() -> Comparison {
    let scene = road();
    let speeds: Vec<f64> = (0..=36).map(|i| 1e-5 * 10.0_f64.powf(f64::from(i) / 6.0)).collect();
    let friction = solved(&scene, &speeds);
    let curve: Vec<(f64, f64)> = speeds.into_iter().zip(friction).collect();
    // The maximum of adhesion: below 0.3 m/s.
    let (place, most) =
        curve.iter().copied().filter(|(speed, _)| *speed < 0.3).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let at = |wanted: f64| {
        curve.iter().min_by(|a, b| (a.0 / wanted).ln().abs().total_cmp(&(b.0 / wanted).ln().abs())).unwrap().1
    };
    let strongest = scene.friction.as_ref().and_then(|friction| friction.rate_shear.as_ref()).unwrap().reference_speed;
    let mut warm = place;
    // Where the maximum lies 20 K warmer.
    let mut hotter = scene.clone();
    hotter.material.as_mut().unwrap().wlf.as_mut().unwrap().temperature += 20.0;
    let speeds: Vec<f64> = curve.iter().map(|point| point.0).collect();
    let hot = solved(&hotter, &speeds);
    let mut largest = 0.0;
    for (&speed, &friction) in speeds.iter().zip(&hot) {
        if friction > largest && speed < 2.0 {
            (warm, largest) = (speed, friction);
        }
    }
    Comparison {
        about: "`scenes/road` by the solver: a compound and an asphalt of literature's magnitudes, 3 bar, 20 °C, \
                cold contacts. The bounds are wide on purpose: compounds, roads and presses differ, and scene and \
                measurement share no sample."
            .into(),
        rows: vec![
            Row::between("largest friction below 0.3 m/s", [0.6, 1.4], most, ""),
            Row::between("its place", [1e-3, 0.1], place, "m/s"),
            Row::between("friction at 1 m/s over that", [0.5, 0.95], at(1.0) / most, ""),
            Row::between("friction at 10 µm/s over that", [0.2, 0.8], at(1e-5) / most, ""),
            Row::between("place of the maximum 20 K warmer, over that at 20 °C", [3.0, 300.0], warm / place, ""),
        ],
        pictures: vec![Picture {
            file: "road.svg",
            caption: "Friction of a tread on a road over the speed at 20 °C and 40 °C",
            x: "speed in m/s",
            y: "friction coefficient",
            is_logarithmic: true,
            curves: vec![Curve::line("20 °C", curve), Curve::line("40 °C", speeds.into_iter().zip(hot).collect())],
        }],
        remark: format!(
            "In words. *Where the maximum lies*: Grosch found one maximum of adhesion, on smooth tracks at centimetres a \
             second near room temperature, and one of hysteresis on rough ones at metres a second and more, both moving \
             with a_T. Lorenz et al. fit a shear strength that is largest at 6 mm/s for one compound. The place here \
             follows that of the scene's shear strength, an input ({} mm/s), so it is no prediction. *Level*: compounds \
             on asphalt and concrete slide at 0.6 to 1.4; here it follows from spectrum, moduli and the shear strength's \
             height, and moves in proportion to the latter and with the shortest wave of the road, which is a choice. \
             *Fall*: measured curves fall above the maximum, where contacts warm too; here adhesion falls, and above \
             1 m/s hysteresis rises again, for which we have no measurement. Nothing of this validates a coefficient for \
             your compound on your road: for that there is `asperity calibrate`.",
            short(1e3 * strongest, 2)
        ),
    }
}
