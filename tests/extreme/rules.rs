//! What must hold of every run.

use asperity::model::{Model, SlipHistory};
use asperity::outputs::{Output, Variable};
use asperity::scene::{RateShear, Scene};
use asperity::simulation::SimulationState;

use crate::run::{MAX_STEPS, Outcome};

/// Something that does not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Which rule.
    pub rule: &'static str,
    /// What was seen.
    pub text: String,
}

/// The limits of one scene.
pub struct Limits {
    model: Model,
    relative: f64,
    /// m.
    absolute: f64,
    /// What the absolute tolerance of positions is as a force of the softest link between carrier and mass, N: as far may
    /// a limit of a force be passed. An event is located within a tenth of it, on positions that are themselves known
    /// within it. Of a stiff link the elongation is known far better than within that tolerance.
    pub force: f64,
    /// The largest |X_i|, m.
    farthest: f64,
    masses: f64,
    /// Coulomb's coefficient, and the shear force of a mass at rest, N.
    friction: (f64, f64),
    rate_shear: Option<RateShear>,
    /// Whether nothing forgets an error, so that every step may make its own.
    adds_up: bool,
}

/// The largest residual of the energies over the largest energy and the tolerance.
pub const ENERGY: f64 = 10.0;
/// Roundings of a sum of as many terms as there are steps: of random signs, with room.
const ROUNDING: f64 = 1e-13;

impl Limits {
    pub fn new(scene: &Scene, adds_up: bool) -> Self {
        let model = Model::new(scene);
        let (relative, absolute) = (scene.solver.relative_tolerance, scene.absolute_tolerance());
        let coulomb = scene.friction.as_ref().and_then(|friction| friction.coulomb);
        Self {
            relative,
            absolute,
            force: absolute * softest(&model),
            farthest: model.rest_x.iter().fold(0.0, |farthest: f64, x| farthest.max(x.abs())),
            masses: model.masses() as f64,
            friction: (coulomb.unwrap_or_default(), scene.shear_force().unwrap_or_default()),
            rate_shear: scene.rate_shear(),
            adds_up,
            model,
        }
    }

    /// The rules for the row at a time, the carrier at u; of each rule the first finding is kept.
    pub fn check_row(
        &self,
        (time, u): (f64, f64),
        variables: &[Variable],
        values: &[f64],
        findings: &mut Vec<Finding>,
    ) {
        let mut note = |rule: &'static str, text: String| {
            if !findings.iter().any(|finding| finding.rule == rule) {
                findings.push(Finding { rule, text: format!("t = {time:.2e}: {text}") });
            }
        };
        if let Some(i) = values.iter().position(|value| !value.is_finite()) {
            note("finite", format!("{} = {}", variables[i].name, values[i]));
        }
        for (i, mass) in variables.iter().zip(values.windows(5)).filter(|(variable, _)| is_first(variable)) {
            let [x, z, normal, friction, mode] = *mass else { continue };
            let name = i.name.trim_end_matches(".x");
            if let Some(text) = self.normal(normal, mode) {
                note("normal", format!("{name}: {text}"));
            }
            if let Some(text) = self.gap(u, x, z) {
                note("gap", format!("{name}: {text}"));
            }
            if let Some(text) = self.friction(normal, friction, mode) {
                note("friction", format!("{name}: {text}, mode {mode}"));
            }
        }
    }

    /// F_N ≥ 0, but for the tolerance within which a lift is located.
    fn normal(&self, normal: f64, mode: f64) -> Option<String> {
        (normal < -self.force).then(|| format!("F_N = {normal:.1e} below -{:.1e}, mode {mode}", self.force))
    }

    /// g ≥ -tolerance, and no worse than the roundings of the position, of u and X_i that it is the sum of, and of the
    /// height.
    fn gap(&self, u: f64, x: f64, z: f64) -> Option<String> {
        let point = self.model.surface_at(x);
        let along = x.abs() + u.abs() + self.farthest;
        let rounding = 8.0 * f64::EPSILON * (z.abs() + point.height.abs() + along * point.slope.abs());
        let gap = z - point.height;
        (gap < -self.absolute - rounding).then(|| format!("g = {gap:.1e} below -{:.1e}", self.absolute))
    }

    /// |F_T| ≤ T, but for the tolerance within which a break is located and the row's own error.
    fn friction(&self, normal: f64, friction: f64, mode: f64) -> Option<String> {
        // On the area that touches at rest: the rubber is no softer in slip.
        let share = self.model.friction.fine_contact(normal.max(0.0), 0.0, &SlipHistory::default()).share.value;
        let limit = self.friction.0 * normal.max(0.0)
            + share * (self.friction.1 + self.rate_limit(mode))
            + self.model.friction.largest_hysteresis(normal);
        let slack = self.force * (1.0 + self.friction.0) + self.relative * limit;
        (friction.abs() > limit + slack).then(|| format!("|F_T| = {:.2e} above {limit:.2e}", friction.abs()))
    }

    /// A τ_f(v_c) of a mass that sticks and remembers no speed, the largest A τ_f(v) of another, N.
    fn rate_limit(&self, mode: f64) -> f64 {
        self.rate_shear.map_or(0.0, |law| {
            let decades = (law.creep_speed() / law.reference_speed).log10();
            law.force.unwrap_or(0.0)
                * if mode == 2.0 && self.model.friction.memory.is_none() {
                    (-law.sharpness * decades * decades).exp()
                } else {
                    1.0
                }
        })
    }

    /// The rules for a whole run.
    pub fn check_run(&self, outcome: &mut Outcome) {
        let checks = [("energy", self.energy(outcome)), ("work", work(outcome)), ("channels", channels(self, outcome))];
        let found = checks.into_iter().filter_map(|(rule, text)| Some(Finding { rule, text: text? }));
        let found: Vec<_> = found.collect();
        outcome.findings.extend(found);
    }

    /// The residual within ten times the tolerance: the relative one of the largest energy that went through, the
    /// absolute one as a force on every mass along the carrier's path.
    fn energy(&self, outcome: &Outcome) -> Option<String> {
        let (residual, scale) = (outcome.largest("energy.residual"), energy_scale(outcome));
        let path = outcome.path;
        let absolute = self.force * self.masses * path;
        let allowed = ENERGY * (self.relative * scale + absolute) + ROUNDING * scale;
        let allowed = if self.adds_up { allowed * outcome.last("solver.steps").max(1.0) } else { allowed };
        let share = residual / allowed * ENERGY;
        (residual > allowed)
            .then(|| format!("residual {residual:.1e} J, {share:.1} tolerances; largest energy {scale:.1e} J"))
    }

    /// A run that stopped left everything as it was.
    pub fn kept(
        &self,
        before: &(Vec<f64>, SimulationState),
        after: &(Vec<f64>, SimulationState),
        findings: &mut Vec<Finding>,
    ) {
        let same = before.0.iter().zip(&after.0).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same || before.1 != after.1 {
            findings
                .push(Finding { rule: "kept", text: "the state is not the one before the motion that failed".into() });
        }
    }
}

/// c + Σ c_j of the softest link to the carrier that has springs; of the others where none has, and of the dampers
/// where nothing has, N/m.
fn softest(model: &Model) -> f64 {
    let softest = |kinds: &[f64]| kinds.iter().copied().filter(|&c| c > 0.0).reduce(f64::min);
    let [carrier, between] = [&model.glassy.0[..2], &model.glassy.0[2..]].map(softest);
    carrier.or(between).unwrap_or_else(|| model.mass * model.stiffest_frequency().powi(2))
}

fn is_first(variable: &Variable) -> bool {
    matches!(variable.output, Output::ElementX(_))
}

/// The largest energy that went through or was stored, J.
pub fn energy_scale(outcome: &Outcome) -> f64 {
    let names = ["energy.input", "energy.kinetic", "energy.elastic", "E_diss"];
    names.iter().map(|name| outcome.largest(name)).fold(0.0, f64::max)
}

/// One bound for every scene.
fn work(outcome: &Outcome) -> Option<String> {
    let tried = outcome.work();
    (tried > MAX_STEPS as f64).then(|| format!("{tried} steps tried"))
}

/// What is lost stays lost: no channel ever gives energy back, but for what a step done again puts right.
fn channels(limits: &Limits, outcome: &Outcome) -> Option<String> {
    let names = ["dissipation.E_damper", "dissipation.E_maxwell", "dissipation.E_friction", "dissipation.E_impact"];
    let scale = energy_scale(outcome);
    let repeated = outcome.column("solver.repeated");
    let is_done_again = |row: usize| repeated.get(row) < repeated.get(row + 1);
    names.iter().find_map(|name| {
        let pairs = outcome.column(name);
        let pairs = pairs.windows(2).enumerate().filter(|(row, _)| !is_done_again(*row));
        let fall = pairs.map(|(_, pair)| pair[0] - pair[1]).fold(0.0, f64::max);
        (fall > ENERGY * limits.relative * scale + limits.force * limits.masses * outcome.path)
            .then(|| format!("{name} falls by {fall:.1e} of {scale:.1e} J"))
    })
}
