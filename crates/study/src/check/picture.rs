//! The pictures of what was checked: errors over speed, loops, wrenches.

use super::element::COMPARED;
use super::sliding::{COMPARED as COMPARED_OF_PATCHES, ElementErrors, Sliding};
use super::{COMPONENTS, Dragged, Loop, PatchCheck, PointChecks, Wrench, WrenchSeries};
use crate::decimals::real;
use crate::picture::{Ladders, Mark, Picture, Point, Stroke};

/// Panels side by side, with the marks of each line.
fn side_by_side(x: (&str, &str), panels: impl Iterator<Item = (String, Vec<[Mark; 2]>)>) -> Picture {
    let panel =
        |(title, lines): (String, Vec<[Mark; 2]>)| Ladders { title, marks: lines.concat(), ..Ladders::default() };
    Picture::of(vec![Picture::ladders(x, &panels.map(panel).collect::<Vec<_>>())])
}

impl PointChecks {
    /// Errors of points over speed, one line for each load.
    pub fn picture(&self) -> Picture {
        let mut loads: Vec<f64> = self.points.iter().map(|check| check.point.load).collect();
        loads.sort_by(f64::total_cmp);
        loads.dedup();
        let line = |(look, &of): (usize, &f64), i: usize| {
            let own = self.points.iter().filter(|check| check.point.load == of);
            let points = own.filter_map(|check| Some([check.point.speed, check.errors()?[i].abs()])).collect();
            Mark::marked(&format!("{of:.3e} {}", self.load.unit()), look, points)
        };
        let panel = |(i, name): (usize, &&str)| {
            (format!("error of {name}, as a share of it"), loads.iter().enumerate().map(|load| line(load, i)).collect())
        };
        side_by_side(("speed", "m/s"), COMPARED.iter().enumerate().map(panel))
    }
}

impl Loop {
    /// -F_x over u.
    pub fn picture(&self) -> Picture {
        let [layer, element] = self.friction().map(|rows| rows.into_iter().map(|(u, force)| [u, force]).collect());
        let curves = vec![Mark::line("layer", 0, layer), Mark::line("element", 1, element)];
        Picture::over(("u", "m"), vec![(("-F_x", "N"), curves)])
    }
}

impl Sliding<'_> {
    /// Errors of elements over their pressure, one line for each speed.
    pub fn errors_of_elements(&self) -> Picture {
        let speeds = self.errors();
        let panel = |(i, (name, _)): (usize, &(&str, usize))| {
            let line = |(look, ElementErrors { speed, errors }): (usize, &ElementErrors)| {
                let points = errors.iter().map(|(pressure, errors)| [*pressure, errors[i].abs()]).collect();
                Mark::marked(&format!("{} m/s", real(*speed)), look, points)
            };
            (format!("error of {name}, as a share of it"), speeds.iter().enumerate().map(line).collect())
        };
        side_by_side(("pressure", "Pa"), COMPARED_OF_PATCHES.iter().enumerate().map(panel))
    }
}

impl Dragged {
    /// The wrenches of layers and elements over time.
    pub fn picture(&self) -> Picture {
        let (times, pair) = self.rows();
        let points = |rows: &[Wrench], i: usize| -> Vec<Point> {
            times.iter().zip(rows).map(|(&time, row)| [time, row[i]]).collect()
        };
        let panel = |(i, &of): (usize, &(&'static str, &'static str))| {
            let layers = Mark::line("layers", 0, points(&pair.reference, i));
            (of, vec![layers, Mark::broken("elements", 1, points(&pair.other, i), Stroke::Dashed)])
        };
        Picture::over(("time", "s"), COMPONENTS.iter().enumerate().map(panel).collect())
    }
}

impl PatchCheck {
    /// Differences in steady sliding over the speed.
    pub fn differences(&self, pairs: &[(&str, &WrenchSeries)]) -> Picture {
        let shares: Vec<_> = pairs.iter().map(|(name, pair)| (*name, pair.shares())).collect();
        let panel = |(i, (component, _)): (usize, &(&str, &str))| {
            let line = |(look, (name, shares)): (usize, &(&str, Vec<Wrench>))| {
                Mark::marked(name, look, self.speeds().zip(shares).map(|(speed, share)| [speed, share[i]]).collect())
            };
            let title = format!("difference of {component}, as a share of the largest");
            (title, shares.iter().enumerate().map(line).collect())
        };
        side_by_side(("speed", "m/s"), COMPONENTS.iter().enumerate().map(panel))
    }
}
