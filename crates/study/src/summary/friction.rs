//! The friction in the summary of a scene, and where it falls over the speed.

use std::ops::Range;

use asperity::model::{EvenSliding, FrictionLaw, SlipHistory};
use asperity::scene::{RateShear, Scene};

use super::fine::MIDDLE;
use super::words::{LEFT_OUT, number, or_left_out};
use super::{LabelledLine, labelled};

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
