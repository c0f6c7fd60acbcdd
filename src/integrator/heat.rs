//! The flash temperatures over one step, condensed as the Maxwell elements are (docs/theory.md, section 14).
//!
//! The flux Q = F_T v_t/A that friction makes is a polynomial in time through its values at the stages: within the step
//! that of the velocities (see `interpolation`), up to an inner stage a parabola at most. Each term of the kernel follows
//! it by the exact solution of ϑ̇_j = w_j Q - ϑ_j/t_j, however short t_j is, so that ϑ at stage i is
//!
//!   ϑ_i = Σ_j e^(-c_i h/t_j) ϑ_j + Σ_{l≤i} W_il Q_l,
//!
//! with numbers W_il that the terms share.

use super::interpolation::{Interpolation, Velocities};
use super::scheme::Coefficients;
use super::stage_values::StageValues;
use super::tableau::{MAX_STAGES, StageWeights, Tableau};
use crate::math::{Relaxation, weighted_sum};
use crate::model::{Flash, FlashTerm, Model};

/// Workspace for the flash temperatures of a layer over one step.
#[derive(Clone, Debug)]
pub(super) struct StageHeat {
    tableau: &'static Tableau,
    interpolation: &'static Interpolation,
    /// By stage, those through whose fluxes the temperature there follows; of the last one, in its embedded error estimate.
    nodes: Vec<Vec<usize>>,
    /// The kernel; empty where friction heats nothing.
    terms: Vec<FlashTerm>,
    /// The length of the step, s.
    h: f64,
    /// By term: ϑ_j at the end of the step.
    ends: Vec<TermWeights>,
    /// W_il, K m²/W.
    sums: [StageWeights; MAX_STAGES],
    /// The weights of the embedded error estimate of ϑ at the end, K m²/W.
    error: StageWeights,
    /// By mass, the part of ϑ at the implicit stages that the start has left, one after another, K.
    left: Vec<f64>,
    /// The rise of the temperature over the step under a flux of 1 W/m², K m²/W.
    rise: f64,
}

/// What ϑ_j at one time of a step consists of.
#[derive(Clone, Copy, Debug, Default)]
struct TermWeights {
    /// Of ϑ_j at the start.
    decay: f64,
    /// Of the flux at the stages, K m²/W.
    flux: StageWeights,
}

/// The flash temperatures of the masses at a stage, as far as they are known before it is solved.
#[derive(Clone, Debug)]
pub(super) struct StageFlash {
    /// By mass, what the earlier stages leave, K; empty where friction heats nothing.
    known: Vec<f64>,
    /// By mass, from where ϑ is looked for, K.
    guess: Vec<f64>,
    /// K/W by the power of the stage itself.
    gain: f64,
    /// The rise of the temperature over the step relative to that by the stage alone.
    rise: f64,
    /// 1/A, 1/m².
    per_area: f64,
}

/// The part of a change of ϑ that heat makes of itself over a whole step, up to which the step's solution is the one that
/// is continuous in its length.
const MAX_FEEDBACK: f64 = 0.5;

impl StageHeat {
    /// Workspace for `model` over steps by a method, if it `is_used`.
    pub(super) fn new(coefficients: &'static Coefficients, model: &Model, is_used: bool) -> Self {
        let Coefficients { tableau, interpolation, .. } = coefficients;
        let terms = model.flash.as_ref().filter(|_| is_used).map_or(Vec::new(), |kernel| kernel.terms.clone());
        let masses = if terms.is_empty() { 0 } else { model.masses() };
        Self {
            tableau,
            interpolation,
            nodes: (0..tableau.stages).map(|i| nodes(tableau, interpolation, i)).collect(),
            h: 0.0,
            ends: vec![TermWeights::default(); terms.len()],
            sums: [StageWeights::default(); MAX_STAGES],
            error: StageWeights::default(),
            left: vec![0.0; tableau.last() * masses],
            rise: 0.0,
            terms,
        }
    }

    /// Begins a step of length `h` (s) from the parts `flash` of the temperatures, K.
    pub(super) fn begin(&mut self, flash: &[f64], h: f64) {
        if self.terms.is_empty() {
            return;
        }
        // What the start leaves at the stages.
        self.h = h;
        let (c, last, masses) = (&self.tableau.c, self.tableau.last(), flash.len() / self.terms.len());
        for (i, left) in (1..).zip(self.left.chunks_exact_mut(masses)) {
            decayed(&self.terms, c[i] * h, flash, left);
        }
        // What the fluxes at the stages add.
        (self.sums, self.error) = ([StageWeights::default(); MAX_STAGES], StageWeights::default());
        for n in 0..self.terms.len() {
            let term = self.terms[n];
            for i in 1..=last {
                let driven = Relaxation::new(h / term.time, c[i]).driven;
                let flux = through(&self.nodes[i], c, 0.0, &driven);
                add(if i < last { &mut self.sums[i] } else { &mut self.error }, term.weight * h, &flux);
            }
            self.ends[n] = self.at(&term, 1.0);
            add(&mut self.sums[last], 1.0, &self.ends[n].flux);
        }
        add(&mut self.error, -1.0, &self.sums[last]);
        self.rise = self.terms.iter().map(|term| term.rise(h)).sum();
    }

    /// The weights of one `term` at the fraction `theta` of the step.
    fn at(&self, term: &FlashTerm, theta: f64) -> TermWeights {
        let (h, z, c) = (self.h, self.h / term.time, &self.tableau.c);
        let Relaxation { decay, driven } = Relaxation::new(z, theta);
        let mut flux = StageWeights::default();
        match self.interpolation.velocities() {
            Velocities::Polynomial => flux = self.interpolation.combined(&driven),
            Velocities::BrokenLine => {
                for piece in self.interpolation.in_time().windows(2) {
                    let (from, to) = (c[piece[0]], c[piece[1]].min(theta));
                    if from < to {
                        let driven = Relaxation::new(z, to - from).driven;
                        let left = (-z * (theta - to)).exp();
                        add(&mut flux, left, &through(piece, c, from, &driven));
                    }
                }
            }
        }
        TermWeights { decay, flux: flux.map(|weight| term.weight * h * weight) }
    }

    /// Sets what is known of the temperatures before stage `i`, with these rates at the earlier `stages`.
    pub(super) fn prepare(&self, i: usize, stages: &[StageValues], flash: &mut StageFlash) {
        let (masses, weights) = (flash.known.len(), &self.sums[i]);
        if masses == 0 {
            return;
        }
        let left = std::iter::once((1.0, &self.left[(i - 1) * masses..i * masses]));
        weighted_sum(&mut flash.known, left.chain(weighted(&weights[..i], stages.iter().map(heat_flux))));
        (flash.gain, flash.rise) = (weights[i] * flash.per_area, self.rise / weights[i]);
        let latest = flash.known.iter().zip(&stages[i - 1].heat_flux);
        flash.guess.iter_mut().zip(latest).for_each(|(guess, (known, flux))| *guess = known + weights[i] * flux);
    }

    /// Writes the variation of what is known of the temperatures before stage `i`, for those of their parts at the start and
    /// of the `fluxes` at the earlier stages.
    pub(super) fn vary(&self, i: usize, start: &[f64], fluxes: &[Vec<f64>], known: &mut [f64]) {
        if !self.terms.is_empty() {
            decayed(&self.terms, self.tableau.c[i] * self.h, start, known);
            for (weight, flux) in weighted(&self.sums[i][..i], fluxes.iter().map(Vec::as_slice)) {
                known.iter_mut().zip(flux).for_each(|(known, flux)| *known += weight * flux);
            }
        }
    }

    /// Writes the parts of the temperatures at the end of the step, K, or their variations for those of the parts at the
    /// start and of the `fluxes` at the stages.
    pub(super) fn at_end<'a>(
        &self,
        start: &'a [f64],
        fluxes: impl Iterator<Item = &'a [f64]> + Clone,
        flash: &mut [f64],
    ) {
        write(self.ends.iter().copied(), start, fluxes, flash);
    }

    /// Writes the parts of the temperatures at the fraction `theta` of the step, K.
    pub(super) fn within(&self, theta: f64, start: &[f64], stages: &[StageValues], flash: &mut [f64]) {
        let weights = self.terms.iter().map(|term| self.at(term, theta));
        write(weights, start, stages.iter().map(heat_flux), flash);
    }

    /// ϑ of mass `i` at the fraction `theta` of the step, K; 0 where friction heats nothing.
    pub(super) fn of_mass_within(&self, theta: f64, start: &[f64], stages: &[StageValues], i: usize) -> f64 {
        let masses = if self.terms.is_empty() { 1 } else { start.len() / self.terms.len() };
        let part = |(term, part): (&FlashTerm, &f64)| {
            let TermWeights { decay, flux } = self.at(term, theta);
            let driven = flux.iter().zip(stages).map(|(weight, stage)| weight * stage.heat_flux[i]);
            decay * part + driven.sum::<f64>()
        };
        self.terms.iter().zip(start.iter().skip(i).step_by(masses)).map(part).sum()
    }

    /// Whether stage `i` is the end of the step.
    pub(super) fn ends_with(&self, i: usize) -> bool {
        i == self.tableau.last()
    }

    /// The embedded error estimate of ϑ of mass `i` at the end of the step, K.
    pub(super) fn error(&self, i: usize, stages: &[StageValues]) -> f64 {
        self.error.iter().zip(stages).map(|(weight, stage)| weight * stage.heat_flux[i]).sum()
    }
}

/// The stages up to `i` through whose fluxes the temperature there follows: the start, the earlier one that lies best
/// between, and itself.
fn nodes(tableau: &Tableau, interpolation: &Interpolation, i: usize) -> Vec<usize> {
    let off_middle = |stage: &usize| (tableau.c[*stage] - 0.5 * tableau.c[i]).abs();
    let between = (1..i).min_by(|a, b| off_middle(a).total_cmp(&off_middle(b)));
    // In steps of time-stepping the flux may jump where a mass stops: a line through it does not oscillate.
    let between = between.filter(|_| interpolation.velocities() == Velocities::Polynomial);
    [0].into_iter().chain(between).chain([i]).collect()
}

/// Writes the sums of the parts `flash` of the temperatures after a `time` (s) without friction, K.
fn decayed(terms: &[FlashTerm], time: f64, flash: &[f64], sums: &mut [f64]) {
    let parts = flash.chunks_exact(sums.len());
    weighted_sum(sums, terms.iter().map(|term| (-time / term.time).exp()).zip(parts));
}

/// Writes the parts with these weights, term by term.
fn write<'a>(
    weights: impl ExactSizeIterator<Item = TermWeights>,
    start: &'a [f64],
    fluxes: impl Iterator<Item = &'a [f64]> + Clone,
    flash: &mut [f64],
) {
    if start.is_empty() {
        return;
    }
    let masses = start.len() / weights.len();
    let parts = start.chunks_exact(masses).zip(flash.chunks_exact_mut(masses));
    for (TermWeights { decay, flux }, (start, flash)) in weights.zip(parts) {
        let driven = flux.into_iter().zip(fluxes.clone()).filter(|(weight, _)| *weight != 0.0);
        weighted_sum(flash, std::iter::once((decay, start)).chain(driven));
    }
}

/// Those of the `values` whose weight counts.
fn weighted<'a>(weights: &'a [f64], values: impl Iterator<Item = &'a [f64]>) -> impl Iterator<Item = (f64, &'a [f64])> {
    weights.iter().copied().zip(values).filter(|(weight, _)| *weight != 0.0)
}

pub(super) fn heat_flux(stage: &StageValues) -> &[f64] {
    &stage.heat_flux
}

/// The weights of the values at two or three `stages` in ∫ e^(-z(θ-s)) p(s) ds, where p is the polynomial through them in
/// time after `from`, and the integrals of its powers are `driven`.
fn through(stages: &[usize], c: &StageWeights, from: f64, driven: &[f64]) -> StageWeights {
    let mut weights = StageWeights::default();
    for &stage in stages {
        // The coefficients of Lagrange's polynomial by the powers of time.
        let others = stages.iter().filter(|&&other| other != stage).map(|&other| c[other] - from);
        let (mut powers, here) = ([1.0, 0.0, 0.0], c[stage] - from);
        for node in others {
            let scale = 1.0 / (here - node);
            let [a, b, d] = powers;
            powers = [-node * a, a - node * b, b - node * d].map(|power| power * scale);
        }
        weights[stage] = powers.iter().zip(driven).map(|(power, integral)| power * integral).sum();
    }
    weights
}

/// sums += factor · terms.
fn add(sums: &mut StageWeights, factor: f64, terms: &StageWeights) {
    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += factor * term);
}

impl StageFlash {
    pub(super) fn new(model: &Model) -> Self {
        let masses = if model.flash.is_some() { model.masses() } else { 0 };
        let per_area = if model.element_area > 0.0 { 1.0 / model.element_area } else { 0.0 };
        Self { known: vec![0.0; masses], guess: vec![0.0; masses], gain: 0.0, rise: 0.0, per_area }
    }

    /// Of mass `i`.
    #[inline]
    pub(super) fn of_mass(&self, i: usize) -> Flash {
        match (self.known.get(i), self.guess.get(i)) {
            (Some(&known), Some(&guess)) => Flash { known, gain: self.gain, guess },
            _ => Flash::default(),
        }
    }

    /// Looks for ϑ of mass `i` from `flash` (K) next time.
    #[inline]
    pub(super) fn set_guess(&mut self, i: usize, flash: f64) {
        if let Some(guess) = self.guess.get_mut(i) {
            *guess = flash;
        }
    }

    /// Whether a step's solution is the one that is continuous in its length where friction feeds itself by this part at
    /// the stage.
    pub(super) fn is_continuous(&self, feedback: f64) -> bool {
        feedback * self.rise <= MAX_FEEDBACK || self.known.is_empty()
    }

    /// Q of a contact with this friction (N) and speed of slip (m/s), W/m².
    pub(super) fn heat_flux(&self, friction: f64, speed: f64) -> f64 {
        friction * speed.abs() * self.per_area
    }
}
