//! Labels beside markers, where there is room: none lies on a line, a marker or another label.

/// A rectangle in pixels: left, top, right, bottom.
type Rectangle = [i32; 4];

/// What is drawn already, and where something may be.
#[derive(Debug)]
pub(super) struct Labels {
    area: Rectangle,
    taken: Vec<Rectangle>,
}

/// Pieces of a line that count as taken: about as long as a marker.
const PIECES: i32 = 24;

impl Labels {
    /// Labels in an area where nothing is drawn yet.
    pub(super) fn new(area: Rectangle) -> Self {
        Self { area, taken: Vec::new() }
    }

    /// Takes the place of a marker of some radius.
    pub(super) fn take_marker(&mut self, (x, y): (i32, i32), radius: i32) {
        self.taken.push([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Takes the places along a straight line.
    pub(super) fn take_line(&mut self, from: (i32, i32), to: (i32, i32)) {
        for i in 0..=PIECES {
            let between = |a: i32, b: i32| a + (b - a) * i / PIECES;
            self.take_marker((between(from.0, to.0), between(from.1, to.1)), 1);
        }
    }

    /// The upper left corner of a label of `size` beside the marker at `(x, y)`; `None` where there is no room.
    pub(super) fn place(&mut self, (x, y): (i32, i32), radius: i32, size: (i32, i32)) -> Option<(i32, i32)> {
        let (width, height) = size;
        let [right, left] = [x + radius, x - radius - width];
        let [above, below] = [y - radius - height, y + radius];
        let middle = (x - width / 2, y - height / 2);
        let corners = [
            (right, above),
            (left, above),
            (right, below),
            (left, below),
            (right + radius, middle.1),
            (left - radius, middle.1),
            (middle.0, above - radius),
            (middle.0, below + radius),
        ];
        let corner = corners.into_iter().find(|&corner| self.is_free(corner, size))?;
        self.taken.push(rectangle(corner, size));
        Some(corner)
    }

    fn is_free(&self, corner: (i32, i32), size: (i32, i32)) -> bool {
        let [left, top, right, bottom] = rectangle(corner, size);
        let [area_left, area_top, area_right, area_bottom] = self.area;
        let inside = left >= area_left && top >= area_top && right <= area_right && bottom <= area_bottom;
        let apart = |other: &Rectangle| other[2] <= left || other[0] >= right || other[3] <= top || other[1] >= bottom;
        inside && self.taken.iter().all(apart)
    }
}

fn rectangle((x, y): (i32, i32), (width, height): (i32, i32)) -> Rectangle {
    [x, y, x + width, y + height]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_go_where_there_is_room() {
        let mut labels = Labels::new([0, 0, 200, 100]);
        labels.take_marker((50, 50), 5);
        // Above to the right; then, with that taken, elsewhere; never out of the area.
        assert_eq!(labels.place((50, 50), 5, (40, 10)), Some((55, 35)));
        assert_eq!(labels.place((50, 50), 5, (40, 10)), Some((5, 35)));
        assert_eq!(labels.place((198, 2), 5, (40, 10)), Some((153, 7)));
        assert_eq!(labels.place((50, 50), 5, (300, 10)), None);
    }

    #[test]
    fn no_label_lies_on_a_line() {
        let mut labels = Labels::new([0, 0, 200, 100]);
        labels.take_line((50, 50), (100, 0));
        assert_eq!(labels.place((50, 50), 5, (40, 10)), Some((5, 35)));
    }
}
