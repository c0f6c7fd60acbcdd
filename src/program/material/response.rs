//! What a scene answers an oscillation with: the modulus of its compound, or the stiffness of its links.

use asperity::scene::{Link, LinkKind, Scene};

/// A range of angular frequencies, rad/s.
pub(super) type Band = (f64, f64);

/// How far beyond its rates 1/τ a response is shown, in decades.
const BEYOND: f64 = 1.0;
/// What is shown of a response without any rate.
const PLAIN: Band = (1.0, 1e4);
/// Steps of a decade in which the maximum of tan δ is looked for, before a parabola gives it more closely.
const FINE: f64 = 500.0;

/// A complex modulus or stiffness over frequency: a spring, a dashpot and Maxwell elements in parallel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Response {
    /// What it is of, empty for the compound.
    pub(super) name: &'static str,
    /// E_∞ or c, Pa or N/m.
    pub(super) spring: f64,
    /// η or d, Pa s or N s/m.
    damper: f64,
    /// (τ_j, E_j or c_j), s and Pa or N/m.
    elements: Vec<(f64, f64)>,
}

/// The compound's modulus at the scene's temperature; in the direct form the links' stiffnesses.
pub(super) fn responses(scene: &Scene) -> Vec<Response> {
    let Some(material) = &scene.material else {
        let links = LinkKind::ALL.into_iter().filter_map(|kind| Some((kind, scene.link(kind)?)));
        return links.map(|(kind, link)| Response::of_link(kind, &link)).collect();
    };
    let shift = material.shift_factor();
    vec![Response {
        name: "",
        spring: material.equilibrium_modulus,
        damper: shift * material.viscosity.unwrap_or(0.0),
        elements: material.prony.iter().map(|term| (shift * term.relaxation_time, term.modulus)).collect(),
    }]
}

impl Response {
    fn of_link(kind: LinkKind, link: &Link) -> Self {
        Self {
            name: kind.name(),
            spring: link.stiffness.unwrap_or(0.0),
            damper: link.damping.unwrap_or(0.0),
            elements: link.maxwell.iter().map(|element| (element.relaxation_time, element.stiffness)).collect(),
        }
    }

    /// Both parts at ω: c + iωd + Σ c_j iωτ_j/(1 + iωτ_j).
    pub(super) fn at(&self, omega: f64) -> (f64, f64) {
        let start = (self.spring, omega * self.damper);
        self.elements.iter().fold(start, |(storage, loss), (tau, modulus)| {
            // Finite however long or short τ is.
            let x = omega * tau;
            let inverse = 1.0 / x;
            (storage + modulus / (1.0 + inverse * inverse), loss + modulus / (x + inverse))
        })
    }

    /// tan δ at ω.
    pub(super) fn loss_tangent(&self, omega: f64) -> f64 {
        let (storage, loss) = self.at(omega);
        loss / storage
    }

    /// All springs together.
    pub(super) fn glassy(&self) -> f64 {
        self.spring + self.elements.iter().map(|(_, modulus)| modulus).sum::<f64>()
    }

    /// Whether a dashpot without a spring makes both parts grow without end.
    pub(super) fn has_damper(&self) -> bool {
        self.damper > 0.0
    }

    /// The rates at which it changes: 1/τ_j, and c/d.
    fn rates(&self) -> impl Iterator<Item = f64> {
        let creep = (self.damper > 0.0 && self.spring > 0.0).then(|| self.spring / self.damper);
        let elements = self.elements.iter().filter(|(_, modulus)| *modulus > 0.0).map(|(tau, _)| 1.0 / tau);
        elements.chain(creep)
    }

    /// ω in `band` at which tan δ is largest, and tan δ there; `None` where nothing is lost.
    pub(super) fn most_lossy(&self, band: Band) -> Option<(f64, f64)> {
        let all: Vec<(f64, f64)> =
            evenly(band, FINE).into_iter().map(|omega| (omega, self.loss_tangent(omega))).collect();
        let lossy = (0..all.len()).filter(|&i| all[i].1 > 0.0 && all[i].1.is_finite());
        let largest = lossy.max_by(|&i, &j| all[i].1.total_cmp(&all[j].1))?;
        let around = largest.checked_sub(1).and_then(|before| all.get(before..largest + 2));
        Some(match around {
            Some(&[(_, a), (omega, b), (after, c)]) if a + c < 2.0 * b => {
                // The top of the parabola through the three over ln ω.
                let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
                let omega = omega * (after / omega).powf(shift);
                (omega, self.loss_tangent(omega))
            }
            _ => all[largest],
        })
    }
}

/// The band in which `responses` change, from power of ten to power of ten.
pub(super) fn band(responses: &[Response]) -> Band {
    let rates = || responses.iter().flat_map(Response::rates).map(f64::log10);
    let (low, high) = (rates().fold(f64::MAX, f64::min), rates().fold(f64::MIN, f64::max));
    if low > high {
        return PLAIN;
    }
    (10.0_f64.powf((low - BEYOND).floor()), 10.0_f64.powf((high + BEYOND).ceil()))
}

/// Angular frequencies over `band`, evenly in the logarithm, about `steps` a decade.
pub(super) fn evenly((low, high): Band, steps: f64) -> Vec<f64> {
    let decades = (high / low).log10();
    let intervals = (decades * steps).round().max(1.0);
    (0..=intervals as usize).map(|i| low * 10.0_f64.powf(decades * i as f64 / intervals)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zener() -> Response {
        Response { name: "", spring: 2.0, damper: 0.0, elements: vec![(0.1, 6.0)] }
    }

    /// Of one element, tan δ = E_1 x/(E_∞ + (E_∞ + E_1) x²) with x = ωτ: largest at x² = E_∞/(E_∞ + E_1) = 1/4.
    #[test]
    fn the_maximum_of_tan_delta_is_where_theory_has_it() {
        let (omega, tangent) = zener().most_lossy((1e-2, 1e4)).unwrap();
        // A parabola over a step of 0.5 % errs by the cube of that, times the curve's asymmetry; the value by its
        // square.
        assert!((omega / 5.0 - 1.0).abs() < 1e-6 && (tangent / 0.75 - 1.0).abs() < 1e-12, "{omega} {tangent}");
    }

    #[test]
    fn parts_have_the_limits_of_spring_and_glass() {
        let (storage, loss) = zener().at(1e-9);
        assert!((storage - 2.0).abs() < 1e-15 && loss < 1e-9);
        assert!((zener().at(1e12).0 - zener().glassy()).abs() < 1e-15);
    }

    #[test]
    fn the_band_holds_every_rate() {
        let two = Response { elements: vec![(0.1, 6.0), (1e-4, 1.0), (1e9, 0.0)], ..zener() };
        assert_eq!(band(&[zener(), two]), (1.0, 1e5));
        assert_eq!(band(&[Response { elements: Vec::new(), ..zener() }]), PLAIN);
    }

    #[test]
    fn what_loses_nothing_has_no_maximum() {
        assert_eq!(Response { elements: Vec::new(), ..zener() }.most_lossy((1.0, 10.0)), None);
    }
}
