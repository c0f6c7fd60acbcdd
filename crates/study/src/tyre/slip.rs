//! Forces over longitudinal slip and slip angle at loads, speeds and temperatures, as a table.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use asperity::patch::Patch;
use asperity::scene::FaceShape;
use asperity::table::{Cell, Column, Header, Table, TableError};
use asperity::tables::{Dimension, POSITIVE};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::rolling::{Motion, Roller, Rolling};
use crate::decimals::{percent, short, temperature_as_given};
use crate::error::{Error, ErrorKind};
use crate::files;
use crate::friction_law::FrictionLaw;
use crate::progress::Stop;
use crate::values::Values;

/// What the header of the table begins with.
const SLIP: (&str, u64) = ("asperity slip", 1);
/// What its columns are along.
const AXES: &str = "ISO 8855 and, the wheel upright, ISO-W (TYDEX W): x ahead, y to the left, z up; forces on the tyre";
/// The status of a point that is steady.
const STEADY: &str = "steady";
/// The speed of travel where none is given, m/s.
const SPEED: f64 = 10.0;
/// The largest slip that may be asked for.
const LARGEST_SLIP: f64 = 100.0;

// The points of slip curves. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Args)]
pub struct SlipOptions {
    /// Vertical loads in N, or with their unit, as a list or as a..b/n, n values evenly spaced in the logarithm.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Force),
        required_unless_present = "fit", required_if_eq("fit", "mf"))]
    #[serde(default)]
    pub loads: Option<Values>,
    /// Longitudinal slips κ, as a list or as a..b/n, n values evenly spaced: the rolling speed Ω R_e over that of travel ahead,
    /// less 1; R_e is found in free rolling.
    #[arg(long, value_name = "VALUES", value_parser = Values::signed(Dimension::Number), allow_hyphen_values = true)]
    #[serde(default)]
    pub slips: Option<Values>,
    /// Slip angles in rad, or with their unit, in the format of --slips: the angle of travel to the left of the wheel.
    #[arg(long, value_name = "VALUES", value_parser = Values::signed(Dimension::Angle), allow_hyphen_values = true)]
    #[serde(default)]
    pub angles: Option<Values>,
    /// Speeds of travel in m/s, in the format of --loads. Default: 10.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Speed))]
    #[serde(default)]
    pub speeds: Option<Values>,
    /// Temperatures in K, or with their unit, as a list or evenly spaced as a..b/n. Default: the patch's own.
    #[arg(long, value_name = "VALUES", value_parser = Values::of(Dimension::Temperature), allow_hyphen_values = true)]
    #[serde(default)]
    pub temperatures: Option<Values>,
    /// Each slip at each angle; else slips straight ahead, and angles in free rolling.
    #[arg(long, requires = "slips", requires = "angles")]
    #[serde(default)]
    pub combined: bool,
}

/// A model that is fitted to the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Fit {
    /// The Magic Formula of Pacejka, pure slip: B, C, D, E per load, and coefficients of MF 5.2 and 6.1
    Mf,
    /// The five numbers of a cylinder's friction, of the table of asperity sweep, also of a lip, in the place of a patch
    Stribeck,
    /// Those of LuGre that steady motion has, of the same tables
    Lugre,
}

impl Fit {
    /// Its law of friction, where it is one.
    pub fn friction_law(self) -> Option<FrictionLaw> {
        match self {
            Self::Mf => None,
            Self::Stribeck => Some(FrictionLaw::Stribeck),
            Self::Lugre => Some(FrictionLaw::LuGre),
        }
    }
}

/// What a wheel rolls under.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipConditions {
    /// K; `None` where nothing depends on it.
    pub temperature: Option<f64>,
    /// The speed of travel, m/s.
    pub speed: f64,
    /// The vertical load, N.
    pub load: f64,
}

/// A point of slip curves.
#[derive(Clone, Debug, PartialEq)]
pub struct SlipPoint {
    /// What the wheel rolls under.
    pub at: SlipConditions,
    /// The longitudinal slip κ.
    pub slip: f64,
    /// The slip angle, rad.
    pub angle: f64,
    /// The speed of the tread over that of travel in free rolling, straight ahead.
    pub free: Option<f64>,
    /// What it comes to; why it does not.
    pub rolling: Result<Rolling, String>,
}

/// Slip curves of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct SlipCurves {
    /// The patch's name.
    pub name: String,
    /// The radius of the tread, m; of a flat one there is none.
    pub radius: Option<f64>,
    /// The points by temperature, speed and load.
    pub points: Vec<SlipPoint>,
}

impl SlipOptions {
    fn loads(&self) -> &[f64] {
        self.loads.as_ref().map_or(&[], |loads| &loads.0)
    }

    fn speeds(&self) -> Vec<f64> {
        self.speeds.clone().map_or(vec![SPEED], |speeds| speeds.0)
    }

    /// Slips and angles, each pair once.
    fn slips(&self) -> Vec<(f64, f64)> {
        let values = |given: &Option<Values>| given.clone().unwrap_or_default().0;
        let (slips, angles) = (values(&self.slips), values(&self.angles));
        if self.combined {
            return angles.iter().flat_map(|&angle| slips.iter().map(move |&slip| (slip, angle))).collect();
        }
        let straight = slips.iter().map(|&slip| (slip, 0.0));
        let free = angles.iter().map(|&angle| (0.0, angle)).filter(|(_, angle)| *angle != 0.0 || !slips.contains(&0.0));
        straight.chain(free).collect()
    }

    /// Loads at speeds and temperatures.
    fn conditions(&self, patch: &Patch) -> Vec<SlipConditions> {
        let own = || vec![patch.has_temperatures().then(|| patch.temperature())];
        let temperatures =
            self.temperatures.as_ref().map_or_else(own, |Values(all)| all.iter().copied().map(Some).collect());
        let (speeds, mut all) = (self.speeds(), Vec::new());
        for temperature in temperatures {
            for &speed in &speeds {
                all.extend(self.loads().iter().map(|&load| SlipConditions { temperature, speed, load }));
            }
        }
        all
    }

    /// How many parts the work has: free rolling, and the points.
    pub fn parts(&self, patch: &Patch) -> usize {
        self.conditions(patch).len() * (1 + self.slips().len())
    }

    /// Refuses what a patch cannot do.
    fn check(&self, patch: &Patch) -> Result<(), Error> {
        if self.slips().is_empty() || self.loads().is_empty() {
            return Err(Error::value("expected `loads`, and `slips`, `angles` or both"));
        }
        let check = |name: &str, values: &[f64], is_in: fn(f64) -> bool, expected: &str| {
            let wrong = values.iter().find(|value| !is_in(**value));
            wrong.map_or(Ok(()), |value| Err(Error::value(format!("`{name}`: expected {expected}, found {value:?}"))))
        };
        let positive = |value: f64| POSITIVE.holds(value);
        check("loads", self.loads(), positive, "numbers above 0, in N")?;
        check("speeds", &self.speeds(), positive, "numbers above 0, in m/s")?;
        let slips = self.slips();
        let [slips, angles]: [Vec<f64>; 2] =
            [slips.iter().map(|pair| pair.0).collect(), slips.iter().map(|pair| pair.1).collect()];
        check("slips", &slips, |slip| slip.abs() <= LARGEST_SLIP, "numbers from -100 to 100")?;
        check("angles", &angles, |angle| angle.abs() < FRAC_PI_2, "angles within 90° to either side, in rad")?;
        let Some(Values(temperatures)) = &self.temperatures else { return Ok(()) };
        let table = &patch.table().grid.temperatures;
        let (Some(&low), Some(&high), true) = (table.first(), table.last(), patch.has_temperatures()) else {
            return Err(Error::value("`temperatures`: expected none, since the table of the patch has not several"));
        };
        match temperatures.iter().find(|kelvin| !(low..=high).contains(*kelvin)) {
            None => Ok(()),
            Some(kelvin) => Err(Error::value(format!(
                "`temperatures`: expected those of the table, {} to {}, found {}",
                temperature_as_given(low),
                temperature_as_given(high),
                temperature_as_given(*kelvin)
            ))),
        }
    }
}

impl SlipCurves {
    /// Rolls the tread of a patch at all points, telling `done` after each part.
    ///
    /// # Errors
    /// Where the patch has no tread, a value is out of range, or it is stopped. What fails at a point stands in its row.
    pub fn new(patch: &Patch, options: &SlipOptions, (stop, done): (&Stop, &(dyn Fn() + Sync))) -> Result<Self, Error> {
        let roller = Roller::new(patch, stop)?;
        options.check(patch)?;
        let slips = options.slips();
        let at = |at: SlipConditions| -> Result<Vec<SlipPoint>, Error> {
            let temperature = at.temperature.unwrap_or_else(|| patch.temperature());
            let free = told(roller.free(at.load, at.speed, temperature))?;
            done();
            let point = |&(slip, angle): &(f64, f64)| {
                let rolling = match &free {
                    Ok((ratio, height)) => {
                        let [x, y] = [at.speed * angle.cos(), at.speed * angle.sin()];
                        let transport_speed = (1.0 + slip) * ratio * x;
                        told(roller.at_load(
                            &Motion { velocity: [x, y], transport_speed, temperature },
                            at.load,
                            Some(*height),
                        ))?
                    }
                    Err(problem) => Err(format!("free rolling: {problem}")),
                };
                done();
                Ok(SlipPoint { at, slip, angle, free: free.as_ref().ok().map(|free| free.0), rolling })
            };
            slips.par_iter().map(point).collect()
        };
        let points = options.conditions(patch).into_par_iter().map(at).collect::<Result<Vec<_>, _>>()?.concat();
        let radius = match patch.shape() {
            FaceShape::Cylinder { radius, .. } => Some(*radius),
            _ => None,
        };
        Ok(Self { name: patch.name().to_owned(), radius, points })
    }

    /// The points at which rolling is steady.
    pub fn steady(&self) -> impl Iterator<Item = (&SlipPoint, &Rolling)> {
        self.points.iter().filter_map(|point| Some((point, point.rolling.as_ref().ok()?)))
    }

    /// How many points have no result, and why the first of them has none.
    pub fn failures(&self) -> Option<(usize, &str)> {
        let failed = || self.points.iter().filter_map(|point| point.rolling.as_ref().err());
        Some((failed().count(), failed().next()?))
    }

    /// What to look at: points of which much lies beyond the table.
    pub fn warnings(&self, patch: &Patch) -> Vec<String> {
        let mut warnings = Vec::new();
        let beyond = self.steady().map(|(_, rolling)| rolling.beyond).fold(0.0, f64::max);
        if beyond > MUCH {
            warnings.push(format!(
                "up to {} of the load is borne beyond the pressures of the table, where it goes on",
                percent(beyond, 2)
            ));
        }
        let slip = |(point, rolling): (&SlipPoint, &Rolling)| {
            let [x, y] = [point.at.speed * point.angle.cos(), point.at.speed * point.angle.sin()];
            (x - rolling.transport_speed).hypot(y)
        };
        let fastest = self.steady().map(slip).fold(0.0, f64::max);
        let largest = patch.table().grid.speeds.last().copied().unwrap_or(f64::INFINITY);
        if fastest > largest {
            warnings.push(format!(
                "slip reaches {} m/s, beyond the {largest} m/s of the table: friction is that of its end there",
                short(fastest, 3)
            ));
        }
        warnings
    }

    /// A row for each point; one without a result has a status that says why.
    pub fn table(&self) -> Table {
        let header = Header::new(SLIP).with("patch", &self.name).with("axes", AXES);
        let header = self.radius.map_or(header.clone(), |radius| header.with_number("radius", radius, "m"));
        let numbers = COLUMNS.iter().map(|column| Column::numbers(column.0, column.1));
        let mut table = Table::new(header, numbers.chain([Column::words("status", "")]));
        for point in &self.points {
            let status = point.rolling.as_ref().err().map_or(STEADY, String::as_str);
            let numbers = COLUMNS.iter().map(|column| Cell::from((column.2)(self, point)));
            table.push(numbers.chain([Cell::from(status)]));
        }
        table
    }

    /// Reads the curves of a table that was written.
    ///
    /// # Errors
    /// Where it cannot be read, or is no such table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let table = Table::parse(&files::text(path)?, path)?;
        table.header.check_kind(SLIP)?;
        let points = (0..table.len()).map(|row| point(&table, row)).collect::<Result<_, _>>()?;
        let radius = table.header.optional("radius", |header, key| header.number(key, "m"))?;
        Ok(Self { name: table.header.needed("patch")?.to_owned(), radius, points })
    }
}

/// A share of the load that is not small.
const MUCH: f64 = 0.05;

/// A column of numbers: its name, its unit, and what a point has of it.
type NumberColumn = (&'static str, &'static str, fn(&SlipCurves, &SlipPoint) -> Option<f64>);

const COLUMNS: [NumberColumn; 19] = [
    ("temperature", "K", |_, point| point.at.temperature),
    ("speed", "m/s", |_, point| Some(point.at.speed)),
    ("load", "N", |_, point| Some(point.at.load)),
    ("slip", "", |_, point| Some(point.slip)),
    ("slip_angle", "rad", |_, point| Some(point.angle)),
    ("F_x", "N", |_, point| of(point, |rolling| rolling.force[0])),
    ("F_y", "N", |_, point| of(point, |rolling| rolling.force[1])),
    ("F_z", "N", |_, point| of(point, |rolling| rolling.force[2])),
    ("M_z", "N m", |_, point| of(point, |rolling| rolling.moment_z)),
    ("friction", "", |_, point| of(point, Rolling::friction)),
    ("sliding", "", |_, point| of(point, |rolling| rolling.sliding)),
    ("P_diss", "W", |_, point| of(point, |rolling| rolling.power)),
    ("beyond", "", |_, point| of(point, |rolling| rolling.beyond)),
    ("contact_length", "m", |_, point| of(point, |rolling| rolling.contact_length)),
    ("temperature_largest", "K", |_, point| point.rolling.as_ref().ok()?.warmest),
    ("height", "m", |_, point| of(point, |rolling| rolling.height)),
    ("transport_speed", "m/s", |_, point| of(point, |rolling| rolling.transport_speed)),
    ("free_rolling", "", |_, point| point.free),
    ("effective_radius", "m", |curves, point| Some(curves.radius? / point.free?)),
];

fn of(point: &SlipPoint, number: fn(&Rolling) -> f64) -> Option<f64> {
    point.rolling.as_ref().ok().map(number)
}

/// The point in a row of a table.
fn point(table: &Table, row: usize) -> Result<SlipPoint, TableError> {
    let optional = |name: &str, unit: &str| table.number(row, name, unit);
    let number =
        |name: &str, unit: &str| optional(name, unit)?.ok_or_else(|| table.cell_error(row, name, unit, "a number"));
    let rolling = match table.word(row, "status", "")? {
        status if status == STEADY => Ok(Rolling {
            height: number("height", "m")?,
            transport_speed: number("transport_speed", "m/s")?,
            force: [number("F_x", "N")?, number("F_y", "N")?, number("F_z", "N")?],
            moment_z: number("M_z", "N m")?,
            sliding: number("sliding", "")?,
            power: number("P_diss", "W")?,
            beyond: number("beyond", "")?,
            contact_length: number("contact_length", "m")?,
            warmest: optional("temperature_largest", "K")?,
        }),
        status => Err(status),
    };
    let at = SlipConditions {
        temperature: optional("temperature", "K")?,
        speed: number("speed", "m/s")?,
        load: number("load", "N")?,
    };
    let (slip, angle, free) = (number("slip", "")?, number("slip_angle", "rad")?, optional("free_rolling", "")?);
    Ok(SlipPoint { at, slip, angle, free, rolling })
}

/// What a point comes to, or why it does not in words; where all is stopped, that.
fn told<T>(found: Result<T, Error>) -> Result<Result<T, String>, Error> {
    match found {
        Err(stopped) if stopped.kind() == ErrorKind::Stopped => Err(stopped),
        found => Ok(found.map_err(|problem| problem.to_string())),
    }
}
