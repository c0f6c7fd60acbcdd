//! What of what is not known matters for friction, at each point and in the mean over all.

use asperity::element::{Load, OperatingPoint};

use crate::csv;
use crate::uncertainty::{Index, Indices};

/// What explains the variance of friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Matters {
    /// The names of the keys and of the file of the covariance.
    pub groups: Vec<String>,
    /// What is left, in words.
    pub rest: &'static str,
    /// At the points where there are indices.
    pub points: Vec<Matter>,
    /// Of the mean friction over all points; `None` where there are too few samples.
    pub mean: Option<Indices>,
}

/// What explains the variance of friction at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Matter {
    /// The point.
    pub point: OperatingPoint,
    /// What each group explains.
    pub indices: Indices,
}

impl Matters {
    /// What no group explains; a surface's seed has no direction, so that none can be told for it.
    pub(super) fn rest(has_seed: bool) -> &'static str {
        if has_seed { "not additive, not monotone or the surface's seed" } else { "not additive or not monotone" }
    }

    /// What explains the variance of the mean over all points, the largest first.
    pub fn largest(&self) -> Vec<(&str, Index)> {
        let of_mean = self.mean.iter().flat_map(|indices| self.groups.iter().zip(&indices.groups));
        let mut all: Vec<(&str, Index)> = of_mean.map(|(name, index)| (name.as_str(), *index)).collect();
        all.sort_by(|(_, one), (_, other)| other.share.total_cmp(&one.share));
        all
    }

    /// As a table of text: a row for each point and group, those of the mean over all points first, without a point.
    pub fn text(&self, load: Load) -> String {
        let of_load = format!("{} [{}]", load.name(), load.unit());
        let head = ["speed [m/s]", &of_load, "temperature [K]", "key", "share [1]", "standard_error [1]"];
        let text = |value: Option<f64>| value.map(|value| format!("{value:?}")).unwrap_or_default();
        let mean = self.mean.iter().map(|indices| (None, indices));
        let points = self.points.iter().map(|matter| (Some(matter.point), &matter.indices));
        let rows = mean.chain(points).flat_map(|(point, indices)| {
            let place = [
                text(point.map(|point| point.speed)),
                text(point.map(|point| point.load)),
                text(point.and_then(|point| point.temperature)),
            ];
            let own = self
                .groups
                .iter()
                .zip(&indices.groups)
                .map(|(name, index)| (name.as_str(), index.share, Some(index.error)));
            let all: Vec<_> = own.chain([(self.rest, indices.rest, None)]).collect();
            all.into_iter().map(move |(name, share, error)| {
                place.iter().cloned().chain([name.to_owned(), text(Some(share)), text(error)]).collect()
            })
        });
        csv::text(head, rows)
    }
}
