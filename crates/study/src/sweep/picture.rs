//! The pictures of a table: friction over speed with its parts in panels of their own below, its master curve, friction
//! over the way, and what matters for it.

use asperity::element::{OperatingPoint, Quantity};
use asperity::scene::Wlf;

use super::{Matters, Sampled, SweepColumn, SweepRow, SweepTable, is_converged};
use crate::decimals::{as_given, temperature_as_given};
use crate::picture::{Axis, Colour, Fill, Fit, Mark, Panel, Picture, Point, Stroke, Tick};
use crate::uncertainty::Index;

/// Friction over speed: a panel for each temperature, a colour for each load; with one load, one panel and a colour for
/// each temperature.
pub fn sweep_picture(table: &SweepTable) -> Picture {
    picture(table, ("speed", "m/s"), &panels(table), |point| point.speed)
}

/// A column of the table over speed, in the panels of [`sweep_picture`].
pub fn column_picture(table: &SweepTable, column: &SweepColumn) -> Picture {
    let hollow = Hollow::of(table);
    let marks = |(look, Group { name, rows }): (usize, &Group<'_>)| {
        let points = |is_drawn: fn(&SweepRow) -> bool| -> Vec<Point> {
            let drawn = rows.iter().filter(|row| is_drawn(row));
            drawn.filter_map(|row| Some([row.point.speed, column.value(row)?])).collect()
        };
        let (steady, other) = (points(SweepRow::is_result), points(|row| !row.is_result()));
        let line = Mark::line(name, look, steady.clone());
        let (full, hollow_points) = match hollow {
            Hollow::NotSteady => (steady, other),
            Hollow::NotConverged => (Vec::new(), [steady, other].concat()),
        };
        let symbols = Mark::symbols(name, look, full, Fill::Full);
        let all = [line, symbols, Mark::symbols(hollow.name(), look, hollow_points, Fill::Hollow)];
        all.into_iter().filter(|mark| mark.points().next().is_some())
    };
    let panel = |(title, groups): GroupedPanel<'_>| (title, groups.iter().enumerate().flat_map(marks).collect());
    let panels = panels(table).into_iter().map(panel).collect();
    Picture::side_by_side(("speed", "m/s"), vec![(column.of(), panels)]).titled(table.header.scene())
}

/// Friction over the speed at the reference temperature of the compound's shift, a_T v: a panel for each load, a colour for
/// each temperature. Where friction follows the compound's times alone, temperatures lie on one curve.
pub fn master_picture(table: &SweepTable, wlf: &Wlf) -> Picture {
    let title = format!("a_T v in m/s, at {}", temperature_as_given(wlf.reference_temperature));
    let shift = |temperature: f64| Wlf { temperature, ..*wlf }.shift_factor();
    let shifted = |point: &OperatingPoint| point.temperature.map_or(1.0, shift) * point.speed;
    picture(table, (&title, ""), &panels_of_loads(table), shifted)
}

/// Friction over the way, of a table for each of `ways` (m): a panel for each load and temperature, a colour for each
/// speed.
pub fn over_ways(ways: &[f64], tables: &[SweepTable]) -> Picture {
    let Some(first) = tables.first() else { return Picture::default() };
    let grid = &first.header.grid;
    let panel = |at: OperatingPoint| {
        let curve = |(look, &speed): (usize, &f64)| {
            let of = |row: &&SweepRow| row.point == OperatingPoint { speed, ..at } && row.is_result();
            let friction = |table: &SweepTable| table.rows.iter().find(of)?.value(Quantity::Friction);
            let points = ways.iter().zip(tables).filter_map(|(&way, table)| Some([way, friction(table)?]));
            Mark::marked(&format!("{speed} m/s"), look, points.collect())
        };
        let title = at.describe(first.header.load);
        let title = title.split_once(", ").map(|(_, rest)| rest.to_owned()).unwrap_or_default();
        (title, grid.speeds.iter().enumerate().flat_map(curve).collect())
    };
    let panels = grid.points().step_by(grid.speeds.len()).map(panel).collect();
    Picture::side_by_side(("way", "m"), vec![(("friction coefficient", ""), panels)]).titled(first.header.scene())
}

/// Bars of what matters in the mean over all points.
pub fn matters_picture(table: &SweepTable, matters: &Matters) -> Picture {
    let rest = matters.mean.iter().map(|mean| (matters.rest, Index { share: mean.rest, error: 0.0 }));
    let bars: Vec<(&str, Index)> = matters.largest().into_iter().chain(rest).collect();
    let end = |share: f64| share.clamp(0.0, 1.0);
    let places = || bars.iter().zip(0..).map(|((_, index), row)| (-f64::from(row), *index));
    let boxes = places().map(|(at, index)| [0.0, at - 0.27, end(index.share), at + 0.27]);
    let error = |(at, index): (f64, Index)| {
        let ends = [-1.0, 1.0].map(|sign| [end(index.share + sign * index.error), at]);
        (index.error > 0.0).then(|| Mark::line("", 0, ends.to_vec()).coloured(Colour::INK))
    };
    let mut marks = vec![Mark::boxes("", 0, boxes.collect()).coloured(Colour([64, 149, 197]))];
    marks.extend(places().filter_map(error));
    let number = |(at, Index { share, error }): (f64, Index)| {
        let error = if error > 0.0 { format!(" ± {:.0}", 100.0 * error) } else { String::new() };
        Tick { at, name: format!("{:.0}{error} %", 100.0 * share) }
    };
    let shares = [0.0, 0.25, 0.5, 0.75, 1.0].map(|at| Tick { at, name: format!("{:.0} %", 100.0 * at) });
    let x = Axis { named: shares.into(), ..Axis::linear(("", ""), [0.0, 1.0], Fit::Tight) };
    let y = Axis::names(bars.iter().map(|(name, _)| (*name).to_owned()));
    let height = 30.0 * bars.len().max(1) as f64;
    let panel = Panel { beside: places().map(number).collect(), ..Panel::new(x, y, marks) }.sized(420.0, height);
    Picture::of(vec![panel.into()]).titled(format!("{}: part of the variance of mean friction", table.header.scene()))
}

/// The rows of one curve, and the curve's name.
#[derive(Debug)]
struct Group<'a> {
    name: String,
    rows: Vec<&'a SweepRow>,
}

/// The title of a panel, and what has a colour in it.
type GroupedPanel<'a> = (String, Vec<Group<'a>>);

fn panels(table: &SweepTable) -> Vec<GroupedPanel<'_>> {
    if table.header.grid.loads.len() == 1 { panels_of_loads(table) } else { panels_of_temperatures(table) }
}

fn panels_of_loads(table: &SweepTable) -> Vec<GroupedPanel<'_>> {
    let panel = |&load: &f64| {
        let name = load_name(table, load);
        let group = |&kelvin: &Option<f64>| Group {
            name: temperature_name(kelvin).unwrap_or_else(|| name.clone()),
            rows: rows(table, load, kelvin),
        };
        let groups = temperatures(table).iter().map(group).collect();
        (if table.header.grid.temperatures.is_empty() { String::new() } else { name.clone() }, groups)
    };
    table.header.grid.loads.iter().map(panel).collect()
}

fn panels_of_temperatures(table: &SweepTable) -> Vec<GroupedPanel<'_>> {
    let panel = |kelvin: Option<f64>| {
        let group = |&load: &f64| Group { name: load_name(table, load), rows: rows(table, load, kelvin) };
        (temperature_name(kelvin).unwrap_or_default(), table.header.grid.loads.iter().map(group).collect())
    };
    temperatures(table).into_iter().map(panel).collect()
}

fn temperatures(table: &SweepTable) -> Vec<Option<f64>> {
    match table.header.grid.temperatures.as_slice() {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    }
}

fn temperature_name(kelvin: Option<f64>) -> Option<String> {
    kelvin.map(temperature_as_given)
}

fn load_name(table: &SweepTable, load: f64) -> String {
    as_given(load, table.header.load.unit())
}

fn rows(table: &SweepTable, load: f64, temperature: Option<f64>) -> Vec<&SweepRow> {
    table.rows.iter().filter(|row| row.point.load == load && row.point.temperature == temperature).collect()
}

/// The friction coefficient and, below it, each part of it that is there and not all of it.
fn picture(
    table: &SweepTable,
    x_of: (&str, &str),
    panels: &[GroupedPanel<'_>],
    x: impl Fn(&OperatingPoint) -> f64,
) -> Picture {
    let points = Points { x: &x, hollow: Hollow::of(table) };
    let row = |quantity: Quantity, part: Option<(&str, Quantity)>| {
        panels.iter().map(|panel| (panel.0.clone(), points.marks(&panel.1, quantity, part))).collect::<Vec<_>>()
    };
    let fine =
        is_there(table, Quantity::FineHysteresis).then_some(("of it below the profile", Quantity::FineHysteresis));
    let mut rows = vec![(("friction coefficient", ""), row(Quantity::Friction, None))];
    let has_parts = is_there(table, Quantity::Adhesion);
    if has_parts || fine.is_some() {
        rows.push((("hysteresis", ""), row(Quantity::Hysteresis, fine)));
    }
    if has_parts {
        rows.push((("adhesion", ""), row(Quantity::Adhesion, None)));
    }
    Picture::side_by_side(x_of, rows).titled(table.header.scene())
}

/// The name of what the scene's own numbers give, beside the median of samples.
const OWN: &str = "the scene's own numbers";

/// What of the samples stands for a quantity.
fn sampled(quantity: Quantity) -> Option<Sampled> {
    match quantity {
        Quantity::Friction => Some(Sampled::Friction),
        Quantity::Hysteresis => Some(Sampled::Hysteresis),
        _ => None,
    }
}

/// Whether a part of the friction is not 0 everywhere.
fn is_there(table: &SweepTable, part: Quantity) -> bool {
    table.rows.iter().any(|row| row.value(part).is_some_and(|value| value != 0.0))
}

/// Which points cannot be relied on, in a word: they are hollow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hollow {
    NotSteady,
    /// All points, since the study of the table's scene found them to depend on the spacing.
    NotConverged,
}

impl Hollow {
    fn of(table: &SweepTable) -> Self {
        if is_converged(&table.header.keys) == Some(false) { Self::NotConverged } else { Self::NotSteady }
    }

    fn name(self) -> &'static str {
        match self {
            Self::NotSteady => "not steady: see the table's status",
            Self::NotConverged => "not converged or not steady: see the table",
        }
    }
}

/// What of rows is drawn.
#[derive(Clone, Copy, Debug)]
struct Points<X> {
    /// The value of the horizontal axis at a point.
    x: X,
    hollow: Hollow,
}

impl<X: Fn(&OperatingPoint) -> f64> Points<X> {
    /// The curves of a quantity, and dashed those of a part of it.
    fn marks(&self, groups: &[Group<'_>], quantity: Quantity, part: Option<(&str, Quantity)>) -> Vec<Mark> {
        let bands = groups.iter().enumerate().flat_map(|(look, Group { rows, .. })| self.bands(quantity, rows, look));
        let curves = groups.iter().enumerate().flat_map(|(look, group)| self.curves(group, look, quantity, part));
        bands.chain(curves).collect()
    }

    fn curves(
        &self,
        Group { name, rows }: &Group<'_>,
        look: usize,
        quantity: Quantity,
        part: Option<(&str, Quantity)>,
    ) -> Vec<Mark> {
        let median = self.median(quantity, rows);
        let has_median = !median.is_empty();
        let mut marks = if has_median { Mark::marked(name, look, median).to_vec() } else { Vec::new() };
        let steady = self.points(quantity, rows, SweepRow::is_result);
        if rows.iter().any(|row| row.samples.is_some()) {
            marks.push(Mark::broken(OWN, look, steady, Stroke::Dashed));
        } else {
            let symbols = steady.iter().copied().filter(|_| self.hollow == Hollow::NotSteady).collect();
            marks.push(Mark::line(name, look, steady));
            marks.push(Mark::symbols(name, look, symbols, Fill::Full));
        }
        if let Some((name, part)) = part {
            let stroke = if has_median { Stroke::Dotted } else { Stroke::Dashed };
            marks.push(Mark::broken(name, look, self.points(part, rows, SweepRow::is_result), stroke));
        }
        let hollow = match self.hollow {
            Hollow::NotSteady => self.points(quantity, rows, |row| !row.is_result()),
            Hollow::NotConverged => self.points(quantity, rows, |_| true),
        };
        marks.push(Mark::symbols(self.hollow.name(), look, hollow, Fill::Hollow));
        marks.retain(|mark| mark.points().next().is_some());
        marks
    }

    /// The bands of the samples in which 90 and 50 % of them lie; none of a table without.
    fn bands(&self, quantity: Quantity, rows: &[&SweepRow], look: usize) -> Vec<Mark> {
        let Some(sampled) = sampled(quantity) else { return Vec::new() };
        let band = |(name, low, opacity): (&str, f64, f64)| {
            let mut outline = self.quantile(sampled, low, rows);
            outline.extend(self.quantile(sampled, 1.0 - low, rows).into_iter().rev());
            (outline.len() > 2).then(|| Mark::area(name, look, outline, opacity))
        };
        let bands = [("90 % of the samples", 0.05, 0.13), ("50 % of the samples", 0.25, 0.25)];
        bands.into_iter().filter_map(band).collect()
    }

    /// The median of the samples; nothing of a table without.
    fn median(&self, quantity: Quantity, rows: &[&SweepRow]) -> Vec<Point> {
        sampled(quantity).map(|sampled| self.quantile(sampled, 0.5, rows)).unwrap_or_default()
    }

    fn quantile(&self, sampled: Sampled, probability: f64, rows: &[&SweepRow]) -> Vec<Point> {
        let of = |row: &&SweepRow| row.samples.as_ref()?.quantile(sampled, probability);
        rows.iter().filter_map(|row| Some([(self.x)(&row.point), of(row)?])).collect()
    }

    fn points(&self, quantity: Quantity, rows: &[&SweepRow], is_drawn: impl Fn(&SweepRow) -> bool) -> Vec<Point> {
        let drawn = rows.iter().filter(|row| is_drawn(row));
        drawn.filter_map(|row| Some([(self.x)(&row.point), row.value(quantity)?])).collect()
    }
}

#[cfg(test)]
mod tests {
    use asperity::element::{Load, PointStatus, SweepGrid};
    use asperity::table::Header;

    use super::*;
    use crate::picture::Shape;
    use crate::sweep::SweepHeader;

    /// Friction 1 + v, of which `adhesion`, at two speeds and temperatures, the last point not steady.
    fn table(adhesion: f64, convergence: Option<&str>) -> SweepTable {
        let grid = SweepGrid { speeds: vec![0.1, 1.0], loads: vec![1e5], temperatures: vec![293.15, 313.15] };
        let row = |(i, point): (usize, OperatingPoint)| {
            let mut row = SweepRow::new(point, PointStatus::new((i == 3).then_some("stick-slip")));
            row.set(Quantity::Friction, Some(1.0 + point.speed));
            row.set(Quantity::Hysteresis, Some(1.0 + point.speed - adhesion));
            row.set(Quantity::Adhesion, Some(adhesion));
            row
        };
        let rows = grid.points().enumerate().map(row).collect::<Vec<_>>();
        let header = SweepHeader {
            keys: Header::default().with("scene", "block").with_some("convergence", convergence),
            load: Load::Pressure { area: 1.0 },
            rest_separation: 0.0,
            grid,
            samples: None,
        };
        SweepTable::new(header, rows)
    }

    /// Of each panel's marks whether they are lines, or how their symbols are filled, with how many points.
    fn looks(picture: &Picture, row: usize) -> Vec<(Option<Fill>, usize)> {
        let look = |mark: &Mark| match &mark.shape {
            Shape::Points { fill, .. } => (Some(*fill), mark.points().count()),
            _ => (None, mark.points().count()),
        };
        picture.rows[row].panels[0].marks.iter().map(look).collect()
    }

    #[test]
    fn points_that_are_not_steady_are_hollow_and_off_the_line() {
        let picture = sweep_picture(&table(0.0, None));
        assert_eq!((picture.title.as_str(), picture.rows.len()), ("block", 1), "hysteresis alone has no panel");
        let (full, hollow) = (Some(Fill::Full), Some(Fill::Hollow));
        let expected = [(None, 2), (full, 2), (None, 1), (full, 1), (hollow, 1)];
        assert_eq!(looks(&picture, 0), expected);
        assert_eq!(looks(&sweep_picture(&table(0.0, Some("converged: spacing"))), 0), expected);
        let open = sweep_picture(&table(0.0, Some("not converged: spacing")));
        assert_eq!(looks(&open, 0), [(None, 2), (hollow, 2), (None, 1), (hollow, 2)]);
    }

    #[test]
    fn parts_have_panels_of_their_own() {
        let picture = sweep_picture(&table(0.25, None));
        let titles: Vec<&str> = picture.rows.iter().map(|row| row.panels[0].y.quantity.as_str()).collect();
        assert_eq!(titles, ["friction coefficient", "hysteresis", "adhesion"]);
        assert_eq!(picture.rows[2].panels[0].marks[0].points().collect::<Vec<_>>(), [[0.1, 0.25], [1.0, 0.25]]);
    }
}
