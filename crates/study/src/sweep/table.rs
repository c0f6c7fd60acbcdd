//! The table of a sweep: what its header says, the row of each point with its samples, and both as files have them.

use std::path::Path;

use asperity::element::{
    FrictionTable, Load, LowEnd, OperatingPoint, PointStatus, Quantity, SWEEP, SweepGrid, rest_separation,
};
use asperity::scene::is_possible;
use asperity::table::{Cell, Column, Header, Table, TableError, number};

use crate::Error;
use crate::decimals::rounded;
use crate::files;

/// What [`Verdict`](crate::converge::Verdict) begins with where all is within the error of the study.
pub const CONVERGED: &str = "converged";

/// Whether a study of convergence found a table's numbers to depend on the spacing; `None` without a study.
pub fn is_converged(header: &Header) -> Option<bool> {
    header.text_of("convergence").map(|found| found.starts_with(CONVERGED))
}

/// What follows from all rows, and is not read.
const LOW_END: &str = "low_end";
const RANKING: &str = "ranking";
/// How gaps were found, in tables that have them.
pub(super) const GAPS: &str = "gaps";

/// What a table says before its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepHeader {
    /// All of it, as files have it.
    pub keys: Header,
    /// What the loads are.
    pub load: Load,
    /// Separation at w = 0, m.
    pub rest_separation: f64,
    /// The points that the table is to have.
    pub grid: SweepGrid,
    /// The samples; `None` without.
    pub samples: Option<SampleHeader>,
}

impl SweepHeader {
    /// That of a table which rests on what `keys` say.
    pub(super) fn new(keys: Header, load: Load, rest_separation: f64, grid: SweepGrid) -> Self {
        let area = match load {
            Load::Pressure { area } => keys.with_number("nominal_area", area, "m2"),
            Load::Force => keys,
        };
        let keys = area
            .with_number("rest_separation", rest_separation, "m")
            .with_numbers("speeds", &grid.speeds, "m/s")
            .with_numbers(&format!("{}s", load.name()), &grid.loads, load.unit());
        let has_temperatures = !grid.temperatures.is_empty();
        let keys = if has_temperatures { keys.with_numbers("temperatures", &grid.temperatures, "K") } else { keys };
        Self { keys, load, rest_separation, grid, samples: None }
    }

    /// That of a table.
    ///
    /// # Errors
    /// [`TableError`] where it is not the table of a sweep, or lacks a key.
    pub fn of_table(table: &Table) -> Result<Self, TableError> {
        let mut keys = table.header.clone();
        keys.check_kind(SWEEP)?;
        keys.needed("fingerprint")?;
        let load = Load::of_table(table)?;
        let grid = SweepGrid {
            speeds: keys.numbers("speeds", "m/s")?,
            loads: keys.numbers(&format!("{}s", load.name()), load.unit())?,
            temperatures: keys.optional("temperatures", |keys, key| keys.numbers(key, "K"))?.unwrap_or_default(),
        };
        let (rest_separation, samples) = (rest_separation(&keys)?, SampleHeader::of_table(&keys)?);
        [LOW_END, RANKING].iter().for_each(|key| keys.remove(key));
        Ok(Self { keys, load, rest_separation, grid, samples })
    }

    /// The name of the scene that was swept.
    pub fn scene(&self) -> &str {
        self.keys.text_of("scene").unwrap_or_default()
    }

    /// Whether a covariance's numbers were fitted anew in each of its samples.
    pub fn is_refitted(&self) -> bool {
        self.samples.is_some_and(|samples| samples.refit)
    }

    /// What tells this sweep from others.
    pub fn fingerprint(&self) -> &str {
        self.keys.text_of("fingerprint").unwrap_or_default()
    }

    /// A column of numbers by its name; `None` where there is none.
    pub fn column(&self, name: &str) -> Option<SweepColumn> {
        let table = self.table();
        let at = table.columns().iter().position(|column| column.name == name && !column.has_words)?;
        Some(SweepColumn { column: table.columns()[at].clone(), at, header: self.clone() })
    }

    /// The quantities of the table's columns.
    fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let has_gaps = self.keys.text_of(GAPS).is_some();
        Quantity::ALL.into_iter().filter(move |quantity| has_gaps || !quantity.is_of_gaps())
    }

    /// The table, without rows.
    pub fn table(&self) -> Table {
        let quantities = self.quantities().map(|quantity| quantity.column(self.load));
        let own = OperatingPoint::columns(self.load).into_iter().chain([PointStatus::column()]).chain(quantities);
        Table::new(
            self.keys.clone(),
            own.chain(self.samples.iter().flat_map(|samples| columns_of_samples(samples.sampled()))),
        )
    }
}

/// A column of numbers of a sweep's table.
#[derive(Clone, Debug)]
pub struct SweepColumn {
    column: Column,
    at: usize,
    header: SweepHeader,
}

impl SweepColumn {
    /// Its name and its unit, that of a number apart.
    pub fn of(&self) -> (&str, &str) {
        (&self.column.name, if self.column.unit == "1" { "" } else { &self.column.unit })
    }

    /// The value of a row; `None` where it has none.
    pub fn value(&self, row: &SweepRow) -> Option<f64> {
        row.cells(&self.header)[self.at].number().filter(|number| !number.is_nan())
    }
}

/// The row of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepRow {
    /// The point.
    pub point: OperatingPoint,
    /// Whether its values can be relied on.
    pub status: PointStatus,
    values: [Option<f64>; Quantity::ALL.len()],
    /// The samples, in a table that has them.
    pub samples: Option<SampleValues>,
}

impl SweepRow {
    /// A row without values.
    pub fn new(point: OperatingPoint, status: PointStatus) -> Self {
        Self { point, status, values: [None; Quantity::ALL.len()], samples: None }
    }

    /// A value; `None` where the point has none.
    pub fn value(&self, quantity: Quantity) -> Option<f64> {
        self.values[quantity as usize]
    }

    /// Sets a value.
    pub fn set(&mut self, quantity: Quantity, value: Option<f64>) {
        self.values[quantity as usize] = value;
    }

    /// Whether friction and area are a result.
    pub fn is_result(&self) -> bool {
        self.status.is_result()
    }

    /// Whether all values can be relied on.
    pub fn is_steady(&self) -> bool {
        self.status == PointStatus::Steady
    }

    /// Its cells in the columns of [`SweepHeader::table`].
    pub fn cells(&self, header: &SweepHeader) -> Vec<Cell> {
        let values = header.quantities().map(|quantity| Cell::from(self.value(quantity)));
        let own = self.point.cells().into_iter().chain([self.status.text().into()]).chain(values);
        own.chain(self.samples.iter().flat_map(SampleValues::cells)).collect()
    }

    /// A row of a table with this header.
    ///
    /// # Errors
    /// [`TableError`] where no sweep has written it so: of a point that the header does not have, without friction, or
    /// with another number of samples.
    pub fn of_table(table: &Table, row: usize, header: &SweepHeader) -> Result<Self, TableError> {
        let load = header.load;
        let point = OperatingPoint::of_row(table, row, load)?;
        if header.grid.index(&point).is_none() {
            return Err(table.error_in(row, "a point that the header does not have"));
        }
        let mut found = Self::new(point, PointStatus::of_row(table, row)?);
        for quantity in Quantity::ALL {
            let (name, unit) = (quantity.name(load), quantity.unit(load));
            let is_needed = found.is_result() && quantity == Quantity::Friction;
            // Tables of before lack what is known since.
            if table.has(&name, unit) || is_needed {
                let value = table.number(row, &name, unit)?;
                if value.map_or(is_needed, |value| !is_possible(value)) {
                    return Err(table.cell_error(row, &name, unit, "a number"));
                }
                found.set(quantity, value);
            }
        }
        found.samples = header.samples.map(|samples| SampleValues::of_row(table, row, samples)).transpose()?;
        Ok(found)
    }
}

/// A table of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepTable {
    /// What stands before the rows.
    pub header: SweepHeader,
    /// The rows, those of points not yet found missing.
    pub rows: Vec<SweepRow>,
}

impl SweepTable {
    /// The table of rows that were found, in the order of the points, with what follows from all of them.
    pub fn new(header: SweepHeader, rows: Vec<SweepRow>) -> Self {
        let mut table = Self { header, rows };
        let grid = &table.header.grid;
        table.rows.sort_by_key(|row| grid.index(&row.point));
        let ranking: Vec<String> = table.ranking().iter().map(usize::to_string).collect();
        let low_end = FrictionTable::new(&table.table()).ok().map(|table| low_end(&table));
        let keys = std::mem::take(&mut table.header.keys).with_some(LOW_END, low_end);
        table.header.keys = keys.with_some(RANKING, (!ranking.is_empty()).then(|| ranking.join(",")));
        table
    }

    /// Reads a table.
    ///
    /// # Errors
    /// Where the file cannot be read, or is no such table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Ok(Self::parse(&files::text(path)?, path)?)
    }

    /// The table of a `text`, which is that of the file at `path`.
    ///
    /// # Errors
    /// [`TableError`] where the text is no such table, or a row is not as a sweep writes it.
    pub fn parse(text: &str, path: &Path) -> Result<Self, TableError> {
        // A last line without an end was cut off as its writer was stopped.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let table = Table::parse(whole, path)?;
        let header = SweepHeader::of_table(&table)?;
        let rows = (0..table.len()).map(|row| SweepRow::of_table(&table, row, &header));
        Ok(Self { rows: rows.collect::<Result<_, _>>()?, header })
    }

    /// The samples, from 1, by their mean friction over the table, the lowest first; a sample without a result at a point
    /// counts there with the median. Empty while points are missing, and without samples.
    pub fn ranking(&self) -> Vec<usize> {
        if self.rows.len() == self.header.grid.count() { ranking(&self.rows) } else { Vec::new() }
    }

    /// The table as all tables are.
    pub fn table(&self) -> Table {
        let mut table = self.header.table();
        self.rows.iter().for_each(|row| table.push(row.cells(&self.header)));
        table
    }

    /// The table as files have it.
    pub fn text(&self) -> String {
        self.table().text()
    }
}

/// What lies at the low end of a table, for a contact patch lives at low pressures: how far the law reaches below the
/// least load at the least and at the largest speed, the farthest of all temperatures, and how much of a load may lie
/// there.
fn low_end(table: &FrictionTable) -> String {
    let (grid, unit) = (&table.grid, table.load.unit());
    let (slow, fast) = (grid.speeds[0], grid.speeds[grid.speeds.len() - 1]);
    let mut speeds = vec![slow, fast];
    speeds.dedup();
    let ends: Vec<LowEnd> = speeds.iter().map(|&speed| farthest(table, speed)).collect();
    let reach = |(speed, end): (&f64, &LowEnd)| format!("{} µm farther at {speed} m/s", rounded(1e6 * end.reach, 2));
    let reaches: Vec<String> = speeds.iter().zip(&ends).map(reach).collect();
    let share = ends.iter().map(|end| end.share).fold(0.0, f64::max);
    format!(
        "below {} {unit} the law is a parabola that reaches {}; of an oblique face that presses up to the table's largest {} \
         it bears {} % of the load",
        grid.loads[0],
        reaches.join(" and "),
        table.load.name(),
        rounded(100.0 * share, 2)
    )
}

/// The larger reach and share of all temperatures.
fn farthest(table: &FrictionTable, speed: f64) -> LowEnd {
    let temperatures = if table.grid.temperatures.is_empty() { &[0.0][..] } else { &table.grid.temperatures };
    let ends = temperatures.iter().map(|&temperature| table.low_end(speed, temperature));
    ends.fold(LowEnd { reach: 0.0, share: 0.0 }, |far, end| LowEnd {
        reach: far.reach.max(end.reach),
        share: far.share.max(end.share),
    })
}

/// The verdict of a study of convergence on `scene` and the point that it was found at, from the text of the study's table,
/// which is that of the file at `path`.
///
/// # Errors
/// What is wrong with the text.
pub fn verdict(text: &str, path: &Path, scene: &str) -> Result<String, Error> {
    let not_a_study =
        |problem: String| Error::in_file(path, None, format!("not a study of this scene's convergence: {problem}"));
    let header = Table::parse(text, path).map_err(|error| not_a_study(error.problem))?.header;
    let value = |key| header.text_of(key).ok_or_else(|| not_a_study(format!("expected a line `# {key} = ...`")));
    value("asperity converge")?;
    let studied = value("scene")?;
    if studied != scene {
        return Err(not_a_study(format!("it is of the scene {studied}, the sweep of {scene}")));
    }
    let verdict = header
        .text_of("verdict")
        .ok_or_else(|| not_a_study("expected a line `# verdict = ...`: the study is not finished".to_owned()))?;
    // The studies of a layer and of the surface solved for are of different errors.
    let by = header.text_of("method").map_or_else(String::new, |method| format!(", by {method}"));
    Ok(format!("{verdict} (at {}, {}{by})", value("pressure")?, value("speed")?))
}

/// The samples of a table: friction, hysteresis and area of scenes drawn from what is not known of one.
///
/// Behind the columns of every table stand quantiles over the samples that have a result, and then all samples: those
/// without one are empty. Quantile p of n numbers is at place (n + 1/3) p + 1/3 of these as they rise, number 8 of R. J.
/// Hyndman and Y. Fan, The American Statistician 50 (1996) 361: nearly without bias for the median whatever the
/// distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleHeader {
    /// How many there are.
    pub count: usize,
    /// What scrambles their points.
    pub seed: u64,
    /// How many draws were no scene, and were drawn anew.
    pub redrawn: usize,
    /// Whether a covariance's numbers were fitted anew in each.
    pub refit: bool,
    /// Whether they have leak gaps.
    pub has_gaps: bool,
}

/// The key of that.
const REFIT: &str = "refit";

impl SampleHeader {
    /// What of each sample is kept, in the order of a file.
    pub fn sampled(self) -> &'static [Sampled] {
        if self.has_gaps { &Sampled::ALL } else { &Sampled::ALL[..Sampled::LeakGap as usize] }
    }

    /// Gives them to a table that is begun.
    pub(super) fn set_in(self, header: &mut SweepHeader) {
        header.samples = Some(self);
        let numbers = [("samples", self.count as u64), ("seed", self.seed), ("redrawn", self.redrawn as u64)];
        numbers.into_iter().for_each(|(key, number)| header.keys.set(key, &number.to_string()));
        if self.refit {
            header.keys.set(REFIT, "true");
        }
    }

    /// The keys without those of samples.
    pub(super) fn removed_from(keys: &Header) -> Header {
        let mut keys = keys.clone();
        ["samples", "seed", "redrawn", REFIT].iter().for_each(|key| keys.remove(key));
        keys
    }

    /// Those of a header; `None` where it names none.
    pub(super) fn of_table(keys: &Header) -> Result<Option<Self>, TableError> {
        let count = keys.optional("samples", Header::whole)?.map(|count| count as usize);
        let of = |count| {
            let (seed, redrawn) = (keys.whole("seed")?, keys.whole("redrawn")? as usize);
            Ok(Self { count, seed, redrawn, refit: keys.has(REFIT), has_gaps: keys.has(GAPS) })
        };
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
    /// The leak gap, m, of a table with gaps.
    LeakGap,
}

impl Sampled {
    /// All of them, in their order in a file.
    pub const ALL: [Self; 4] = [Self::Friction, Self::Hysteresis, Self::ContactRatio, Self::LeakGap];

    /// What of a row it is.
    pub(super) fn quantity(self) -> Quantity {
        match self {
            Self::Friction => Quantity::Friction,
            Self::Hysteresis => Quantity::Hysteresis,
            Self::ContactRatio => Quantity::ContactRatio,
            Self::LeakGap => Quantity::LeakGap,
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        if self == Self::LeakGap { "m" } else { "1" }
    }

    /// As names of columns begin.
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Hysteresis => "hysteresis",
            Self::ContactRatio => "contact_ratio",
            Self::LeakGap => "leak_gap",
        }
    }

    /// The quantiles that a table has of it.
    pub fn quantiles(self) -> &'static [f64] {
        match self {
            Self::Friction => &[0.05, 0.25, 0.5, 0.75, 0.95],
            Self::Hysteresis | Self::ContactRatio | Self::LeakGap => &[0.05, 0.5, 0.95],
        }
    }

    fn quantile_columns(self) -> impl Iterator<Item = Column> {
        let of_quantile = move |p: &f64| format!("{}_q{:02}", self.name(), (100.0 * p).round());
        let mean = (self == Self::Friction).then(|| "friction_mean".to_owned());
        self.quantiles().iter().map(of_quantile).chain(mean).map(move |name| Column::numbers(name, self.unit()))
    }

    /// The column of all samples.
    fn column(self) -> Column {
        Column::words(format!("{}_samples", self.name()), self.unit())
    }
}

/// The columns of what is kept of samples.
pub(super) fn columns_of_samples(sampled: &'static [Sampled]) -> impl Iterator<Item = Column> {
    let quantiles = sampled.iter().copied().flat_map(Sampled::quantile_columns);
    let all = sampled.iter().copied().map(Sampled::column);
    std::iter::once(Column::numbers("samples", "1")).chain(quantiles).chain(all)
}

/// The samples of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleValues {
    /// By what is kept, in the order of [`Sampled::ALL`], and sample; `None` where the point has no such result.
    values: Vec<Vec<Option<f64>>>,
}

impl SampleValues {
    /// Those of samples, each with what is kept of it.
    pub fn new(samples: &[Vec<Option<f64>>], sampled: &[Sampled]) -> Self {
        let values = |at: usize| samples.iter().map(|sample| sample[at]).collect();
        Self { values: (0..sampled.len()).map(values).collect() }
    }

    /// What is kept.
    fn sampled(&self) -> impl Iterator<Item = Sampled> {
        Sampled::ALL.into_iter().take(self.values.len())
    }

    /// The values of all samples; empty where that is not kept.
    pub fn of(&self, sampled: Sampled) -> &[Option<f64>] {
        self.values.get(sampled as usize).map_or(&[], Vec::as_slice)
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
        for sampled in self.sampled() {
            cells.extend(sampled.quantiles().iter().map(|p| Cell::from(self.quantile(sampled, *p))));
            cells.extend((sampled == Sampled::Friction).then(|| Cell::from(self.mean(sampled))));
        }
        let all = |sampled| {
            let texts: Vec<String> =
                self.of(sampled).iter().map(|value| value.map(number).unwrap_or_default()).collect();
            Cell::Word(texts.join(";"))
        };
        cells.extend(self.sampled().map(all));
        cells
    }

    /// The samples of a row.
    pub(super) fn of_row(table: &Table, row: usize, samples: SampleHeader) -> Result<Self, TableError> {
        let count = samples.count;
        let number = |text: &str| match text {
            "" => Some(None),
            text => text.parse().ok().filter(|number: &f64| number.is_finite()).map(Some),
        };
        let list = |sampled: &Sampled| {
            let column = sampled.column();
            let text = table.word(row, &column.name, &column.unit)?;
            let found: Option<Vec<_>> = text.split(';').map(number).collect();
            let expected = format!("{count} numbers in each column of all samples");
            let refused = || table.cell_error(row, &column.name, &column.unit, &expected);
            found.filter(|found| found.len() == count).ok_or_else(refused)
        };
        Ok(Self { values: samples.sampled().iter().map(list).collect::<Result<_, _>>()? })
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

    const STUDY: &str = "# asperity converge = 3\n# scene = block\n# pressure = 100000 Pa\n# speed = 0.1 m/s\n\
                         # verdict = converged: spacing leaves most open\nmasses\n";

    fn verdict_of(text: &str, scene: &str) -> Result<String, String> {
        verdict(text, "study.csv".as_ref(), scene).map_err(|error| error.to_string())
    }

    #[test]
    fn a_verdict_says_where_it_was_found() {
        let found = verdict_of(STUDY, "block");
        assert_eq!(found, Ok("converged: spacing leaves most open (at 100000 Pa, 0.1 m/s)".to_owned()));
        let found = verdict_of(&STUDY.replace("# speed", "# method = layer: as asked for\n# speed"), "block");
        assert!(found.is_ok_and(|verdict| verdict.ends_with("0.1 m/s, by layer: as asked for)")));
        assert!(verdict_of(STUDY, "seal").is_err_and(|problem| problem.contains("of the scene block")));
        let unfinished = STUDY.replace("# verdict", "# other");
        assert!(verdict_of(&unfinished, "block").is_err_and(|problem| problem.contains("not finished")));
        assert!(verdict_of("speed,friction\n", "block").is_err());
    }

    /// What is written is read back as the same, whatever the loads are; one of before, without a column, too.
    #[test]
    fn tables_are_read_as_they_were_written() {
        for (load, temperatures) in [(Load::Force, vec![]), (Load::Pressure { area: 2e-5 }, vec![273.15, 293.15])] {
            let grid = SweepGrid { speeds: vec![1e-5, 0.1 + 0.2], loads: vec![2e5, 1e30], temperatures };
            let keys = Header::new(SWEEP).with("scene", "a = b, c").with("fingerprint", "00ff");
            let keys = keys.with_some(GAPS, (load == Load::Force).then_some("solved"));
            let mut header = SweepHeader::new(keys, load, -1.5e-5, grid);
            let samples = SampleHeader { count: 2, seed: 1, redrawn: 0, refit: true, has_gaps: false };
            if load != Load::Force {
                samples.set_in(&mut header);
            }
            let row = |(i, point): (usize, OperatingPoint)| {
                let mut row = SweepRow::new(point, PointStatus::new((i > 0).then_some("not steady, \"by far\"")));
                let values = header.quantities().zip(1..).filter(|(_, number)| number % 3 != 0);
                values.for_each(|(quantity, number)| row.set(quantity, Some(f64::from(number) / 7.0)));
                row.samples = header.samples.map(|samples| {
                    SampleValues::new(&[vec![Some(0.3), None, Some(0.1)], vec![None; 3]], samples.sampled())
                });
                row
            };
            let table = SweepTable { rows: header.grid.points().enumerate().map(row).collect(), header };
            let read = SweepTable::parse(&table.text(), "t.csv".as_ref()).unwrap();
            assert_eq!(read, table);
            let concluded = SweepTable::new(table.header.clone(), table.rows.clone());
            assert_eq!(concluded.header.keys.has(RANKING), load != Load::Force);
            assert_eq!(SweepTable::parse(&concluded.text(), "t.csv".as_ref()).unwrap(), table);
        }
    }

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
        let samples = [
            vec![Some(0.1 + 0.2), None, Some(1.0), Some(1e-6)],
            vec![None; 4],
            vec![Some(0.5), None, Some(0.25), Some(0.0)],
        ];
        for has_gaps in [false, true] {
            let header = SampleHeader { count: 3, seed: 1, redrawn: 0, refit: false, has_gaps };
            let values = SampleValues::new(&samples, header.sampled());
            let mut table = Table::new(Header::default(), columns_of_samples(header.sampled()));
            table.push(values.cells());
            let end = if has_gaps { "1;;0.25,1e-6;;0\n" } else { ",0.30000000000000004;;0.5,;;,1;;0.25\n" };
            assert!(table.text().ends_with(end), "{}", table.text());
            assert_eq!(SampleValues::of_row(&table, 0, header), Ok(values));
            assert!(SampleValues::of_row(&table, 0, SampleHeader { count: 4, ..header }).is_err());
        }
    }
}
