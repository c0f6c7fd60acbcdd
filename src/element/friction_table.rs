//! The law's points from the table of a sweep: every point of the grid is there, steady or in full contact.
//!
//! In full contact all of the surface touches: the separation is 0 however hard it is pressed, and nothing gives way but what
//! stands behind. Such a table serves behind a backing. In its law a contact then gives way by so little that the
//! backing's slope is all that is seen, and by enough to have an inverse.

use std::path::Path;

use super::grid::{Load, OperatingPoint, SweepGrid};
use super::point_status::PointStatus;
use super::quantity::{Need, Quantity};
use crate::scene::{Backing, is_possible, read_text};
use crate::table::{Header, Table, TableError};

/// What the header of a sweep's table begins with; the number grows when readers have to know of a change.
pub const SWEEP: (&str, u64) = ("asperity sweep", 1);

/// How much closer a contact in full contact comes from one load to the next, over the most by which one of the table's
/// others does: with a thousandth the law over speed and temperature is still smooth beside them. 1e-15 m where all
/// points are in full contact.
const GIVES_WAY: f64 = 1e-3;
const GIVES_WAY_ALL: f64 = 1e-15;

/// How much stiffer along the surface a contact in full contact is than the stiffest of the table's others, which are near
/// that; much more would not be smooth beside soft ones at the next speed. 1e20 Pa/m where all points are in full contact.
const STIFFER: f64 = 10.0;
const STIFF_ALL: f64 = 1e20;

/// The points of a table, checked: every point of the grid has a row and was steady or in full contact.
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
    /// By point, whether it is in full contact.
    full_contact: Vec<bool>,
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
        let found = Self::of_sweep(table)?;
        found.check_alone()?;
        Ok(found)
    }

    /// From the table of a sweep, which may have points in full contact.
    pub(super) fn of_sweep(table: &Table) -> Result<Self, TableError> {
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
                "{} values of the {}, expected at least two: the law goes from one to the next",
                grid.loads.len(),
                load.name()
            )));
        }
        let order = rows_of_points(table, &grid, load, &points)?;
        let full_contact = full_contact(table, load, &points, &order)?;
        let mut values = [const { None }; Quantity::ALL.len()];
        for quantity in Quantity::ALL {
            values[quantity as usize] = values_of(table, load, quantity, (&order, &full_contact))?;
        }
        let rest_separation = rest_separation(&table.header)?;
        let mut found = Self { header: table.header.clone(), load, rest_separation, grid, values, full_contact };
        found.check_separations().map_err(|crossing| table.error(crossing.to_string()))?;
        found.stiffen_full_contact();
        Ok(found)
    }

    /// Whether it has points that only what stands behind a contact gives way at: in full contact, or measured.
    pub fn needs_backing(&self) -> bool {
        self.full_contact.contains(&true)
    }

    /// Refuses a table that needs a backing.
    ///
    /// # Errors
    /// [`TableError`] with what helps.
    pub fn check_alone(&self) -> Result<(), TableError> {
        /// How a backing is given.
        const BACKING: &str =
            "a patch with a backing takes it, of one element too: [patch] backing = { normal = .., shear = .. }";
        if !self.needs_backing() {
            return Ok(());
        }
        if self.is_measured() {
            let problem = "friction that was measured is as in full contact, which has no stiffness of its own";
            return Err(self.header.error(format!("{problem}; {BACKING}")));
        }
        let full = self.nodes().filter(|node| self.is_full_contact(*node));
        let full: Vec<String> = full.map(|node| self.point(node).describe(self.load)).collect();
        Err(self.header.error(format!(
            "full contact, which has no stiffness of its own, at {}; {BACKING}; or leave a speed, a {} or a temperature out",
            some_of(&full),
            self.load.name()
        )))
    }

    /// Whether a point is in full contact.
    pub fn is_full_contact(&self, node: Node) -> bool {
        self.full_contact[self.index(node)]
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
    /// of the table; `None` where nothing sticks. In full contact k is that of the backing, if there is one.
    pub fn stick_time(&self, backing: Option<Backing>) -> Option<f64> {
        let last = |axis: &[f64]| axis.len().saturating_sub(1);
        let node = Node { temperature: 0, load: last(&self.grid.loads), speed: last(&self.grid.speeds) };
        self.stick_time_at(node, backing)
    }

    /// The time (s) in which a carrier passes the way to slip, μ F/k, at the load and the speed of a node; `None` where
    /// nothing sticks there. In full contact k is that of the backing, if there is one.
    pub fn stick_time_at(&self, node: Node, backing: Option<Backing>) -> Option<f64> {
        let (load, speed) = (self.grid.loads.get(node.load)?, self.grid.speeds.get(node.speed)?);
        let limit = self.value(Quantity::Friction, node) * self.load.force(*load);
        let behind = backing.filter(|_| self.is_full_contact(node)).map(|backing| backing.shear * self.load.area());
        let time = limit / behind.unwrap_or_else(|| self.value(Quantity::Stiffness, node)) / speed;
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
    pub fn nodes(&self) -> impl Iterator<Item = Node> + use<> {
        let (speeds, loads) = (self.grid.speeds.len(), self.grid.loads.len());
        (0..self.grid.count()).map(move |index| Node {
            temperature: index / speeds / loads,
            load: index / speeds % loads,
            speed: index % speeds,
        })
    }

    /// The table without the points at `index` of an axis.
    pub(super) fn without(&self, axis: TableAxis, index: usize) -> Self {
        let kept: Vec<bool> = self.nodes().map(|node| axis.index(node) != index).collect();
        let mut table = Self {
            values: std::array::from_fn(|i| self.values[i].as_ref().map(|values| those(&kept, values))),
            full_contact: those(&kept, &self.full_contact),
            ..self.clone()
        };
        let grid = &mut table.grid;
        [&mut grid.speeds, &mut grid.loads, &mut grid.temperatures][axis as usize].remove(index);
        table
    }

    /// Pressed harder, the carrier is closer: the separations have an inverse. In full contact it stays where it is.
    fn check_separations(&self) -> Result<(), SeparationsCross> {
        let separation = |node| self.value(Quantity::Separation, node);
        for node in self.nodes().filter(|node| node.load > 0) {
            let below = Node { load: node.load - 1, ..node };
            let (here, before) = (separation(node), separation(below));
            let crosses = match (self.is_full_contact(below), self.is_full_contact(node)) {
                (true, is_full) => !is_full || here > before,
                (false, _) => here >= before,
            };
            if crosses {
                let (load, point) = (self.load.name(), self.point(node).describe(self.load));
                return Err(SeparationsCross { here, before, point, load });
            }
        }
        Ok(())
    }

    /// Lets points in full contact give way by a little along the normal, and sets their stiffness along the surface: that
    /// of the backing is all that is left of it in series.
    fn stiffen_full_contact(&mut self) {
        if !self.needs_backing() {
            return;
        }
        let below = |node: Node| Some(Node { load: node.load.checked_sub(1)?, ..node });
        let steps = self.nodes().filter_map(|node| Some((node, below(node)?)));
        let closer = |(node, below)| self.value(Quantity::Separation, below) - self.value(Quantity::Separation, node);
        let step = GIVES_WAY * steps.map(closer).fold(0.0, f64::max);
        let step = if step > 0.0 { step } else { GIVES_WAY_ALL };
        let others = self.nodes().filter(|node| !self.is_full_contact(*node));
        let stiffness = STIFFER * others.map(|node| self.value(Quantity::Stiffness, node)).fold(0.0, f64::max);
        let stiffness = if stiffness > 0.0 { stiffness } else { STIFF_ALL * self.load.area() };
        for node in self.nodes() {
            if !self.is_full_contact(node) {
                continue;
            }
            let own = self.value(Quantity::Separation, node);
            let closer = below(node).map_or(own, |below| self.value(Quantity::Separation, below) - step);
            self.set(Quantity::Separation, node, own.min(closer));
            self.set(Quantity::Stiffness, node, stiffness);
        }
    }

    fn set(&mut self, quantity: Quantity, node: Node, value: f64) {
        let index = self.index(node);
        if let Some(values) = &mut self.values[quantity as usize] {
            values[index] = value;
        }
    }
}

/// Those of `values` that are `kept`.
fn those<T: Copy>(kept: &[bool], values: &[T]) -> Vec<T> {
    kept.iter().zip(values).filter(|(kept, _)| **kept).map(|(_, value)| *value).collect()
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

/// Whether the points, each steady or in full contact, are in full contact, in the order of the rows.
fn full_contact(
    table: &Table,
    load: Load,
    points: &[OperatingPoint],
    order: &[usize],
) -> Result<Vec<bool>, TableError> {
    let (mut full, mut failed) = (Vec::with_capacity(order.len()), Vec::new());
    for &row in order {
        let status = PointStatus::of_row(table, row)?;
        if !status.is_result() {
            failed.push(format!("{} is not steady: {}", points[row].describe(load), status.text()));
        }
        full.push(status == PointStatus::FullContact);
    }
    if failed.is_empty() {
        return Ok(full);
    }
    Err(table.error(format!(
        "{}; an element needs every point of the table: sweep them again, or leave a speed, a pressure or a temperature out",
        some_of(&failed)
    )))
}

/// The values of a quantity, in the order of `rows`; `None` where an element ignores it, or it is missing or empty and
/// need not be there. The stiffness in full contact is none.
fn values_of(
    table: &Table,
    load: Load,
    quantity: Quantity,
    (rows, full_contact): (&[usize], &[bool]),
) -> Result<Option<Vec<f64>>, TableError> {
    let (need, name, unit) = (quantity.need(), quantity.name(load), quantity.unit(load));
    if need == Need::Ignored || (need == Need::Optional && !table.has(&name, unit)) {
        return Ok(None);
    }
    let cells: Vec<_> = rows.iter().map(|&row| (row, table.number(row, &name, unit))).collect();
    if need == Need::Optional && cells.iter().all(|(_, cell)| *cell == Ok(None)) {
        return Ok(None);
    }
    let value = |((row, cell), is_full): ((usize, Result<Option<f64>, TableError>), &bool)| {
        if quantity == Quantity::Stiffness && *is_full {
            return Ok(f64::NAN);
        }
        let number = cell.ok().flatten().filter(|&number| quantity.allows(number));
        number.ok_or_else(|| table.cell_error(row, &name, unit, quantity.expected()))
    };
    cells.into_iter().zip(full_contact).map(value).collect::<Result<_, _>>().map(Some)
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
