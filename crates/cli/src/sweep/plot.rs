//! The plots of a table: friction over speed with its parts in panels of their own below, and its master curve.

use std::path::Path;

use asperity::element::{OperatingPoint, Quantity};
use asperity::scene::Wlf;

use crate::figure::{Curve, Figure as _, Panel, PanelRow, SideBySide, Stroke};
use crate::files::FileError;
use asperity_study::decimals::as_given;
use asperity_study::sweep::{Sampled, SweepRow, SweepTable, is_converged};

/// Draws friction over speed at `path`: a panel for each temperature, a colour for each load; with one load, one panel
/// and a colour for each temperature.
pub(super) fn draw(path: &Path, table: &SweepTable) -> Result<(), FileError> {
    let panels = match table.header.grid.loads[..] {
        [_] => panels_of_loads(table),
        _ => panels_of_temperatures(table),
    };
    plot(table, "speed in m/s".into(), panels, |point| point.speed).write(path)
}

/// Draws friction over the speed at the reference temperature of the compound's shift, a_T v: a panel for each load, a
/// colour for each temperature. Where friction follows the compound's times alone, temperatures lie on one curve.
pub(super) fn draw_master(path: &Path, table: &SweepTable, wlf: &Wlf) -> Result<(), FileError> {
    let x_title = format!("a_T v in m/s, at {} K", wlf.reference_temperature);
    let shift = |temperature: f64| Wlf { temperature, ..*wlf }.shift_factor();
    let shifted = |point: &OperatingPoint| point.temperature.map_or(1.0, shift) * point.speed;
    plot(table, x_title, panels_of_loads(table), shifted).write(path)
}

/// The rows of one curve, and the curve's name.
#[derive(Debug)]
struct Group<'a> {
    name: String,
    rows: Vec<&'a SweepRow>,
}

/// The title of a panel, and what has a colour in it.
type GroupedPanel<'a> = (String, Vec<Group<'a>>);

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
    kelvin.map(|kelvin| format!("{kelvin} K"))
}

fn load_name(table: &SweepTable, load: f64) -> String {
    as_given(load, table.header.load.unit())
}

fn rows(table: &SweepTable, load: f64, temperature: Option<f64>) -> Vec<&SweepRow> {
    table.rows.iter().filter(|row| row.point.load == load && row.point.temperature == temperature).collect()
}

/// The friction coefficient and, below it, each part of it that is there and not all of it.
fn plot(
    table: &SweepTable,
    x_title: String,
    panels: Vec<GroupedPanel<'_>>,
    x: impl Fn(&OperatingPoint) -> f64,
) -> SideBySide {
    let points = Points { x: &x, hollow: Hollow::of(table) };
    let row = |y_title: &str, quantity: Quantity, part: Option<(&str, Quantity)>| PanelRow {
        y_title: y_title.into(),
        panels: panels.iter().map(|panel| points.panel(panel, quantity, part)).collect(),
    };
    let fine =
        is_there(table, Quantity::FineHysteresis).then_some(("of it below the profile", Quantity::FineHysteresis));
    let mut rows = vec![row("friction coefficient", Quantity::Friction, None)];
    let has_parts = is_there(table, Quantity::Adhesion);
    if has_parts || fine.is_some() {
        rows.push(row("hysteresis", Quantity::Hysteresis, fine));
    }
    if has_parts {
        rows.push(row("adhesion", Quantity::Adhesion, None));
    }
    SideBySide { title: table.header.scene().to_owned(), x_title, rows }
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

#[derive(Clone, Copy, Debug)]
struct Points<X> {
    /// The value of the horizontal axis at a point.
    x: X,
    hollow: Hollow,
}

impl<X: Fn(&OperatingPoint) -> f64> Points<X> {
    /// The curves of a quantity, and dashed those of a part of it.
    fn panel(&self, (title, groups): &GroupedPanel<'_>, quantity: Quantity, part: Option<(&str, Quantity)>) -> Panel {
        let bands = groups.iter().enumerate().flat_map(|(look, Group { rows, .. })| self.bands(quantity, rows, look));
        let curves = groups.iter().enumerate().flat_map(|(look, Group { name, rows })| {
            let median = self.median(quantity, rows, (name, look));
            let steady = self.points(quantity, rows, SweepRow::is_result);
            let (stroke, hollow) = match self.hollow {
                Hollow::NotSteady => (Stroke::Marked, self.points(quantity, rows, |row| !row.is_result())),
                Hollow::NotConverged => (Stroke::Line, self.points(quantity, rows, |_| true)),
            };
            let (name, stroke) = match rows.iter().any(|row| row.samples.is_some()) {
                true => (OWN.to_owned(), Stroke::Dashed),
                false => (name.clone(), stroke),
            };
            let whole = Curve { name, look, stroke, points: steady };
            let part = part.map(|(name, part)| {
                let points = self.points(part, rows, SweepRow::is_result);
                let stroke = if median.is_some() { Stroke::Dotted } else { Stroke::Dashed };
                Curve { name: name.into(), look, stroke, points }
            });
            let hollow = (!hollow.is_empty()).then(|| Curve {
                name: self.hollow.name().into(),
                look,
                stroke: Stroke::Hollow,
                points: hollow,
            });
            median.into_iter().chain([whole]).chain(part).chain(hollow)
        });
        Panel { title: title.clone(), curves: bands.chain(curves).collect() }
    }

    /// The bands of the samples in which 90 and 50 % of them lie; none of a table without.
    fn bands(&self, quantity: Quantity, rows: &[&SweepRow], look: usize) -> Vec<Curve> {
        let Some(sampled) = sampled(quantity) else { return Vec::new() };
        let bands =
            [("90 % of the samples", 0.05, Stroke::WideBand), ("50 % of the samples", 0.25, Stroke::NarrowBand)];
        let band = |(name, low, stroke): (&str, f64, Stroke)| {
            let mut points = self.quantile(sampled, low, rows);
            points.extend(self.quantile(sampled, 1.0 - low, rows).into_iter().rev());
            (points.len() > 2).then(|| Curve { name: name.into(), look, stroke, points })
        };
        bands.into_iter().filter_map(band).collect()
    }

    /// The median of the samples, with the name and the look of its group; `None` of a table without.
    fn median(&self, quantity: Quantity, rows: &[&SweepRow], (name, look): (&str, usize)) -> Option<Curve> {
        let points = self.quantile(sampled(quantity)?, 0.5, rows);
        (!points.is_empty()).then(|| Curve { name: name.to_owned(), look, stroke: Stroke::Marked, points })
    }

    fn quantile(&self, sampled: Sampled, probability: f64, rows: &[&SweepRow]) -> Vec<(f64, f64)> {
        let of = |row: &&SweepRow| row.samples.as_ref()?.quantile(sampled, probability);
        rows.iter().filter_map(|row| Some(((self.x)(&row.point), of(row)?))).collect()
    }

    fn points(&self, quantity: Quantity, rows: &[&SweepRow], is_drawn: impl Fn(&SweepRow) -> bool) -> Vec<(f64, f64)> {
        let drawn = rows.iter().filter(|row| is_drawn(row));
        drawn.filter_map(|row| Some(((self.x)(&row.point), row.value(quantity)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use asperity::element::{Load, PointStatus, SweepGrid};
    use asperity::table::Header;
    use asperity_study::sweep::SweepHeader;

    use super::*;

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

    fn drawn(table: &SweepTable) -> SideBySide {
        plot(table, String::new(), panels_of_loads(table), |point| point.speed)
    }

    #[test]
    fn points_that_are_not_steady_are_hollow_and_off_the_line() {
        let picture = drawn(&table(0.0, None));
        assert_eq!((picture.title.as_str(), picture.rows.len()), ("block", 1), "hysteresis alone has no panel");
        let strokes = |picture: &SideBySide| {
            let curves = picture.rows[0].panels[0].curves.clone();
            curves.iter().map(|curve| (curve.stroke, curve.points.len())).collect::<Vec<_>>()
        };
        assert_eq!(strokes(&picture), [(Stroke::Marked, 2), (Stroke::Marked, 1), (Stroke::Hollow, 1)]);
        let converged = drawn(&table(0.0, Some("converged: spacing")));
        assert_eq!(strokes(&converged), strokes(&picture));
        let open = drawn(&table(0.0, Some("not converged: spacing")));
        let all = [(Stroke::Line, 2), (Stroke::Hollow, 2), (Stroke::Line, 1), (Stroke::Hollow, 2)];
        assert_eq!(strokes(&open), all);
    }

    #[test]
    fn parts_have_panels_of_their_own() {
        let picture = drawn(&table(0.25, None));
        let titles: Vec<&str> = picture.rows.iter().map(|row| row.y_title.as_str()).collect();
        assert_eq!(titles, ["friction coefficient", "hysteresis", "adhesion"]);
        assert_eq!(picture.rows[2].panels[0].curves[0].points, [(0.1, 0.25), (1.0, 0.25)]);
    }
}
