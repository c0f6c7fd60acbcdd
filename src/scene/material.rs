//! The material form of a scene: moduli, density and the layer's thickness instead of the constants of links.

use serde::Serialize;

use super::LinkKind;
use super::error::{ParameterError, Problem};
use super::layer::{Layer, Link, MaxwellElement};
use crate::tables::{Dimension, FileKind, NOT_NEGATIVE, POSITIVE, ReadTable, Role};

/// A linear viscoelastic solid: a spring, a dashpot and Maxwell elements in parallel, as moduli.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Material {
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Poisson's ratio ν, 1; the same at every frequency.
    pub poisson_ratio: f64,
    /// Modulus E_∞ after all relaxation, Pa.
    pub equilibrium_modulus: f64,
    /// Kelvin-Voigt viscosity η, Pa s, at the reference temperature.
    pub viscosity: Option<f64>,
    /// The Prony series (E_j, τ_j), at the reference temperature.
    pub prony: Vec<PronyTerm>,
    /// How times move with temperature; `None`: the scene has no temperature.
    pub wlf: Option<Wlf>,
    /// How it takes up the heat of friction; `None`: contacts stay at the layer's temperature.
    pub heat: Option<Heat>,
}

/// How a material takes up the heat that friction makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Heat {
    /// Conductivity λ, W/(m K).
    pub conductivity: f64,
    /// Specific capacity c, J/(kg K).
    pub capacity: f64,
    /// χ, 1: the part of the power that the rubber takes, and not the hard side.
    pub share: f64,
}

/// A term of a Prony series: a Maxwell element of the material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PronyTerm {
    /// Relaxation time τ_j at the reference temperature, s.
    pub relaxation_time: f64,
    /// Modulus E_j, Pa.
    pub modulus: f64,
}

const SERIES_ROLES: [Role; 2] = [
    Role::new("relaxation_time", "", Dimension::Time).within(POSITIVE),
    Role::new("modulus", "", Dimension::Pressure).within(NOT_NEGATIVE),
];
/// The file of a series in its canonical form: moduli of tension.
pub const SERIES: FileKind = FileKind::new(
    "a Prony series",
    &SERIES_ROLES,
    "a relaxation time and a modulus: relaxation_time [s], modulus [Pa]",
);

impl PronyTerm {
    /// The terms of a file.
    pub(super) fn of_table(table: &ReadTable) -> Vec<Self> {
        let rows = table.values("relaxation_time").iter().zip(table.values("modulus"));
        rows.map(|(&relaxation_time, &modulus)| Self { relaxation_time, modulus }).collect()
    }
}

/// The shift of all times with temperature after Williams, Landel and Ferry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Wlf {
    /// C_1, 1.
    pub c1: f64,
    /// C_2, K.
    pub c2: f64,
    /// T_ref, at which the times of the material are given, K.
    pub reference_temperature: f64,
    /// The layer's temperature T, K.
    pub temperature: f64,
}

impl Wlf {
    /// No rubber is soft below this, K (silicone's glass transition is at about 150 K): a lower temperature is probably
    /// meant in °C.
    pub const COLDEST: f64 = 100.0;

    /// Contacts that friction heats are taken to be this far above the pole at least, K.
    pub const ABOVE_POLE: f64 = 30.0;

    /// a_T: log10 a_T = -C_1 (T - T_ref)/(C_2 + T - T_ref), for T above
    /// [`lowest_temperature`](Self::lowest_temperature).
    pub fn shift_factor(&self) -> f64 {
        let above = self.temperature - self.reference_temperature;
        10.0_f64.powf(-self.c1 * above / (self.c2 + above))
    }

    /// What a number below [`COLDEST`](Self::COLDEST) probably means.
    fn in_kelvin(number: f64) -> String {
        let kelvin = 273.15 + number;
        format!("; temperatures are in K, {number} °C being {kelvin:.2} K, or \"{number} °C\"")
    }

    /// The temperatures (K) of some that are probably meant in °C.
    pub fn meant_in_celsius(temperatures: &[f64]) -> Option<String> {
        let cold = temperatures.iter().find(|kelvin| **kelvin < Self::COLDEST)?;
        Some(format!("{cold} K is too cold for rubber{}", Self::in_kelvin(*cold)))
    }

    /// T_ref - C_2, K: above it alone the law holds.
    pub fn lowest_temperature(&self) -> f64 {
        self.reference_temperature - self.c2
    }
}

impl PronyTerm {
    /// The term as a Maxwell element, its modulus (Pa) in the place of a stiffness.
    pub fn element(&self) -> MaxwellElement {
        MaxwellElement { stiffness: self.modulus, relaxation_time: self.relaxation_time }
    }
}

/// Real (storage) and imaginary (loss) part of the complex stiffness of a spring, a damper and Maxwell elements in
/// parallel at the angular frequency ω ≥ 0 (rad/s): c + iωd + Σ c_j iωτ_j/(1 + iωτ_j).
///
/// In N/m for stiffnesses; in Pa for moduli, the damper then being a viscosity (2).
pub fn complex_stiffness(
    spring: f64,
    damper: f64,
    elements: impl IntoIterator<Item = MaxwellElement>,
    omega: f64,
) -> (f64, f64) {
    elements.into_iter().fold((spring, omega * damper), |(storage, loss), element| {
        // Finite however long or short τ is.
        let x = omega * element.relaxation_time;
        let inverse = 1.0 / x;
        (storage + element.stiffness / (1.0 + inverse * inverse), loss + element.stiffness / (x + inverse))
    })
}

impl Link {
    /// K'(ω) and K''(ω), N/m, for ω ≥ 0 in rad/s: see [`complex_stiffness`].
    pub fn complex_stiffness(&self, omega: f64) -> (f64, f64) {
        let (spring, damper) = (self.stiffness.unwrap_or(0.0), self.damping.unwrap_or(0.0));
        complex_stiffness(spring, damper, self.maxwell.iter().copied(), omega)
    }
}

impl Material {
    /// a_T, the factor of every time at the layer's temperature; 1 without a temperature.
    pub fn shift_factor(&self) -> f64 {
        self.wlf.map_or(1.0, |wlf| wlf.shift_factor())
    }

    /// E'(ω) and E''(ω) at the layer's temperature, Pa, for ω ≥ 0 in rad/s (2), as the links have them:
    /// E*(ω) = E_∞ + iω a_T η + Σ_j E_j iω a_T τ_j/(1 + iω a_T τ_j).
    pub fn complex_modulus(&self, omega: f64) -> (f64, f64) {
        self.complex_modulus_at_reference(omega * self.shift_factor())
    }

    fn complex_modulus_at_reference(&self, omega: f64) -> (f64, f64) {
        let elements = self.prony.iter().map(PronyTerm::element);
        complex_stiffness(self.equilibrium_modulus, self.viscosity.unwrap_or(0.0), elements, omega)
    }

    /// M'(ω) and M''(ω), Pa: the plane modulus of [`complex_modulus`](Self::complex_modulus).
    pub fn complex_plane_modulus(&self, omega: f64) -> (f64, f64) {
        self.plane_moduli(self.complex_modulus(omega))
    }

    /// [`complex_plane_modulus`](Self::complex_plane_modulus) at the reference temperature.
    pub(super) fn complex_plane_modulus_at_reference(&self, omega: f64) -> (f64, f64) {
        self.plane_moduli(self.complex_modulus_at_reference(omega))
    }

    fn plane_moduli(&self, (storage, loss): (f64, f64)) -> (f64, f64) {
        (self.plane_modulus(storage), self.plane_modulus(loss))
    }

    /// M = E/(1 - ν²), Pa: the plane modulus of the modulus E, Pa.
    pub fn plane_modulus(&self, modulus: f64) -> f64 {
        modulus / (1.0 - self.poisson_ratio * self.poisson_ratio)
    }

    /// A link whose constants are the moduli times `size`, m (docs/model.md, section 7).
    pub(super) fn link(&self, size: f64) -> Link {
        let shift = self.shift_factor();
        let element = |term: &PronyTerm| MaxwellElement {
            stiffness: term.modulus * size,
            relaxation_time: shift * term.relaxation_time,
        };
        Link {
            stiffness: Some(self.equilibrium_modulus * size),
            damping: self.viscosity.map(|eta| shift * eta * size),
            maxwell: self.prony.iter().map(element).collect(),
        }
    }
}

impl Layer {
    /// Area A = B Δx of the layer that one mass stands for, m²; in the material form alone.
    pub fn element_area(&self) -> Option<f64> {
        self.width.map(|width| width * self.spacing)
    }

    /// Area k A of the whole layer, m²; in the material form alone.
    pub fn area(&self) -> Option<f64> {
        self.element_area().map(|area| area * self.masses as f64)
    }

    /// What turns a modulus into the stiffness of a link of springs, m: A/H to the carrier, H B/Δx to the neighbour;
    /// times G/E = 1/(2(1 + ν)) where the link is sheared.
    pub(super) fn spring_size(&self, kind: LinkKind, poisson_ratio: f64) -> Option<f64> {
        let (thickness, width) = (self.thickness?, self.width?);
        let size = if kind.is_lateral() { thickness * width / self.spacing } else { self.spacing * width / thickness };
        let sheared = matches!(kind, LinkKind::Horizontal | LinkKind::LateralZ);
        Some(if sheared { size / (2.0 * (1.0 + poisson_ratio)) } else { size })
    }
}

impl Wlf {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        if self.c2 + (self.temperature - self.reference_temperature) > 0.0 {
            return Ok(());
        }
        let celsius = if self.temperature < Self::COLDEST { Self::in_kelvin(self.temperature) } else { String::new() };
        let expected = format!(
            "more than material.wlf.reference_temperature - c2 = {:.2} K, where the shift has its pole{celsius}",
            self.lowest_temperature()
        );
        let problem = Problem::value(format_args!("{:?}", self.temperature), expected);
        Err(ParameterError::new("material.wlf.temperature", problem))
    }
}
