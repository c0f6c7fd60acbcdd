//! A run of a seal as a picture: friction over the stroke, leak over time, film and pressures over the width of the lip.

use asperity::seal::{Seal, SealOutput, SealRun};

use crate::decimals::with_prefix;
use crate::picture::{Axis, Fit, Mark, Panel, Picture, ys};
use crate::time_history::ends_of_parts;

/// Instants at which the film is drawn.
const INSTANTS: usize = 4;

/// A run of a seal, collected row by row.
#[derive(Debug)]
pub struct SealHistory {
    title: String,
    /// The width of the lip, m.
    width: f64,
    /// The indices of the rows whose film is drawn.
    drawn: Vec<usize>,
    /// t (s), u (m), F_x (N), film.leak (mm³).
    rows: Vec<[f64; 4]>,
    films: Vec<Moment>,
    /// The moment of the largest friction so far.
    largest: Option<Moment>,
}

/// The film at an instant, by cells.
#[derive(Debug)]
struct Moment {
    /// s.
    time: f64,
    /// |F_x|, N.
    force: f64,
    /// Contents, m.
    contents: Vec<f64>,
    /// The pressure of the fluid, Pa.
    fluid: Vec<f64>,
    /// The pressure that contacts bear, Pa.
    contact: Vec<f64>,
}

impl Moment {
    fn new(run: &SealRun, force: f64) -> Self {
        let cells = run.contents().len();
        let of_cells = |output: fn(usize) -> SealOutput| (0..cells).map(|i| run.value(output(i))).collect();
        Self {
            time: run.time(),
            force,
            contents: run.contents().to_vec(),
            fluid: of_cells(SealOutput::Pressure),
            contact: of_cells(SealOutput::Contact),
        }
    }
}

impl SealHistory {
    /// For a run with rows at `times` (s).
    pub fn new(seal: &Seal, times: &[f64]) -> Self {
        Self {
            title: seal.name().to_owned(),
            width: seal.width(),
            drawn: ends_of_parts(times, INSTANTS),
            rows: Vec::new(),
            films: Vec::new(),
            largest: None,
        }
    }

    /// Adds the present row of the run.
    pub fn add(&mut self, run: &SealRun) {
        let (force, leak) = (run.value(SealOutput::ForceX), run.value(SealOutput::Leak));
        if self.largest.as_ref().is_none_or(|largest| force.abs() > largest.force) {
            self.largest = Some(Moment::new(run, force.abs()));
        }
        if self.drawn.contains(&self.rows.len()) {
            self.films.push(Moment::new(run, force.abs()));
        }
        self.rows.push([run.time(), run.inputs()[0], force, 1e9 * leak]);
    }

    /// Friction over the stroke and leak over time; below them film and pressures over the width.
    pub fn picture(&self) -> Picture {
        let column = |i: usize| self.rows.iter().map(move |row| row[i]);
        let pairs = |x: usize, y: usize| column(x).zip(column(y)).map(|(x, y)| [x, y]).collect();
        let curve = |x: (&str, &str, usize), y: (&str, &str, usize)| {
            let marks = vec![Mark::line("", 0, pairs(x.2, y.2))];
            let along = Axis::linear((x.0, x.1), column(x.2), Fit::Tight);
            Panel::new(along, Axis::linear((y.0, y.1), ys(&marks), Fit::Round), marks).sized(894.0, 264.0)
        };
        let (stroke, leak) = (("u", "m", 1), ("net leak to the air", "mm³", 3));
        let over_time = [curve(stroke, ("force on the rod", "N", 2)), curve(("time", "s", 0), leak)];
        let films = self.largest.iter().map(|largest| self.pressures(largest));
        let panels = over_time.into_iter().chain([self.contents()]).chain(films);
        Picture::of(panels.map(Into::into).collect()).titled(&self.title)
    }

    /// Values of the cells over the width.
    fn over_width(&self, values: &[f64]) -> Vec<[f64; 2]> {
        let cell = self.width / values.len() as f64;
        values.iter().enumerate().map(|(i, &value)| [(i as f64 + 0.5) * cell, value]).collect()
    }

    fn panel(&self, of: (&str, &str), marks: Vec<Mark>) -> Panel {
        let x = Axis::linear(("x from the sealed side", "m"), [0.0, self.width], Fit::Tight);
        let y = Axis::linear(of, ys(&marks), Fit::Round);
        Panel::new(x, y, marks).sized(894.0, 264.0)
    }

    fn contents(&self) -> Panel {
        let last = self.films.last().map_or(0.0, |film| film.time);
        let line = |(look, film): (usize, &Moment)| {
            Mark::line(with_prefix(film.time, last, "s"), look, self.over_width(&film.contents))
        };
        self.panel(("film", "m"), self.films.iter().enumerate().map(line).collect())
    }

    fn pressures(&self, moment: &Moment) -> Panel {
        let total: Vec<f64> =
            moment.fluid.iter().zip(&moment.contact).map(|(fluid, contact)| fluid + contact).collect();
        let at = with_prefix(moment.time, moment.time, "s");
        let lines = [("of the fluid", &moment.fluid), ("of contacts", &moment.contact), ("total", &total)];
        let marks = lines.into_iter().enumerate();
        let marks = marks.map(|(look, (name, values))| Mark::line(name, look, self.over_width(values))).collect();
        Panel { title: format!("At {at}, when friction is largest"), ..self.panel(("pressure", "Pa"), marks) }
    }
}
