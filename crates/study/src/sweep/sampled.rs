//! The columns of a table with samples: friction, hysteresis and area of scenes drawn from what is not known of one.
//!
//! Behind the columns of every table stand quantiles over the samples that have a result, and then all samples: those
//! without one are empty. Quantile p of n numbers is at place (n + 1/3) p + 1/3 of these as they rise, number 8 of R. J.
//! Hyndman and Y. Fan, The American Statistician 50 (1996) 361: nearly without bias for the median whatever the
//! distribution.

use asperity::table::{Cell, Column, Header, Table, TableError, number};

use super::table::{SweepHeader, SweepRow};

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
    /// Gives them to a table that is begun.
    pub(super) fn set_in(self, header: &mut SweepHeader) {
        header.samples = Some(self);
        let numbers = [("samples", self.count as u64), ("seed", self.seed), ("redrawn", self.redrawn as u64)];
        numbers.into_iter().for_each(|(key, number)| header.keys.set(key, &number.to_string()));
    }

    /// The keys without those of samples.
    pub(super) fn removed_from(keys: &Header) -> Header {
        let mut keys = keys.clone();
        ["samples", "seed", "redrawn"].iter().for_each(|key| keys.remove(key));
        keys
    }

    /// Those of a header; `None` where it names none.
    pub(super) fn of_table(keys: &Header) -> Result<Option<Self>, TableError> {
        let count = keys.optional("samples", Header::whole)?.map(|count| count as usize);
        let of = |count| Ok(Self { count, seed: keys.whole("seed")?, redrawn: keys.whole("redrawn")? as usize });
        count.map(of).transpose()
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
        let of_quantile = move |p: &f64| format!("{}_q{:02}", self.name(), (100.0 * p).round());
        let mean = (self == Self::Friction).then(|| "friction_mean".to_owned());
        self.quantiles().iter().map(of_quantile).chain(mean)
    }

    /// The column of all samples.
    fn column(self) -> Column {
        Column::words(format!("{}_samples", self.name()), "1")
    }
}

/// The columns.
pub(super) fn columns_of_samples() -> impl Iterator<Item = Column> {
    let quantiles = Sampled::ALL.into_iter().flat_map(Sampled::quantile_columns);
    let numbers = std::iter::once("samples".to_owned()).chain(quantiles);
    numbers.map(|name| Column::numbers(name, "1")).chain(Sampled::ALL.into_iter().map(Sampled::column))
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

    /// The cells of a row.
    pub(super) fn cells(&self) -> Vec<Cell> {
        let mut cells = vec![Cell::from(self.results() as f64)];
        for sampled in Sampled::ALL {
            cells.extend(sampled.quantiles().iter().map(|p| Cell::from(self.quantile(sampled, *p))));
            cells.extend((sampled == Sampled::Friction).then(|| Cell::from(self.mean(sampled))));
        }
        let all = |sampled| {
            let texts: Vec<String> =
                self.of(sampled).iter().map(|value| value.map(number).unwrap_or_default()).collect();
            Cell::Word(texts.join(";"))
        };
        cells.extend(Sampled::ALL.map(all));
        cells
    }

    /// The `count` samples of a row.
    pub(super) fn of_row(table: &Table, row: usize, count: usize) -> Result<Self, TableError> {
        let number = |text: &str| match text {
            "" => Some(None),
            text => text.parse().ok().filter(|number: &f64| number.is_finite()).map(Some),
        };
        let list = |sampled: Sampled| {
            let column = sampled.column();
            let text = table.word(row, &column.name, &column.unit)?;
            let found: Option<Vec<_>> = text.split(';').map(number).collect();
            let expected = format!("{count} numbers in each column of all samples");
            let refused = || table.cell_error(row, &column.name, &column.unit, &expected);
            found.filter(|found| found.len() == count).ok_or_else(refused)
        };
        let [friction, hysteresis, contact] = Sampled::ALL.map(list);
        Ok(Self { values: [friction?, hysteresis?, contact?] })
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

/// The mean friction of each sample over the rows, a sample without a result at one counting with the median there;
/// `None` of one that has no result at all.
pub(super) fn means(rows: &[SweepRow]) -> Vec<Option<f64>> {
    let samples: Vec<_> = rows.iter().filter_map(|row| row.samples.as_ref()).filter(|all| all.results() > 0).collect();
    let count = samples.first().map_or(0, |first| first.of(Sampled::Friction).len());
    let medians: Vec<f64> = samples.iter().filter_map(|all| all.quantile(Sampled::Friction, 0.5)).collect();
    let mean = |sample: usize| {
        let own = |all: &&&SampleValues| all.of(Sampled::Friction)[sample].is_some();
        samples.iter().find(own)?;
        let friction =
            samples.iter().zip(&medians).map(|(all, median)| all.of(Sampled::Friction)[sample].unwrap_or(*median));
        Some(friction.sum::<f64>() / samples.len() as f64)
    };
    (0..count).map(mean).collect()
}

/// The samples, from 1, by their mean friction over the rows: the lowest first, those without a result left out.
pub(super) fn ranking(rows: &[SweepRow]) -> Vec<usize> {
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
        let mut table = Table::new(Header::default(), columns_of_samples());
        table.push(values.cells());
        assert!(table.text().ends_with(",0.30000000000000004;;0.5,;;,1;;0.25\n"), "{}", table.text());
        assert_eq!(SampleValues::of_row(&table, 0, 3), Ok(values));
        assert!(SampleValues::of_row(&table, 0, 4).is_err());
    }
}
