//! The roughness below the profile in the summary of a scene: how steep it is, how it rubs, which waves give how much of
//! friction, and how contacts warm; and its friction over speed.

use std::f64::consts::{SQRT_2, TAU};

use asperity::model::{FineFriction, FrictionLaw};
use asperity::scene::{FineRoughness, Scene, Spectrum};

use super::heating::{Heating, WarmedContact};
use crate::decimals::{decimal, rounded};
use crate::steady::persson::WholeFriction;

/// Speeds (m/s) and pressures (Pa) at which the law is printed.
const SPEEDS: [f64; 3] = [1e-4, 1e-2, 1.0];
const PRESSURES: [f64; 3] = [1e5, 3e5, 1e6];
/// Pressure (Pa) at which friction is divided into its parts.
pub const MIDDLE: f64 = PRESSURES[1];

/// The summary in a line each; nothing where the profile lacks nothing.
pub(super) fn rows(scene: &Scene) -> Vec<String> {
    let (Some(fine), Some(law), Some(area)) = (&scene.fine, FineFriction::new(scene), scene.layer.element_area())
    else {
        return Vec::new();
    };
    let mut rows = vec![fine.describe(), gradients(scene)];
    rows.extend(softening(scene));
    rows.push(at_rest(scene, &law, area));
    rows.extend(law_table(&law, area));
    if !scene.fine_bands().is_empty() {
        rows.extend(parts_table(scene, fine));
    }
    rows.extend(flash_rows(scene, area));
    rows
}

/// Which waves there are below the profile, and what friction they give.
pub(super) fn short_rows(scene: &Scene) -> Vec<String> {
    let Some(fine) = &scene.fine else { return Vec::new() };
    let mut rows = vec![fine.describe(), gradients(scene)];
    if !scene.fine_bands().is_empty() && scene.layer.element_area().is_some() {
        rows.extend(parts(scene));
    }
    rows
}

fn number(value: f64) -> String {
    decimal(rounded(value, 4), 1e-3..1e5)
}

/// By what strain softens the bands; nothing where it does not.
fn softening(scene: &Scene) -> Option<String> {
    let bands = scene.fine_bands();
    let [first, last] = [bands.first()?.factors, bands.last()?.factors];
    let least = first.storage.min(first.loss).min(last.storage).min(last.loss);
    (least < 1.0).then(|| {
        format!(
            "strain softens rubber in the bands: storage and loss modulus {:.3} and {:.3} times in the longest waves, {:.3} and \
             {:.3} times in the shortest",
            first.storage, first.loss, last.storage, last.loss
        )
    })
}

fn gradients(scene: &Scene) -> String {
    // An isotropic surface is √2 times as steep as its lines.
    let slopes = Spectrum::new(&scene.surface).modes().fold(0.0, |sum, (q, square)| sum + q * q * square);
    let has_bands = !scene.fine_bands().is_empty();
    let height = if has_bands { format!(", rms height {} m", number(scene.fine_height())) } else { String::new() };
    format!(
        "rms gradient {} below the profile{height}; {} of the profile, as of a line on an isotropic surface",
        number(scene.fine_gradient()),
        number(SQRT_2 * slopes.sqrt())
    )
}

fn at_rest(scene: &Scene, law: &FineFriction, area: f64) -> String {
    let (friction, normal) = (FrictionLaw::new(scene), MIDDLE * area);
    let limit = friction.limit(normal) / normal;
    let bands = law.at_rest(normal).hysteresis.value / normal;
    if bands == 0.0 {
        return format!("T/F_N {limit:.3} at rest under {MIDDLE:.0e} Pa");
    }
    format!(
        "T/F_N {limit:.3} at rest under {MIDDLE:.0e} Pa, {bands:.3} of it by the bands: that of slip at {} m/s, no static \
         friction",
        number(law.creep_speed())
    )
}

/// A row of a table whose columns are those of [`SPEEDS`].
fn table_row(name: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: String = cells.into_iter().map(|cell| format!("{cell:>16}")).collect();
    format!("{name:<18}{cells}").trim_end().to_owned()
}

fn speeds_row(name: &str) -> String {
    table_row(name, SPEEDS.map(|speed| format!("{speed:.0e} m/s")))
}

/// μ_h and A_r/A of a mass.
fn law_table(law: &FineFriction, area: f64) -> Vec<String> {
    let row = |pressure: f64| {
        let at = |speed: f64| {
            let contact = law.contact(pressure * area, speed);
            format!("{:.3}, {:.4}", contact.hysteresis.value / (pressure * area), contact.share.value)
        };
        table_row(&format!("{pressure:.0e} Pa"), SPEEDS.map(at))
    };
    std::iter::once(speeds_row("mu_h, A_r/A under")).chain(PRESSURES.map(row)).collect()
}

/// Friction by the theory over profile and bands at each of [`SPEEDS`]; nothing where there is none.
fn wholes(scene: &Scene) -> Option<[WholeFriction; 3]> {
    let wholes = SPEEDS.map(|speed| WholeFriction::new(scene, MIDDLE, speed));
    wholes.last().is_some_and(|last| last.friction() > 0.0).then_some(wholes)
}

/// A row of shares of friction.
fn shares(wholes: &[WholeFriction; 3], name: &str, of: &dyn Fn(&WholeFriction) -> f64) -> String {
    let share = |whole: &WholeFriction| format!("{:.1} %", 100.0 * of(whole) / whole.friction());
    table_row(name, wholes.each_ref().map(share))
}

/// The parts of friction by the theory.
fn parts(scene: &Scene) -> Vec<String> {
    let Some(wholes) = wholes(scene) else { return Vec::new() };
    let friction = wholes.each_ref().map(|whole| format!("{:.3}", whole.friction()));
    vec![
        format!("friction under {MIDDLE:.0e} Pa, by Persson's theory over profile and bands:"),
        speeds_row(""),
        table_row("friction", friction),
        shares(&wholes, "  profile", &|whole| whole.hysteresis(|wave| !wave.is_fine)),
        shares(&wholes, "  bands", &|whole| whole.hysteresis(|wave| wave.is_fine)),
        shares(&wholes, "  shear, coulomb", &|whole| whole.adhesion),
    ]
}

/// The parts of friction, and what each decade of wavelengths gives.
fn parts_table(scene: &Scene, fine: &FineRoughness) -> Vec<String> {
    let mut rows = parts(scene);
    if let Some(wholes) = wholes(scene).filter(|_| fine.hysteresis) {
        let [.., last] = &wholes;
        let decade = |wave_number: f64| (TAU / wave_number).log10().floor() as i32;
        let mut decades: Vec<i32> = last.by_wave.iter().map(|wave| decade(wave.wave_number)).collect();
        decades.sort_unstable();
        decades.dedup();
        rows.push("  hysteresis by wavelength, the bar at the last speed:".into());
        rows.extend(decades.into_iter().rev().map(|of| {
            let part = |whole: &WholeFriction| whole.hysteresis(|wave| decade(wave.wave_number) == of);
            let bar = "#".repeat((BAR * part(last) / last.friction()).round() as usize);
            format!("{}  {bar}", shares(&wholes, &format!("  1e{} to 1e{of} m", of + 1), &part)).trim_end().to_owned()
        }));
    }
    rows
}

/// Characters of a bar for all of friction.
const BAR: f64 = 40.0;

/// The contact that warms: its length (m), pressure (Pa), and speeds (m/s).
const CONTACT_LENGTH: f64 = 1e-3;
const CONTACT_PRESSURE: f64 = 1e6;
const CONTACT_SPEEDS: [f64; 3] = [0.1, 1.0, 10.0];

fn flash_rows(scene: &Scene, area: f64) -> Vec<String> {
    let (Some(heating), Some(temperature)) = (Heating::new(scene, area), temperature(scene)) else {
        return Vec::new();
    };
    let title =
        format!("contacts after {CONTACT_LENGTH} m under {CONTACT_PRESSURE:.0e} Pa, of rubber at {temperature} K:");
    let row = |speed: f64| {
        let WarmedContact { rise, cold, warm } = heating.after(CONTACT_LENGTH, CONTACT_PRESSURE, speed);
        format!("{:<18}{rise:.1} K warmer, T/F_N {warm:.3} in place of {cold:.3}", format!("{speed} m/s"))
    };
    std::iter::once(title).chain(CONTACT_SPEEDS.map(row)).collect()
}

/// The layer's temperature, K.
fn temperature(scene: &Scene) -> Option<f64> {
    Some(scene.material.as_ref()?.wlf?.temperature)
}

/// Temperatures beside the layer's at which friction is drawn, K.
const AROUND: f64 = 20.0;
/// Points of a curve.
const POINTS: usize = 121;

/// μ_h of a mass over speed, under the pressure [`MIDDLE`].
#[derive(Clone, Debug, PartialEq)]
pub struct FineFrictionCurve {
    /// The layer's temperature, K, where the scene has one.
    pub temperature: Option<f64>,
    /// Speeds (m/s) and friction coefficients.
    pub points: Vec<(f64, f64)>,
}

impl FineFrictionCurve {
    /// At the temperature of a scene and at those around it, from cold to warm; none without bands that rub.
    pub fn around(scene: &Scene) -> Vec<Self> {
        let Some(area) = scene.layer.element_area().filter(|_| scene.has_fine_hysteresis()) else { return Vec::new() };
        let own = temperature(scene);
        let temperatures = own.map_or(vec![None], |own| [own - AROUND, own, own + AROUND].map(Some).to_vec());
        temperatures.into_iter().filter_map(|temperature| Self::at(scene, temperature, area)).collect()
    }

    /// `None` at a temperature that WLF does not reach.
    fn at(scene: &Scene, temperature: Option<f64>, area: f64) -> Option<Self> {
        let scene = scene.with_temperature(temperature);
        scene.check().ok()?;
        let law = FineFriction::new(&scene)?;
        let friction = |speed: f64| law.contact(MIDDLE * area, speed).hysteresis.value / (MIDDLE * area);
        let points = (0..POINTS).map(|i| 10.0_f64.powf(-6.0 + 8.0 * i as f64 / (POINTS - 1) as f64));
        Some(Self { temperature, points: points.map(|speed| (speed, friction(speed))).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::super::heating::tests::scene;
    use super::*;

    /// The parts of friction add up, and so do the decades to the hysteresis.
    #[test]
    fn parts_of_friction_add_up() {
        let rows = rows(&scene(|text| text));
        let shares = |start: &str| -> f64 {
            let of = |row: &String| row.split_whitespace().rev().filter_map(|word| word.parse::<f64>().ok()).next();
            rows.iter().filter(|row| row.starts_with(start)).filter_map(of).sum()
        };
        let (profile, bands, adhesion) = (shares("  profile"), shares("  bands"), shares("  shear"));
        assert!((profile + bands + adhesion - 100.0).abs() < 0.2, "{profile} {bands} {adhesion}");
        assert!((shares("  1e") - profile - bands).abs() < 0.3, "{rows:#?}");
        assert!(bands > 10.0 && rows.iter().any(|row| row.ends_with('#')), "{rows:#?}");
    }
}
