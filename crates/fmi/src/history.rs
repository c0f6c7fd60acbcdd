//! The values that an input had: what its speed follows from, and what it goes through where it follows them late.

use serde::{Deserialize, Serialize};

use asperity::scene::is_possible;

/// The points that are kept between communication steps; one more is that of the step under way.
const POINTS: usize = 8;

/// The values of an input at the last points, the last one first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct History {
    points: [Point; POINTS + 1],
    count: usize,
}

/// A value that an input had.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Point {
    value: f64,
    /// How long ago, s.
    age: f64,
}

impl History {
    fn points(&self) -> &[Point] {
        self.points.get(..self.count).unwrap_or_default()
    }

    /// The last value, and how long ago that was, s.
    pub(super) fn last(&self) -> Option<(f64, f64)> {
        self.points().first().map(|point| (point.value, point.age))
    }

    /// The value before the last `span` (s), or the first one, and how long ago that was, s.
    pub(super) fn before(&self, span: f64) -> Option<(f64, f64)> {
        let points = self.points();
        points.iter().find(|point| point.age >= span).or(points.last()).map(|point| (point.value, point.age))
    }

    /// Adds the value that is there now. With an `interval` (s; 0 without) only new values count, and each has come over
    /// that time: before it the input was at rest.
    pub(super) fn push(&mut self, value: f64, interval: f64) {
        match self.last() {
            Some((last, _)) if interval > 0.0 && last == value => return,
            Some((last, age)) if interval > 0.0 && age > interval => self.insert(Point { value: last, age: interval }),
            _ => {}
        }
        self.insert(Point { value, age: 0.0 });
    }

    fn insert(&mut self, point: Point) {
        self.points.rotate_right(1);
        self.points[0] = point;
        self.count = (self.count + 1).min(self.points.len());
    }

    /// A time h (s) passes.
    pub(super) fn pass(&mut self, h: f64) {
        self.count = self.count.min(POINTS);
        self.points.iter_mut().for_each(|point| point.age += h);
    }

    /// The value so long ago (s), straight between the points; `None` without any.
    pub(super) fn at(&self, age: f64) -> Option<f64> {
        let points = self.points();
        let next = points.iter().position(|point| point.age >= age);
        Some(match next {
            Some(0) => points[0].value,
            Some(next) => {
                let (late, early) = (points[next - 1], points[next]);
                // Exact at both ends.
                let share = (early.age - age) / (early.age - late.age);
                early.value * (1.0 - share) + late.value * share
            }
            None => points.last()?.value,
        })
    }

    /// How long ago the values came, s.
    pub(super) fn ages(&self) -> impl Iterator<Item = f64> {
        self.points().iter().map(|point| point.age)
    }

    /// Whether its values are finite and in their order.
    pub(super) fn is_valid(&self) -> bool {
        let points = self.points();
        let possible = |point: &Point| is_possible(point.value) && is_possible(point.age) && point.age > 0.0;
        self.count <= POINTS && points.iter().all(possible) && points.windows(2).all(|pair| pair[0].age < pair[1].age)
    }
}

/// In which communication steps an input has new values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Cadence {
    /// Steps since the last new value.
    since: u32,
    /// Steps between the two before.
    apart: u32,
    /// How many times running they were so far apart.
    times: u32,
}

impl Cadence {
    /// A step begins, with a new value or the last one.
    pub(super) fn step(&mut self, is_new: bool) {
        if is_new {
            self.times = if self.since == self.apart { self.times.saturating_add(1) } else { 1 };
            (self.apart, self.since) = (self.since, 0);
        }
        self.since = self.since.saturating_add(1);
    }

    /// How many steps apart new values have come, three times running and in the last step; `None` where they come in
    /// every step, or unevenly.
    pub(super) fn regular(&self) -> Option<usize> {
        const TIMES: u32 = 3;
        (self.apart > 1 && self.since == 1 && self.times >= TIMES).then_some(self.apart as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_straight_through_the_points() {
        let mut history = History::default();
        assert_eq!(history.at(0.0), None);
        for value in [1.0, 3.0] {
            history.push(value, 0.0);
            history.pass(0.5);
        }
        assert_eq!([0.0, 0.5, 0.75, 1.0, 9.0].map(|age| history.at(age)), [3.0, 3.0, 2.0, 1.0, 1.0].map(Some));
        assert_eq!(
            (history.before(0.1), history.before(0.6), history.before(9.0)),
            (Some((3.0, 0.5)), Some((1.0, 1.0)), Some((1.0, 1.0)))
        );
        assert!(history.is_valid());
        (0..20).for_each(|i| {
            history.push(f64::from(i), 0.0);
            history.pass(1.0);
        });
        assert!(history.is_valid() && history.before(1e9) == Some((12.0, 8.0)));
    }

    /// What rests for long, and then has a new value, has gone there over the interval.
    #[test]
    fn new_values_have_come_over_the_interval() {
        let mut history = History::default();
        for value in [1.0, 1.0, 1.0, 2.0] {
            history.push(value, 0.5);
            history.pass(0.25);
        }
        assert_eq!([0.25, 0.5, 0.75, 1.0].map(|age| history.at(age)), [2.0, 1.5, 1.0, 1.0].map(Some));
    }

    #[test]
    fn values_that_come_at_every_other_step_are_seen() {
        let mut cadence = Cadence::default();
        let seen = [1, 0, 1, 0, 1, 0, 1].map(|new| {
            cadence.step(new == 1);
            cadence.regular()
        });
        assert_eq!(seen, [None, None, None, None, None, None, Some(2)]);
        (0..9).for_each(|_| cadence.step(true));
        assert_eq!(cadence.regular(), None);
    }
}
