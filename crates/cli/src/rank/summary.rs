//! What a ranking says.

use std::path::PathBuf;

use asperity_study::decimals::{rounded, short};
use asperity_study::rank::{Band, Mean, MeasuredRanking, RankPlan, RankedScene, Ranking, SURE};

use crate::files::{name_of, named};
use crate::terminal::{LabelledLine, labelled, lines};

/// Most pairs that are printed.
const MOST_PAIRS: usize = 15;

/// The summary.
pub(super) fn text(
    plan: &RankPlan,
    ranking: &Ranking,
    measured: Option<&MeasuredRanking>,
    files: &[&PathBuf],
) -> String {
    let named_files = plan.labels().into_iter().zip(plan.files());
    let scenes = named_files.map(|(label, file)| format!("{label} ({})", name_of(file)));
    let mut rows = vec![
        ("Scenes", scenes.collect::<Vec<_>>().join(", ")),
        ("Points", points(ranking)),
        ("Samples", samples(plan, ranking)),
    ];
    rows.extend(ranked(ranking));
    rows.extend(labelled("Pairs", pairs(ranking)));
    rows.push(("Told apart", told_apart(ranking)));
    rows.extend(measured.map(measured_lines).unwrap_or_default());
    rows.push(("Written", files.iter().map(|path| named(path)).collect::<Vec<_>>().join(", ")));
    lines(&rows)
}

fn points(ranking: &Ranking) -> String {
    let count = ranking.points.len();
    let first = ranking.points.first().map_or(0.0, |point| point.weight);
    let even =
        if ranking.points.iter().all(|point| point.weight == first) { "all of the same weight" } else { "weighted" };
    let mean = match ranking.mean {
        Mean::Arithmetic => "",
        Mean::Harmonic => "; ranked by the harmonic mean of friction, 1 over the mean of 1/μ",
    };
    format!("{count}, {even}{mean}")
}

fn samples(plan: &RankPlan, ranking: &Ranking) -> String {
    if !plan.has_samples() {
        return "none, for no scene says in [uncertainty] what is not known of it: no bands, no probabilities"
            .to_owned();
    }
    let mut text = format!("{} with common numbers", ranking.samples);
    if ranking.failed > 0 {
        text += &format!(", and {} without a result that are left out", ranking.failed);
    }
    if ranking.redrawn > 0 {
        text += &format!("; {} draws were no scene and were drawn anew", ranking.redrawn);
    }
    let known = plan.known();
    if !known.is_empty() {
        text += &format!("; taken as known, without [uncertainty]: {}", known.join(", "));
    }
    text
}

/// A table of the scenes in their order.
fn ranked(ranking: &Ranking) -> Vec<LabelledLine> {
    let width = ranking.scenes.iter().map(|scene| scene.label.chars().count()).max().unwrap_or(0).max(8) + 2;
    let has_bands = ranking.samples > 0;
    let row = |label: &str, cells: &[String]| {
        let cells: String = cells.iter().map(|cell| format!("{cell:<10}")).collect();
        format!("{label:<width$}{cells}").trim_end().to_owned()
    };
    let head = ["index", "5 %", "25 %", "50 %", "75 %", "95 %", "friction", "largest"].map(str::to_owned);
    let cells = |scene: &RankedScene| {
        let number = |value: f64| format!("{value:.1}");
        let band = |band: Band| band.map(number).to_vec();
        let mut cells = vec![number(scene.index)];
        cells.extend(scene.index_band.map(band).unwrap_or_default());
        cells.push(rounded(scene.friction, 4).to_string());
        cells.extend(has_bands.then(|| short(scene.largest, 3)));
        cells
    };
    let head = if has_bands { row("", &head) } else { row("", &[head[0].clone(), head[6].clone()]) };
    let rows = ranking.order.iter().map(|&i| row(&ranking.scenes[i].label, &cells(&ranking.scenes[i])));
    labelled("Ranking", std::iter::once(head).chain(rows))
}

fn pairs(ranking: &Ranking) -> Vec<String> {
    let label = |scene: usize| ranking.scenes[scene].label.as_str();
    let ties = |ties: f64| match ties {
        0.0 => String::new(),
        ties => format!(" (equal in {} of the samples, which counts by half)", short(ties, 3)),
    };
    // Whatever is above first.
    let pair = |pair: &asperity_study::rank::Pair| {
        let [one, other] = pair.scenes;
        let (one, other, above) =
            if pair.above < 0.5 { (other, one, 1.0 - pair.above) } else { (one, other, pair.above) };
        format!("{} above {} with {}{}", label(one), label(other), short(above, 3), ties(pair.ties))
    };
    let more = ranking.pairs.len().saturating_sub(MOST_PAIRS);
    let more = (more > 0).then(|| format!("and {more} more"));
    ranking.pairs.iter().take(MOST_PAIRS).map(pair).chain(more).collect()
}

fn told_apart(ranking: &Ranking) -> String {
    let Some(([first, second], above)) = ranking.first_two() else {
        return "not known, without samples".to_owned();
    };
    let word = if ranking.is_sure() { "yes" } else { "no" };
    let sign = if ranking.is_sure() { "at least" } else { "less than" };
    format!("{word}: {} is above {} with {}, {sign} {SURE}", first.label, second.label, short(above, 3))
}

fn measured_lines(measured: &MeasuredRanking) -> Vec<LabelledLine> {
    let row = |scene: &asperity_study::rank::MeasuredScene| {
        format!("{}: {} measured, {} found", scene.label, rounded(scene.measured, 4), rounded(scene.computed, 4))
    };
    let tau = measured.tau.map_or_else(
        || "Kendall's rank correlation is not defined: all are equal".to_owned(),
        |tau| format!("Kendall's rank correlation (tau-b) {}", short(tau, 3)),
    );
    let means = format!("means over the {} points at which all of these were measured", measured.points);
    labelled("Measured", measured.scenes.iter().map(row).chain([means, tau]))
}
