use super::*;
use crate::csv::Csv;
use crate::files::parse_scene;
use crate::progress::Stop;
use crate::sweep::SweepOptions;
use crate::uncertainty::SampleOptions;
use crate::values::Values;

/// An elastic sine on which all friction is a shear strength over a constant real area, and a coefficient.
fn scene(name: &str, strength: f64, uncertain: &str) -> RankScene {
    let text = format!(
        "name = '{name}'\nlayer = {{ foundation = 'half_space', masses = 16, spacing = 6.25e-5, width = 1e-2 }}\n\
         material = {{ density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 3e6, prony = [] }}\n\
         [surface]\nkind = 'sinusoid'\namplitude = 1e-5\nwavelength = 1e-3\npoints_per_wavelength = 64\n\
         fine = {{ rms_slope = 1.0, modulus = 4e7 }}\n[friction]\nshear_strength = {strength}\n{uncertain}"
    );
    let file = std::path::PathBuf::from(format!("{name}.toml"));
    let scene = parse_scene(&text, &file, &[]).unwrap_or_else(|error| panic!("{error}"));
    RankScene { scene, file }
}

const TEN_PER_CENT: &str = "[uncertainty]\n'friction.shear_strength' = { relative = 0.1 }\n";

fn plan(scenes: Vec<RankScene>, count: usize) -> RankPlan {
    let options = SweepOptions {
        speeds: Some(Values(vec![0.1, 1.0])),
        pressures: Some(Values(vec![2e4, 4e4])),
        ..SweepOptions::default()
    };
    RankPlan::new(scenes, options, SampleOptions { count, seed: 1 }).unwrap()
}

fn found(plan: &RankPlan) -> RankFound {
    plan.find(&Weights::default(), &Stop::default(), &|| ()).unwrap()
}

fn ranked(scenes: Vec<RankScene>) -> Ranking {
    found(&plan(scenes, 64)).ranking
}

#[test]
fn two_equal_scenes_are_above_each_other_with_a_half_exactly() {
    let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 6.5e6, TEN_PER_CENT)]);
    assert_eq!(ranking.pairs, [Pair { scenes: [0, 1], above: 0.5, ties: 1.0 }]);
    assert_eq!((ranking.samples, ranking.is_sure()), (64, false));
    assert!(ranking.points.iter().all(|point| point.largest == [0.5, 0.5]));
}

/// Each is known to 10 %, and they differ by 1 %: as their strengths err together they are told apart.
#[test]
fn what_scenes_share_drops_out() {
    let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 6.565e6, TEN_PER_CENT)]);
    let ([first, _], above) = ranking.first_two().unwrap();
    assert_eq!((first.label.as_str(), above, ranking.is_sure()), ("b", 1.0, true));
    // Friction is proportional to the strength.
    let band = first.index_band.unwrap();
    assert!(band.iter().all(|index| (index - 101.0).abs() < 0.01), "{band:?}");
    let friction = first.friction_band.unwrap();
    // Quantiles of a log-normal 3.29 deviations apart, within those of 64 points.
    assert!(((friction[4] / friction[0]).ln() / 0.329 - 1.0).abs() < 0.1, "{friction:?}");
    // Of keys of different names nothing is shared: 1 % is little beside 10 % of either.
    let other = "[uncertainty]\n'surface.fine.modulus' = { relative = 0.1 }\n";
    let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 6.565e6, other)]);
    let (_, above) = ranking.first_two().unwrap();
    assert!(!ranking.is_sure() && above < 0.7, "{above}");
}

/// One of which everything is known takes part with its own numbers, and without any uncertainty there is no band.
#[test]
fn known_scenes_take_part() {
    let plan_of = |uncertain| plan(vec![scene("a", 6.5e6, uncertain), scene("b", 7e6, "")], 64);
    let mixed = plan_of(TEN_PER_CENT);
    assert_eq!((mixed.known(), mixed.sweeps(), mixed.has_samples()), (vec!["b"], 66, true));
    let ranking = found(&mixed).ranking;
    let (_, above) = ranking.first_two().unwrap();
    // ln(7/6.5) is 0.74 deviations: Φ(0.74) = 0.771.
    assert!((above - 0.771).abs() < 0.03, "{above}");
    let known = plan_of("");
    let ranking = found(&known).ranking;
    assert_eq!((known.has_samples(), ranking.first_two(), ranking.order.clone()), (false, None, vec![1, 0]));
    assert_eq!((ranking.scenes[1].index_band, ranking.pairs.len()), (None, 0));
}

#[test]
fn a_table_has_a_row_for_each_point_and_scene() {
    let ranking = ranked(vec![scene("a", 6.5e6, TEN_PER_CENT), scene("b", 7e6, "")]);
    let csv = Csv::parse(&table(&ranking), None).unwrap();
    assert_eq!((csv.rows.len(), csv.names.len()), (8, 12));
    let column = |name: &str| csv.column(name).unwrap();
    let row = &csv.rows[1].fields;
    assert_eq!([&*row[0], &*row[column("weight")], &*row[column("largest")]][..2], ["b", "0.25"]);
    assert_eq!(row[column("friction")], row[column("friction_0.95")], "everything is known of b");
}

#[test]
fn measured_friction_is_ranked_beside() {
    let folder = std::env::temp_dir().join(format!("asperity-rank-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("measured.csv");
    let plan = plan(vec![scene("a", 6.5e6, ""), scene("b", 7e6, ""), scene("c", 6e6, "")], 64);
    let found = found(&plan);
    let write = |rows: &str| std::fs::write(&path, format!("scene;speed [mm/s];pressure [Pa];mu\n{rows}")).unwrap();
    // b above a above c is computed.
    write("# comment\na;100;3e4;0,5\nb.toml;100;3e4;0,6\nc;100;3e4;0,55\nb;100;3e4;0,7\na;1e5;3e4;0,1\n");
    let ranking = measured_ranking(&plan, &found, &path, &[]).unwrap();
    assert_eq!((ranking.points, ranking.tau), (1, Some(1.0 / 3.0)));
    assert!((ranking.scenes[1].measured - 0.65).abs() < 1e-12, "{ranking:?}");
    let computed = ranking.scenes[1].computed / ranking.scenes[0].computed;
    assert!((computed / (7.0 / 6.5) - 1.0).abs() < 1e-3, "{computed}");
    assert!(ranking.notes.iter().any(|note| note.contains("line 7 (100 m/s, 30000 Pa)")), "{:?}", ranking.notes);
    write("a;100;3e4;0,5\nx;100;3e4;0,6\n");
    let error = measured_ranking(&plan, &found, &path, &[]).unwrap_err().to_string();
    assert!(error.contains("line 3: scene = \"x\": expected one of a, b, c, or its file"), "{error}");
    write("a;100;3e4;0,5\nb;500;3e4;0,6\n");
    let error = measured_ranking(&plan, &found, &path, &[]).unwrap_err().to_string();
    assert!(error.contains("at which at least two"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_cannot_be_ranked_is_refused() {
    let options = SweepOptions {
        speeds: Some(Values(vec![0.1])),
        pressures: Some(Values(vec![2e4])),
        temperatures: Some(Values(vec![293.15])),
        ..SweepOptions::default()
    };
    let new = |scenes: Vec<RankScene>| {
        RankPlan::new(scenes, options.clone(), SampleOptions { count: 64, seed: 1 }).unwrap_err().to_string()
    };
    assert!(new(vec![scene("a", 1e6, "")]).contains("at least 2 scenes"));
    assert!(new(vec![scene("a", 1e6, ""), scene("b", 1e6, "")]).starts_with("a: `temperatures`: the scene has no"));
}
