//! The law's points from the table of a sweep: every point of the grid is there and steady.

use std::path::Path;

use super::grid::{Load, OperatingPoint, SweepGrid};
use super::point_status::PointStatus;
use super::quantity::{Need, Quantity};
use crate::scene::{is_possible, read_text};
use crate::table::{Header, Table, TableError};

/// What the header of a sweep's table begins with; the number grows when readers have to know of a change.
pub const SWEEP: (&str, u64) = ("asperity sweep", 1);

/// The points of a table, checked: every point of the grid has a row and was steady.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionTable {
    /// What stands before the rows: what the numbers rest on.
    pub header: Header,
    /// What the loads are.
    pub load: Load,
    /// Separation at w = 0, m.
    pub rest_separation: f64,
    /// The points, at least two loads.
    pub grid: SweepGrid,
    /// By quantity, where the table has it, and point.
    values: [Option<Vec<f64>>; Quantity::ALL.len()],
}

/// A point of a table by its indices on the axes of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Index of the temperature; 0 where the table has none.
    pub temperature: usize,
    /// Index of the load.
    pub load: usize,
    /// Index of the speed.
    pub speed: usize,
}

/// An axis of a table's grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TableAxis {
    Speed,
    Load,
    Temperature,
}

impl TableAxis {
    /// The axes, `axis as usize` being the index of each.
    pub(super) const ALL: [Self; 3] = [Self::Speed, Self::Load, Self::Temperature];

    /// The index of a node on this axis.
    pub(super) fn index(self, node: Node) -> usize {
        [node.speed, node.load, node.temperature][self as usize]
    }

    /// The values of a grid on this axis.
    pub(super) fn values(self, grid: &SweepGrid) -> &Vec<f64> {
        [&grid.speeds, &grid.loads, &grid.temperatures][self as usize]
    }
}

impl FrictionTable {
    /// Reads the table at `path`.
    ///
    /// # Errors
    /// [`TableError`] where the file is not the table of a sweep or its grid is not full.
    pub fn load(path: &Path) -> Result<Self, TableError> {
        let unreadable =
            |error| TableError { file: path.to_owned(), line: None, problem: format!("cannot be read: {error}") };
        Self::parse(&read_text(path).map_err(unreadable)?, path)
    }

    /// Reads a table from its text; `path` is where it came from.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, path: &Path) -> Result<Self, TableError> {
        Self::new(&Table::parse(text, path)?)
    }

    /// From the table of a sweep.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn new(table: &Table) -> Result<Self, TableError> {
        table.header.check_kind(SWEEP)?;
        let load = Load::of_table(table)?;
        let points = points(table, load)?;
        let grid = SweepGrid {
            speeds: axis(points.iter().map(|point| point.speed)),
            loads: axis(points.iter().map(|point| point.load)),
            temperatures: axis(points.iter().filter_map(|point| point.temperature)),
        };
        if grid.loads.len() < 2 {
            return Err(table.error(format!(
                "{} values of the {}, expected at least two: the normal stiffness is the slope between them",
                grid.loads.len(),
                load.name()
            )));
        }
        let order = rows_of_points(table, &grid, load, &points)?;
        check_steady(table, load, &points, &order)?;
        let mut values = [const { None }; Quantity::ALL.len()];
        for quantity in Quantity::ALL {
            values[quantity as usize] = values_of(table, load, quantity, &order)?;
        }
        let rest_separation = rest_separation(&table.header)?;
        let found = Self { header: table.header.clone(), load, rest_separation, grid, values };
        found.check_separations().map_err(|crossing| table.error(crossing.to_string()))?;
        Ok(found)
    }

    /// The name of the scene that was swept.
    pub fn scene(&self) -> &str {
        self.header.text_of("scene").unwrap_or("contact")
    }

    /// Whether it has `quantity`.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.values[quantity as usize].is_some()
    }

    /// The value of `quantity` at a point; 0 where the table does not have it.
    pub fn value(&self, quantity: Quantity, node: Node) -> f64 {
        self.values[quantity as usize].as_ref().map_or(0.0, |values| values[self.index(node)])
    }

    /// The time (s) in which a carrier that is pressed the hardest passes the way to slip, μ F/k, at the largest speed
    /// of the table; `None` where nothing sticks.
    pub fn stick_time(&self) -> Option<f64> {
        let last = |axis: &[f64]| axis.len().saturating_sub(1);
        let node = Node { temperature: 0, load: last(&self.grid.loads), speed: last(&self.grid.speeds) };
        self.stick_time_at(node)
    }

    /// The time (s) in which a carrier passes the way to slip, μ F/k, at the load and the speed of a node; `None` where
    /// nothing sticks there.
    pub fn stick_time_at(&self, node: Node) -> Option<f64> {
        let (load, speed) = (self.grid.loads.get(node.load)?, self.grid.speeds.get(node.speed)?);
        let limit = self.value(Quantity::Friction, node) * self.load.force(*load);
        let time = limit / self.value(Quantity::Stiffness, node) / speed;
        (time.is_finite() && time > 0.0).then_some(time)
    }

    /// The operating point of a node.
    pub(super) fn point(&self, node: Node) -> OperatingPoint {
        self.grid.point(self.index(node))
    }

    fn index(&self, node: Node) -> usize {
        (node.temperature * self.grid.loads.len() + node.load) * self.grid.speeds.len() + node.speed
    }

    /// The nodes by temperature, load, speed, as the points of the [grid](SweepGrid::points).
    fn nodes(&self) -> impl Iterator<Item = Node> {
        let (speeds, loads) = (self.grid.speeds.len(), self.grid.loads.len());
        (0..self.grid.count()).map(move |index| Node {
            temperature: index / speeds / loads,
            load: index / speeds % loads,
            speed: index % speeds,
        })
    }

    /// The table without the points at `index` of an axis.
    pub(super) fn without(&self, axis: TableAxis, index: usize) -> Self {
        let rest = |values: &Vec<f64>| {
            let kept = self.nodes().zip(values).filter(|(node, _)| axis.index(*node) != index);
            kept.map(|(_, &value)| value).collect()
        };
        let mut table = Self { values: std::array::from_fn(|i| self.values[i].as_ref().map(rest)), ..self.clone() };
        let grid = &mut table.grid;
        [&mut grid.speeds, &mut grid.loads, &mut grid.temperatures][axis as usize].remove(index);
        table
    }

    /// Pressed harder, the carrier is closer: the separations have an inverse.
    fn check_separations(&self) -> Result<(), SeparationsCross> {
        let separation = |node| self.value(Quantity::Separation, node);
        for node in self.nodes().filter(|node| node.load > 0) {
            let (here, before) = (separation(node), separation(Node { load: node.load - 1, ..node }));
            if here >= before {
                let (load, point) = (self.load.name(), self.point(node).describe(self.load));
                return Err(SeparationsCross { here, before, point, load });
            }
        }
        Ok(())
    }
}

/// A carrier that is pressed harder is no closer.
#[derive(Debug, thiserror::Error)]
#[error("separation = {here} m at {point}, but {before} m at the {load} below: expected a smaller one")]
struct SeparationsCross {
    here: f64,
    before: f64,
    point: String,
    load: &'static str,
}

/// The values that occur, rising, each once.
fn axis(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut axis: Vec<f64> = values.collect();
    axis.sort_by(f64::total_cmp);
    axis.dedup();
    axis
}

/// Separation at w = 0 by the header of a sweep's table, m.
///
/// # Errors
/// [`TableError`] where it has none.
pub fn rest_separation(header: &Header) -> Result<f64, TableError> {
    let found = header.number("rest_separation", "m")?;
    if is_possible(found) { Ok(found) } else { Err(header.error(format!("rest_separation = {found}"))) }
}

/// The points of the rows, all with a temperature or none.
fn points(table: &Table, load: Load) -> Result<Vec<OperatingPoint>, TableError> {
    let points = (0..table.len()).map(|row| OperatingPoint::of_row(table, row, load)).collect::<Result<Vec<_>, _>>()?;
    match points.iter().position(|point| point.temperature.is_none()) {
        Some(row) if points.iter().any(|point| point.temperature.is_some()) => {
            Err(table.cell_error(row, "temperature", "K", "a number, as in other rows"))
        }
        _ => Ok(points),
    }
}

/// For each point of the grid the index of its row.
fn rows_of_points(
    table: &Table,
    grid: &SweepGrid,
    load: Load,
    points: &[OperatingPoint],
) -> Result<Vec<usize>, TableError> {
    let mut found: Vec<Option<usize>> = vec![None; grid.count()];
    for (row, point) in points.iter().enumerate() {
        if grid.index(point).is_some_and(|index| found[index].replace(row).is_some()) {
            return Err(table.error_in(row, format!("a second row of {}", point.describe(load))));
        }
    }
    let missing = |(point, row): (OperatingPoint, &Option<usize>)| row.is_none().then(|| point.describe(load));
    let missing: Vec<String> = grid.points().zip(&found).filter_map(missing).collect();
    if missing.is_empty() {
        Ok(found.into_iter().flatten().collect())
    } else {
        Err(table.error(format!("no row of {}; an element needs every point of the table", some_of(&missing))))
    }
}

fn check_steady(table: &Table, load: Load, points: &[OperatingPoint], order: &[usize]) -> Result<(), TableError> {
    let mut failed = Vec::new();
    for &row in order {
        let point = points[row].describe(load);
        match PointStatus::of_row(table, row)? {
            PointStatus::Steady => (),
            PointStatus::FullContact => failed.push(format!("{point} is in full contact, which has no stiffness")),
            status => failed.push(format!("{point} is not steady: {}", status.text())),
        }
    }
    if failed.is_empty() {
        return Ok(());
    }
    Err(table.error(format!(
        "{}; an element needs every point of the table: sweep them again, or leave a speed, a pressure or a temperature out",
        some_of(&failed)
    )))
}

/// The values of a quantity, in the order of `rows`; `None` where an element ignores it, or it is missing or empty and
/// need not be there.
fn values_of(table: &Table, load: Load, quantity: Quantity, rows: &[usize]) -> Result<Option<Vec<f64>>, TableError> {
    let (need, name, unit) = (quantity.need(), quantity.name(load), quantity.unit(load));
    if need == Need::Ignored || (need == Need::Optional && !table.has(&name, unit)) {
        return Ok(None);
    }
    let cells: Vec<_> = rows.iter().map(|&row| (row, table.number(row, &name, unit))).collect();
    if need == Need::Optional && cells.iter().all(|(_, cell)| *cell == Ok(None)) {
        return Ok(None);
    }
    let value = |(row, cell): (usize, Result<Option<f64>, TableError>)| {
        let number = cell.ok().flatten().filter(|&number| quantity.allows(number));
        number.ok_or_else(|| table.cell_error(row, &name, unit, quantity.expected()))
    };
    cells.into_iter().map(value).collect::<Result<_, _>>().map(Some)
}

/// The first of `texts`, and how many more there are.
pub fn some_of(texts: &[String]) -> String {
    const SHOWN: usize = 10;
    let shown = texts.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join("; ");
    match texts.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown}; and {more} more"),
    }
}
