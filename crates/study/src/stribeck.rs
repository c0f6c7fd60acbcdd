//! The Stribeck curve of a seal: friction, film and leak in steady motion over speed, sealed pressure and temperature, to the
//! air and back.

use asperity::seal::{FilmError, Seal, SealMotion, SealOutput, SealRun, SealStart};
use asperity::table::{Cell, Column, Header, Table};
use asperity::tables::{Dimension, FINITE, NOT_NEGATIVE, NumberRange, POSITIVE};
use clap::Args;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::decimals::short;
use crate::error::Error;
use crate::picture::{Axis, Fit, Mark, Panel, Picture, Row, Stroke, xs, ys};
use crate::progress::{Stop, Stopped};
use crate::values::Values;

/// What the header of the table begins with.
pub(crate) const STRIBECK: (&str, u64) = ("asperity stribeck", 1);

/// A run goes on by this part of the lip's width until its force changes by no more than [`STEADY`] over one of them, and at
/// most for so many of them: what the outstroke lays is as long. Where little comes back it gathers before the lip for some
/// forty of them.
const WIDTH: f64 = 1.0;
const STEADY: f64 = 1e-4;
const MOST_WIDTHS: usize = 60;
/// Rows of a width.
const ROWS: u32 = 4;

// The points of a Stribeck curve. Not a doc comment: that would be the description of the commands that have it.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Args)]
#[serde(default)]
pub struct StribeckOptions {
    /// Of a seal, sealed pressures in Pa, in the format of --speeds. Default: the first one of its sets of pressures.
    #[arg(long, value_name = "VALUES", value_parser = Values::from_zero(Dimension::Pressure), requires = "seal")]
    pub sealed: Option<Values>,
}

/// The directions of the rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the air.
    Out,
    /// To the sealed side, with the film that the outstroke left where that returns.
    In,
}

impl Direction {
    fn word(self) -> &'static str {
        match self {
            Self::Out => "out",
            Self::In => "in",
        }
    }

    fn sign(self) -> f64 {
        match self {
            Self::Out => 1.0,
            Self::In => -1.0,
        }
    }
}

/// A point of the curve: what is given, and both strokes.
#[derive(Clone, Debug)]
pub struct StribeckPoint {
    /// K; `None` where nothing depends on it.
    pub temperature: Option<f64>,
    /// Pa.
    pub sealed: f64,
    /// m/s.
    pub speed: f64,
    /// ηV, N/m.
    pub viscous: f64,
    /// What the strokes come to; why they do not.
    pub strokes: Result<[StrokeFigures; 2], String>,
}

/// A stroke in steady motion.
#[derive(Clone, Copy, Debug)]
pub struct StrokeFigures {
    direction: Direction,
    /// |F_x|, N.
    pub force: f64,
    /// |F_x| over the load.
    pub friction: f64,
    /// Mean content, weighted with the total pressure, m.
    pub thickness: f64,
    /// Share of the load that contacts bear.
    pub share: f64,
    /// Flow to the air, m³/s.
    pub leak_rate: f64,
    /// Whether the force no longer changes.
    pub is_steady: bool,
}

/// The curve of a seal.
#[derive(Clone, Debug)]
pub struct Stribeck {
    name: String,
    /// The points by temperature, sealed pressure and speed.
    pub points: Vec<StribeckPoint>,
}

impl Stribeck {
    /// Computes the curve of a seal over speeds (m/s), by default those of its table, at sealed pressures and temperatures.
    /// The lip is rigid along the motion: in steady motion a spring changes nothing.
    ///
    /// # Errors
    /// Where a value is out of range, or the seal has no temperature to change.
    pub fn new(
        seal: &Seal,
        speeds: Option<&Values>,
        temperatures: Option<&Values>,
        options: &StribeckOptions,
        (stop, done): (&Stop, &(dyn Fn() + Sync)),
    ) -> Result<Self, Error> {
        if temperatures.is_some() && !seal.has_temperatures() {
            return Err(Error::value(
                "`temperatures`: expected none, since neither the table nor the viscosity of the seal has several",
            ));
        }
        let given = |name: &str, values: Option<&Values>, range: NumberRange| match values {
            Some(Values(values)) => match values.iter().find(|value| !range.holds(**value)) {
                Some(value) => Err(Error::value(format!("`{name}`: expected {range}, found {value:?}"))),
                None => Ok(Some(values.clone())),
            },
            None => Ok(None),
        };
        let speeds = given("speeds", speeds, POSITIVE)?.unwrap_or_else(|| seal.table().grid.speeds.clone());
        let sealed = given("sealed", options.sealed.as_ref(), NOT_NEGATIVE)?.unwrap_or(vec![seal.sealed_pressure()]);
        let temperatures = match given("temperatures", temperatures, FINITE)? {
            Some(values) => values.into_iter().map(Some).collect(),
            None => vec![seal.has_temperatures().then(|| seal.temperature())],
        };
        let rigid = seal.rigid();
        let at = |(temperature, sealed, speed): (Option<f64>, f64, f64)| {
            if stop.go_on().is_break() {
                return Err(Error::from(Stopped));
            }
            let kelvin = temperature.unwrap_or_else(|| seal.temperature());
            let strokes = strokes(&rigid, kelvin, sealed, speed);
            done();
            Ok(StribeckPoint { temperature, sealed, speed, viscous: seal.file().viscosity.at(kelvin) * speed, strokes })
        };
        let places: Vec<(Option<f64>, f64, f64)> = temperatures
            .iter()
            .flat_map(|&temperature| sealed.iter().map(move |&sealed| (temperature, sealed)))
            .flat_map(|(temperature, sealed)| speeds.iter().map(move |&speed| (temperature, sealed, speed)))
            .collect();
        let points = places.into_par_iter().map(at).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { name: seal.name().to_owned(), points })
    }

    /// How many points a curve has.
    pub fn count(
        seal: &Seal,
        speeds: Option<&Values>,
        temperatures: Option<&Values>,
        options: &StribeckOptions,
    ) -> usize {
        let count = |values: Option<&Values>, own: usize| values.map_or(own, |values| values.0.len());
        count(speeds, seal.table().grid.speeds.len()) * count(options.sealed.as_ref(), 1) * count(temperatures, 1)
    }

    fn has_temperatures(&self) -> bool {
        self.points.iter().any(|point| point.temperature.is_some())
    }

    /// A row for each point and stroke.
    pub fn table(&self) -> Table {
        let mut columns: Vec<Column> =
            self.has_temperatures().then(|| Column::numbers("temperature", "K")).into_iter().collect();
        let numbers = [
            ("sealed_pressure", "Pa"),
            ("speed", "m/s"),
            ("viscosity_speed", "N/m"),
            ("F_x", "N"),
            ("friction", ""),
            ("thickness", "m"),
            ("contact_share", ""),
            ("leak_rate", "m3/s"),
            ("net_leak", "m2"),
        ];
        columns.extend(numbers.map(|(name, unit)| Column::numbers(name, unit)));
        columns.extend(["stroke", "status"].map(|name| Column::words(name, "")));
        let mut table = Table::new(Header::new(STRIBECK).with("seal", &self.name), columns);
        for point in &self.points {
            for (i, stroke) in [Direction::Out, Direction::In].into_iter().enumerate() {
                table.push(point.cells(i, stroke));
            }
        }
        table
    }

    /// Friction over ηV, with the film and the share that contacts bear below: a colour for each temperature and sealed
    /// pressure, instrokes broken.
    pub fn picture(&self) -> Picture {
        let mut groups: Vec<(Option<f64>, f64)> = Vec::new();
        for point in &self.points {
            if !groups.contains(&(point.temperature, point.sealed)) {
                groups.push((point.temperature, point.sealed));
            }
        }
        let marks = |of: fn(&StrokeFigures) -> f64| -> Vec<Mark> {
            let curve = |look: usize, group: (Option<f64>, f64), i: usize| {
                let of_group = self.points.iter().filter(|point| (point.temperature, point.sealed) == group);
                let strokes = of_group.filter_map(|point| Some((point.viscous, point.strokes.as_ref().ok()?)));
                let points = strokes.map(|(viscous, strokes)| [viscous, of(&strokes[i])]).collect();
                let direction = [Direction::Out, Direction::In][i];
                let stroke = if direction == Direction::Out { Stroke::Solid } else { Stroke::Dashed };
                Mark::broken(format!("{}, {}", group_name(group), direction.word()), look, points, stroke)
            };
            groups.iter().enumerate().flat_map(|(look, &group)| [0, 1].map(|i| curve(look, group, i))).collect()
        };
        let [friction, film, share] = [
            marks(|figures| figures.friction),
            marks(|figures| 1e6 * figures.thickness),
            marks(|figures| figures.share),
        ];
        let x = Axis::logarithmic(("viscosity times speed", "N/m"), xs(&friction));
        let y = [
            Axis::linear(("friction coefficient", ""), ys(&friction).chain([0.0]), Fit::Round),
            Axis::logarithmic(("film", "µm"), ys(&film)),
            Axis::linear(("load on contacts", ""), [0.0, 1.0], Fit::Tight),
        ];
        let panels = y.into_iter().zip([friction, film, share]);
        let panel = |(y, marks): (Axis, Vec<Mark>)| Row::from(Panel::new(x.clone(), y, marks).sized(794.0, 292.0));
        Picture::of(panels.map(panel).collect()).titled(&self.name)
    }

    /// How many points have no result, and how many are not steady.
    pub fn failures(&self) -> [usize; 2] {
        let failed = self.points.iter().filter(|point| point.strokes.is_err()).count();
        let unsteady = self.points.iter().flat_map(|point| point.strokes.iter().flatten()).filter(|one| !one.is_steady);
        [failed, unsteady.count()]
    }
}

impl StribeckPoint {
    /// The net leak of a stroke out and in over its length, m³/m.
    pub fn net_leak(&self) -> Option<f64> {
        let [out, back] = self.strokes.as_ref().ok()?;
        Some((out.leak_rate + back.leak_rate) / self.speed)
    }

    fn cells(&self, i: usize, direction: Direction) -> Vec<Cell> {
        let figures = self.strokes.as_ref().ok().map(|strokes| strokes[i]);
        let status = match &self.strokes {
            Ok(strokes) if strokes[i].is_steady => "steady".to_owned(),
            Ok(_) => "not steady".to_owned(),
            Err(problem) => problem.clone(),
        };
        let number = |of: fn(&StrokeFigures) -> f64| Cell::from(figures.as_ref().map(of));
        let mut cells: Vec<Cell> = self.temperature.map(Cell::from).into_iter().collect();
        cells.extend([Cell::from(self.sealed), Cell::from(self.speed), Cell::from(self.viscous)]);
        cells.extend([
            number(|figures| -figures.direction.sign() * figures.force),
            number(|figures| figures.friction),
            number(|figures| figures.thickness),
            number(|figures| figures.share),
            number(|figures| figures.leak_rate),
        ]);
        cells.extend([Cell::from(self.net_leak()), Cell::from(direction.word()), Cell::from(status)]);
        cells
    }
}

fn group_name((temperature, sealed): (Option<f64>, f64)) -> String {
    let pressure = format!("{} MPa", short(1e-6 * sealed, 3));
    temperature.map_or(pressure.clone(), |kelvin| format!("{} °C, {pressure}", short(kelvin - 273.15, 4)))
}

/// Both strokes of a rigid seal at a speed (m/s), until they are steady.
fn strokes(seal: &Seal, temperature: f64, sealed: f64, speed: f64) -> Result<[StrokeFigures; 2], String> {
    let start = SealStart { sealed_pressure: sealed, temperature, ..SealStart::default() };
    let told = |error: FilmError| error.to_string();
    let mut run = SealRun::new(seal, &start).map_err(told)?;
    let out = follow(&mut run, seal, (Direction::Out, speed, temperature), MOST_WIDTHS).map_err(told)?;
    // The film that comes back first is the steady one.
    move_on(&mut run, seal, (Direction::Out, speed, temperature), MOST_WIDTHS as f64 * WIDTH).map_err(told)?;
    let back = follow(&mut run, seal, (Direction::In, speed, temperature), MOST_WIDTHS).map_err(told)?;
    Ok([out, back])
}

/// Moves the rod until its force is steady, at most by so many parts of the width.
fn follow(
    run: &mut SealRun,
    seal: &Seal,
    (direction, speed, temperature): (Direction, f64, f64),
    most: usize,
) -> Result<StrokeFigures, FilmError> {
    let (mut before, mut passed, mut is_steady) = (f64::NAN, 0, false);
    while passed < most && !is_steady {
        move_on(run, seal, (direction, speed, temperature), WIDTH)?;
        passed += 1;
        let force = run.force().abs();
        is_steady = (force - before).abs() <= STEADY * force;
        before = force;
    }
    let force = run.force().abs();
    let figures = StrokeFigures {
        direction,
        force,
        friction: force / run.load().max(f64::MIN_POSITIVE),
        thickness: run.value(SealOutput::Thickness),
        share: run.value(SealOutput::ContactShare),
        leak_rate: run.leak_rate(),
        is_steady,
    };
    Ok(figures)
}

/// Moves the rod on by some widths of the lip.
fn move_on(
    run: &mut SealRun,
    seal: &Seal,
    (direction, speed, temperature): (Direction, f64, f64),
    widths: f64,
) -> Result<(), FilmError> {
    let rows = (widths * f64::from(ROWS)).ceil();
    let duration = widths * seal.width() / speed / rows;
    let motion = SealMotion { duration, u_rate: direction.sign() * speed, temperature, ..SealMotion::default() };
    (0..rows as u32).try_for_each(|_| run.advance(&motion))
}
