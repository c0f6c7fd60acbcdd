//! Sweeps with samples.

use std::ops::ControlFlow;
use std::sync::Mutex;

use asperity::element::{OperatingPoint, Quantity};
use asperity::scene::Setting;

use super::*;
use crate::files::parse_scene;
use crate::progress::Stop;
use crate::uncertainty::{SampleOptions, UncertainScene, inverse_normal};
use crate::values::Values;

/// A sine pressed flat, so that all of it touches: friction is the shear strength over the pressure, and hysteresis none.
const FLAT: &str = "
name = 'pressed flat'
layer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = 1e-2 }
friction = { rate_shear = { strength = 2e5, reference_speed = 1.0, sharpness = 0.0 } }
[material]
density = 1e3
poisson_ratio = 0.5
equilibrium_modulus = 2e6
prony = []
[surface]
kind = 'sinusoid'
amplitude = 1e-7
wavelength = 1e-3
points_per_wavelength = 16
[uncertainty]
";

/// A rough surface in part of its contact, with waves below the profile.
const ROUGH: &str = "
name = 'rough'
layer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = 1e-2 }
friction = { rate_shear = { strength = 6e6, reference_speed = 1.0, sharpness = 0.1 } }
[material]
density = 1e3
poisson_ratio = 0.5
equilibrium_modulus = 2e6
prony = [{ relaxation_time = 1e-6, modulus = 5e7 }, { relaxation_time = 1e-3, modulus = 1e7 }]
wlf = { c1 = 8.86, c2 = 101.6, reference_temperature = 293.15, temperature = 293.15 }
[surface]
kind = 'self_affine'
length = 0.02
points = 256
hurst = 0.8
rms = 1e-5
roll_off_wavelength = 5e-3
cut_off_wavelength = 5e-4
seed = 7
fine = { shortest = 1e-5 }
[uncertainty]
";

fn uncertain(text: &str, section: &str) -> UncertainScene {
    let text = format!("{text}{section}");
    let scene = parse_scene(&text, "scene.toml".as_ref(), &[]).unwrap_or_else(|error| panic!("{error}"));
    UncertainScene::new(scene).unwrap()
}

fn options(speeds: &[f64], temperatures: Option<&[f64]>) -> SweepOptions {
    SweepOptions {
        speeds: Some(Values(speeds.to_vec())),
        pressures: Some(Values(vec![2e5, 4e5])),
        temperatures: temperatures.map(|values| Values(values.to_vec())),
        ..SweepOptions::default()
    }
}

fn plan(scene: &UncertainScene, options: &SweepOptions, count: usize, seed: u64) -> SweepPlan {
    SweepPlan::with_samples(scene, options, None, SampleOptions { count, seed })
        .unwrap_or_else(|error| panic!("{error}"))
}

fn rows(plan: &SweepPlan, points: &[OperatingPoint]) -> Vec<SweepRow> {
    let rows = Mutex::new(Vec::new());
    let _: ControlFlow<()> = plan.find(points, &Stop::default(), |row| {
        rows.lock().unwrap().push(row);
        ControlFlow::Continue(())
    });
    rows.into_inner().unwrap()
}

fn table(plan: &SweepPlan) -> SweepTable {
    let points: Vec<OperatingPoint> = plan.header().grid.points().collect();
    SweepTable::new(plan.header().clone(), rows(plan, &points))
}

/// 0.4 MPa are more than a tenth of M = 2e6/0.75 Pa.
#[test]
fn a_pressure_that_is_too_much_is_told_before_whatever_slides() {
    for method in [SweepMethod::Layer, SweepMethod::Steady] {
        let mut asked = options(&[1.0], None);
        asked.sliding.method = Some(method);
        let scene = parse_scene(FLAT, "scene.toml".as_ref(), &[]).unwrap();
        let plan = SweepPlan::new(scene, &asked, None).unwrap();
        let first = plan.first_warnings();
        assert!(first.len() == 1 && first[0].contains("the largest of `pressures` = 400000.0 Pa"), "{first:?}");
    }
}

/// Adhesion alone: friction is as log-normal as the strength. Quantiles lie within three standard errors of independent
/// samples, and over seeds their error falls faster than N^-0.7.
#[test]
fn quantiles_of_adhesion_are_those_of_the_strength() {
    let scene = uncertain(FLAT, "'friction.rate_shear.strength' = { relative = 0.1 }\n");
    let one = options(&[1.0], None);
    let square_error = |count: usize, seed: u64| {
        let plan = plan(&scene, &one, count, seed);
        let point = plan.header().grid.point(0);
        let row = rows(&plan, &[point]).remove(0);
        let (own, samples) = (row.value(Quantity::Friction).unwrap(), row.samples.unwrap());
        assert_eq!(samples.results(), count);
        let mut square = 0.0;
        for p in [0.05, 0.25, 0.5, 0.75, 0.95] {
            let z = inverse_normal(p);
            let off = (samples.quantile(Sampled::Friction, p).unwrap() / own).ln() - 0.1 * z;
            // √(p (1 - p)/N) over the density.
            let density = (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt() / 0.1;
            let error = (p * (1.0 - p) / count as f64).sqrt() / density;
            assert!(off.abs() < 3.0 * error, "{count}, {seed}, {p}: {off} of {error}");
            square += off * off / 5.0;
        }
        square
    };
    let rms = |count: usize| ((1..=8).map(|seed| square_error(count, seed)).sum::<f64>() / 8.0).sqrt();
    let errors = [64, 256, 1024].map(rms);
    let exponent = (errors[2] / errors[0]).ln() / 16.0_f64.ln();
    assert!(exponent < -0.7, "{errors:?}: N^{exponent}");
}

/// Friction is the strength over the pressure: elasticities 1 and 0; and with a strength of creep as well.
#[test]
fn what_matters_is_what_acts() {
    let scene = uncertain(
        FLAT,
        "'friction.rate_shear.strength' = { relative = 0.1 }\n'layer.width' = { relative = 0.3 }\n\
         'material.density' = { factor = 2.0 }\n",
    );
    let plan = plan(&scene, &options(&[0.1, 1.0], None), 256, 1);
    let table = table(&plan);
    let matters = plan.matters(&table.rows).unwrap();
    assert_eq!(matters.groups, ["friction.rate_shear.strength", "layer.width", "material.density"]);
    let indices = matters.points.iter().map(|matter| &matter.indices).chain(&matters.mean);
    for found in indices {
        for (index, wanted) in found.groups.iter().zip([1.0, 0.0, 0.0]) {
            assert!((index.share - wanted).abs() < 0.05, "{found:?}");
        }
    }
    assert_eq!((matters.points.len(), matters.largest()[0].0), (4, "friction.rate_shear.strength"));
    assert_eq!(matters.table(plan.header().load).len(), 5 * 4);
}

/// In any parts, among more samples, and continued: the same.
#[test]
fn samples_are_the_same_in_any_parts() {
    let scene = uncertain(
        ROUGH,
        "'friction.rate_shear.strength' = { relative = 0.1 }\n'surface.fine.shortest' = { factor = 2.0 }\n\
         surface = 'seed'\n'surface.spectrum' = { relative = 0.2, each = 'decade' }\n'material.prony' = { relative = 0.1 }\n",
    );
    let options = options(&[0.1, 1.0], None);
    let whole = plan(&scene, &options, 16, 3);
    let first = table(&whole);
    // By itself, one point after the other, on one thread.
    let again = plan(&scene, &options, 16, 3);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let points: Vec<OperatingPoint> = again.header().grid.points().collect();
    let parts: Vec<SweepRow> =
        pool.install(|| points.iter().rev().flat_map(|point| rows(&again, std::slice::from_ref(point))).collect());
    let second = SweepTable::new(again.header().clone(), parts);
    assert_eq!(first.text(), second.text());
    assert_eq!((first.ranking().len(), first.header.keys.has("ranking")), (16, true));
    // Sample 7 of 16 is sample 7 of 32.
    let more = table(&plan(&scene, &options, 32, 3));
    for (few, many) in first.rows.iter().zip(&more.rows) {
        for sampled in first.header.samples.unwrap().sampled().iter().copied() {
            let of = |row: &SweepRow| row.samples.as_ref().unwrap().of(sampled)[..16].to_vec();
            assert_eq!(of(few), of(many));
        }
    }
    assert_ne!(first.header.fingerprint(), more.header.fingerprint());
    // What stands without samples stands there too.
    let (own, text) = (SweepPlan::new(scene.scene().clone(), &options, None).unwrap(), first.text());
    let own = table(&own);
    for (with, without) in first.rows.iter().zip(&own.rows) {
        let mut with = with.clone();
        with.samples = None;
        assert_eq!(with, *without);
    }
    assert_eq!(SweepTable::parse(&text, "t.csv".as_ref()).unwrap().ranking(), first.ranking());
    assert_eq!(whole.samples_table(&first.rows).len(), 16 * 4);
}

/// One solution for each sample and the scene's own at each point, and the surface shared where it is the same.
#[test]
fn samples_cost_as_many_solutions() {
    let scene = uncertain(ROUGH, "'friction.rate_shear.strength' = { relative = 0.1 }\n");
    let plan = plan(&scene, &options(&[0.1], None), 64, 1);
    let point = plan.header().grid.point(0);
    rows(&plan, &[point]);
    assert_eq!(plan.solutions(), 65);
}

/// The rubber of a sample is as much warmer than the point as it was drawn warmer than the scene.
#[test]
fn a_drawn_temperature_moves_all_temperatures() {
    let scene = uncertain(ROUGH, "'material.wlf.temperature' = { absolute = 2.0 }\n");
    let own = table(&plan(&scene, &options(&[0.1], None), 16, 1));
    let there = table(&plan(&scene, &options(&[0.1], Some(&[293.15, 313.15])), 16, 1));
    assert_eq!(own.rows[0].samples, there.rows[0].samples);
    let spread = |row: &SweepRow| {
        let at = |p| row.samples.as_ref().unwrap().quantile(Sampled::Friction, p).unwrap();
        at(0.95) / at(0.05)
    };
    assert!(
        there.rows.iter().all(|row| spread(row) > 1.005),
        "{:?}",
        there.rows.iter().map(spread).collect::<Vec<_>>()
    );
}

/// The table of the sample at a quantile is that of the scene with what was drawn set.
#[test]
fn a_quantile_is_a_sample_of_its_own() {
    let scene =
        uncertain(ROUGH, "'friction.rate_shear.strength' = { relative = 0.1 }\n'surface.rms' = { relative = 0.1 }\n");
    let options = options(&[0.1, 1.0], None);
    let plan = plan(&scene, &options, 16, 1);
    let swept = table(&plan);
    let low = quantile_table(&scene, &swept, 0.05, &Stop::default()).unwrap();
    let number = swept.ranking()[0];
    assert!(low.header.keys.text_of("sample").unwrap().starts_with(&format!("{number} of 16, seed 1: quantile 0.05")));
    let drawn: Vec<Setting> =
        plan.drawn().into_iter().map(|(key, values)| Setting::new(key, values[number - 1])).collect();
    let set = parse_scene(ROUGH, "scene.toml".as_ref(), &drawn).unwrap();
    let wanted = table(&SweepPlan::new(set, &options, None).unwrap());
    for ((low, wanted), own) in low.rows.iter().zip(&wanted.rows).zip(&swept.rows) {
        assert_eq!(low, wanted);
        let sample = own.samples.as_ref().unwrap().of(Sampled::Friction)[number - 1];
        assert_eq!(low.value(Quantity::Friction), sample);
    }
    let error = quantile_table(&scene, &wanted, 0.05, &Stop::default()).unwrap_err().to_string();
    assert!(error.contains("table of a sweep with samples"), "{error}");
    let other = uncertain(ROUGH, "'friction.rate_shear.strength' = { relative = 0.2 }\n");
    let error = quantile_table(&other, &swept, 0.05, &Stop::default()).unwrap_err().to_string();
    assert!(error.starts_with("the table is of another sweep"), "{error}");
}
