use asperity::scene::{Scene, Setting};

use super::*;
use crate::files::parse_scene;

const SCENE: &str = "
name = 'rough'
layer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = 1e-2 }
friction = { rate_shear = { strength = 1e6, reference_speed = 1.0, sharpness = 0.1 } }
[material]
density = 1e3
poisson_ratio = 0.5
equilibrium_modulus = 2e6
prony = [{ relaxation_time = 1e-6, modulus = 5e6 }, { relaxation_time = 1e-2, modulus = 1e6 }]
wlf = { c1 = 8.86, c2 = 101.6, reference_temperature = 293.15, temperature = 293.15 }
[surface]
kind = 'self_affine'
length = 0.1
points = 2000
hurst = 0.8
rms = 2e-5
roll_off_wavelength = 5e-3
cut_off_wavelength = 1e-4
seed = 7
fine = { shortest = 2e-6 }
[uncertainty]
";

fn uncertain(section: &str) -> UncertainScene {
    let text = format!("{SCENE}{section}");
    let scene = parse_scene(&text, "rough.toml".as_ref(), &[]).unwrap_or_else(|error| panic!("{error}"));
    UncertainScene::new(scene).unwrap()
}

fn sampler(scene: &UncertainScene, count: usize) -> Sampler {
    Sampler::new(scene.axes(), SampleOptions { count, seed: 1 }).unwrap()
}

fn all(scene: &UncertainScene, count: usize) -> Vec<Drawn> {
    scene.draw_all(&sampler(scene, count), Ok).unwrap().made
}

/// Mean and deviation of the logarithm, or of the number.
fn moments(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    let numbers: Vec<f64> = numbers.collect();
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    (mean, (numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt())
}

#[test]
fn numbers_are_drawn_as_the_section_says() {
    let scene = uncertain(
        "'friction.rate_shear.strength' = { relative = 0.1 }\n'surface.fine.shortest' = { factor = 2.0 }\n\
         'material.wlf.temperature' = { absolute = '2 °C' }\n'layer.width' = { absolute = '0.2 mm' }\n",
    );
    let drawn = all(&scene, 256);
    let of = |number: fn(&Scene) -> f64| moments(drawn.iter().map(|drawn| number(&drawn.scene)));
    let rate_shear = |scene: &Scene| scene.friction.clone().unwrap().rate_shear.unwrap().strength.unwrap();
    // Of 256 points of a net: the mean of a stratified sample.
    let (mean, deviation) = of_logarithm(&drawn, rate_shear);
    assert!((mean - 1e6_f64.ln()).abs() < 2e-3 && (deviation - 0.1).abs() < 2e-3, "{mean} {deviation}");
    let shortest = |scene: &Scene| scene.fine.clone().unwrap().waves.shortest().unwrap();
    let (mean, deviation) = of_logarithm(&drawn, shortest);
    let wanted = 2.0 * 2.0_f64.ln() / 12.0_f64.sqrt();
    assert!((mean - 2e-6_f64.ln()).abs() < 5e-3 && (deviation - wanted).abs() < 5e-3, "{mean} {deviation}");
    let (mean, deviation) = of(|scene| scene.material.clone().unwrap().wlf.unwrap().temperature);
    assert!((mean - 293.15).abs() < 0.02 && (deviation - 2.0).abs() < 0.05, "{mean} {deviation}");
    let (mean, deviation) = of(|scene| scene.layer.width.unwrap());
    assert!((mean - 1e-2).abs() < 2e-6 && (deviation - 2e-4).abs() < 5e-6, "{mean} {deviation}");
    assert!(drawn.iter().all(|drawn| drawn.normals.len() == 4));
}

fn of_logarithm(drawn: &[Drawn], number: impl Fn(&Scene) -> f64) -> (f64, f64) {
    moments(drawn.iter().map(|drawn| number(&drawn.scene).ln()))
}

/// What is derived follows: the waves that the profile lacks go on from the drawn law.
#[test]
fn all_that_is_derived_follows() {
    let scene =
        uncertain("'surface.rms' = { relative = 0.3 }\nsurface = 'seed'\n'material.prony' = { relative = 0.2 }\n");
    for drawn in all(&scene, 16) {
        let value = |name: &str| drawn.values.iter().find(|(key, _)| key == name).unwrap().1;
        let set = [("surface.rms", value("surface.rms")), ("surface.seed", value("surface"))];
        let set = set.map(|(key, number)| Setting::parse(key, &number.to_string()));
        let wanted = parse_scene(SCENE, "rough.toml".as_ref(), &set).unwrap();
        assert_eq!((&drawn.scene.surface, drawn.scene.fine_bands()), (&wanted.surface, wanted.fine_bands()));
        let moduli: Vec<f64> = drawn.scene.material.unwrap().prony.iter().map(|term| term.modulus).collect();
        assert_eq!(moduli, [1, 2].map(|i| value(&format!("material.prony[{i}].modulus"))));
    }
}

#[test]
fn neighbouring_moduli_move_together() {
    let scene = uncertain("'material.prony' = { relative = 0.2 }\n");
    let drawn = all(&scene, 1024);
    let logarithm = |drawn: &Drawn, i: usize| {
        let term = scene.scene().material.clone().unwrap().prony[i];
        (drawn.scene.material.clone().unwrap().prony[i].modulus / term.modulus).ln() / 0.2
    };
    // Four decades apart: exp(-½ 2²).
    let product = drawn.iter().map(|drawn| logarithm(drawn, 0) * logarithm(drawn, 1)).sum::<f64>() / 1024.0;
    assert!((product - (-2.0_f64).exp()).abs() < 0.03, "{product}");
    assert!((moments(drawn.iter().map(|drawn| logarithm(drawn, 0))).1 - 1.0).abs() < 0.02);
}

#[test]
fn a_sample_is_the_same_among_more_and_beside_others() {
    let scene =
        uncertain("'surface.rms' = { relative = 0.3 }\n'surface.spectrum' = { relative = 0.2, each = 'decade' }\n");
    let (few, many) = (all(&scene, 32), all(&scene, 128));
    assert_eq!((few[17].values.clone(), &few[17].scene), (many[17].values.clone(), &many[17].scene));
    // Keys of the same name are drawn alike in another scene, where the axes are those of both.
    let other = uncertain("'surface.rms' = { relative = 0.3 }\n'layer.width' = { relative = 0.1 }\n");
    let axes = [scene.axes(), other.axes()].concat();
    let sampler = Sampler::new(axes, SampleOptions { count: 32, seed: 1 }).unwrap();
    let draws = UncertainScene::draw_together(&[&scene, &other], &sampler, Ok).unwrap();
    for both in draws.made {
        let rms = |drawn: &Drawn| drawn.values.iter().find(|(key, _)| key == "surface.rms").unwrap().1;
        assert_eq!(rms(&both[0]), rms(&both[1]));
    }
}

#[test]
fn what_the_scene_refuses_is_drawn_anew_and_counted() {
    // Beyond 1 a Hurst exponent is none: 4 % of the draws.
    let scene = uncertain("'surface.hurst' = { absolute = 0.115 }\n");
    let sampler = sampler(&scene, 128);
    let draws = scene.draw_all(&sampler, Ok).unwrap();
    assert!((2..=10).contains(&draws.redrawn), "{}", draws.redrawn);
    assert!(draws.made.iter().all(|drawn| drawn.scene.surface.self_affine().unwrap().hurst <= 1.0));
    let scene = uncertain("'surface.hurst' = { absolute = 0.3 }\n");
    let error = scene.draw_all(&sampler_of(&scene), Ok).unwrap_err().to_string();
    assert!(error.contains("draws are no scene") && error.contains("give surface.hurst less"), "{error}");
}

fn sampler_of(scene: &UncertainScene) -> Sampler {
    sampler(scene, 64)
}
