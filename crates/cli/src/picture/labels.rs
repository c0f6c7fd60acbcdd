//! Where labels have room: beside points, and in the gaps of contour lines.

use asperity_study::picture::Point;

/// Left, top, right, bottom.
pub(super) type Bounds = [f64; 4];

/// Pieces of a line that labels avoid: each about as long as a symbol.
const PIECES: i32 = 24;

/// Finds places for labels so that none covers a line, a symbol or another label.
#[derive(Debug)]
pub(super) struct Room {
    area: Bounds,
    taken: Vec<Bounds>,
}

impl Room {
    pub(super) fn new(area: Bounds) -> Self {
        Self { area, taken: Vec::new() }
    }

    /// Keeps labels off a square.
    pub(super) fn take(&mut self, at: Point, radius: f64) {
        self.taken.push(around(at, [2.0 * radius; 2]));
    }

    /// Keeps labels off straight lines.
    pub(super) fn take_line(&mut self, points: &[Point]) {
        for ends in points.windows(2) {
            for i in 0..=PIECES {
                let part = f64::from(i) / f64::from(PIECES);
                self.take([0, 1].map(|axis| ends[0][axis] + part * (ends[1][axis] - ends[0][axis])), 1.0);
            }
        }
    }

    /// The middle of a label of `size` beside a symbol; `None` where there is no space.
    pub(super) fn beside(&mut self, [x, y]: Point, radius: f64, size: Point) -> Option<Point> {
        let [across, down] = size.map(|side| side / 2.0 + radius);
        let corners = [(1.0, -1.0), (-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(i, j)| [x + i * across, y + j * down]);
        let sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0)];
        let sides = sides.map(|(i, j)| [x + i * (across + radius), y + j * (down + radius)]);
        corners.into_iter().chain(sides).find(|&middle| self.takes(middle, size))
    }

    /// Where a label of `size` may stand on a line that is long enough for it: nearest to its middle.
    pub(super) fn along(&mut self, line: &[Point], size: Point) -> Option<Bounds> {
        const SHARES: [f64; 9] = [0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82];
        let steps = line.windows(2).scan(0.0, |sum, ends| {
            *sum += (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
            Some(*sum)
        });
        let lengths: Vec<f64> = std::iter::once(0.0).chain(steps).collect();
        let length = *lengths.last()?;
        let at = |share: f64| line[lengths.partition_point(|&along| along < share * length).min(line.len() - 1)];
        let shares = SHARES.into_iter().filter(|_| length >= 2.5 * size[0]);
        let middle = shares.map(at).find(|&middle| self.takes(middle, size))?;
        Some(around(middle, size))
    }

    /// Takes the space of a label, if it is free.
    fn takes(&mut self, middle: Point, size: Point) -> bool {
        let own @ [left, top, right, bottom] = around(middle, size);
        let [first, highest, last, lowest] = self.area;
        let is_inside = left >= first && top >= highest && right <= last && bottom <= lowest;
        let is_apart = |other: &Bounds| other[2] <= left || other[0] >= right || other[3] <= top || other[1] >= bottom;
        let is_free = is_inside && self.taken.iter().all(is_apart);
        self.taken.extend(is_free.then_some(own));
        is_free
    }
}

fn around([x, y]: Point, [width, height]: Point) -> Bounds {
    [x - width / 2.0, y - height / 2.0, x + width / 2.0, y + height / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_go_where_there_is_space() {
        let mut room = Room::new([0.0, 0.0, 200.0, 100.0]);
        room.take([50.0, 50.0], 5.0);
        // Above to the right; then, with that taken, elsewhere; never out of the area.
        let size = [40.0, 10.0];
        assert_eq!(room.beside([50.0, 50.0], 5.0, size), Some([75.0, 40.0]));
        assert_eq!(room.beside([50.0, 50.0], 5.0, size), Some([25.0, 40.0]));
        assert_eq!(room.beside([198.0, 2.0], 5.0, size), Some([173.0, 12.0]));
        assert_eq!(room.beside([50.0, 50.0], 5.0, [300.0, 10.0]), None);
    }

    #[test]
    fn no_label_lies_on_a_line() {
        let mut room = Room::new([0.0, 0.0, 200.0, 100.0]);
        room.take_line(&[[50.0, 50.0], [100.0, 0.0]]);
        assert_eq!(room.beside([50.0, 50.0], 5.0, [40.0, 10.0]), Some([25.0, 40.0]));
    }

    #[test]
    fn a_label_on_a_line_is_nearest_to_its_middle() {
        let mut room = Room::new([0.0, 0.0, 200.0, 100.0]);
        let line: Vec<Point> = (0..=100).map(|i| [2.0 * f64::from(i), 50.0]).collect();
        assert_eq!(room.along(&line, [20.0, 10.0]), Some([90.0, 45.0, 110.0, 55.0]));
        // With that taken, beside it: as near on the one side as on the other.
        assert_eq!(room.along(&line, [20.0, 10.0]), Some([58.0, 45.0, 78.0, 55.0]));
        assert_eq!(room.along(&line[..10], [20.0, 10.0]), None);
    }
}
