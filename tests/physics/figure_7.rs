//! The paper's figure 7 from scenes/figure-7: tangential force against displacement at three pressures.

use crate::common::{root, scratch, simulate};

const ROWS: usize = 50;

/// F_z as the tangential motion begins, and -F_x over its `ROWS` rows.
fn curve(name: &str) -> (f64, Vec<f64>) {
    let scene = root().join(format!("scenes/figure-7/{name}.toml"));
    let table = simulate(&scene, &scratch(&format!("figure-7-{name}")), &[]);
    let start = table.column("time").len() - 1 - ROWS;
    assert_eq!(table.column("u")[start], 0.0, "pressed straight down");
    let forces = table.column("F_x")[start..].iter().map(|force| -force).collect();
    (table.column("F_z")[start], forces)
}

#[test]
fn the_stiffer_the_harder_it_is_pressed_and_flat_in_the_end() {
    let curves = ["low", "middle", "high"].map(curve);
    let stiffness = curves.each_ref().map(|(_, forces)| forces[3]);
    assert!(stiffness[0] < stiffness[1] && stiffness[1] < stiffness[2], "{stiffness:?}");
    for (normal_force, forces) in &curves {
        let (end, before) = (forces[ROWS], forces[ROWS * 3 / 4]);
        let (last, first) = ((end - before).abs() / (ROWS / 4) as f64, forces[3] / 3.0);
        assert!(last < 0.02 * first, "{last} N a row in the last quarter, {first} N a row at first");
        // Full slip: |F_x| = μ F_z with μ = 0.4, give or take the slopes.
        assert!((end / normal_force - 0.4).abs() < 0.03, "{end} N tangentially, {normal_force} N normally");
    }
}
