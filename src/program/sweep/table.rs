//! The table of a sweep as text: a header of comments, the names of the columns, one line a point.

use asperity::scene::Scene;

use super::grid::{Grid, Point, Values};
use crate::program::result_file::real;

/// The header's first line; the number grows when a reader of the table has to know.
const FORMAT: &str = "# asperity sweep = 1";
/// The status of a point whose numbers can be relied on.
pub(crate) const STEADY: &str = "steady";

/// What presses the layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LoadKind {
    /// A mean pressure on the nominal area (m²).
    Pressure { area: f64 },
    /// F_z of the whole layer.
    Force,
}

impl LoadKind {
    /// F_z of a load, N.
    pub(super) fn force(self, load: f64) -> f64 {
        match self {
            Self::Pressure { area } => load * area,
            Self::Force => load,
        }
    }

    /// The load of a force (N).
    fn of_force(self, force: f64) -> f64 {
        match self {
            Self::Pressure { area } => force / area,
            Self::Force => force,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Pressure { .. } => "pressure",
            Self::Force => "force",
        }
    }

    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::Pressure { .. } => "Pa",
            Self::Force => "N",
        }
    }
}

/// What a table says before its rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) scene: String,
    pub(super) fingerprint: String,
    pub(super) load: LoadKind,
    /// m.
    pub(super) rest_separation: f64,
    pub(super) grid: Grid,
}

impl Header {
    /// The comments and the names of the columns.
    pub(super) fn text(&self) -> String {
        let mut lines = vec![
            FORMAT.to_owned(),
            format!("# scene = {}", self.scene.replace(['\n', '\r'], " ")),
            format!("# fingerprint = {}", self.fingerprint),
        ];
        if let LoadKind::Pressure { area } = self.load {
            lines.push(format!("# nominal_area = {} m2", real(area)));
        }
        lines.push(format!("# rest_separation = {} m", real(self.rest_separation)));
        lines.push(format!("# speeds = {} m/s", self.grid.speeds));
        lines.push(format!("# {}s = {} {}", self.load.name(), self.grid.loads, self.load.unit()));
        lines.extend(self.grid.temperatures.as_ref().map(|values| format!("# temperatures = {values} K")));
        lines.push(columns(self.load));
        lines.join("\n") + "\n"
    }
}

fn columns(load: LoadKind) -> String {
    let (name, unit) = (load.name(), load.unit());
    format!(
        "speed [m/s],{name} [{unit}],temperature [K],status,friction [1],friction_standard_error [1],friction_hysteresis [1],\
         friction_adhesion [1],mean_{name} [{unit}],contact_ratio [1],P_damper [W],P_maxwell [W],P_friction [W],P_impact [W],\
         separation [m],tangential_stiffness [N/m],w [m],runs [1],time [s]"
    )
}

/// Numbers of a row after its status.
const NUMBERS: usize = 15;
/// Fields of a row.
const FIELDS: usize = NUMBERS + 4;

/// What a point came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    /// [`STEADY`], or what is wrong.
    pub(super) status: String,
    /// Friction coefficient, its standard error, its parts.
    pub(super) friction: Option<[f64; 4]>,
    /// Mean F_z, N.
    pub(super) force: Option<f64>,
    /// Contact ratio.
    pub(super) contact: Option<f64>,
    /// In dampers, Maxwell elements, friction and impacts, W; none for a channel that the scene cannot have.
    pub(super) power: [Option<f64>; 4],
    /// N/m.
    pub(super) tangential_stiffness: Option<f64>,
    /// m.
    pub(super) w: Option<f64>,
    pub(super) runs: Option<u32>,
    /// s.
    pub(super) time: Option<f64>,
}

impl Row {
    /// The row's line, with its end.
    pub(super) fn line(&self, point: &Point, header: &Header) -> String {
        let friction = |i: usize| self.friction.map(|parts| parts[i]);
        let numbers = [
            friction(0),
            friction(1),
            friction(2),
            friction(3),
            self.force.map(|force| header.load.of_force(force)),
            self.contact,
            self.power[0],
            self.power[1],
            self.power[2],
            self.power[3],
            self.w.map(|w| header.rest_separation + w),
            self.tangential_stiffness,
            self.w,
            self.runs.map(f64::from),
            self.time,
        ];
        let first = [Some(point.speed), Some(point.load), point.temperature];
        let text = |number: &Option<f64>| number.map(real).unwrap_or_default();
        let fields = first.iter().map(text).chain([quoted(&self.status)]).chain(numbers.iter().map(text));
        fields.collect::<Vec<_>>().join(",") + "\n"
    }
}

/// The text as one field of one line.
fn quoted(text: &str) -> String {
    let text = text.replace(['\n', '\r'], " ");
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

/// A line of a table that has been read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) point: Point,
    pub(super) status: String,
    /// Friction coefficient and its parts, where they are given.
    pub(super) friction: Option<[f64; 3]>,
    /// As it stands in the file, with its end: a table that is taken up again keeps it to the letter.
    pub(super) text: String,
}

impl Line {
    /// Reads a whole line; `None` where it is none.
    pub(super) fn read(text: &str) -> Option<Self> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        let record = reader.records().next()?.ok().filter(|record| record.len() == FIELDS)?;
        let number = |i: usize| record[i].parse::<f64>().ok();
        let temperature = if record[2].is_empty() { None } else { Some(number(2)?) };
        Some(Self {
            point: Point { speed: number(0)?, load: number(1)?, temperature },
            status: record[3].to_owned(),
            friction: number(4).and_then(|all| Some([all, number(6)?, number(7)?])),
            text: text.to_owned(),
        })
    }

    pub(super) fn is_steady(&self) -> bool {
        self.status == STEADY
    }
}

/// A table read from a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    pub(super) header: Header,
    pub(super) lines: Vec<Line>,
}

/// Why a text is no table: the line, from 1, and what was expected there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unreadable {
    pub(super) line: usize,
    pub(super) expected: String,
}

impl Table {
    /// Reads a table. What follows the last end of a line is a line that was being written as its writer was stopped.
    pub(super) fn read(text: &str) -> Result<Self, Unreadable> {
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let lines: Vec<&str> = whole.split_inclusive('\n').collect();
        let (header, first) = read_header(&lines)?;
        let read = |(i, line): (usize, &&str)| {
            Line::read(line).ok_or(Unreadable { line: first + i + 1, expected: format!("{FIELDS} fields of a point") })
        };
        let lines = lines[first..].iter().enumerate().map(read).collect::<Result<_, _>>()?;
        Ok(Self { header, lines })
    }
}

/// The header and the number of its lines.
fn read_header(lines: &[&str]) -> Result<(Header, usize), Unreadable> {
    let wrong = |line: usize, expected: &str| Unreadable { line, expected: expected.to_owned() };
    if lines.first().is_none_or(|line| line.trim_end() != FORMAT) {
        return Err(wrong(1, FORMAT));
    }
    let comments = lines.iter().take_while(|line| line.starts_with('#')).count();
    let value = |key: &str| {
        let start = format!("# {key} = ");
        let found = lines[..comments].iter().find_map(|line| line.strip_prefix(start.as_str()));
        found.map(str::trim_end).ok_or_else(|| wrong(comments + 1, &format!("{start}…")))
    };
    let number = |key: &str| {
        let text = value(key)?.split(' ').next().unwrap_or_default();
        text.parse::<f64>().map_err(|_| wrong(comments, &format!("a number for {key}")))
    };
    let values = |key: &str| {
        let text = value(key)?.split(' ').next().unwrap_or_default();
        Values::in_value(text).map_err(|_| wrong(comments, &format!("numbers for {key}")))
    };
    let load = match number("nominal_area") {
        Ok(area) => LoadKind::Pressure { area },
        Err(_) => LoadKind::Force,
    };
    if lines.get(comments).is_none_or(|line| line.trim_end() != columns(load)) {
        return Err(wrong(comments + 1, "the names of the columns"));
    }
    let grid = Grid {
        speeds: values("speeds")?,
        loads: values(&format!("{}s", load.name()))?,
        temperatures: value("temperatures").is_ok().then(|| values("temperatures")).transpose()?,
    };
    let (scene, fingerprint) = (value("scene")?.to_owned(), value("fingerprint")?.to_owned());
    Ok((Header { scene, fingerprint, load, rest_separation: number("rest_separation")?, grid }, comments + 1))
}

/// What tells one sweep from another: everything of the scene that its points depend on, and the settings.
pub(super) fn fingerprint(scene: &Scene, settings: &str) -> Result<String, serde_json::Error> {
    let text = format!("{FORMAT}\n{}\n{settings}\n{}", env!("CARGO_PKG_VERSION"), serde_json::to_string(scene)?);
    Ok(uuid::Uuid::new_v5(&uuid::Uuid::NAMESPACE_OID, text.as_bytes()).simple().to_string())
}
