//! One Jenkins element: a spring and a slider in series, along x.
//!
//! Leaps of the law and motions at constant height are those of [`spring`](super::spring), as for the elements of a
//! patch; what is here follows a carrier whose height changes.
//!
//! G = -F_x is the force in the spring, K the tangential stiffness, L = μ F_z the limit, σ the direction of slip.
//!
//! - *Stick*, |G| ≤ L: while K grows, Ġ = K u̇, as contacts that are made carry no force yet; while K falls, contacts
//!   that are lost take their share of the force along: the elongation G/K grows by u̇.
//! - *Slip*: G = σL, as long as the force of a sticking spring would exceed the limit.
//!
//! So a growing and a falling stiffness both dissipate energy: the spring stores V = G²/(2K), and ∫ G du = V + E_diss
//! with E_diss never falling. Straight motions of the carrier are followed exactly: changes between stick and slip are
//! roots, integrals are by Gauss's formula of six points over segments in which the integrand is a polynomial of degree
//! 11 at most (stick) or close to one (slip).

use super::law::{ElementContact, LawAtSpeed};
use super::spring::{Advanced, Segment, SpringLaw, advance, apply_jump, damped, damper_loss};
use crate::math::bracketed_root;
use crate::model::Mode;

/// Most changes between stick and slip in one segment: more are rounding, where both are the same.
const MAX_MODE_CHANGES: usize = 6;
/// Share of the limit that counts as the limit.
const AT_LIMIT: f64 = 1.0 - 1e-12;
/// Share of a segment to which a change is located.
const ROOT: f64 = 1e-14;

/// The rates of a straight motion, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotionRates {
    /// u̇, m/s.
    pub(super) u: f64,
    /// ȧ = -ẇ, m/s.
    pub(super) approach: f64,
}

/// Records losses and changes between stick and slip.
pub(super) trait MotionRecorder {
    /// An energy (J) was lost near an approach (m).
    fn record_loss(&mut self, approach: f64, energy: f64);
    /// The mode from `elapsed` s after the start of the motion on.
    fn record_mode(&mut self, elapsed: f64, mode: Mode);
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jenkins {
    /// The force in the spring, G = -F_x, N.
    pub(super) force: f64,
    /// K, the tangential stiffness, N/m.
    pub(super) stiffness: f64,
    /// Sticking, slipping, or free where there is no contact.
    pub(super) mode: Mode,
}

/// A phase of stick or slip while the approach changes.
struct SpringPhase<'a> {
    curve: &'a LawAtSpeed,
    rates: MotionRates,
    /// The approach where it begins, m.
    from: f64,
    /// The contact there.
    here: ElementContact,
    /// The spring there.
    start: Jenkins,
    /// Whether the stiffness grows.
    rising: bool,
}

impl ElementContact {
    fn law(&self) -> SpringLaw<f64> {
        SpringLaw { stiffness: self.stiffness.value, limit: self.limit.value }
    }
}

impl Jenkins {
    pub(super) fn new(contact: &ElementContact) -> Self {
        let stiffness = contact.stiffness.value;
        Self { force: 0.0, stiffness, mode: if stiffness > 0.0 { Mode::Stick } else { Mode::Free } }
    }

    /// V, J.
    fn energy(&self) -> f64 {
        if self.stiffness > 0.0 { self.force * self.force / (2.0 * self.stiffness) } else { 0.0 }
    }

    /// The speed has changed, and with it the law, at the same position.
    pub(super) fn set_law(&mut self, contact: &ElementContact, approach: f64, recorder: &mut impl MotionRecorder) {
        let ([force, _], lost) = apply_jump([self.force, 0.0], self.stiffness, &contact.law());
        (self.force, self.stiffness) = (force, contact.stiffness.value);
        recorder.record_loss(approach, lost);
    }

    /// The carrier moves along x alone, over `time` (s).
    pub(super) fn slide(
        &mut self,
        contact: &ElementContact,
        approach: f64,
        u_rate: f64,
        time: f64,
        recorder: &mut impl MotionRecorder,
    ) {
        if self.stiffness <= 0.0 {
            return;
        }
        let (law, start) = (contact.law(), self.force);
        let segment = Segment { begin: law, end: law, displacement: [u_rate * time, 0.0], half_turn: 0.0 };
        let Advanced { force: [force, _], slips, slip, .. } = advance([start, 0.0], &segment);
        self.force = force;
        recorder.record_loss(approach, slip);
        if slips && u_rate != 0.0 {
            self.set_mode(Mode::along(u_rate), (force - start) / (self.stiffness * u_rate), recorder);
        } else {
            self.set_mode(Mode::Stick, 0.0, recorder);
        }
    }

    /// The force on the ground (N) of the spring and of a damper beside it, τ = `damping` (s), where the carrier moves along
    /// x at `u_rate` (m/s).
    pub(super) fn damped_force(&self, contact: &ElementContact, u_rate: f64, damping: f64) -> f64 {
        if damping > 0.0 { damped([self.force, 0.0], &contact.law(), [u_rate, 0.0], damping)[0] } else { self.force }
    }

    /// What that damper takes while the carrier moves from one contact to another for `time` (s), J.
    pub(super) fn damper_loss(&self, contacts: [&ElementContact; 2], u_rate: f64, time: f64, damping: f64) -> f64 {
        let [begin, end] = contacts.map(ElementContact::law);
        let segment = Segment { begin, end, displacement: [u_rate * time, 0.0], half_turn: 0.0 };
        damper_loss([self.force, 0.0], &segment, time, damping)
    }

    fn set_mode(&mut self, mode: Mode, elapsed: f64, recorder: &mut impl MotionRecorder) {
        if mode != self.mode {
            self.mode = mode;
            recorder.record_mode(elapsed, mode);
        }
    }

    /// The carrier moves straight through a segment of the approach, `from` to `to` (m), in which the stiffness only
    /// grows or only falls; the segment begins `elapsed` s after the start of the motion.
    pub(super) fn change_approach(
        &mut self,
        curve: &LawAtSpeed,
        from: f64,
        to: f64,
        rates: MotionRates,
        elapsed: f64,
        recorder: &mut impl MotionRecorder,
    ) {
        // No contact at either end, and the stiffness only grows or only falls: none between.
        let end = curve.at(to);
        if self.stiffness <= 0.0 && end.stiffness.value <= 0.0 {
            return self.set_mode(Mode::Free, elapsed, recorder);
        }
        // Phases of stick and slip in turn, until the segment ends.
        let (mut at, mut slip) = (from, None);
        for change in 1..=MAX_MODE_CHANGES {
            let here = curve.at(at);
            let rising = end.stiffness.value >= here.stiffness.value;
            let phase = SpringPhase { curve, rates, from: at, here, start: *self, rising };
            let slips = slip.unwrap_or_else(|| phase.is_slip());
            // The last one allowed takes the rest.
            let is_last = change == MAX_MODE_CHANGES;
            let stop = if is_last {
                to
            } else if slips {
                phase.end_of_slip(to)
            } else {
                phase.end_of_stick(to)
            };
            let mode = if slips { Mode::along(phase.start.force) } else { Mode::Stick };
            self.set_mode(mode, elapsed + (at - from) / rates.approach, recorder);
            phase.advance(self, stop, mode, recorder);
            if stop == to {
                break;
            }
            (at, slip) = (stop, Some(!slips));
        }
        // The contact may end where the segment does.
        if self.stiffness <= 0.0 {
            self.set_mode(Mode::Free, elapsed + (to - from) / rates.approach, recorder);
        }
    }
}

impl SpringPhase<'_> {
    fn sign(&self) -> f64 {
        self.start.force.signum()
    }

    /// Change of u until the approach is `at`, m.
    fn change_of_u(&self, at: f64) -> f64 {
        self.rates.u * (at - self.from) / self.rates.approach
    }

    fn is_slip(&self) -> bool {
        let limit = self.here.limit.value;
        limit > 0.0 && self.start.force.abs() >= AT_LIMIT * limit && self.excess_rate(&self.here) >= 0.0
    }

    /// By how much the force of a sticking spring at its limit would grow faster than the limit, N/s.
    fn excess_rate(&self, contact: &ElementContact) -> f64 {
        let (k, l) = (contact.stiffness, contact.limit);
        let lost = if self.rising || k.value <= 0.0 { 0.0 } else { k.slope * self.rates.approach * l.value / k.value };
        self.sign() * k.value * self.rates.u + lost - l.slope * self.rates.approach
    }

    /// The approach at which slip ends, `to` at the latest, m.
    fn end_of_slip(&self, to: f64) -> f64 {
        if self.excess_rate(&self.curve.at(to)) >= 0.0 {
            return to;
        }
        if self.excess_rate(&self.here) <= 0.0 {
            return self.from;
        }
        bracketed_root(|at| self.excess_rate(&self.curve.at(at)), (self.from, to), ROOT * (to - self.from).abs())
    }

    /// The approach at which stick ends, `to` at the latest, m.
    fn end_of_stick(&self, to: f64) -> f64 {
        let excess = |at: f64| {
            let contact = self.curve.at(at);
            self.stick_force(at, &contact).abs() - contact.limit.value
        };
        // Roundings of a force that stays at its limit are no slip.
        let end = excess(to);
        if end <= (1.0 - AT_LIMIT) * self.curve.at(to).limit.value {
            return to;
        }
        let inside = |at: f64| if at == self.from { -end } else { excess(at) };
        bracketed_root(inside, (self.from, to), ROOT * (to - self.from).abs())
    }

    /// G of a sticking spring, N.
    fn stick_force(&self, at: f64, contact: &ElementContact) -> f64 {
        if self.rising {
            self.start.force + self.rates.u / self.rates.approach * self.integral(at, |_, here| here.stiffness.value)
        } else {
            contact.stiffness.value * (self.elongation() + self.change_of_u(at))
        }
    }

    /// G/K at the start, m.
    fn elongation(&self) -> f64 {
        self.start.force / self.start.stiffness
    }

    /// From the start to `at`, over the approach.
    fn integral(&self, at: f64, f: impl Fn(f64, &ElementContact) -> f64) -> f64 {
        if self.rates.u == 0.0 {
            return 0.0;
        }
        let (middle, half) = ((self.from + at) / 2.0, (at - self.from) / 2.0);
        let pair = |(x, weight): (f64, f64)| {
            let (left, right) = (middle - x * half, middle + x * half);
            weight * (f(left, &self.curve.at(left)) + f(right, &self.curve.at(right)))
        };
        half * GAUSS.into_iter().map(pair).sum::<f64>()
    }

    /// Moves on to the approach `to`, m.
    fn advance(&self, spring: &mut Jenkins, to: f64, mode: Mode, recorder: &mut impl MotionRecorder) {
        let end = self.curve.at(to);
        // How far the carrier goes along x per approach.
        let per = self.rates.u / self.rates.approach;
        let work = if mode.slips() {
            spring.force = self.sign() * end.limit.value;
            self.sign() * per * self.integral(to, |_, here| here.limit.value)
        } else {
            // A rounding above the limit at a switch.
            let (force, limit) = (self.stick_force(to, &end), end.limit.value);
            spring.force = force.clamp(-limit, limit);
            if self.rising {
                force * self.change_of_u(to)
                    - per * self.integral(to, |at, here| self.change_of_u(at) * here.stiffness.value)
            } else {
                per * self.integral(to, |at, here| here.stiffness.value * (self.elongation() + self.change_of_u(at)))
            }
        };
        spring.stiffness = end.stiffness.value;
        let loss = work - (spring.energy() - self.start.energy());
        // Of what cancels, a rounding may be left.
        recorder.record_loss((self.from + to) / 2.0, loss.max(0.0));
    }
}

/// Nodes and weights of Gauss's formula of six points on [-1, 1], in pairs.
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
];
