//! The columns of a table with samples: friction, hysteresis and area of scenes drawn from what is not known of one.
//!
//! Behind the columns of every table stand quantiles over the samples that have a result, and then all samples: those
//! without one are empty. Quantile p of n numbers is at place (n + 1/3) p + 1/3 of these as they rise, number 8 of R. J.
//! Hyndman and Y. Fan, The American Statistician 50 (1996) 361: nearly without bias for the median whatever the
//! distribution.

/// The samples of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleHeader {
    /// How many there are.
    pub count: usize,
    /// What scrambles their points.
    pub seed: u64,
    /// How many draws were no scene, and were drawn anew.
    pub redrawn: usize,
}

impl SampleHeader {
    /// As a table's header has it.
    pub(super) fn text(&self) -> String {
        let Self { count, seed, redrawn } = self;
        format!("{count}, seed {seed}, {redrawn} drawn anew")
    }

    pub(super) fn read(text: &str) -> Option<Self> {
        let mut parts = text.split(", ");
        let count = parts.next()?.parse().ok()?;
        let seed = parts.next()?.strip_prefix("seed ")?.parse().ok()?;
        let redrawn = parts.next()?.strip_suffix(" drawn anew")?.parse().ok()?;
        Some(Self { count, seed, redrawn })
    }
}

/// What of each sample is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampled {
    /// Friction coefficient, 1.
    Friction,
    /// Part of it that is hysteresis, 1.
    Hysteresis,
    /// Area in contact over the whole, 1.
    ContactRatio,
}

impl Sampled {
    /// All of them, in their order in a file.
    pub const ALL: [Self; 3] = [Self::Friction, Self::Hysteresis, Self::ContactRatio];

    /// As names of columns begin.
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Hysteresis => "hysteresis",
            Self::ContactRatio => "contact_ratio",
        }
    }

    /// The quantiles that a table has of it.
    pub fn quantiles(self) -> &'static [f64] {
        match self {
            Self::Friction => &[0.05, 0.25, 0.5, 0.75, 0.95],
            Self::Hysteresis | Self::ContactRatio => &[0.05, 0.5, 0.95],
        }
    }

    fn quantile_columns(self) -> impl Iterator<Item = String> {
        let of_quantile = move |p: &f64| format!("{}_q{:02} [1]", self.name(), (100.0 * p).round());
        let mean = (self == Self::Friction).then(|| "friction_mean [1]".to_owned());
        self.quantiles().iter().map(of_quantile).chain(mean)
    }

    /// The column of all samples.
    pub(super) fn column(self) -> String {
        format!("{}_samples [1]", self.name())
    }
}

/// The names of the columns.
pub(super) fn columns() -> impl Iterator<Item = String> {
    let quantiles = Sampled::ALL.into_iter().flat_map(Sampled::quantile_columns);
    std::iter::once("samples [1]".to_owned()).chain(quantiles).chain(Sampled::ALL.into_iter().map(Sampled::column))
}

/// The samples of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleValues {
    /// By what is kept and sample; `None` where the point has no such result.
    values: [Vec<Option<f64>>; Sampled::ALL.len()],
}

impl SampleValues {
    /// Those of samples, each with its values in the order of [`Sampled::ALL`].
    pub fn new(samples: &[[Option<f64>; Sampled::ALL.len()]]) -> Self {
        Self { values: [0, 1, 2].map(|at| samples.iter().map(|sample| sample[at]).collect()) }
    }

    /// The values of all samples.
    pub fn of(&self, sampled: Sampled) -> &[Option<f64>] {
        &self.values[sampled as usize]
    }

    /// How many have a result.
    pub fn results(&self) -> usize {
        self.of(Sampled::Friction).iter().flatten().count()
    }

    /// The quantile of a probability, from 0 to 1; `None` without results.
    pub fn quantile(&self, sampled: Sampled, probability: f64) -> Option<f64> {
        let mut sorted: Vec<f64> = self.of(sampled).iter().copied().flatten().collect();
        sorted.sort_by(f64::total_cmp);
        quantile(&sorted, probability)
    }

    /// The mean; `None` without results.
    pub fn mean(&self, sampled: Sampled) -> Option<f64> {
        let (sum, count) = self.of(sampled).iter().flatten().fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// The fields of a row; `number` writes one.
    pub(super) fn fields(&self, number: impl Fn(f64) -> String) -> Vec<String> {
        let text = |value: Option<f64>| value.map(&number).unwrap_or_default();
        let mut fields = vec![self.results().to_string()];
        for sampled in Sampled::ALL {
            fields.extend(sampled.quantiles().iter().map(|p| text(self.quantile(sampled, *p))));
            fields.extend((sampled == Sampled::Friction).then(|| text(self.mean(sampled))));
        }
        let all = |sampled| self.of(sampled).iter().map(|value| text(*value)).collect::<Vec<_>>().join(";");
        fields.extend(Sampled::ALL.map(all));
        fields
    }

    /// The samples of the fields of a row in the columns of all of them; `None` where these are not `count` each.
    pub(super) fn read(fields: [&str; Sampled::ALL.len()], count: usize) -> Option<Self> {
        let number = |text: &str| match text {
            "" => Some(None),
            text => text.parse().ok().filter(|number: &f64| number.is_finite()).map(Some),
        };
        let list = |field: &str| field.split(';').map(number).collect::<Option<Vec<_>>>();
        let [friction, hysteresis, contact] = fields.map(list);
        let values = [friction?, hysteresis?, contact?];
        values.iter().all(|list| list.len() == count).then_some(Self { values })
    }
}

/// The quantile of numbers that rise; `None` of none.
pub fn quantile(sorted: &[f64], probability: f64) -> Option<f64> {
    /// α = β = 1/3 of the plotting position (k - α)/(n + 1 - α - β).
    const THIRD: f64 = 1.0 / 3.0;
    let last = sorted.len().checked_sub(1)?;
    let place = ((sorted.len() as f64 + THIRD) * probability + THIRD - 1.0).clamp(0.0, last as f64);
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    let share = place - below as f64;
    Some(if share == 0.0 { sorted[below] } else { sorted[below] + share * (sorted[above] - sorted[below]) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As R's quantile(1:10, c(0.05, 0.5, 0.95), type = 8) has it.
    #[test]
    fn quantiles_are_of_type_8() {
        let numbers: Vec<f64> = (1..=10).map(f64::from).collect();
        for (p, wanted) in
            [(0.05, 1.0), (0.25, 2.916_666_666_666_667), (0.5, 5.5), (0.95, 10.0), (0.0, 1.0), (1.0, 10.0)]
        {
            let found = quantile(&numbers, p).unwrap();
            assert!((found - wanted).abs() < 1e-12, "{p}: {found}");
        }
        assert_eq!((quantile(&[], 0.5), quantile(&[3.0], 0.9)), (None, Some(3.0)));
    }

    #[test]
    fn samples_are_read_as_they_were_written() {
        let samples = [[Some(0.1 + 0.2), None, Some(1.0)], [None, None, None], [Some(0.5), None, Some(0.25)]];
        let values = SampleValues::new(&samples);
        let fields = values.fields(|number| format!("{number}"));
        assert_eq!((fields.len(), fields[0].as_str()), (columns().count(), "2"));
        let [.., friction, hysteresis, contact] = &fields[..] else { unreachable!() };
        assert_eq!((friction.as_str(), hysteresis.as_str()), ("0.30000000000000004;;0.5", ";;"));
        assert_eq!(SampleValues::read([friction, hysteresis, contact], 3), Some(values));
        assert_eq!(SampleValues::read([friction, hysteresis, contact], 4), None);
        assert_eq!(SampleValues::read(["1;x;2", ";;", ";;"], 3), None);
        let header = SampleHeader { count: 64, seed: 7, redrawn: 2 };
        assert_eq!(
            (header.text().as_str(), SampleHeader::read(&header.text())),
            ("64, seed 7, 2 drawn anew", Some(header))
        );
    }
}
