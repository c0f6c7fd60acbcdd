//! The layer's temperature as an input: coupled with a heat capacity, an FMU by pythonfmu, against the system solved as one.

use std::process::Command;

use crate::common::{coupled_python, pack, root, run, scratch};

#[test]
fn a_layer_that_heats_itself_comes_to_the_temperature_of_the_whole_system() {
    let (folder, scripts) = (scratch("thermal"), root().join("tests/python/thermal"));
    pack(&scripts.join("heated.toml"), &folder);
    let python = || Command::new(coupled_python());
    let build = ["-m", "pythonfmu", "build", "--handle-state", "-f"];
    run(python().args(build).arg(scripts.join("heat.py")).arg("-d").arg(folder.join("heat.fmu")));
    let printed = run(python().arg(scripts.join("thermal.py")).arg(&folder));
    let numbers: Vec<f64> = printed.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [rise, _, coarse, _, middle, _, fine] = numbers[..] else { panic!("{printed}") };
    assert!(rise > 5.0, "the temperature matters: {rise} K");
    // The mean of the step is known to h², so is w: order 2, an error of 1e-4 of the rise at 50 µs.
    let order = (middle / fine).log2();
    assert!(fine < 2e-4 && middle < coarse && order > 1.5, "{coarse:e} {middle:e} {fine:e}");
}
