//! A spline at many places at once: all but the look-up of the intervals becomes vector instructions.

use std::hint::select_unpredictable;

use super::{Cubic, Ends, Piece, Spline};

/// The most places at once.
pub const BLOCK: usize = 16;

impl Spline {
    /// Writes z, z', z'' and z''' at each of up to [`BLOCK`] places `x` (m) to as many `values`: those of
    /// [`evaluate`](Self::evaluate), to the last bit. For use with [vector
    /// instructions](crate::math::with_widest_vectors).
    #[inline(always)]
    pub fn evaluate_block<P>(&self, x: &[f64], values: &mut [P])
    where
        P: Copy + From<[f64; 4]> + Into<[f64; 4]>,
    {
        let (mut near, mut cells) = ([0.0; BLOCK], [0; BLOCK]);
        self.reduce_near(x, &mut near);
        self.grid.cells(&near, &mut cells[..x.len()]);
        let places = x.iter().zip(near.iter_mut().zip(&cells));
        for ((x, (t, cell)), value) in places.zip(&mut *values) {
            let piece = match self.pieces.get(*cell as usize) {
                Some(piece) if piece.start <= *t && *t < piece.end => piece,
                _ => {
                    *t = self.reduce(*x);
                    self.piece_at_any(*t)
                }
            };
            let Cubic { z, slope, curvature, third } = piece.cubic;
            *value = [z, slope, curvature, third].into();
            *t -= piece.start;
        }
        evaluate_pieces(&near[..x.len()], values);
    }

    /// [Reduces](Self::reduce) each `x` that is less than a period behind the last point.
    #[inline(always)]
    fn reduce_near(&self, x: &[f64], reduced: &mut [f64]) {
        let period = if let Ends::Periodic { period } = self.ends { period } else { 0.0 };
        let last = self.last();
        for (x, reduced) in x.iter().zip(reduced) {
            *reduced = select_unpredictable(*x < last, *x, x - period);
        }
    }

    /// [`piece_at`](Self::piece_at), out of the way of the usual place.
    #[inline(never)]
    fn piece_at_any(&self, x: f64) -> &Piece {
        self.piece_at(x)
    }
}

/// Puts the values at the distances `t` from the start of the intervals in the place of the coefficients there.
#[inline(always)]
fn evaluate_pieces<P>(t: &[f64], values: &mut [P])
where
    P: Copy + From<[f64; 4]> + Into<[f64; 4]>,
{
    for (t, value) in t.iter().zip(values) {
        let [z, slope, curvature, third] = (*value).into();
        let (z, slope, curvature, third) = Cubic { z, slope, curvature, third }.evaluate(*t);
        *value = [z, slope, curvature, third].into();
    }
}
