//! The material form of a scene: moduli, density and the layer's thickness instead of the constants of links.

use serde::Serialize;

use super::error::{ParameterError, Problem};
use super::keys;
use super::{ByLink, Layer, Link, LinkKind, MaxwellElement, RateShear, Scene, is_possible};

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
    fn link(&self, size: f64) -> Link {
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
    fn spring_size(&self, kind: LinkKind, poisson_ratio: f64) -> Option<f64> {
        let (thickness, width) = (self.thickness?, self.width?);
        let size = if kind.is_lateral() { thickness * width / self.spacing } else { self.spacing * width / thickness };
        let sheared = matches!(kind, LinkKind::Horizontal | LinkKind::LateralZ);
        Some(if sheared { size / (2.0 * (1.0 + poisson_ratio)) } else { size })
    }
}

impl Scene {
    /// The link of a kind, if the scene has it: given, or following from the material.
    pub fn link(&self, kind: LinkKind) -> Option<Link> {
        match &self.material {
            Some(material) => self.link_size(kind, material.poisson_ratio).map(|size| material.link(size)),
            None => self.layer.links[kind].clone(),
        }
    }

    /// What turns a modulus into the stiffness of a link, m.
    fn link_size(&self, kind: LinkKind, poisson_ratio: f64) -> Option<f64> {
        match &self.foundation {
            Some(foundation) => {
                let size = foundation.link_size(kind, &self.layer, self.layer.width?);
                Some(size / (1.0 - poisson_ratio * poisson_ratio))
            }
            None => self.layer.spring_size(kind, poisson_ratio),
        }
    }

    /// The mass of one point mass, kg: given, or ρ A H, or ρ A ℓ of a fitted [`Foundation`](super::Foundation).
    pub fn mass(&self) -> f64 {
        let depth = || self.foundation.as_ref().map(|foundation| foundation.depth).or(self.layer.thickness);
        let of_material = || {
            let area = self.layer.element_area()?;
            Some(self.material.as_ref()?.density * area * depth()?)
        };
        self.layer.mass.or_else(of_material).unwrap_or(0.0)
    }

    /// τ_0 + τ_f(v), Pa, at the speed v (m/s) and the reference temperature; 0 without a shear strength.
    pub fn shear_strength_at(&self, speed: f64) -> f64 {
        let Some(friction) = &self.friction else { return 0.0 };
        let of_rate = friction.rate_shear.map_or(0.0, |law| {
            let decades = (speed.max(law.creep_speed()) / law.reference_speed).log10();
            law.strength.unwrap_or(0.0) * (-law.sharpness * decades * decades).exp()
        });
        friction.shear_strength.unwrap_or(0.0) + of_rate
    }

    /// Whether contacts have Coulomb's friction.
    pub fn has_coulomb(&self) -> bool {
        self.friction.as_ref().is_some_and(|friction| friction.coulomb.is_some())
    }

    /// Whether contacts have a shear force, at rest or in slip.
    pub fn has_shear(&self) -> bool {
        self.shear_force().is_some() || self.rate_shear().is_some()
    }

    /// Whether friction in the contacts depends on the speed of slip.
    pub fn friction_depends_on_speed(&self) -> bool {
        self.rate_shear().is_some() || self.fine.as_ref().is_some_and(|fine| fine.waves.has_bands())
    }

    /// The way D over which contacts are renewed where their friction depends on the speed, m: as the scene says, else
    /// [`DEFAULT_MEMORY`](Self::DEFAULT_MEMORY) of a material; 0: none, friction is that at the speed of slip.
    pub fn memory_way(&self) -> f64 {
        let of_form = if self.material.is_some() { Self::DEFAULT_MEMORY } else { 0.0 };
        self.friction.as_ref().and_then(|friction| friction.memory).unwrap_or(of_form)
    }

    /// Whether friction follows the speed that contacts remember, and not that of slip.
    pub fn has_memory(&self) -> bool {
        self.memory_way() > 0.0 && self.friction_depends_on_speed()
    }

    /// The way over which contacts of rubber are renewed where a scene does not say it, m: of the order of the diameter of
    /// what touches.
    pub const DEFAULT_MEMORY: f64 = 50.0e-6;

    /// Whether friction heats the contacts.
    pub fn has_heat(&self) -> bool {
        self.material.as_ref().is_some_and(|material| material.heat.is_some())
    }

    /// Whether the waves that the profile lacks rub.
    pub fn has_fine_hysteresis(&self) -> bool {
        self.fine.as_ref().is_some_and(|fine| fine.hysteresis && fine.waves.has_bands())
    }

    /// Whether the parts of friction are told apart: hysteresis of the waves that the profile lacks from any other, Coulomb's
    /// from the shear force.
    pub fn has_friction_parts(&self) -> bool {
        self.has_fine_hysteresis() || (self.has_coulomb() && self.has_shear())
    }

    /// Whether contacts rub.
    pub fn has_friction(&self) -> bool {
        self.friction.is_some() || self.has_fine_hysteresis()
    }

    /// Adhesive shear force A τ_0 of one mass in contact, N, if the scene has it: given, or of the shear strength.
    pub fn shear_force(&self) -> Option<f64> {
        let friction = self.friction.as_ref()?;
        friction.shear_force.or_else(|| Some(friction.shear_strength? * self.layer.element_area()?))
    }

    /// The shear strength that depends on the speed as the contacts have it, if the scene has it: by its force A τ_f0,
    /// and at the layer's temperature, where v_0(T) = v_0/a_T and v_c(T) = v_c/a_T.
    pub fn rate_shear(&self) -> Option<RateShear> {
        let law = self.friction.as_ref()?.rate_shear?;
        let force = law.force.or_else(|| Some(law.strength? * self.layer.element_area()?));
        let shift = self.material.as_ref().map_or(1.0, Material::shift_factor);
        Some(RateShear {
            force,
            strength: None,
            reference_speed: law.reference_speed / shift,
            sharpness: law.sharpness,
            creep_speed: law.creep_speed.map(|creep| creep / shift),
        })
    }

    /// This scene by the constants of its links; itself where it is given so.
    pub fn direct_form(&self) -> Self {
        let mut scene = self.clone();
        if scene.material.take().is_some() {
            scene.foundation = None;
            let mass = Some(self.mass());
            let layer = self.layer.clone();
            scene.layer = Layer {
                mass,
                links: ByLink::from_fn(|kind| self.link(kind)),
                thickness: None,
                width: None,
                foundation: None,
                ..layer
            };
            if let Some(friction) = &mut scene.friction {
                friction.memory = Some(self.memory_way());
                (friction.shear_force, friction.shear_strength) = (self.shear_force(), None);
                friction.rate_shear = self.rate_shear();
            }
            for phase in &mut scene.excitation {
                (phase.until_force, phase.until_pressure) = (phase.end_force(self.layer.area()), None);
                if phase.pressure.is_some() {
                    (phase.load, phase.pressure) = (Some(phase.load(self.layer.area())), None);
                }
            }
        }
        scene
    }

    /// The layer's temperature, K; `None` without `material.wlf`.
    pub fn temperature(&self) -> Option<f64> {
        self.material.as_ref()?.wlf.as_ref().map(|wlf| wlf.temperature)
    }

    /// The scene with its layer at a temperature, K, not checked; as it is without one, or where it has no
    /// `material.wlf`.
    pub fn with_temperature(&self, kelvin: impl Into<Option<f64>>) -> Self {
        let mut scene = self.clone();
        let wlf = scene.material.as_mut().and_then(|material| material.wlf.as_mut());
        if let (Some(wlf), Some(kelvin)) = (wlf, kelvin.into()) {
            wlf.temperature = kelvin;
        }
        scene
    }

    /// The scene with its layer at a temperature, K, checked.
    ///
    /// # Errors
    /// [`ParameterError`] where the scene has no `material.wlf`, or the temperature is none, or the shift has its pole
    /// above it, or a number of the material becomes impossible.
    pub fn at_temperature(&self, kelvin: f64) -> Result<Self, ParameterError> {
        let has_wlf = self.material.as_ref().is_some_and(|material| material.wlf.is_some());
        if !(has_wlf && kelvin > 0.0 && is_possible(kelvin)) {
            let range = keys::range_of("material.wlf.temperature");
            return Err(ParameterError::new("temperature", Problem::value(format_args!("{kelvin:?}"), range)));
        }
        let scene = self.with_temperature(kelvin);
        scene.check()?;
        Ok(scene)
    }

    /// Checks what follows from several parameters at once, and so cannot be refused when one of them is set: the
    /// temperature, the roughness below the profile, and the constants that follow from the material.
    ///
    /// # Errors
    /// [`ParameterError`] for the first that is out of range.
    pub fn check(&self) -> Result<(), ParameterError> {
        let Some(material) = &self.material else { return Ok(()) };
        material.wlf.map_or(Ok(()), |wlf| wlf.check())?;
        if let Some(Err(clash)) = self.fine.as_ref().map(|fine| fine.check(&self.surface)) {
            let problem = Problem::value(format_args!("{:?}", clash.given), clash.expected);
            return Err(ParameterError::new(format!("surface.fine.{}", clash.key), problem));
        }
        in_range("mass of a point mass, from the material", self.mass(), "layer.mass")?;
        self.rate_shear().map_or(Ok(()), |law| law.check())?;
        LinkKind::ALL
            .into_iter()
            .try_for_each(|kind| self.link(kind).map_or(Ok(()), |link| check_link(&link, kind.description())))
    }
}

impl RateShear {
    /// Checks the law at the layer's temperature.
    fn check(&self) -> Result<(), ParameterError> {
        let speed = |what: &str, speed: f64, key: &str| {
            in_range(&format!("{what} of the shear strength, at the temperature"), speed, key)
        };
        speed("reference speed", self.reference_speed, "friction.rate_shear.reference_speed")?;
        speed("creep speed", self.creep_speed(), "friction.rate_shear.creep_speed")
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

fn check_link(link: &Link, what: &str) -> Result<(), ParameterError> {
    let check = |quantity: &str, value: f64, key: &str| {
        in_range(&format!("{quantity} of the {what}, from the material"), value, &format!("layer.vertical.{key}"))
    };
    check("stiffness", link.stiffness.unwrap_or(0.0), "stiffness")?;
    check("damping", link.damping.unwrap_or(0.0), "damping")?;
    link.maxwell.iter().try_for_each(|element| {
        check("stiffness of an element", element.stiffness, "maxwell.stiffness")?;
        check("relaxation time of an element", element.relaxation_time, "maxwell.relaxation_time")
    })
}

/// Checks a value that follows from others against the range of `key`.
fn in_range(what: &str, value: f64, key: &str) -> Result<(), ParameterError> {
    let range = keys::range_of(key);
    let error = || ParameterError::new(what, Problem::value(format_args!("{value:?}"), range));
    if range.holds(value) { Ok(()) } else { Err(error()) }
}
