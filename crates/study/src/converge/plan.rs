//! Which runs are to be made: halvings of the spacing until nothing changes any more, then twice the length, another
//! split into profile and finer waves, and other seeds at that spacing.

use super::variants::Variant;
use super::verdict::{Pair, Study};

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    /// Change of friction and of area from one halving to the next that is small enough.
    pub(super) error: f64,
    /// Most halvings, at least one.
    pub(super) max_halvings: u32,
    /// Whether there is more of the surface, or the layer slides over more of it, with twice the length.
    pub(super) has_length: bool,
    /// Number of seeds, the scene's own included; `None` where it has none.
    pub(super) seeds: Option<u32>,
    /// Whether the profile may end elsewhere, and the waves that it lacks begin there.
    pub(super) has_split: bool,
}

/// A run's values; `None`: it did not become steady.
pub(super) type Outcome = Option<Pair>;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Next {
    /// Runs that depend on none of each other.
    Runs(Vec<Variant>),
    Done(Study),
}

impl Plan {
    /// What comes next, by the outcomes of the runs so far; `None` of a run that is still to be made.
    pub(super) fn next(&self, outcome: impl Fn(Variant) -> Option<Outcome>) -> Next {
        let missing = |variants: Vec<Variant>| -> Vec<Variant> {
            variants.into_iter().filter(|&variant| outcome(variant).is_none()).collect()
        };
        // There is no verdict without these two.
        let first = missing(vec![Variant::halved(0), Variant::halved(1)]);
        if !first.is_empty() {
            return Next::Runs(first);
        }
        let (ladder, end) = self.ladder(&outcome);
        if !end && outcome(Variant::halved(ladder.len() as u32)).is_none() {
            return Next::Runs(vec![Variant::halved(ladder.len() as u32)]);
        }
        let Some(finest) = ladder.len().checked_sub(1) else {
            let [length, split] = [self.has_length, self.has_split].map(|has| has.then_some(None));
            return Next::Done(Study { ladder, length, split, seeds: self.seeds.map(|_| vec![None]) });
        };
        let others = self.others(finest as u32);
        let left = missing(others.clone());
        if !left.is_empty() {
            return Next::Runs(left);
        }
        let mut outcomes = others.into_iter().filter_map(outcome);
        let [length, split] = [self.has_length, self.has_split].map(|has| has.then(|| outcomes.next().flatten()));
        Next::Done(Study { ladder, length, split, seeds: self.seeds.map(|_| outcomes.collect()) })
    }

    /// The steady runs from the scene's spacing on, and whether no finer one is to be made.
    fn ladder(&self, outcome: impl Fn(Variant) -> Option<Outcome>) -> (Vec<Pair>, bool) {
        let mut ladder: Vec<Pair> = Vec::new();
        while let Some(Some(pair)) = outcome(Variant::halved(ladder.len() as u32)) {
            let settled = ladder.last().is_some_and(|before| pair.change_from(before).is_within(self.error));
            ladder.push(pair);
            if settled || ladder.len() as u32 > self.max_halvings {
                return (ladder, true);
            }
        }
        let unsteady = outcome(Variant::halved(ladder.len() as u32)).is_some();
        (ladder, unsteady)
    }

    /// Twice the length, then the other split and the other seeds.
    fn others(&self, halvings: u32) -> Vec<Variant> {
        let finest = Variant::halved(halvings);
        let seeds = (1..self.seeds.unwrap_or(1)).map(|seed_shift| Variant { seed_shift, ..finest });
        let doubled = self.has_length.then_some(Variant { doubled: true, ..finest });
        let split = self.has_split.then_some(Variant { split: true, ..finest });
        doubled.into_iter().chain(split).chain(seeds).collect()
    }

    /// Number of runs that follow these at least.
    pub(super) fn following(&self, runs: &[Variant]) -> usize {
        let is_of_ladder = runs.iter().any(|run| run.is_of_ladder());
        if is_of_ladder { self.others(0).len() } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All runs in their order, with the outcomes that `law` gives, and the study.
    fn made(plan: Plan, law: impl Fn(Variant) -> Outcome) -> (Vec<Vec<Variant>>, Study) {
        let (mut made, mut rounds) = (Vec::new(), Vec::new());
        for _ in 0..20 {
            let outcome = |variant| made.contains(&variant).then(|| law(variant));
            match plan.next(outcome) {
                Next::Done(study) => return (rounds, study),
                Next::Runs(runs) => {
                    made.extend(runs.iter().copied());
                    rounds.push(runs);
                }
            }
        }
        unreachable!("the plan has an end")
    }

    const PLAN: Plan = Plan { error: 0.05, max_halvings: 6, has_length: true, seeds: Some(3), has_split: false };

    /// 0.1 (1 + 0.4 2^-i): the fourth halving changes by less than 5 %.
    fn first_order(variant: Variant) -> Outcome {
        Some(Pair { friction: 0.5, area: 0.1 * (1.0 + 0.4 * 0.5_f64.powi(variant.halvings as i32)) })
    }

    #[test]
    fn the_spacing_is_halved_until_little_changes_then_length_and_seeds_follow() {
        let (rounds, study) = made(PLAN, first_order);
        let doubled = Variant { doubled: true, ..Variant::halved(3) };
        let seeds = [1, 2].map(|seed_shift| Variant { seed_shift, ..Variant::halved(3) });
        assert_eq!(rounds[0], [Variant::halved(0), Variant::halved(1)]);
        assert_eq!(rounds[1..3], [vec![Variant::halved(2)], vec![Variant::halved(3)]]);
        assert_eq!(rounds[3..], [vec![doubled, seeds[0], seeds[1]]]);
        assert_eq!((study.ladder.len(), study.seeds.map(|seeds| seeds.len())), (4, Some(2)));
    }

    #[test]
    fn the_other_split_is_run_at_the_finest_spacing() {
        let (rounds, study) = made(Plan { has_split: true, ..PLAN }, first_order);
        assert_eq!(rounds[3][1], Variant { split: true, ..Variant::halved(3) });
        assert!(study.split.is_some_and(|split| split.is_some()));
        assert_eq!(study.seeds.map(|seeds| seeds.len()), Some(2));
    }

    /// Of a file that is one period there is no more, and nothing follows where there is no seed either.
    #[test]
    fn a_surface_of_which_there_is_no_more_is_not_doubled() {
        let (rounds, study) = made(Plan { has_length: false, seeds: None, ..PLAN }, first_order);
        assert_eq!((rounds.len(), study.ladder.len(), study.length), (3, 4, None));
        let (rounds, study) = made(Plan { has_length: false, ..PLAN }, first_order);
        assert_eq!((rounds[3].len(), study.seeds.map(|seeds| seeds.len())), (2, Some(2)));
    }

    #[test]
    fn max_masses_end_the_halvings() {
        let (rounds, study) = made(Plan { max_halvings: 1, seeds: None, ..PLAN }, first_order);
        assert_eq!(
            rounds,
            [vec![Variant::halved(0), Variant::halved(1)], vec![Variant { doubled: true, ..Variant::halved(1) }]]
        );
        assert_eq!((study.ladder.len(), study.seeds), (2, None));
    }

    #[test]
    fn a_run_that_is_not_steady_ends_the_halvings() {
        let unsteady_from =
            |first: u32| move |variant: Variant| first_order(variant).filter(|_| variant.halvings < first);
        let (rounds, study) = made(PLAN, unsteady_from(2));
        assert_eq!((rounds.len(), study.ladder.len()), (3, 2));
        assert!(study.length.is_some_and(|length| length.is_some()));
        let (rounds, study) = made(PLAN, unsteady_from(0));
        assert_eq!((rounds.len(), study.ladder.len(), study.length), (1, 0, Some(None)));
    }

    #[test]
    fn runs_that_are_there_are_not_made_again() {
        let there = [Variant::halved(0), Variant::halved(2), Variant { doubled: true, ..Variant::halved(3) }];
        let outcome = |variant| there.contains(&variant).then(|| first_order(variant));
        assert_eq!(PLAN.next(outcome), Next::Runs(vec![Variant::halved(1)]));
    }
}
