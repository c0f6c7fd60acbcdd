//! The samples of a table by their mean friction over it.

use asperity::element::{Sampled, TableRow};

/// The mean friction of each sample over the rows, a sample without a result at one counting with the median there;
/// `None` of one that has no result at all.
pub(super) fn means(rows: &[&TableRow]) -> Vec<Option<f64>> {
    let samples: Vec<_> = rows.iter().filter_map(|row| row.samples.as_ref()).filter(|all| all.results() > 0).collect();
    let count = samples.first().map_or(0, |first| first.of(Sampled::Friction).len());
    let medians: Vec<f64> = samples.iter().filter_map(|all| all.quantile(Sampled::Friction, 0.5)).collect();
    let mean = |sample: usize| {
        let own = |all: &&&asperity::element::SampleValues| all.of(Sampled::Friction)[sample].is_some();
        samples.iter().find(own)?;
        let friction =
            samples.iter().zip(&medians).map(|(all, median)| all.of(Sampled::Friction)[sample].unwrap_or(*median));
        Some(friction.sum::<f64>() / samples.len() as f64)
    };
    (0..count).map(mean).collect()
}

/// The samples, from 1, by their mean friction over the rows: the lowest first, those without a result left out.
pub(super) fn ranking(rows: &[&TableRow]) -> Vec<usize> {
    let means = means(rows);
    let mut order: Vec<(f64, usize)> = (1..).zip(means).filter_map(|(number, mean)| Some((mean?, number))).collect();
    order.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    order.into_iter().map(|(_, number)| number).collect()
}

/// Which of so many in a row is the quantile of a probability, from 0: in the middle of its part of them; `None` of none.
pub(super) fn number_at(count: usize, probability: f64) -> Option<usize> {
    let last = count.checked_sub(1)?;
    Some(((count as f64 * probability).floor().max(0.0) as usize).min(last))
}
