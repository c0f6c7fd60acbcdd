//! What is not known, in groups: each key, and each file of a covariance; and the axes that each is drawn along.

use super::section::{Spread, UncertainKey, Uncertainty};

/// A key or a file of a covariance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The path of the key, or the name of the file.
    pub name: String,
    /// Its axes; none of a surface's seed, whose effect has no direction.
    pub axes: Vec<String>,
}

/// Distance of the nodes of the process over the relaxation times, in decades: its length.
const LENGTH: f64 = 2.0;

/// What is not known of a scene, in the order of the keys; the covariance last.
pub(super) fn groups(uncertainty: &Uncertainty) -> Vec<Group> {
    let Uncertainty { keys, covariance } = uncertainty;
    let of_key = |key: &UncertainKey| Group { name: key.key.clone(), axes: axes(key) };
    let fitted = covariance.iter().map(|covariance| {
        let name = covariance.file.to_string_lossy().into_owned();
        Group { axes: (0..covariance.numbers.len()).map(|i| fitted_axis(&name, i)).collect(), name }
    });
    keys.iter().map(of_key).chain(fitted).collect()
}

fn axes(key: &UncertainKey) -> Vec<String> {
    match &key.spread {
        Spread::Number { .. } => vec![key.key.clone()],
        Spread::Prony { decades, .. } => nodes(decades).map(node_axis).collect(),
        Spread::Spectrum { decades: None, .. } => vec![Uncertainty::SPECTRUM.to_owned()],
        Spread::Spectrum { decades: Some(decades), .. } => decades.iter().map(|decade| decade_name(*decade)).collect(),
        Spread::Seed => Vec::new(),
    }
}

/// The axis of a decade of wavelengths of the spectrum.
pub fn decade_name(decade: i32) -> String {
    format!("{} 1e{decade} m", Uncertainty::SPECTRUM)
}

/// Axis `index` of a file.
pub(super) fn fitted_axis(file: &str, index: usize) -> String {
    format!("{file} {}", index + 1)
}

/// Nodes about these decades of relaxation times: even decades, the same in every scene.
fn nodes(decades: &[f64]) -> std::ops::RangeInclusive<i32> {
    let [first, last] = [f64::min, f64::max].map(|of| decades.iter().copied().reduce(of).unwrap_or_default() / LENGTH);
    first.floor() as i32 - 1..=last.ceil() as i32 + 1
}

fn node_axis(node: i32) -> String {
    format!("{} 1e{} s", Uncertainty::PRONY, LENGTH as i32 * node)
}

/// A normal process over the decades of relaxation times: standard at each, with a correlation that falls as a Gaussian
/// of the length of two decades; a moving mean of independent normal numbers at the nodes.
pub(super) fn process(decades: &[f64], normal: impl Fn(&str) -> f64) -> Vec<f64> {
    let drawn: Vec<(f64, f64)> =
        nodes(decades).map(|node| (LENGTH * f64::from(node), normal(&node_axis(node)))).collect();
    let at = |decade: &f64| {
        // exp(-(d/L)²) for correlations of exp(-(d/L)²/2).
        let weight = |node: f64| (-((decade - node) / LENGTH).powi(2)).exp();
        let (sum, squares) = drawn.iter().fold((0.0, 0.0), |(sum, squares), (node, number)| {
            let weight = weight(*node);
            (sum + weight * number, squares + weight * weight)
        });
        sum / f64::sqrt(squares)
    };
    decades.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_tests::assert_within;

    /// From the weights: one at each time, exp(-½ (d/2)²) between two; nodes two decades apart leave 2 %.
    #[test]
    fn the_process_is_as_long_as_two_decades() {
        let decades: Vec<f64> = (-24..=8).map(|i| 0.25 * f64::from(i)).collect();
        let axes: Vec<String> = nodes(&decades).map(node_axis).collect();
        let responses: Vec<Vec<f64>> =
            axes.iter().map(|axis| process(&decades, |other| if other == axis { 1.0 } else { 0.0 })).collect();
        for (i, one) in decades.iter().enumerate() {
            for (j, other) in decades.iter().enumerate() {
                let found: f64 = responses.iter().map(|response| response[i] * response[j]).sum();
                let wanted = (-0.125 * (one - other).powi(2)).exp();
                assert_within(found, wanted, if i == j { 1e-14 } else { 0.03 });
            }
        }
    }
}
