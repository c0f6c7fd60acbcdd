//! Which runs are to be made: halvings of the spacing until nothing changes any more, then twice the length, another
//! split into profile and finer waves, and other seeds at that spacing.
//!
//! What the runs leave open, and the coarsest spacing that will do.

use super::variants::Variant;
use crate::decimals::{decimal, rounded};
use crate::sweep::{CONVERGED, SMALL_FRICTION};

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

/// A value of each of the two quantities that are to converge, or a share of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Friction coefficient, 1.
    pub friction: f64,
    /// Area in contact over the whole, 1.
    pub area: f64,
}

impl Pair {
    /// The change from `before` to this one, over this one. A friction coefficient that is small counts as
    /// [`SMALL_FRICTION`], as in the standard error of a run.
    pub fn change_from(&self, before: &Self) -> Self {
        (*self - *before).over(self)
    }

    fn over(&self, scale: &Self) -> Self {
        let share = |part: f64, whole: f64| if part == 0.0 { 0.0 } else { part / whole };
        Self {
            friction: share(self.friction, scale.friction.abs().max(SMALL_FRICTION)),
            area: share(self.area, scale.area),
        }
    }

    fn abs(&self) -> Self {
        Self { friction: self.friction.abs(), area: self.area.abs() }
    }

    /// Whether both are within `error` of 0.
    pub fn is_within(&self, error: f64) -> bool {
        self.friction.abs() <= error && self.area.abs() <= error
    }

    /// Friction coefficient and area, each with its name.
    pub fn named(&self) -> [(&'static str, f64); 2] {
        [("friction", self.friction), ("area", self.area)]
    }
}

impl std::ops::Sub for Pair {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { friction: self.friction - other.friction, area: self.area - other.area }
    }
}

/// What the runs came to, those that did not become steady being `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The scene, then with half the spacing, a quarter, …, all steady.
    pub ladder: Vec<Pair>,
    /// The finest of these with twice the length; `None` where there is no more of the surface.
    pub length: Option<Option<Pair>>,
    /// The finest of these with the profile down to half the wavelength at which the waves that it lacks begin; `None`
    /// where that cannot move.
    pub split: Option<Option<Pair>>,
    /// The finest of these with other seeds; `None` where the scene has no seed.
    pub seeds: Option<Vec<Option<Pair>>>,
}

/// Why area and friction may be off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The spacing of the masses or of the points.
    Spacing,
    /// The length of the layer or of the surface.
    Length,
    /// Where the profile ends and the waves that it lacks begin.
    Split,
    /// The seed.
    Chance,
}

impl Source {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spacing => "spacing",
            Self::Length => "length",
            Self::Split => "split",
            Self::Chance => "chance",
        }
    }
}

/// What a source leaves open, as shares of friction and area; `None`: not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Open {
    /// The source.
    pub source: Source,
    /// The shares.
    pub shares: Option<Pair>,
}

/// What is left open, and what will do.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What each source leaves open.
    pub open: Vec<Open>,
    /// How often the spacing of the scene is halved for friction to be within the error, and for area; `None`: more
    /// often than was tried.
    pub coarsest: [Option<usize>; 2],
    error: f64,
}

/// The largest share that is left open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestOpen {
    /// The source.
    pub source: Source,
    /// The quantity and its share; `None`: not known.
    pub share: Option<(&'static str, f64)>,
}

impl Verdict {
    /// On what each source may leave open, `error`.
    pub fn new(study: &Study, error: f64) -> Self {
        let mut open = vec![Open { source: Source::Spacing, shares: last_change(&study.ladder) }];
        if let Some(length) = study.length {
            open.push(Open { source: Source::Length, shares: length_shares(study.ladder.last(), length) });
        }
        if let Some(split) = study.split {
            open.push(Open { source: Source::Split, shares: split_shares(study.ladder.last(), split) });
        }
        if let Some(seeds) = &study.seeds {
            open.push(Open { source: Source::Chance, shares: chance(study.ladder.last(), seeds) });
        }
        let coarsest = [|pair: &Pair| pair.friction, |pair: &Pair| pair.area];
        Self { open, coarsest: coarsest.map(|value| coarsest_within(&study.ladder, error, value)), error }
    }

    /// Whether all that is left open is known and within the error.
    pub fn is_converged(&self) -> bool {
        self.open.iter().all(|open| open.shares.is_some_and(|shares| shares.is_within(self.error)))
    }

    /// The source that leaves most open; one that is not known before all others.
    pub fn largest(&self) -> Option<LargestOpen> {
        let of = |open: &Open| {
            let share = open.shares.map(|shares| {
                let [friction, area] = shares.named();
                if friction.1 > area.1 { friction } else { area }
            });
            LargestOpen { source: open.source, share }
        };
        let size = |largest: &LargestOpen| largest.share.map_or(f64::INFINITY, |(_, share)| share);
        self.open.iter().map(of).max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// The verdict in a sentence.
    pub fn sentence(&self) -> String {
        let start = if self.is_converged() { CONVERGED } else { "not converged" };
        match self.largest() {
            Some(LargestOpen { source, share: Some((quantity, share)) }) => {
                let against = if share <= self.error { "within" } else { "more than" };
                let (name, share, error) = (source.name(), percent(share), percent(self.error));
                format!("{start}: {name} leaves most open, {share} of the {quantity}, {against} {error}")
            }
            Some(LargestOpen { source, share: None }) => {
                format!("{start}: what {} leaves open is not known", source.name())
            }
            None => start.to_owned(),
        }
    }
}

/// A share in percent, in two digits.
pub fn percent(share: f64) -> String {
    format!("{} %", decimal(rounded(100.0 * share, 2), 1e-3..1e6))
}

fn last_change(ladder: &[Pair]) -> Option<Pair> {
    let [.., before, last] = ladder else { return None };
    Some(last.change_from(before).abs())
}

fn length_shares(own: Option<&Pair>, doubled: Option<Pair>) -> Option<Pair> {
    Some(doubled?.change_from(own?).abs())
}

/// The change of friction alone: of the area in contact with the profile's waves finer ones take their part.
fn split_shares(own: Option<&Pair>, split: Option<Pair>) -> Option<Pair> {
    let change = split?.change_from(own?).abs();
    Some(Pair { area: 0.0, ..change })
}

/// The standard deviation over the seeds, the scene's own included, over the mean.
fn chance(own: Option<&Pair>, others: &[Option<Pair>]) -> Option<Pair> {
    let all: Vec<Pair> = std::iter::once(own.copied()).chain(others.iter().copied()).collect::<Option<_>>()?;
    let count = all.len() as f64;
    let of = |value: fn(&Pair) -> f64| {
        let mean = all.iter().map(value).sum::<f64>() / count;
        let variance = all.iter().map(|pair| (value(pair) - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, variance.sqrt())
    };
    let (friction, area) = (of(|pair| pair.friction), of(|pair| pair.area));
    let mean = Pair { friction: friction.0, area: area.0 };
    Some(Pair { friction: friction.1, area: area.1 }.over(&mean))
}

/// The first run of the ladder from which on all are within `error` of the limit. That is as far beyond the finest run
/// as this one is from the one before: the area is of first order in the spacing.
fn coarsest_within(ladder: &[Pair], error: f64, value: fn(&Pair) -> f64) -> Option<usize> {
    let (last, left) = (ladder.last()?, value(&last_change(ladder)?));
    let is_off = |pair: &Pair| value(&(last.change_from(pair).abs())) + left > error;
    match ladder.iter().rposition(is_off) {
        None => Some(0),
        Some(off) => Some(off + 1).filter(|&coarsest| coarsest < ladder.len()),
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

    fn pairs(values: &[(f64, f64)]) -> Vec<Pair> {
        values.iter().map(|&(friction, area)| Pair { friction, area }).collect()
    }

    fn study(ladder: &[(f64, f64)], length: (f64, f64)) -> Study {
        Study { ladder: pairs(ladder), length: Some(pairs(&[length]).pop()), split: None, seeds: None }
    }

    /// An area of first order, 0.1 (1 + 0.4 2^-i): the changes are half of what was left before, and as much is left.
    const LADDER: [(f64, f64); 5] = [(0.5, 0.14), (0.5, 0.12), (0.5, 0.11), (0.5, 0.105), (0.5, 0.1025)];

    #[test]
    fn what_is_left_of_an_area_of_first_order_is_its_last_change() {
        let verdict = Verdict::new(&study(&LADDER, LADDER[4]), 0.05);
        let left = verdict.open[0].shares.unwrap();
        assert!((left.area - 0.0025 / 0.1025).abs() < 1e-12 && left.friction == 0.0);
        assert!(verdict.is_converged());
        // 0.105 is 5 % off the limit of 0.1, and 0.11 is 10 %: with shares of 0.1025 the first is just within.
        assert_eq!(verdict.coarsest, [Some(0), Some(3)]);
        assert_eq!(Verdict::new(&study(&LADDER, LADDER[4]), 0.1).coarsest, [Some(0), Some(2)]);
        assert_eq!(Verdict::new(&study(&LADDER, LADDER[4]), 0.024).coarsest, [Some(0), None]);
    }

    /// A value that is right by chance at a coarse spacing, and wrong again at a finer one, will not do.
    #[test]
    fn the_coarsest_spacing_is_followed_by_good_ones_alone() {
        let ladder = [(0.3, 0.1), (0.4, 0.1), (0.3, 0.1), (0.3, 0.1)];
        assert_eq!(Verdict::new(&study(&ladder, ladder[3]), 0.05).coarsest, [Some(2), Some(0)]);
    }

    #[test]
    fn the_largest_share_is_named_with_its_source() {
        let verdict = Verdict::new(&study(&[(0.5, 0.1), (0.5, 0.101)], (0.4, 0.101)), 0.05);
        assert!(!verdict.is_converged());
        let largest = verdict.largest().unwrap();
        assert_eq!(largest.source, Source::Length);
        let (name, share) = largest.share.unwrap();
        assert!(name == "friction" && (share - 0.25).abs() < 1e-12, "{largest:?}");
    }

    #[test]
    fn chance_is_the_standard_deviation_over_all_seeds() {
        let others = pairs(&[(0.4, 0.1), (0.6, 0.1)]).into_iter().map(Some).collect::<Vec<_>>();
        let steady = Study { seeds: Some(others.clone()), ..study(&[(0.5, 0.1), (0.5, 0.1)], (0.5, 0.1)) };
        let verdict = Verdict::new(&steady, 0.25);
        let shares = verdict.open[2].shares.unwrap();
        // Of 0.4, 0.5 and 0.6: 0.1 over 0.5.
        assert!((shares.friction - 0.2).abs() < 1e-12 && shares.area < 1e-12, "{shares:?}");
        assert!(verdict.is_converged() && verdict.largest().unwrap().source == Source::Chance);
        assert!(!Verdict::new(&steady, 0.15).is_converged());
    }

    /// The area of the profile alone falls as it gets finer waves; friction has to stay.
    #[test]
    fn the_split_is_judged_by_friction() {
        let of = |friction: f64| Some(pairs(&[(friction, 0.07)]).pop());
        let steady = Study { split: of(0.48), ..study(&[(0.5, 0.1), (0.5, 0.1)], (0.5, 0.1)) };
        assert!(Verdict::new(&steady, 0.05).is_converged());
        let verdict = Verdict::new(&Study { split: of(0.4), ..steady.clone() }, 0.05);
        assert!(!verdict.is_converged() && verdict.largest().unwrap().source == Source::Split);
        assert!(!Verdict::new(&Study { split: Some(None), ..steady }, 0.05).is_converged());
    }

    #[test]
    fn what_is_not_known_is_not_converged() {
        let one = study(&[(0.5, 0.1)], (0.5, 0.1));
        let verdict = Verdict::new(&one, 0.5);
        assert!(!verdict.is_converged());
        assert_eq!(verdict.largest(), Some(LargestOpen { source: Source::Spacing, share: None }));
        assert_eq!(verdict.coarsest, [None, None]);
        let seeds = Some(vec![None]);
        let verdict = Verdict::new(&Study { seeds, ..study(&[(0.5, 0.1), (0.5, 0.1)], (0.5, 0.1)) }, 0.5);
        assert!(!verdict.is_converged());
        assert_eq!(verdict.largest(), Some(LargestOpen { source: Source::Chance, share: None }));
    }

    /// Shares of a friction coefficient near 0 are those of a small one: its sign is scatter.
    #[test]
    fn small_friction_is_judged_by_a_small_coefficient() {
        let [before, after] = pairs(&[(1e-4, 0.1), (-1e-4, 0.1)])[..] else { unreachable!() };
        let change = after.change_from(&before);
        assert!((change.friction + 0.02).abs() < 1e-12 && change.area == 0.0, "{change:?}");
    }

    #[test]
    fn the_verdict_names_what_leaves_most_open() {
        let pair = |friction: f64, area: f64| Pair { friction, area };
        let ladder = vec![pair(0.5, 0.102), pair(0.5, 0.1)];
        let study = Study { ladder, length: Some(Some(pair(0.5, 0.1))), split: None, seeds: None };
        assert_eq!(
            Verdict::new(&study, 0.05).sentence(),
            "converged: spacing leaves most open, 2 % of the area, within 5 %"
        );
        assert_eq!(
            Verdict::new(&study, 0.01).sentence(),
            "not converged: spacing leaves most open, 2 % of the area, more than 1 %"
        );
        let study = Study { length: Some(None), ..study };
        assert_eq!(Verdict::new(&study, 0.05).sentence(), "not converged: what length leaves open is not known");
    }
}
