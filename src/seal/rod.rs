//! The film that lies on the rod beyond the lip: what left comes back in the order in which it comes.

use serde::{Deserialize, Serialize};

/// The most pieces that are kept.
const MOST_PIECES: usize = 256;

/// A piece of film: the length that it covers, m, and its thickness, m.
type Piece = (f64, f64);

/// The film on the rod as a stack of pieces, the last beside the lip.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct RodFilm {
    pieces: Vec<Piece>,
}

impl RodFilm {
    /// Whether the numbers may be those of a film.
    pub(super) fn is_valid(&self) -> bool {
        let is_length = |number: f64| number.is_finite() && number >= 0.0;
        self.pieces.len() <= MOST_PIECES
            && self.pieces.iter().all(|&(length, film)| is_length(length) && is_length(film))
    }

    /// The piece that comes back first.
    pub(super) fn nearest(&self) -> Option<Piece> {
        self.pieces.last().copied()
    }

    /// The volume by length along the lip, m².
    pub(super) fn volume(&self) -> f64 {
        self.pieces.iter().map(|(length, thickness)| length * thickness).sum()
    }

    /// Lays a volume by length along the lip (m²) onto a length (m) that leaves the lip.
    pub(super) fn lay(&mut self, length: f64, volume: f64) {
        if length <= 0.0 {
            return;
        }
        self.pieces.push((length, volume.max(0.0) / length));
        if self.pieces.len() > MOST_PIECES {
            // Over what length joining changes the film, and by which part of it: friction follows a thin film's logarithm.
            let changed = |i: &usize| {
                let ((a, thick), (b, other)) = (self.pieces[*i], self.pieces[*i + 1]);
                (thick - other).abs() / (thick + other).max(f64::MIN_POSITIVE) * a * b / (a + b)
            };
            let nearest = (0..MOST_PIECES).min_by(|a, b| changed(a).total_cmp(&changed(b)));
            if let Some(i) = nearest {
                let ((a, thick), (b, other)) = (self.pieces[i], self.pieces.remove(i + 1));
                self.pieces[i] = (a + b, (a * thick + b * other) / (a + b));
            }
        }
    }

    /// Takes back a length (m) with a volume by length along the lip (m²). What little is left of a piece is joined to the next.
    pub(super) fn take(&mut self, mut length: f64, mut volume: f64) {
        while let Some((own, thickness)) = self.pieces.pop() {
            let (left, rest) = (own - length, (own * thickness - volume).max(0.0));
            match self.pieces.last_mut() {
                _ if left > LITTLE * own => return self.pieces.push((left, rest / left)),
                Some((next, film)) if left > 0.0 => {
                    *film = (*next * *film + rest) / (*next + left);
                    *next += left;
                    return;
                }
                _ => (length, volume) = ((-left).max(0.0), (volume - own * thickness).max(0.0)),
            }
            if length <= 0.0 {
                return;
            }
        }
    }
}

/// A part of a piece that is little.
const LITTLE: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    /// The last comes first, volumes are kept however many pieces there are, and beyond all of them the rod is dry.
    #[test]
    fn what_left_last_comes_back_first() {
        let mut rod = RodFilm::default();
        let mut volume = 0.0;
        for i in 0..2000 {
            let laid = 1e-9 * (1.0 + (0.01 * f64::from(i)).sin());
            rod.lay(1e-3, laid);
            volume += laid;
        }
        assert!(rod.is_valid() && (rod.volume() / volume - 1.0).abs() < 1e-12);
        let (length, thickness) = rod.nearest().unwrap();
        rod.take(0.5 * length, 0.5 * length * thickness);
        assert!((rod.volume() / (volume - 0.5 * length * thickness) - 1.0).abs() < 1e-12);
        rod.take(10.0, 1.0);
        assert!(rod.nearest().is_none() && rod.volume() == 0.0);
    }
}
