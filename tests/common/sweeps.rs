//! Tables as `asperity sweep` writes them, from a law that is known.

use std::fmt::Write as _;

/// m²
pub const AREA: f64 = 4e-5;
/// m
pub const REST: f64 = 1e-4;

/// The grid of a table.
pub struct Grid {
    pub speeds: Vec<f64>,
    pub pressures: Vec<f64>,
    /// None: the scene has no temperature.
    pub temperatures: Vec<f64>,
}

/// `count` values from `a` to `b`, evenly in the logarithm.
pub fn logarithmic(a: f64, b: f64, count: usize) -> Vec<f64> {
    let at = |i: usize| if i + 1 == count { b } else { a * (b / a).powf(i as f64 / (count - 1) as f64) };
    (0..count).map(at).collect()
}

impl Grid {
    /// 11 speeds over five decades and 4 pressures.
    pub fn plain() -> Self {
        let (speeds, pressures) = (logarithmic(1e-4, 10.0, 11), vec![1e5, 2e5, 4e5, 8e5]);
        Self { speeds, pressures, temperatures: Vec::new() }
    }

    /// The table's text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "# asperity sweep = 1\n# scene = known law\n# fingerprint = 00\n# nominal_area = {AREA:e} m2\n\
             # rest_separation = {REST:e} m\nspeed [m/s],pressure [Pa],temperature [K],status,friction [1],\
             friction_standard_error [1],friction_hysteresis [1],friction_adhesion [1],mean_pressure [Pa],\
             contact_ratio [1],P_damper [W],P_maxwell [W],P_friction [W],P_impact [W],separation [m],\
             tangential_stiffness [N/m],w [m],runs [1],time [s]\n"
        );
        let temperatures: Vec<_> = match self.temperatures.as_slice() {
            [] => vec![None],
            some => some.iter().copied().map(Some).collect(),
        };
        for temperature in temperatures {
            for &p in &self.pressures {
                for &v in &self.speeds {
                    text += &row(v, p, temperature);
                }
            }
        }
        text
    }
}

fn row(v: f64, p: f64, temperature: Option<f64>) -> String {
    let t = temperature.unwrap_or(WARM);
    let (mu, s) = (friction(v, p, t), separation(v, p, t));
    let power = mu * p * AREA * v;
    let kelvin = temperature.map_or_else(String::new, |t| t.to_string());
    let mut row = format!("{v:e},{p:e},{kelvin},steady,{mu},{},{},{},{p:e},", 1e-3 * mu, 0.4 * mu, 0.6 * mu);
    let _ = writeln!(
        row,
        "{},{},{},{},,{s:e},{},{:e},3,1e-2",
        0.1 * (p / 1e5).powf(0.8),
        0.1 * power,
        0.3 * power,
        0.6 * power,
        stiffness(p),
        s - REST,
    );
    row
}

/// K
pub const WARM: f64 = 300.0;

/// Friction coefficient at a speed (m/s), a pressure (Pa) and a temperature (K): a hump that goes to higher speeds with
/// it.
pub fn friction(v: f64, p: f64, t: f64) -> f64 {
    let place = v.log10() + 1.0 - (t - WARM) / 20.0;
    0.5 + 0.4 * (-place * place / 3.0).exp() - 0.03 * (p / 1e5).ln()
}

/// Mean separation, m: pressed harder the carrier is closer, dragged faster it is further away.
pub fn separation(v: f64, p: f64, t: f64) -> f64 {
    let (y, x) = ((p / 1e5).ln(), v.log10() - (t - WARM) / 20.0);
    8e-5 - 6e-6 * y * (1.0 - 0.05 * y) + 1e-6 * x * (1.0 + 0.05 * y)
}

/// Tangential stiffness, N/m.
pub fn stiffness(p: f64) -> f64 {
    2e4 * (p / 1e5).powf(0.7)
}
