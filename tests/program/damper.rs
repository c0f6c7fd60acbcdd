//! The example scenes/damper: friction as a damper, against a Jenkins element integrated by an independent program.

use std::process::Command;

use crate::common::{Table, root, run, scratch};

/// Of the reference: loads (N) with the largest amplitude over frequency (µm) and its frequency (Hz), on both sides of the
/// optimum and there.
const REFERENCE: [(f64, f64, f64); 3] =
    [(0.0341995, 3.97053, 552.5), (0.051526, 3.06269, 617.5), (0.176217, 6.14023, 696.0)];

/// Within 2 %: the search ends with steps of 5e-4 of the frequency, and the layer's masses make 6e-4 of the amplitude.
#[test]
fn the_optimal_load_is_that_of_a_jenkins_element() {
    let folder = scratch("damper");
    let loads = REFERENCE.map(|(load, ..)| load.to_string()).join(",");
    let script = root().join("scenes/damper/damper.py");
    run(Command::new("python3")
        .arg("-B")
        .arg(script)
        .arg(env!("CARGO_BIN_EXE_asperity"))
        .arg(&folder)
        .args(["--loads", &loads]));
    let found = Table::read(&folder.join("damper.csv"));
    for (i, (load, amplitude, frequency)) in REFERENCE.into_iter().enumerate() {
        let [found_amplitude, found_frequency] = ["amplitude [m]", "frequency [Hz]"].map(|name| found.column(name)[i]);
        assert!((1e6 * found_amplitude / amplitude - 1.0).abs() < 0.02, "{load} N: {found_amplitude} m");
        assert!((found_frequency / frequency - 1.0).abs() < 0.005, "{load} N: {found_frequency} Hz");
    }
}
