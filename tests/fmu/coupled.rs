//! The example scenes/coupled: a body, an FMU by pythonfmu, on one layer and between two, joined by three masters.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::common::{Table, coupled_python, pack, root, run, scratch};

const METHODS: [&str; 3] = ["jacobi", "gauss_seidel", "newton"];

/// Where the example's tables lie, for few communication steps; it fails where two mirrored layers lack balance.
fn tables() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let (folder, example) = (scratch("coupled"), root().join("scenes/coupled"));
        for scene in ["smooth", "stuck", "inside"] {
            pack(&example.join(format!("{scene}.toml")), &folder);
        }
        let python = || Command::new(coupled_python());
        let body = folder.join("body.fmu");
        let build = ["-m", "pythonfmu", "build", "--handle-state", "-f"];
        run(python().args(build).arg(example.join("body.py")).arg("-d").arg(body));
        run(python().arg(example.join("coupled.py")).arg(&folder).arg("--quick"));
        folder
    })
}

/// The last column of `name`.csv called `column`, and its slope over the last halving of the step.
fn end_and_order(name: &str, column: &str) -> (f64, f64) {
    let table = Table::read(&tables().join(format!("{name}.csv")));
    let (h, values) = (table.column("h"), table.column(column));
    let [.., (h_1, a), (h_2, b)] = h.into_iter().zip(values).collect::<Vec<_>>()[..] else {
        panic!("{name}: too short")
    };
    (b, (a / b).ln() / (h_1 / h_2).ln())
}

/// A force held over h lags by h/2: a negative damping, by which an oscillation grows as exp(gT), gT = ω² T h/4 = 0.44
/// at h = 50 µs, with ω² = 7e6 1/s² of the body between two layers and T = 5 ms. From there to h/2 the slope of
/// exp(gT) - 1 is 1 + gT/(4 ln 2) = 1.16.
const SLACK: f64 = 0.25;

/// An energy grows by twice the exponent.
const SLACK_OF_DEFECT: f64 = 0.4;

fn check_order(suffix: &str, order: f64) {
    // That of `stuck` is the distance from the same body inside the layer's FMU.
    for case in ["smooth", "pair", "stuck"] {
        for method in METHODS {
            let column = format!("{method}{suffix}");
            let (_, found) = end_and_order(&format!("{case}.errors"), &column);
            assert!((found - order).abs() < SLACK, "{case} {column}: order {found} of the error");
            let (_, found) = end_and_order(&format!("{case}.defects"), &column);
            assert!((found - order).abs() < SLACK_OF_DEFECT, "{case} {column}: order {found} of the defect");
        }
    }
}

/// A force held over a step of h is off by Ḟ h/2 on average: order 1, whatever else the master does.
#[test]
fn values_only_are_of_first_order() {
    check_order("", 1.0);
}

/// Forces that run linearly, and a motion that does, miss second derivatives times h².
#[test]
fn rates_make_every_master_one_of_second_order() {
    check_order("_rates", 2.0);
}

/// With F = -Ku, the impulse of a step errs, in units of K ü h³, by
/// - 1/12 if the force runs straight between those at the ends (newton);
/// - 1/6 if it runs on at its rate, and by 1/4 since that rate is the one of a layer that came along a chord, h ü/2
///   behind (gauss_seidel): 5/12;
/// - 1/2 more if the layer, led along the tangent, stops h² ü/2 behind (jacobi): 11/12.
#[test]
fn extrapolated_forces_err_as_theory_has_it() {
    for case in ["smooth", "pair"] {
        let [jacobi, seidel, newton] =
            METHODS.map(|method| end_and_order(&format!("{case}.errors"), &format!("{method}_rates")).0);
        // The next order is h ω, here 0.05, of it or some times as much; the layer creeps, and is curved in u.
        let close = |ratio: f64, theory: f64| (ratio / theory - 1.0).abs() < 0.2;
        assert!(
            close(seidel / newton, 5.0) && close(jacobi / newton, 11.0),
            "{case}: {jacobi:e} {seidel:e} {newton:e}"
        );
    }
}

/// What Newton's method costs: an error of 1e-4 of the displacement, 1e-4 of the energy.
#[test]
fn the_iterated_master_keeps_the_energy() {
    for case in ["smooth", "pair"] {
        let (error, _) = end_and_order(&format!("{case}.errors"), "newton_rates");
        let (defect, _) = end_and_order(&format!("{case}.defects"), "newton_rates");
        assert!(error < 2e-4 && defect < 2e-4, "{case}: {error:e} {defect:e}");
    }
}
