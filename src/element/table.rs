//! The table of a sweep as a full grid over temperature, pressure and speed.

use std::fmt;
use std::fs;
use std::path::Path;

use super::error::{TableError, TableProblem};
use super::reader::{Refusal, Text};
use crate::scene::{SMALLEST, is_possible};

/// What presses the layer of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// A mean pressure on the nominal area, Pa.
    Pressure,
    /// F_z of the whole layer, N: of a scene that has no area.
    Force,
}

impl Load {
    /// The unit of the loads.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Pressure => "Pa",
            Self::Force => "N",
        }
    }

    /// What a load is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::Force => "force",
        }
    }

    fn column(self) -> &'static str {
        match self {
            Self::Pressure => "pressure [Pa]",
            Self::Force => "force [N]",
        }
    }
}

/// A point of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Speed, m/s.
    pub speed: f64,
    /// Pressure, Pa, or force, N.
    pub pressure: f64,
    /// Which of both.
    pub load: Load,
    /// Temperature, K, where the table has any.
    pub temperature: Option<f64>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} m/s, {} {}", self.speed, self.pressure, self.load.unit())?;
        self.temperature.map_or(Ok(()), |temperature| write!(f, ", {temperature} K"))
    }
}

/// What a table knows of each of its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Mean separation of the carrier's rest line and the profile's mean, m.
    Separation,
    /// Friction coefficient, 1.
    Friction,
    /// Tangential stiffness at the start, N/m.
    Stiffness,
    /// The part of the friction coefficient that is hysteresis, 1.
    Hysteresis,
    /// Masses in contact over all masses, 1.
    ContactRatio,
    /// Power lost in dampers, W.
    DamperPower,
    /// Power lost in Maxwell elements, W.
    MaxwellPower,
    /// Power lost in friction, W.
    FrictionPower,
    /// Power lost in impacts, W.
    ImpactPower,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Separation,
        Self::Friction,
        Self::Stiffness,
        Self::Hysteresis,
        Self::ContactRatio,
        Self::DamperPower,
        Self::MaxwellPower,
        Self::FrictionPower,
        Self::ImpactPower,
    ];

    /// The powers by channel.
    pub const CHANNELS: [Self; 4] = [Self::DamperPower, Self::MaxwellPower, Self::FrictionPower, Self::ImpactPower];

    /// The column's name.
    fn column(self) -> &'static str {
        match self {
            Self::Separation => "separation [m]",
            Self::Friction => "friction [1]",
            Self::Stiffness => "tangential_stiffness [N/m]",
            Self::Hysteresis => "friction_hysteresis [1]",
            Self::ContactRatio => "contact_ratio [1]",
            Self::DamperPower => "P_damper [W]",
            Self::MaxwellPower => "P_maxwell [W]",
            Self::FrictionPower => "P_friction [W]",
            Self::ImpactPower => "P_impact [W]",
        }
    }

    fn is_needed(self) -> bool {
        matches!(self, Self::Separation | Self::Friction | Self::Stiffness)
    }

    /// What a value has to be.
    fn expected(self) -> &'static str {
        match self {
            Self::Separation | Self::Hysteresis => "a number",
            Self::Stiffness => "a number above 0",
            _ => "a number, 0 or more",
        }
    }

    fn allows(self, value: f64) -> bool {
        is_possible(value)
            && match self {
                Self::Separation | Self::Hysteresis => true,
                Self::Stiffness => value >= SMALLEST,
                _ => value >= 0.0,
            }
    }
}

/// The values of every quantity, `None` where the table does not know it.
pub(super) type Values = [Option<Vec<f64>>; Quantity::ALL.len()];

/// A table, checked: every point of the grid is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The name of the scene that was swept.
    pub scene: String,
    /// What its loads are.
    pub load: Load,
    /// Area that the pressure is meant over, m²; 1 where the loads are forces.
    pub nominal_area: f64,
    /// Separation at w = 0, m.
    pub rest_separation: f64,
    /// Speeds, m/s, rising.
    pub speeds: Vec<f64>,
    /// Pressures, Pa, or forces, N, rising, at least two.
    pub pressures: Vec<f64>,
    /// Temperatures, K, rising; none where the scene has none.
    pub temperatures: Vec<f64>,
    /// By temperature, pressure, speed.
    pub(super) values: Values,
}

impl Table {
    /// Reads the table at `path`.
    ///
    /// # Errors
    /// [`TableError`] where the file is no table or its grid is not full.
    pub fn load(path: &Path) -> Result<Self, TableError> {
        let unreadable =
            |error: std::io::Error| TableError::new(path, None, TableProblem::Unreadable(error.to_string()));
        Self::parse(&fs::read_to_string(path).map_err(unreadable)?, path)
    }

    /// Reads a table from its text; `path` is where it came from.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, path: &Path) -> Result<Self, TableError> {
        Self::read(text).map_err(|(line, problem)| TableError::new(path, line, problem))
    }

    fn read(text: &str) -> Result<Self, Refusal> {
        let text = Text::parse(text)?;
        match text.head.get("asperity sweep").map(String::as_str) {
            Some("1") => (),
            found => return Err((None, TableProblem::Format(found.unwrap_or("none").to_owned()))),
        }
        let load = if text.column(Load::Force.column()).is_ok() { Load::Force } else { Load::Pressure };
        let area = || text.quantity("nominal_area", "m2", "an area above 0 in m2", |area| area > 0.0);
        let mut table = Self {
            load,
            scene: text.head.get("scene").cloned().unwrap_or_else(|| "contact".into()),
            nominal_area: if load == Load::Force { 1.0 } else { area()? },
            rest_separation: text.quantity("rest_separation", "m", "a length in m", |_| true)?,
            speeds: Vec::new(),
            pressures: Vec::new(),
            temperatures: Vec::new(),
            values: Default::default(),
        };
        let places = places(&text, load)?;
        table.speeds = axis(places.iter().map(|place| place.speed));
        table.pressures = axis(places.iter().map(|place| place.pressure));
        table.temperatures = axis(places.iter().filter_map(|place| place.temperature));
        table.fill(&text, &places)?;
        table.check_separations()?;
        Ok(table)
    }

    /// The number of its points.
    pub fn points(&self) -> usize {
        self.temperatures.len().max(1) * self.pressures.len() * self.speeds.len()
    }

    /// Whether it knows `quantity`.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.values[quantity as usize].is_some()
    }

    /// The value of `quantity` at a temperature, a pressure and a speed by their places on the axes; 0 where it is not
    /// known.
    pub fn value(&self, quantity: Quantity, (temperature, pressure, speed): (usize, usize, usize)) -> f64 {
        let at = (temperature * self.pressures.len() + pressure) * self.speeds.len() + speed;
        self.values[quantity as usize].as_ref().map_or(0.0, |values| values[at])
    }

    /// The table without what stands at the place `at` of an axis: 0 speed, 1 pressure, 2 temperature.
    pub(super) fn without(&self, axis: usize, at: usize) -> Self {
        let (speeds, pressures) = (self.speeds.len(), self.pressures.len());
        let on_axis = |index: usize| [index % speeds, index / speeds % pressures, index / speeds / pressures][axis];
        let rest = |values: &Vec<f64>| {
            let kept = values.iter().enumerate().filter(|(index, _)| on_axis(*index) != at);
            kept.map(|(_, &value)| value).collect()
        };
        let mut table = Self { values: std::array::from_fn(|i| self.values[i].as_ref().map(rest)), ..self.clone() };
        [&mut table.speeds, &mut table.pressures, &mut table.temperatures][axis].remove(at);
        table
    }

    /// The point at a place of the grid.
    fn place(&self, at: usize) -> Place {
        let (speeds, pressures) = (self.speeds.len(), self.pressures.len());
        Place {
            speed: self.speeds[at % speeds],
            pressure: self.pressures[at / speeds % pressures],
            load: self.load,
            temperature: self.temperatures.get(at / speeds / pressures).copied(),
        }
    }

    /// Where a point stands in the grid.
    fn index(&self, place: &Place) -> usize {
        let on = |axis: &[f64], value: f64| axis.partition_point(|&other| other < value);
        let temperature = place.temperature.map_or(0, |temperature| on(&self.temperatures, temperature));
        (temperature * self.pressures.len() + on(&self.pressures, place.pressure)) * self.speeds.len()
            + on(&self.speeds, place.speed)
    }

    fn fill(&mut self, text: &Text, places: &[Place]) -> Result<(), Refusal> {
        if self.pressures.len() < 2 {
            return Err((None, TableProblem::Pressures { load: self.load.name(), found: self.pressures.len() }));
        }
        let mut rows: Vec<Option<usize>> = vec![None; self.points()];
        for (row, place) in places.iter().enumerate() {
            if rows[self.index(place)].replace(row).is_some() {
                return Err((Some(text.rows[row].0), TableProblem::Twice(*place)));
            }
        }
        let missing: Vec<Place> = (0..rows.len()).filter(|&at| rows[at].is_none()).map(|at| self.place(at)).collect();
        if !missing.is_empty() {
            return Err((None, TableProblem::Missing(missing)));
        }
        let rows: Vec<usize> = rows.into_iter().flatten().collect();
        self.check_steady(text, &rows)?;
        for quantity in Quantity::ALL {
            self.values[quantity as usize] = column(text, &rows, quantity)?;
        }
        Ok(())
    }

    fn check_steady(&self, text: &Text, rows: &[usize]) -> Result<(), Refusal> {
        let status = text.column("status")?;
        let statuses = rows.iter().enumerate().map(|(at, &row)| (self.place(at), text.rows[row].1[status].clone()));
        let failed: Vec<_> = statuses.filter(|(_, status)| status != "steady").collect();
        if failed.is_empty() { Ok(()) } else { Err((None, TableProblem::NotSteady(failed))) }
    }

    /// Pressed harder, the carrier is closer: the table of separations can be read the other way round.
    fn check_separations(&self) -> Result<(), Refusal> {
        let Some(separations) = &self.values[Quantity::Separation as usize] else { return Ok(()) };
        let speeds = self.speeds.len();
        let above_another = (0..separations.len()).filter(|at| !(at / speeds).is_multiple_of(self.pressures.len()));
        for at in above_another {
            let (here, before) = (separations[at], separations[at - speeds]);
            if here >= before {
                let load = self.load.name();
                return Err((None, TableProblem::Separation { place: self.place(at), load, here, before }));
            }
        }
        Ok(())
    }
}

/// The points of the rows.
fn places(text: &Text, load: Load) -> Result<Vec<Place>, Refusal> {
    let names = ["speed [m/s]", load.column(), "temperature [K]"];
    let [speed, pressure, temperature] = [text.column(names[0])?, text.column(names[1])?, text.column(names[2])?];
    let place = |(line, fields): &(usize, Vec<String>)| {
        let positive = |column: usize, name: &str| {
            let number = fields[column].parse().ok().filter(|&number: &f64| number >= SMALLEST && is_possible(number));
            number.ok_or_else(|| (Some(*line), field(name, &fields[column], "a number above 0")))
        };
        let has_temperature = !fields[temperature].is_empty();
        Ok(Place {
            speed: positive(speed, names[0])?,
            pressure: positive(pressure, names[1])?,
            load,
            temperature: if has_temperature { Some(positive(temperature, names[2])?) } else { None },
        })
    };
    let places: Vec<Place> = text.rows.iter().map(place).collect::<Result<_, Refusal>>()?;
    let with = places.iter().filter(|place| place.temperature.is_some()).count();
    match places.iter().position(|place| place.temperature.is_none()) {
        Some(row) if with > 0 => Err((Some(text.rows[row].0), field(names[2], "", "a number, as in other rows"))),
        _ => Ok(places),
    }
}

/// The values that occur, rising, each once.
fn axis(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut axis: Vec<f64> = values.collect();
    axis.sort_by(f64::total_cmp);
    axis.dedup();
    axis
}

/// The values of a quantity in the order of `rows`; `None` where the column is empty or not there and need not be.
fn column(text: &Text, rows: &[usize], quantity: Quantity) -> Result<Option<Vec<f64>>, Refusal> {
    let column = match text.column(quantity.column()) {
        Err(_) if !quantity.is_needed() => return Ok(None),
        column => column?,
    };
    if !quantity.is_needed() && rows.iter().all(|&row| text.rows[row].1[column].is_empty()) {
        return Ok(None);
    }
    let value = |&row: &usize| {
        let (line, fields) = &text.rows[row];
        let number = fields[column].parse().ok().filter(|&number| quantity.allows(number));
        number.ok_or_else(|| (Some(*line), field(quantity.column(), &fields[column], quantity.expected())))
    };
    rows.iter().map(value).collect::<Result<_, _>>().map(Some)
}

fn field(column: &str, found: &str, expected: &'static str) -> TableProblem {
    TableProblem::Field { column: column.into(), found: found.into(), expected }
}
