//! Dashpots brought at once to where a steady motion would have them.
//!
//! In steady motion ẏ = a/τ is 0 in the mean, and so is a = e - y of every Maxwell element. Elements that relax in
//! minutes take minutes to come there, which is of no use where only the steady state is asked for. Where the
//! elongation e is forced on a link, as the profile does along z, what an element misses of its steady motion dies away
//! as D e^{-t/τ}: in the mean over a time T of whole periods that is ā = D (τ/T)(1 - e^{-T/τ}), and at their end ā
//! x/(eˣ - 1) of it are left, x = T/τ. So much is taken off: all of ā for an element slower than T, nothing for a quick
//! one. Where masses come and go, e follows the dashpots a little, and a second time is needed.

use super::Simulation;
use crate::model::LinkKind;

impl Simulation {
    /// a_j = e - y_j of every Maxwell element, m, in an order of the run's own: for the means that
    /// [`relax_dashpots`](Self::relax_dashpots) takes.
    pub fn maxwell_elongations(&self) -> &[f64] {
        &self.run.state.maxwell
    }

    /// Takes off the elements of the links along z what they miss of steady motion: `means` are those of
    /// [`maxwell_elongations`](Self::maxwell_elongations) over the last `time` s, whole periods of the motion. Returns
    /// what the vertical elements bore in that mean, N: 0 in steady motion.
    ///
    /// The energies since the start no longer balance.
    pub fn relax_dashpots(&mut self, means: &[f64], time: f64) -> f64 {
        let mut borne = 0.0;
        for row in self.model.rows.iter().filter(|row| !row.kind.is_along_x()) {
            let x = time / row.relaxation_time;
            let left = if x > 0.0 { x / x.exp_m1() } else { 1.0 };
            let elements = &mut self.run.state.maxwell[row.range.clone()];
            for (a, mean) in elements.iter_mut().zip(&means[row.range.clone()]) {
                *a -= left * mean;
            }
            if row.kind == LinkKind::Vertical {
                borne += row.stiffness * means[row.range.clone()].iter().sum::<f64>();
            }
        }
        // The forces have jumped: the next motion decides all contacts anew.
        self.run.rates_hold = false;
        borne
    }
}
