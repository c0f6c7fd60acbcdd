//! A law for the tests of this module.

use super::law::GapLaw;
use crate::element::FrictionTable;

/// A table with gaps whose ln p falls straight with the separation.
fn table() -> FrictionTable {
    let mut text = "# asperity sweep = 1\n# scene = straight\n# fingerprint = 00\n# nominal_area = 1e-4 m2\n\
                    # rest_separation = 0 m\nspeed [m/s],pressure [Pa],temperature [K],status,friction [1],contact_ratio [1],separation [m],\
                    leak_gap [m],drag_gap [m],tangential_stiffness [N/m]\n"
        .to_owned();
    for speed in [1e-3, 1.0] {
        for i in 0..40 {
            let pressure = 10.0 * 1.5_f64.powi(i);
            let separation = 4e-6 - 2e-7 * 1.5_f64.ln() * f64::from(i);
            let (leak, drag) = (0.9 * separation, 0.8 * separation + 1e-7);
            let friction = if speed > 0.1 { 0.1 } else { 0.13 };
            text +=
                &format!("{speed},{pressure},,steady,{friction},{},{separation},{leak},{drag},1e6\n", 1e-8 * pressure);
        }
    }
    FrictionTable::parse(&text, "straight.csv".as_ref()).unwrap()
}

/// The law of that table at a speed, m/s.
pub(super) fn law(speed: f64) -> GapLaw {
    GapLaw::new(&table(), 0.0, speed)
}

/// The total pressure (Pa) on a cell of so many: a parabola.
pub(super) fn pressed(i: usize, count: usize) -> f64 {
    let x = 2.0 * (i as f64 + 0.5) / count as f64 - 1.0;
    1e6 * (1.05 - x * x)
}

/// ln p, both gaps straight between rows and beyond; the gap of a pressure is the inverse.
#[test]
fn the_law_is_straight_over_the_gap() {
    let law = law(1e-3);
    for gap in [0.9e-6, 1.7e-6, 3.9e-6, 4.4e-6] {
        let point = law.at(gap, law.interval(gap, 0));
        let pressure = 10.0 * ((4e-6 - gap) / 2e-7).exp();
        assert!((point.pressure.value / pressure - 1.0).abs() < 1e-9, "{gap}");
        assert!((law.gap_at(pressure) - gap).abs() < 1e-15 || pressure < 1e-5, "{gap} {}", law.gap_at(pressure));
        let leak = if gap > 4e-6 { 3.6e-6 + (gap - 4e-6) } else { 0.9 * gap };
        assert!((point.leak.value / leak - 1.0).abs() < 1e-9, "{gap}");
    }
}
