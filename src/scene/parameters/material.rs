//! The parameters of the material form.

use crate::scene::allowed::{self, Range};
use crate::scene::{Material, Unit};

/// One settable number of `[material]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MaterialParameter {
    /// `material.density`
    Density,
    /// `material.poisson_ratio`
    PoissonRatio,
    /// `material.equilibrium_modulus`
    EquilibriumModulus,
    /// `material.viscosity`
    Viscosity,
    /// `material.prony[1].modulus` and so on; the term counted from 0
    Modulus(usize),
    /// `material.prony[1].relaxation_time` and so on; the term counted from 0
    RelaxationTime(usize),
    /// `material.wlf.c1`
    C1,
    /// `material.wlf.c2`
    C2,
    /// `material.wlf.reference_temperature`
    ReferenceTemperature,
    /// `material.wlf.temperature`
    Temperature,
}

impl MaterialParameter {
    /// Those that `material` has, in the order of the scene's keys.
    pub(super) fn of(material: &Material) -> Vec<Self> {
        let mut parameters = vec![Self::Density, Self::PoissonRatio, Self::EquilibriumModulus];
        parameters.extend(material.viscosity.map(|_| Self::Viscosity));
        parameters.extend((0..material.prony.len()).flat_map(|j| [Self::Modulus(j), Self::RelaxationTime(j)]));
        if material.wlf.is_some() {
            parameters.extend([Self::C1, Self::C2, Self::ReferenceTemperature, Self::Temperature]);
        }
        parameters
    }

    pub(super) fn name(self) -> String {
        match self {
            Self::Density => "material.density".into(),
            Self::PoissonRatio => "material.poisson_ratio".into(),
            Self::EquilibriumModulus => "material.equilibrium_modulus".into(),
            Self::Viscosity => "material.viscosity".into(),
            Self::Modulus(j) => format!("material.prony[{}].modulus", j + 1),
            Self::RelaxationTime(j) => format!("material.prony[{}].relaxation_time", j + 1),
            Self::C1 => "material.wlf.c1".into(),
            Self::C2 => "material.wlf.c2".into(),
            Self::ReferenceTemperature => "material.wlf.reference_temperature".into(),
            Self::Temperature => "material.wlf.temperature".into(),
        }
    }

    pub(super) fn unit(self) -> Unit {
        match self {
            Self::Density => Unit::KilogramPerCubicMeter,
            Self::PoissonRatio | Self::C1 => Unit::One,
            Self::EquilibriumModulus | Self::Modulus(_) => Unit::Pascal,
            Self::Viscosity => Unit::PascalSecond,
            Self::RelaxationTime(_) => Unit::Second,
            Self::C2 | Self::ReferenceTemperature | Self::Temperature => Unit::Kelvin,
        }
    }

    pub(super) fn description(self) -> String {
        match self {
            Self::Density => "Density of the layer's material".into(),
            Self::PoissonRatio => "Poisson's ratio of the layer's material".into(),
            Self::EquilibriumModulus => "Modulus of the layer's material after all relaxation".into(),
            Self::Viscosity => "Kelvin-Voigt viscosity of the layer's material at the reference temperature".into(),
            Self::Modulus(j) => format!("Modulus of term {} of the Prony series", j + 1),
            Self::RelaxationTime(j) => {
                format!("Relaxation time of term {} of the Prony series at the reference temperature", j + 1)
            }
            Self::C1 => "C_1 of Williams, Landel and Ferry".into(),
            Self::C2 => "C_2 of Williams, Landel and Ferry".into(),
            Self::ReferenceTemperature => "Temperature at which the material's times are given".into(),
            Self::Temperature => "Temperature of the layer".into(),
        }
    }

    pub(super) fn range(self) -> Range {
        match self {
            Self::Density => allowed::DENSITY,
            Self::PoissonRatio => allowed::POISSON_RATIO,
            Self::EquilibriumModulus | Self::Modulus(_) => allowed::MODULUS,
            Self::Viscosity => allowed::VISCOSITY,
            Self::RelaxationTime(_) => allowed::RELAXATION_TIME,
            Self::C1 => allowed::WLF_C1,
            Self::C2 => allowed::WLF_C2,
            Self::ReferenceTemperature | Self::Temperature => allowed::TEMPERATURE,
        }
    }

    /// Where the number is kept, if `material` has it.
    pub(super) fn place(self, material: &mut Material) -> Option<&mut f64> {
        match self {
            Self::Density => Some(&mut material.density),
            Self::PoissonRatio => Some(&mut material.poisson_ratio),
            Self::EquilibriumModulus => Some(&mut material.equilibrium_modulus),
            Self::Viscosity => material.viscosity.as_mut(),
            Self::Modulus(j) => Some(&mut material.prony.get_mut(j)?.modulus),
            Self::RelaxationTime(j) => Some(&mut material.prony.get_mut(j)?.relaxation_time),
            Self::C1 => Some(&mut material.wlf.as_mut()?.c1),
            Self::C2 => Some(&mut material.wlf.as_mut()?.c2),
            Self::ReferenceTemperature => Some(&mut material.wlf.as_mut()?.reference_temperature),
            Self::Temperature => Some(&mut material.wlf.as_mut()?.temperature),
        }
    }

    /// The number, if `material` has it.
    pub(super) fn value(self, material: &Material) -> Option<f64> {
        let term = |j: usize| material.prony.get(j);
        match self {
            Self::Density => Some(material.density),
            Self::PoissonRatio => Some(material.poisson_ratio),
            Self::EquilibriumModulus => Some(material.equilibrium_modulus),
            Self::Viscosity => material.viscosity,
            Self::Modulus(j) => Some(term(j)?.modulus),
            Self::RelaxationTime(j) => Some(term(j)?.relaxation_time),
            Self::C1 => Some(material.wlf?.c1),
            Self::C2 => Some(material.wlf?.c2),
            Self::ReferenceTemperature => Some(material.wlf?.reference_temperature),
            Self::Temperature => Some(material.wlf?.temperature),
        }
    }
}
