//! The friction in the summary of a scene, where it falls over the speed, and the roughness below the profile: how steep it
//! is, how it rubs, which waves give how much of friction, and how contacts warm by their own friction.

use std::f64::consts::{SQRT_2, TAU};
use std::ops::Range;

use asperity::model::{EvenSliding, FineFriction, FlashKernel, FrictionLaw, SlipHistory};
use asperity::scene::{FineRoughness, RateShear, Scene, Spectrum};

use super::words::{LEFT_OUT, LabelledLine, labelled, number, or_left_out};
use crate::decimals::short;
use crate::steady::persson::WholeFriction;

/// The friction of a scene; of the speeds of its excitation `all`, or that at which sliding is least even.
pub(super) fn friction(scene: &Scene, all: bool) -> Vec<LabelledLine> {
    let Some(friction) = &scene.friction else { return vec![("Friction", LEFT_OUT.into())] };
    let coulomb = format!("coulomb      {}", or_left_out(friction.coulomb, ""));
    let shear = match friction.shear_strength {
        Some(strength) => format!(
            "shear        {} Pa: {} N a mass in contact",
            number(strength),
            number(scene.shear_force().unwrap_or(0.0))
        ),
        None => format!("shear_force  {}", or_left_out(friction.shear_force, " N a mass in contact")),
    };
    let rate_shear = scene.rate_shear().map_or_else(|| LEFT_OUT.into(), |law| rate_shear_text(&law));
    let mut rows = vec![coulomb, shear, format!("rate_shear   {rate_shear}")];
    rows.extend(FallingFriction::of(scene).map(|falling| falling.describe()));
    rows.extend(memory(scene, all));
    labelled("Friction", rows)
}

/// Where friction falls over the speed, at which the masses of a layer may stick and slip one by one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallingFriction {
    /// The speed from which on it falls, m/s.
    pub from: f64,
    /// The speed up to which it falls, m/s; `None` where that is beyond those looked at.
    pub to: Option<f64>,
    /// The largest fall, as a share of friction a decade of speed.
    pub steepest: f64,
}

impl FallingFriction {
    /// Speeds are 10^(i/PER_DECADE) m/s.
    const PER_DECADE: i32 = 10;
    const EXPONENTS: Range<i32> = -6 * Self::PER_DECADE..2 * Self::PER_DECADE;
    /// A smaller fall over a decade is damped away.
    const LEAST: f64 = 0.01;

    /// Of the masses of a scene under the middle one of the pressures of a summary; `None` where friction does not fall.
    pub fn of(scene: &Scene) -> Option<Self> {
        let law = FrictionLaw::new(scene);
        let normal = scene.layer.element_area().map_or(0.0, |area| MIDDLE * area);
        let per_decade = f64::from(Self::PER_DECADE);
        let speed = |exponent: i32| 10.0_f64.powf(f64::from(exponent) / per_decade);
        let friction = |exponent: i32| law.slip(normal, speed(exponent), &SlipHistory::even(0.0)).force();
        let fall = |at: i32| per_decade * (1.0 - friction(at + 1) / friction(at));
        let falls = Self::EXPONENTS.map(|at| (at, fall(at))).filter(|&(_, fall)| fall > Self::LEAST);
        let falls: Vec<(i32, f64)> = falls.collect();
        let steepest = falls.iter().map(|&(_, fall)| fall).fold(0.0, f64::max);
        let (&(first, _), &(last, _)) = (falls.first()?, falls.last()?);
        let to = (last + 1 != Self::EXPONENTS.end).then(|| speed(last + 1));
        Some(Self { from: speed(first), to, steepest })
    }

    fn describe(&self) -> String {
        let to = self.to.map_or_else(String::new, |to| format!(" to {to:.1e} m/s"));
        format!("falls over the speed from {:.1e} m/s{to}, by up to {:.0} % a decade", self.from, 100.0 * self.steepest)
    }
}

/// The way over which contacts are renewed, and that for even sliding.
fn memory(scene: &Scene, all: bool) -> Vec<String> {
    if !scene.friction_depends_on_speed() {
        return Vec::new();
    }
    let area = scene.layer.element_area();
    let way = scene.memory_way();
    if !all {
        let least_even = EvenSliding::of(scene).into_iter().max_by(|a, b| a.least_memory.total_cmp(&b.least_memory));
        let needed = least_even.map_or_else(String::new, |at| {
            let under = area.map_or_else(String::new, |area| format!(", {:.2} MPa", 1e-6 * at.normal / area));
            format!("; even sliding takes {:.1e} m at {} m/s{under}", at.least_memory, number(at.speed))
        });
        return vec![format!("memory       {} m{needed}", number(way))];
    }
    let row = |EvenSliding { speed, normal, least_memory }: EvenSliding| {
        let under = area.map_or_else(String::new, |area| format!(" under {:.2} MPa", 1e-6 * normal / area));
        let verdict = match least_memory {
            0.0 => "slides evenly at any".to_owned(),
            least if least > way => format!("sticks and slips below {least:.1e} m"),
            least => format!("slides evenly above {least:.1e} m"),
        };
        format!("             at {speed:.3e} m/s{under} {verdict}")
    };
    let renewed = match way {
        0.0 => "none: friction follows the speed at once".to_owned(),
        way => format!("contacts are renewed over {} m", number(way)),
    };
    std::iter::once(format!("memory       {renewed}")).chain(EvenSliding::of(scene).into_iter().map(row)).collect()
}

/// The law of the contacts, for a material at its temperature.
fn rate_shear_text(rate_shear: &RateShear) -> String {
    format!(
        "{} N a mass in contact at {} m/s, sharpness {}, constant below {} m/s",
        number(rate_shear.force.unwrap_or(0.0)),
        number(rate_shear.reference_speed),
        number(rate_shear.sharpness),
        number(rate_shear.creep_speed())
    )
}

/// Speeds (m/s) and pressures (Pa) at which the law is printed.
const SPEEDS: [f64; 3] = [1e-4, 1e-2, 1.0];
const PRESSURES: [f64; 3] = [1e5, 3e5, 1e6];
/// Pressure (Pa) at which friction is divided into its parts.
pub(super) const MIDDLE: f64 = PRESSURES[1];

/// The summary in a line each; nothing where the profile lacks nothing.
pub(super) fn fine(scene: &Scene) -> Vec<String> {
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
pub(super) fn fine_in_brief(scene: &Scene) -> Vec<String> {
    let Some(fine) = &scene.fine else { return Vec::new() };
    let mut rows = vec![fine.describe(), gradients(scene)];
    if !scene.fine_bands().is_empty() && scene.layer.element_area().is_some() {
        rows.extend(parts(scene));
    }
    rows
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
    let height = if has_bands { format!(", rms height {} m", short(scene.fine_height(), 4)) } else { String::new() };
    format!(
        "rms gradient {} below the profile{height}; {} of the profile, as of a line on an isotropic surface",
        short(scene.fine_gradient(), 4),
        short(SQRT_2 * slopes.sqrt(), 4)
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
        short(law.creep_speed(), 4)
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
pub(super) struct FineFrictionCurve {
    /// The layer's temperature, K, where the scene has one.
    pub temperature: Option<f64>,
    /// Speeds (m/s) and friction coefficients.
    pub points: Vec<(f64, f64)>,
}

impl FineFrictionCurve {
    /// At the temperature of a scene and at those around it, from cold to warm; none without bands that rub.
    pub(super) fn around(scene: &Scene) -> Vec<Self> {
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

/// What friction has done to a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WarmedContact {
    /// The rise of its temperature, K.
    rise: f64,
    /// T/F_N at its start.
    cold: f64,
    /// T/F_N at its end.
    warm: f64,
}

/// A contact that its own friction warms.
struct Heating {
    law: FrictionLaw,
    kernel: FlashKernel,
    /// A, m².
    area: f64,
}

impl Heating {
    /// `None` where friction heats nothing.
    fn new(scene: &Scene, area: f64) -> Option<Self> {
        Some(Self { law: FrictionLaw::new(scene), kernel: FlashKernel::new(scene)?, area })
    }

    /// T/F_N under a pressure (Pa) at a speed (m/s), `rise` (K) above the layer's temperature.
    fn friction(&self, pressure: f64, speed: f64, rise: f64) -> f64 {
        let normal = pressure * self.area;
        self.law.slip(normal, speed, &SlipHistory::even(rise)).force() / normal
    }

    /// After a contact of a length (m).
    ///
    /// The terms of the kernel are integrated exactly for the mean of the power at both ends of a step, which follows
    /// the temperature.
    fn after(&self, length: f64, pressure: f64, speed: f64) -> WarmedContact {
        const STEPS: usize = 1000;
        const ITERATIONS: usize = 3;
        let step = length / speed / STEPS as f64;
        let decays: Vec<f64> = self.kernel.terms.iter().map(|term| (-step / term.time).exp()).collect();
        let step_rise = self.kernel.rise(step);
        let cold = self.friction(pressure, speed, 0.0);
        let (mut parts, mut rise, mut friction) = (vec![0.0; decays.len()], 0.0, cold);
        for _ in 0..STEPS {
            let decayed: f64 = parts.iter().zip(&decays).map(|(part, decay)| part * decay).sum();
            let (mut power, mut after) = (friction * pressure * speed, friction);
            for _ in 0..ITERATIONS {
                rise = decayed + power * step_rise;
                after = self.friction(pressure, speed, rise);
                power = 0.5 * (friction + after) * pressure * speed;
            }
            for ((part, decay), term) in parts.iter_mut().zip(&decays).zip(&self.kernel.terms) {
                *part = *part * decay + power * term.weight * term.time * (1.0 - decay);
            }
            rise = parts.iter().sum();
            friction = after;
        }
        WarmedContact { rise, cold, warm: self.friction(pressure, speed, rise) }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const SCENE: &str = "name = 'w'\n\
        layer = { masses = 8, spacing = 1e-4, width = 0.01, foundation = 'half_space' }\n\
        surface = { kind = 'flat', fine = { hurst = 0.8, rms_slope = 0.9, longest = 4e-4, shortest = 4e-6 } }\n\
        friction = { shear_strength = 1e6 }\n\
        [material]\ndensity = 1100.0\npoisson_ratio = 0.5\nequilibrium_modulus = 3e6\n\
        prony = [{ modulus = 8e6, relaxation_time = 1e-3 }, { modulus = 1e8, relaxation_time = 1e-6 }]\n\
        wlf = { c1 = 7.5, c2 = 120.0, reference_temperature = 293.15, temperature = 303.15 }\n\
        heat = { conductivity = 0.25, capacity = 1700.0 }\n";

    fn scene(edit: impl Fn(String) -> String) -> Scene {
        Scene::parse(&edit(SCENE.into()), "w.toml".as_ref()).unwrap()
    }

    fn heating(scene: &Scene) -> Heating {
        Heating::new(scene, scene.layer.element_area().unwrap()).unwrap()
    }

    /// Friction that does not depend on the temperature warms as the kernel's rise says.
    #[test]
    fn constant_friction_warms_by_the_rise_of_the_kernel() {
        let heating = heating(&scene(|text| {
            text.replace("shortest = 4e-6", "shortest = 4e-6, hysteresis = false")
                .replace("shear_strength = 1e6", "coulomb = 0.5")
        }));
        let WarmedContact { rise, cold, warm } = heating.after(1e-3, 1e6, 2.0);
        let exact = 0.5 * 1e6 * 2.0 * heating.kernel.rise(1e-3 / 2.0);
        assert!((rise / exact - 1.0).abs() < 1e-9 && cold == 0.5 && warm == 0.5, "{rise} {exact} {cold} {warm}");
    }

    /// Friction and temperature are those of a step that is ten times as long within the order of the rule.
    #[test]
    fn friction_follows_the_temperature() {
        let heating = heating(&scene(|text| text));
        let WarmedContact { rise, cold, warm } = heating.after(1e-3, 1e6, 1.0);
        let bounds = [cold, warm].map(|friction| friction * 1e6 * heating.kernel.rise(1e-3));
        assert!(warm < cold && bounds[1] < rise && rise < bounds[0], "{rise} in {bounds:?}, {cold} to {warm}");
    }

    /// The parts of friction add up, and so do the decades to the hysteresis.
    #[test]
    fn parts_of_friction_add_up() {
        let rows = fine(&scene(|text| text));
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
