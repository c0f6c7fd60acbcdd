//! The points of a sweep: speeds, loads and temperatures.

use serde::Serialize;

use crate::scene::{SMALLEST, is_possible};
use crate::table::{Cell, Column, Table, TableError};

/// What presses the layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// A mean pressure on the nominal area, Pa.
    Pressure {
        /// The nominal area, m².
        area: f64,
    },
    /// F_z of the whole layer, N: of a scene that has no area.
    Force,
}

impl Load {
    /// `pressure` or `force`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pressure { .. } => "pressure",
            Self::Force => "force",
        }
    }

    /// The unit of the loads.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Pressure { .. } => "Pa",
            Self::Force => "N",
        }
    }

    /// Area that the loads act on, m²; 1 where they are forces.
    pub fn area(self) -> f64 {
        match self {
            Self::Pressure { area } => area,
            Self::Force => 1.0,
        }
    }

    /// What the loads of a sweep's table are: pressures need the area of its header.
    ///
    /// # Errors
    /// [`TableError`] where they are pressures, and it has none.
    pub fn of_table(table: &Table) -> Result<Self, TableError> {
        if table.has(Self::Force.name(), Self::Force.unit()) {
            return Ok(Self::Force);
        }
        match table.header.number("nominal_area", "m2")? {
            area if area > 0.0 && is_possible(area) => Ok(Self::Pressure { area }),
            area => Err(table.error(format!("`# nominal_area = {area} m2`: expected an area above 0"))),
        }
    }

    /// F_z of a load, N.
    pub fn force(self, load: f64) -> f64 {
        load * self.area()
    }

    /// The load of a force F_z, N.
    pub fn at_force(self, force: f64) -> f64 {
        force / self.area()
    }
}

/// A point of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// Sliding speed, m/s.
    pub speed: f64,
    /// Pressure, Pa, or force, N.
    pub load: f64,
    /// Temperature, K; `None` where the scene has none.
    pub temperature: Option<f64>,
    /// The way that rubber has slid which was that warm, m; `None`: its surface is, or that of the whole table.
    pub way: Option<f64>,
}

impl OperatingPoint {
    /// The columns that a point has in a table of such loads.
    pub fn columns(load: Load) -> [Column; 3] {
        [("speed", "m/s"), (load.name(), load.unit()), ("temperature", "K")]
            .map(|(name, unit)| Column::numbers(name, unit))
    }

    /// Its cells in these columns.
    pub fn cells(&self) -> [Cell; 3] {
        [self.speed.into(), self.load.into(), self.temperature.into()]
    }

    /// The point of a row.
    ///
    /// # Errors
    /// [`TableError`] where it is not given by positive numbers.
    pub fn of_row(table: &Table, row: usize, load: Load) -> Result<Self, TableError> {
        let positive = |name: &str, unit: &str| {
            let number = table.number(row, name, unit).ok().flatten();
            let number = number.filter(|&number| number >= SMALLEST && is_possible(number));
            number.ok_or_else(|| table.cell_error(row, name, unit, "a number above 0"))
        };
        let has_temperature = table.number(row, "temperature", "K")?.is_some();
        Ok(Self {
            speed: positive("speed", "m/s")?,
            load: positive(load.name(), load.unit())?,
            temperature: if has_temperature { Some(positive("temperature", "K")?) } else { None },
            way: None,
        })
    }

    /// The point in words: `0.1 m/s, 200000 Pa, 293.15 K, after 0.02 m`.
    pub fn describe(&self, load: Load) -> String {
        let temperature = self.temperature.map_or_else(String::new, |temperature| format!(", {temperature} K"));
        let way = self.way.map_or_else(String::new, |way| format!(", after {way} m"));
        format!("{} m/s, {} {}{temperature}{way}", self.speed, self.load, load.unit())
    }
}

/// The points of a sweep: every speed at every load at every temperature. The values of each axis rise.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepGrid {
    /// Speeds, m/s.
    pub speeds: Vec<f64>,
    /// Pressures, Pa, or forces, N.
    pub loads: Vec<f64>,
    /// Temperatures, K; none where the scene has none.
    pub temperatures: Vec<f64>,
}

impl SweepGrid {
    /// The number of points.
    pub fn count(&self) -> usize {
        self.temperatures.len().max(1) * self.loads.len() * self.speeds.len()
    }

    /// The points by temperature, load, speed.
    pub fn points(&self) -> impl Iterator<Item = OperatingPoint> {
        (0..self.count()).map(|index| self.point(index))
    }

    /// The point at an index of [`points`](Self::points).
    pub fn point(&self, index: usize) -> OperatingPoint {
        let (speeds, loads) = (self.speeds.len(), self.loads.len());
        OperatingPoint {
            speed: self.speeds[index % speeds],
            load: self.loads[index / speeds % loads],
            temperature: self.temperatures.get(index / speeds / loads).copied(),
            way: None,
        }
    }

    /// The index of a point in [`points`](Self::points), if it is one of them.
    pub fn index(&self, point: &OperatingPoint) -> Option<usize> {
        let on = |axis: &[f64], value: f64| axis.iter().position(|&other| other == value);
        let temperature = match point.temperature {
            Some(temperature) => on(&self.temperatures, temperature)?,
            None if self.temperatures.is_empty() => 0,
            None => return None,
        };
        let load = temperature * self.loads.len() + on(&self.loads, point.load)?;
        Some(load * self.speeds.len() + on(&self.speeds, point.speed)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_by_temperature_load_and_speed() {
        let grid = SweepGrid { speeds: vec![1.0, 2.0], loads: vec![3.0, 4.0], temperatures: vec![5.0, 6.0] };
        let points: Vec<OperatingPoint> = grid.points().collect();
        let expected = [(1.0, 3.0, 5.0), (2.0, 3.0, 5.0), (1.0, 4.0, 5.0)];
        assert_eq!(points.len(), 8);
        for (point, (speed, load, temperature)) in points.iter().zip(expected) {
            assert_eq!(*point, OperatingPoint { speed, load, temperature: Some(temperature), way: None });
        }
        assert!(points.iter().enumerate().all(|(index, point)| grid.index(point) == Some(index)));
        assert_eq!(grid.index(&OperatingPoint { temperature: None, ..points[0] }), None);
        assert_eq!(grid.index(&OperatingPoint { speed: 1.5, ..points[0] }), None);
    }
}
