//! Least squares of measured friction: Persson's theory against scipy's fit of the same residuals.

use asperity::scene::Scene;
use asperity_study::calibration::{
    Done, FreeParameter, FrictionModel, FrictionParts, Measurements, ModelError, Problem, Task, TheoryModel, Tolerance,
    map_space, minimise,
};

use crate::common::{Table, root};

fn reference(name: &str) -> std::path::PathBuf {
    root().join("tests/reference/calibrate").join(name)
}

/// The parameters, the least square and the parameters there that scipy found.
fn found_by_scipy() -> (Vec<FreeParameter>, Vec<f64>, f64) {
    let table = Table::read(&reference("theory.fit.csv"));
    let number = |row, name| table.number(row, name);
    let count = table.len() - 1;
    let parameter =
        |row| FreeParameter::new(table.text(row, "key").to_owned(), number(row, "low"), number(row, "high"));
    let parameters = (0..count).map(|row| parameter(row).unwrap()).collect();
    (parameters, (0..count).map(|row| number(row, "value")).collect(), number(count, "value"))
}

fn problem() -> (Problem, Vec<f64>, f64) {
    let (parameters, values, chi_square) = found_by_scipy();
    let measured = Measurements::parse(&std::fs::read(reference("theory.measured.csv")).unwrap(), 1.0, &[]).unwrap();
    (Problem::new(parameters, &measured), values, chi_square)
}

fn scene_at(keys: &[FreeParameter]) -> impl Fn(&[f64]) -> Result<Scene, asperity_study::Error> + Sync {
    let path = reference("theory.toml");
    let scene = Scene::parse(&std::fs::read_to_string(&path).unwrap(), &path).unwrap();
    move |values| {
        let mut scene = scene.clone();
        for (parameter, value) in keys.iter().zip(values) {
            scene.set_by_name(&parameter.key, &format!("{value:?}")).unwrap();
        }
        Ok(scene)
    }
}

/// From the middle of the bounds, far away, to the least square of an independent program, to 1e-6.
#[test]
fn a_fit_by_the_theory_is_that_of_scipy() {
    let (problem, values, chi_square) = problem();
    let scene_at = scene_at(&problem.parameters);
    let theory = TheoryModel::new(&scene_at);
    let fitted = minimise(&problem, &theory, &[0.5; 4], Tolerance::EXACT, &|_| ()).unwrap();
    assert!(fitted.has_converged);
    assert!((fitted.chi_square / chi_square - 1.0).abs() < 1e-9, "{} for {chi_square}", fitted.chi_square);
    for (found, value) in problem.values(&fitted.places).iter().zip(&values) {
        assert!((found / value - 1.0).abs() < 1e-6, "{found} for {value}");
    }
}

/// A model that is mapped on itself has the ratio 1 everywhere: the second round finds what the first one did.
#[test]
fn space_mapping_of_a_model_on_itself_ends_at_once() {
    let (problem, values, _) = problem();
    let scene_at = scene_at(&problem.parameters);
    let theory = TheoryModel::new(&scene_at);
    let mapped = map_space(&problem, &theory, &theory, &[0.5; 4], &|_| ()).unwrap().unwrap();
    assert!(mapped.fitted.has_converged && mapped.rounds == 2, "{mapped:?}");
    for (found, value) in problem.values(&mapped.fitted.places).iter().zip(&values) {
        // A tenth of a standard error, of some 3 %.
        assert!((found / value - 1.0).abs() < 3e-3, "{found} for {value}");
    }
}

/// A parameter at its bound stays there, and the others are the best beside it.
#[test]
fn a_bound_holds() {
    let (mut problem, _, chi_square) = problem();
    let key = problem.parameters[3].key.clone();
    problem.parameters[3] = FreeParameter::new(key, 8e6, 1e8).unwrap();
    let scene_at = scene_at(&problem.parameters);
    let theory = TheoryModel::new(&scene_at);
    let fitted = minimise(&problem, &theory, &[0.5; 4], Tolerance::EXACT, &|_| ()).unwrap();
    assert_eq!(problem.values(&fitted.places)[3], 8e6);
    assert!(fitted.chi_square > chi_square && fitted.has_converged);
}

/// Friction that grows as its one parameter and jumps just above 2.
struct Jump;

impl FrictionModel for Jump {
    fn evaluate(&self, tasks: &[Task], done: &Done<'_>) -> Result<(), ModelError> {
        for (index, task) in tasks.iter().enumerate() {
            let value = task.parameters[0];
            let shear = if value > 2.0 { value + 0.1 } else { value };
            done(index, Ok(FrictionParts { shear, ..FrictionParts::default() }))?;
        }
        Ok(())
    }

    fn step(&self) -> f64 {
        1e-4
    }
}

/// A standard error is that of the branch the fit ended on, not of the jump beside it.
#[test]
fn a_derivative_is_not_taken_across_a_jump() {
    let parameter = FreeParameter::new("friction.coulomb".to_owned(), 1.0, 3.0).unwrap();
    let measured =
        Measurements::parse(b"speed [m/s],pressure [Pa],mu,sigma\n1,1e5,2,1\n2,1e5,2,1\n", 1.0, &[]).unwrap();
    let problem = Problem::new(vec![parameter], &measured);
    let derivative = |linearised: asperity_study::calibration::Linearised| linearised.jacobian[(0, 0)];
    // Two between the bounds; the step of 2e-4 is lost in rounding to 1e-12 of the quotient.
    assert!((derivative(problem.linearised_to_both_sides(&Jump, &[0.5]).unwrap()) - 2.0).abs() < 1e-9);
    assert!(derivative(problem.linearised(&Jump, &[0.5]).unwrap()) > 500.0);
}
