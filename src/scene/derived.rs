//! What follows from the numbers of a scene: masses and links of a material, friction at a temperature, inputs, tolerances.

use std::f64::consts::TAU;
use std::path::{Path as FilePath, PathBuf};

use super::error::{ParameterError, Problem};
use super::foundation::Quality;
use super::{
    ByLink, CarrierBody, CarrierInitial, FineBand, FineWaves, Initial, Input, Layer, Link, LinkKind, Material, Phase,
    RateShear, SMALLEST, Scene, Waves, is_possible, keys, peak_to_valley,
};

impl Scene {
    /// The duration of the excitation if no force ends a phase, s.
    pub fn duration(&self) -> f64 {
        self.excitation.iter().map(|phase| phase.duration).sum()
    }

    /// Paths of the files that the scene was read from; `path` is that of its own.
    pub fn sources(&self, path: &FilePath) -> Vec<PathBuf> {
        let folder = path.parent().unwrap_or(FilePath::new(""));
        std::iter::once(path.to_owned()).chain(self.files.iter().map(|file| folder.join(&file.path))).collect()
    }

    /// The scene's height, m: the peak-to-valley heights of the profile's data points and of the layer's roughness
    /// together, the spacing of the masses where both are flat.
    pub fn height(&self) -> f64 {
        let height = peak_to_valley(self.surface.z()) + peak_to_valley(&self.layer.roughness);
        if height > 0.0 { height } else { self.layer.spacing }
    }

    /// The absolute tolerance, m: as it was set, or the relative one times the [`height`](Self::height), but at least
    /// [`SMALLEST`].
    pub fn absolute_tolerance(&self) -> f64 {
        let default = || (self.solver.relative_tolerance * self.height()).max(SMALLEST);
        self.solver.absolute_tolerance.unwrap_or_else(default)
    }
}

/// The layer, its links, and their friction.
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

    /// The way D over which contacts are renewed where their friction depends on the speed, m: as the scene says, else the
    /// [default](Self::default_memory); 0: none, friction is that at the speed of slip.
    pub fn memory_way(&self) -> f64 {
        self.friction.as_ref().and_then(|friction| friction.memory).unwrap_or(self.default_memory)
    }

    /// Whether that way is the default of a material, by which contacts slide evenly.
    pub fn memory_follows(&self) -> bool {
        let is_said = self.friction.as_ref().is_some_and(|friction| friction.memory.is_some());
        self.material.is_some() && !is_said && self.friction_depends_on_speed()
    }

    /// Whether friction follows the speed that contacts remember, and not that of slip.
    pub fn has_memory(&self) -> bool {
        self.memory_way() > 0.0 && self.friction_depends_on_speed()
    }

    /// The way over which contacts of rubber are renewed at least where a scene does not say it, m: of the order of the
    /// diameter of what touches.
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
                kinematics: Some(layer.kinematics()),
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

/// The carrier that is a body, and what a master gives.
impl Scene {
    /// The inputs of the scene's layer, in the order of the variables.
    pub fn inputs(&self) -> Vec<Input> {
        let acts = |input: &Input| {
            let Some(axis) = input.axis() else { return self.temperature_input };
            let body = &self.carrier[axis];
            if input.is_displacement() { body.as_ref().is_none_or(CarrierBody::has_drive) } else { body.is_some() }
        };
        Input::ALL.into_iter().filter(acts).collect()
    }

    /// The stiffness Σ_i C with which the masses on the profile bear a body along z at its start, per mass, N/m: that
    /// of the springs of the vertical links, with the Maxwell elements where dashpots start undeformed.
    pub fn bearing_stiffness(&self) -> f64 {
        let Some(link) = self.link(LinkKind::Vertical) else { return 0.0 };
        let elements = link.maxwell.iter().map(|element| element.stiffness).sum::<f64>();
        let undeformed = self.layer.initial == Initial::Undeformed;
        link.stiffness.unwrap_or(0.0) + if undeformed { elements } else { 0.0 }
    }

    /// The load's changing part at the start of a run along the excitation, N.
    pub fn first_load(&self) -> f64 {
        self.excitation.first().map_or(0.0, |phase| phase.load(self.layer.area()).start.unwrap_or(0.0))
    }

    /// The value of an input before anything is set: the material's temperature, 0 for the others.
    pub fn input_start(&self, input: Input) -> f64 {
        if input == Input::Temperature { self.temperature().unwrap_or(0.0) } else { 0.0 }
    }

    /// The changing part of the tangential force at the start of a run along the excitation, N.
    pub fn first_pull(&self) -> f64 {
        self.excitation.first().and_then(|phase: &Phase| phase.pull().start).unwrap_or(0.0)
    }

    /// Refuses an equilibrium that does not exist under a load whose changing part is `load` at the start, N.
    pub(crate) fn check_equilibrium(&self, load: f64) -> Result<(), ParameterError> {
        let Some(body) = self.carrier.z.filter(|body| body.initial == CarrierInitial::Equilibrium) else {
            return Ok(());
        };
        let load = load + body.load.unwrap_or(0.0);
        if body.stiffness.unwrap_or(0.0) > 0.0 || (load >= 0.0 && self.bearing_stiffness() > 0.0) {
            return Ok(());
        }
        let expected =
            "a load of 0 or more on vertical springs, or carrier.z.stiffness > 0: otherwise nothing is at rest";
        let given = format_args!("\"equilibrium\" under a load of {load:?} N");
        Err(ParameterError::new("carrier.z.initial", Problem::value(given, expected)))
    }
}

/// v_c where nothing gives it, m/s.
const CREEP_SPEED: f64 = 1e-6;

/// The roughness below the resolution of the profile.
impl Scene {
    /// The bands of waves that the profile lacks, from the longest; none without them, or where their modulus is given.
    pub fn fine_bands(&self) -> Vec<FineBand> {
        let Some(fine) = &self.fine else { return Vec::new() };
        let mut bands = fine.waves.bands(&self.surface);
        if let Some(factors) = &fine.factors {
            bands.iter_mut().for_each(|band| band.gradient_square *= factors.at(TAU / band.wave_number));
        }
        // Each band's strain is that of all waves down to its own.
        let mut gradient_square = 0.0;
        for band in &mut bands {
            gradient_square += band.gradient_square;
            band.factors = fine.softening.factors(0.5 * gradient_square.sqrt());
        }
        bands
    }

    /// The root mean square gradient of the waves that the profile lacks, 1.
    pub fn fine_gradient(&self) -> f64 {
        match self.fine.as_ref().map(|fine| &fine.waves) {
            Some(FineWaves::Modulus { rms_slope, .. }) => *rms_slope,
            _ => self.fine_bands().iter().map(|band| band.gradient_square).sum::<f64>().sqrt(),
        }
    }

    /// The root mean square height of the waves in the bands, m.
    pub fn fine_height(&self) -> f64 {
        let square = |band: &FineBand| band.gradient_square / band.wave_number.powi(2);
        self.fine_bands().iter().map(square).sum::<f64>().sqrt()
    }

    /// v_c of the waves, m/s; `None` where there are none, or where that of the shear strength counts.
    pub(super) fn own_fine_creep_speed(&self) -> Option<f64> {
        let of_shear = self.friction.as_ref().is_some_and(|friction| friction.rate_shear.is_some());
        self.fine.as_ref().filter(|fine| fine.waves.has_bands() && !of_shear).map(|_| self.fine_creep_speed())
    }

    /// v_c, m/s at the reference temperature: slip on the roughness below the profile is no slower.
    pub fn fine_creep_speed(&self) -> f64 {
        let of_shear = self.friction.as_ref().and_then(|friction| friction.rate_shear).map(|law| law.creep_speed());
        self.fine.as_ref().and_then(|fine| fine.creep_speed).or(of_shear).unwrap_or(CREEP_SPEED)
    }
}

impl Scene {
    /// How well the links along the direction of `kind` meet the surface of a half-plane or of a layer of their
    /// thickness; `None` in the direct form.
    pub fn quality(&self, kind: LinkKind) -> Option<Quality> {
        let (layer, material) = (&self.layer, self.material.as_ref()?);
        let body = layer.body(material)?;
        match &self.foundation {
            Some(fit) => Quality::new(&fit.waves, fit.stiffness(kind), body, kind),
            None => {
                let waves = Waves::new(layer, &self.surface);
                Quality::new(&waves, layer.springs(material, kind)?, body, kind)
            }
        }
    }
}
