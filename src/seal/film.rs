//! The film over the width of a lip: the equation of the fluid's content, its fluxes and their derivatives, by finite
//! volumes (docs/seal.md).
//!
//! From the sealed side, x = 0, to the air, x = b, with the rod moving at V and the content m(x, t), the fluid's volume per
//! area,
//!
//!   ∂m/∂t + ∂/∂x [ V c(u) m/u - (h_l(u)³/12η) (m/u) ∂p_f/∂x ] = 0,     u = max(m, u_c(p_0)).
//!
//! Where there is fluid enough, m ≥ u_c, it bears what contacts do not, p_f = p_0 - p_c(u); elsewhere contacts bear all, and
//! the gap is partly empty. What crosses a face between two cells is that of the cell upstream, with van Leer's limited
//! slope (J. Comput. Phys. 32, 1979): upstream by V for the part carried, by the gradient of the pressure for the other.

use super::law::{GapLaw, GapPoint, Slope};

/// What is beyond the ends of the lip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ends {
    /// The sealed pressure, Pa.
    pub(super) sealed: f64,
    /// The flooded gap before the sealed side, m.
    pub(super) supply: f64,
    /// The flow that a rod carries in from the air, over its speed, m.
    pub(super) carried_in: f64,
}

/// A cell's content and what follows from it, with the derivative by the content.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    /// The mean gap, m, and the interval of the law in which it lies.
    gap: f64,
    interval: usize,
    /// The fluid's pressure p_f, Pa, and Pa/m.
    pressure: [f64; 2],
    /// What the rod carries over its speed, c m/u, m, and 1.
    carried: [f64; 2],
    /// The flow over the gradient of pressure, h_l³/(12η) m/u, m³/(Pa s), and its derivative, m²/(Pa s).
    mobility: [f64; 2],
}

/// What a face between two cells takes of the cell upstream: its value and the derivatives by the contents of the cell
/// behind that, of itself, of the one downstream.
struct FaceValue {
    value: f64,
    slopes: [f64; 3],
}

/// A mean gap (m) below which a full contact closes: what it bears goes straight from that of the law to the total pressure.
/// Contents below it count as it in errors. Over a tenth of it the limit would fall faster than a stiff lip's spring.
const CLOSED: f64 = 1e-9;

/// The number of bands of the matrix.
pub(super) const BANDS: usize = 5;

/// The film of a lip on cells of equal width.
#[derive(Clone, Debug)]
pub(super) struct Film {
    /// The width of a cell, m.
    width: f64,
    viscosity: f64,
    /// Whether the rough side is that of the rod.
    moving: bool,
    /// The total pressure in each cell, Pa, the gap at which contacts bear it, m, and by how much it is above what they bear by
    /// the law where that is 0, Pa.
    pub(super) totals: Vec<f64>,
    bearing: Vec<f64>,
    closing: Vec<f64>,
    /// The friction coefficient of contacts that bear all of it.
    frictions: Vec<f64>,
    cells: Vec<Cell>,
    /// What flows through the faces to the air, by length along the lip, m²/s, from that of the sealed side.
    pub(super) flows: Vec<f64>,
    /// The derivative of each flow by the speed, m.
    by_speed: Vec<f64>,
    /// The derivatives of each flow by the contents of the two cells before the face and the two behind it.
    slopes: Vec<[f64; 4]>,
}

impl Film {
    pub(super) fn new(count: usize, width: f64, moving: bool) -> Self {
        Self {
            width,
            viscosity: 1.0,
            moving,
            totals: vec![0.0; count],
            bearing: vec![0.0; count],
            closing: vec![0.0; count],
            frictions: vec![0.0; count],
            cells: vec![Cell::default(); count],
            flows: vec![0.0; count + 1],
            by_speed: vec![0.0; count + 1],
            slopes: vec![[0.0; 4]; count + 1],
        }
    }

    /// The width of a cell, m.
    pub(super) fn width(&self) -> f64 {
        self.width
    }

    /// Sets the fluid's viscosity, Pa s.
    pub(super) fn set_viscosity(&mut self, viscosity: f64) {
        self.viscosity = viscosity;
    }

    /// Sets the total pressure on each cell, Pa.
    pub(super) fn set_totals(&mut self, law: &GapLaw, total: impl Fn(usize) -> f64) {
        let largest = law.at(0.0, 0).pressure.value;
        for i in 0..self.totals.len() {
            let total = total(i);
            (self.totals[i], self.bearing[i]) = (total, law.gap_at(total));
            self.frictions[i] = law.friction_at(total);
            self.closing[i] = if self.bearing[i] > 0.0 { 0.0 } else { (total - largest).max(0.0) };
        }
    }

    /// The gaps at which contacts bear all, m.
    pub(super) fn bearing(&self) -> &[f64] {
        &self.bearing
    }

    /// The fluid's pressure in a cell at the contents given last, Pa.
    pub(super) fn pressure(&self, i: usize) -> f64 {
        self.cells[i].pressure[0]
    }

    /// The mean gap in a cell, m, likewise.
    pub(super) fn gap(&self, i: usize) -> f64 {
        self.cells[i].gap
    }

    /// The share of its area that does not touch over the gap (1/m), and the friction coefficient of its contacts, likewise.
    pub(super) fn open_and_friction(&self, law: &GapLaw, i: usize) -> (Slope, f64) {
        let Cell { gap, interval, pressure, .. } = self.cells[i];
        let (open, friction) = law.open_and_friction(gap, interval);
        (open, if pressure[0] > 0.0 { friction } else { self.frictions[i] })
    }

    /// How the fluid's pressure changes with the content, Pa/m, likewise.
    pub(super) fn stiffness(&self, i: usize) -> f64 {
        self.cells[i].pressure[1]
    }

    /// What a standing or moving rough side lets a rod carry at a gap, over its speed.
    fn carried(&self, gap: f64, point: &GapPoint) -> [f64; 2] {
        let half = [0.5 * point.drag.value, 0.5 * point.drag.slope];
        if self.moving { [gap - half[0], 1.0 - half[1]] } else { half }
    }

    fn mobility(&self, point: &GapPoint) -> [f64; 2] {
        let (h, per) = (point.leak.value, 1.0 / (12.0 * self.viscosity));
        [per * h * h * h, per * 3.0 * h * h * point.leak.slope]
    }

    fn cell(&self, law: &GapLaw, i: usize, content: f64) -> Cell {
        let (bearing, total) = (self.bearing[i], self.totals[i]);
        let gap = content.max(bearing);
        let interval = law.interval(gap, self.cells[i].interval);
        let point = law.at(gap, interval);
        let (carried, mobility) = (self.carried(gap, &point), self.mobility(&point));
        if content >= bearing {
            // In full contact contacts bear all until there is any fluid.
            let closing = self.closing[i] * (1.0 - gap / CLOSED).max(0.0);
            let slope = if closing > 0.0 { self.closing[i] / CLOSED } else { 0.0 };
            let excess = total - point.pressure.value - closing;
            let pressure = if excess > 0.0 { [excess, slope - point.pressure.slope] } else { [0.0; 2] };
            return Cell { gap, interval, pressure, carried, mobility };
        }
        let partly = |[whole, _]: [f64; 2]| [whole * content / gap, whole / gap];
        Cell { gap, interval, pressure: [0.0; 2], carried: partly(carried), mobility: partly(mobility) }
    }

    /// Finds the flows at these contents (m) and the speed V (m/s), and how they change with both.
    pub(super) fn evaluate(&mut self, law: &GapLaw, contents: &[f64], speed: f64, ends: &Ends) {
        // Where there is no gap nothing flows: cells and flows are the 0 that they were made with.
        if law.is_closed() {
            return;
        }
        for (i, &content) in contents.iter().enumerate() {
            self.cells[i] = self.cell(law, i, content);
        }
        let last = self.cells.len();
        for face in 1..last {
            self.inner_face(face, speed);
        }
        self.sealed_end(law, speed, ends);
        let end = &self.cells[last - 1];
        let (out, half) = (end.mobility, 0.5 * self.width);
        let pressed = out[0] * end.pressure[0] / half;
        let pressed_slope = (out[1] * end.pressure[0] + out[0] * end.pressure[1]) / half;
        let leaves = speed >= 0.0;
        let (carried, slope) = if leaves { (end.carried[0], end.carried[1]) } else { (ends.carried_in, 0.0) };
        self.flows[last] = pressed + speed * carried;
        self.by_speed[last] = carried;
        self.slopes[last] = [0.0, pressed_slope + speed * slope, 0.0, 0.0];
    }

    fn sealed_end(&mut self, law: &GapLaw, speed: f64, ends: &Ends) {
        let (first, half) = (&self.cells[0], 0.5 * self.width);
        let before = law.at(ends.supply, law.interval(ends.supply, usize::MAX));
        let excess = first.pressure[0] - ends.sealed;
        let [mobility, slope] = if excess < 0.0 { [self.mobility(&before)[0], 0.0] } else { first.mobility };
        let [carried, carried_slope] =
            if speed >= 0.0 { [self.carried(ends.supply, &before)[0], 0.0] } else { first.carried };
        self.flows[0] = speed * carried - mobility * excess / half;
        self.by_speed[0] = carried;
        let by_first = speed * carried_slope - (slope * excess + mobility * first.pressure[1]) / half;
        self.slopes[0] = [0.0, 0.0, by_first, 0.0];
    }

    fn inner_face(&mut self, face: usize, speed: f64) {
        let (before, behind) = (&self.cells[face - 1], &self.cells[face]);
        let fall = before.pressure[0] - behind.pressure[0];
        let carried = self.face_value(face, speed >= 0.0, |cell| cell.carried);
        let mobility = self.face_value(face, fall > 0.0, |cell| cell.mobility);
        let per = 1.0 / self.width;
        let mut slopes = [0.0; 4];
        for (is_forward, factor, value) in [(speed >= 0.0, speed, &carried), (fall > 0.0, fall * per, &mobility)] {
            for (k, slope) in value.slopes.iter().enumerate() {
                // Upstream of a face are the cells before it, or those behind it in the other order.
                slopes[if is_forward { k } else { 3 - k }] += factor * slope;
            }
        }
        slopes[1] += mobility.value * per * before.pressure[1];
        slopes[2] -= mobility.value * per * behind.pressure[1];
        self.flows[face] = speed * carried.value + mobility.value * fall * per;
        self.by_speed[face] = carried.value;
        self.slopes[face] = slopes;
    }

    /// What of a quantity the cell upstream of an inner face has there.
    fn face_value(&self, face: usize, is_forward: bool, of: impl Fn(&Cell) -> [f64; 2]) -> FaceValue {
        let last = self.cells.len() - 1;
        let (up, down) = if is_forward { (face - 1, face) } else { (face, face - 1) };
        let further = if is_forward { up.checked_sub(1) } else { Some(up + 1).filter(|i| *i <= last) };
        let [q, slope] = of(&self.cells[up]);
        let [q_down, slope_down] = of(&self.cells[down]);
        let Some(further) = further else {
            // Behind the flooded side there is more than enough: straight to the next cell, where that has less.
            if is_forward && q_down < q {
                return FaceValue { value: 0.5 * (q + q_down), slopes: [0.0, 0.5 * slope, 0.5 * slope_down] };
            }
            return FaceValue { value: q, slopes: [0.0, slope, 0.0] };
        };
        let [q_far, slope_far] = of(&self.cells[further]);
        let (rise, next) = (q - q_far, q_down - q);
        if rise * next <= 0.0 {
            return FaceValue { value: q, slopes: [0.0, slope, 0.0] };
        }
        let sum = rise + next;
        let (by_rise, by_next) = ((next / sum).powi(2), (rise / sum).powi(2));
        FaceValue {
            value: q + rise * next / sum,
            slopes: [-by_rise * slope_far, (1.0 + by_rise - by_next) * slope, by_next * slope_down],
        }
    }

    /// The rates of the contents, m/s, at what was evaluated last.
    pub(super) fn rate(&self, i: usize) -> f64 {
        (self.flows[i] - self.flows[i + 1]) / self.width
    }

    /// The derivative of the rate of cell `i` by the speed, 1.
    pub(super) fn rate_by_speed(&self, i: usize) -> f64 {
        (self.by_speed[i] - self.by_speed[i + 1]) / self.width
    }

    /// The derivatives of the rate of cell `i` by the contents of the cells from two before it to two behind it, 1/s.
    pub(super) fn rate_slopes(&self, i: usize) -> [f64; BANDS] {
        let (into, out) = (&self.slopes[i], &self.slopes[i + 1]);
        let mut row = [0.0; BANDS];
        for k in 0..4 {
            row[k] += into[k] / self.width;
            row[k + 1] -= out[k] / self.width;
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{law, pressed};
    use super::*;

    /// The derivatives are those that differences show, in films that bear, that are starved, and at both ends.
    #[test]
    fn slopes_are_those_of_differences() {
        let law = law(0.02);
        for (speed, moving) in [(0.02, true), (-0.05, false), (0.0, true)] {
            let count = 9;
            let mut film = Film::new(count, 2e-5, moving);
            film.set_viscosity(0.05);
            film.set_totals(&law, |i| pressed(i, count));
            // A thicker supply would flow in so fast that differences were rounding.
            let ends = Ends { sealed: 1e5, supply: 2e-6, carried_in: 3e-7 };
            let contents: Vec<f64> = (0..count).map(|i| film.bearing()[i] * (0.7 + 0.09 * i as f64)).collect();
            film.evaluate(&law, &contents, speed, &ends);
            let matrix: Vec<[f64; BANDS]> = (0..count).map(|i| film.rate_slopes(i)).collect();
            let by_speed: Vec<f64> = (0..count).map(|i| film.rate_by_speed(i)).collect();
            let mut rates = |contents: &[f64], speed: f64| -> Vec<f64> {
                film.evaluate(&law, contents, speed, &ends);
                (0..count).map(|i| film.rate(i)).collect()
            };
            for j in 0..count {
                let h = 1e-6 * contents[j];
                let moved = |by: f64| {
                    let mut moved = contents.clone();
                    moved[j] += by;
                    moved
                };
                let (up, down) = (rates(&moved(h), speed), rates(&moved(-h), speed));
                let largest = up.iter().zip(&down).map(|(a, b)| (a - b).abs() / (2.0 * h)).fold(0.0, f64::max);
                for i in j.saturating_sub(2)..(j + 3).min(count) {
                    let difference = (up[i] - down[i]) / (2.0 * h);
                    let found = matrix[i][j + 2 - i];
                    // Of a difference over a millionth.
                    assert!((found - difference).abs() <= 1e-5 * largest, "{speed} {i} {j}: {found} {difference}");
                }
            }
            if speed != 0.0 {
                let (up, down) = (rates(&contents, 1.001 * speed), rates(&contents, 0.999 * speed));
                for i in 0..count {
                    let difference = (up[i] - down[i]) / (0.002 * speed);
                    assert!((by_speed[i] - difference).abs() <= 1e-6 * difference.abs().max(1e-3), "{i}");
                }
            }
        }
    }

    /// In full contact contacts bear all without a fluid, what the law has with a nanometre of it, straight between; nothing
    /// there is open but in proportion.
    #[test]
    fn a_full_contact_opens_without_a_leap() {
        let law = law(0.02);
        let mut film = Film::new(1, 2e-5, true);
        let closes = law.at(0.0, 0).pressure.value;
        let total = 2.0 * closes;
        film.set_totals(&law, |_| total);
        let mut borne = |content: f64| {
            film.evaluate(&law, &[content], 0.0, &Ends::default());
            let (open, _) = film.open_and_friction(&law, 0);
            assert!(open.value.is_finite() && open.slope.is_finite(), "{content}: {open:?}");
            total - film.pressure(0)
        };
        assert_eq!(borne(0.0), total);
        // The law itself falls by 5e-3 over a nanometre.
        let by_law = |content: f64| closes * (-content / 2e-7).exp();
        assert!((borne(0.5 * CLOSED) / (by_law(0.5 * CLOSED) + 0.5 * closes) - 1.0).abs() < 1e-9);
        assert!((borne(CLOSED) / by_law(CLOSED) - 1.0).abs() < 1e-9);
    }
}
