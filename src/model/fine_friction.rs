//! Friction by the roughness below the resolution of the profile, and the area that it leaves in contact.
//!
//! Under the pressure p = F_N/A a contact of the area A flattens the waves of the bands b, whose mean square gradients are
//! h'_b², from the longest to the shortest. Sliding at v it meets them with the moduli M_b(v), and loses by L_b(v); both are
//! means over the directions of waves (docs/foundation.md, section 5). With Σ_b = Σ_{c<b} h'_c² M_c² + ½ h'_b² M_b² and
//! Σ over all bands,
//!
//!   P_b = erf(√2 p/√Σ_b),   μ_h(p, v) = (1/2p) Σ_b h'_b² L_b P_b (¾ + ¼ P_b²),   A_r = A erf(√π p/√Σ).
//!
//! The form is B. N. J. Persson's (J. Chem. Phys. 115, 2001, 3840). The sums are tabulated: √Σ over ln v, and
//! μ_h (1 + p/√Σ), which goes from one limit to another, over ln v and ln(p/√Σ); and so is the error function, as
//! A_r/A (1 + √Σ/p). Speeds are those at the reference temperature, a_T v, but at least the creep speed v_c.

use std::f64::consts::{PI, SQRT_2};

use crate::scene::{FineBand, FineWaves, Material, Scene, WaveModuli};

/// Friction and area of one mass in contact.
#[derive(Clone, Debug)]
pub struct FineFriction {
    /// A, m².
    area: f64,
    /// v_c at the layer's temperature, m/s: up to this speed a contact is as at rest.
    creep_speed: f64,
    /// The even steps of ln v of the tables, from ln v_c on.
    log_speeds: EvenSteps,
    /// ln √Σ there and its slope by the number of steps; √Σ in Pa.
    stress: Vec<[f64; 2]>,
    /// A_r/A (1 + √Σ/p).
    share: ShareTable,
    /// μ_h (1 + p/√Σ); `None` where the waves do not rub.
    hysteresis: Option<HysteresisTable>,
}

/// The law under a normal force that is held.
#[derive(Clone, Copy, Debug)]
pub struct PressedContact<'a> {
    fine: &'a FineFriction,
    /// F_N, N.
    normal: f64,
    /// ln p, p in Pa.
    log_pressure: f64,
}

/// A quantity of a contact, and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactQuantity {
    /// Its value.
    pub value: f64,
    /// By F_N, per N.
    pub by_normal: f64,
    /// By the speed, per m/s.
    pub by_speed: f64,
}

/// A contact on the roughness below the profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FineContact {
    /// A_r/A, 1.
    pub share: ContactQuantity,
    /// μ_h F_N, N.
    pub hysteresis: ContactQuantity,
}

/// Numbers in even steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EvenSteps {
    first: f64,
    step: f64,
    /// How many numbers there are, at least one.
    count: usize,
}

/// A_r/A (1 + √Σ/p) over ln(p/√Σ) in even steps: the value and its slope by the number of steps.
#[derive(Clone, Debug)]
struct ShareTable {
    log_pressures: EvenSteps,
    nodes: Vec<[f64; 2]>,
}

/// A function of ln v and x = ln(p/√Σ) in even steps of both, by bicubic polynomials.
#[derive(Clone, Debug)]
struct HysteresisTable {
    log_pressures: EvenSteps,
    /// For each speed, at each pressure: the value, its derivatives by the numbers of steps along x and along ln v, and the mixed
    /// one.
    nodes: Vec<[f64; 4]>,
    /// The largest value of all.
    largest: f64,
}

/// Speeds of a decade in the tables: cubics are then off by some 1e-5 of the functions, whose features are a decade wide.
const PER_DECADE: f64 = 18.0;
/// The step of ln(p/√Σ), over which each band's P_b changes within some units.
const PRESSURE_STEP: f64 = 0.14;
/// The step of the same in the table of the error function.
const SHARE_STEP: f64 = 0.1;
/// The tables end where the moduli have come to their limits: this factor beyond the rates 1/τ of the material.
const MARGIN: f64 = 1.0e4;
/// Where √2 p/√Σ_b is below this, erf is a line to its square.
const LINEAR: f64 = 1.0e-3;
/// Above this, erf is 1 but for 1e-8.
const FULL: f64 = 4.0;

/// v_c at the temperature of a material, m/s.
fn creep_speed_at(creep_speed: f64, material: &Material) -> f64 {
    creep_speed / material.shift_factor()
}

impl FineFriction {
    /// The law of a scene; `None` where the profile lacks nothing.
    pub fn new(scene: &Scene) -> Option<Self> {
        let (fine, material) = (scene.fine.as_ref()?, scene.material.as_ref()?);
        let area = scene.layer.element_area()?;
        let creep_speed = scene.fine_creep_speed();
        let law = |log_speeds, stress, hysteresis| {
            let creep_speed = creep_speed_at(creep_speed, material);
            Self { area, creep_speed, log_speeds, stress, share: ShareTable::new(), hysteresis }
        };
        if let FineWaves::Modulus { rms_slope, modulus } = fine.waves {
            let constant = EvenSteps { first: 0.0, step: 1.0, count: 1 };
            return (rms_slope > 0.0).then(|| law(constant, vec![[(rms_slope * modulus).ln(), 0.0]], None));
        }
        let bands = scene.fine_bands();
        let rubs = bands.iter().any(|band| band.gradient_square > 0.0);
        let first = bands.first().filter(|_| rubs)?;
        let log_speeds = log_speeds(creep_speed, first.wave_number, material);
        let sums: Vec<BandSums> =
            log_speeds.values().map(|log_speed| BandSums::new(&bands, material, log_speed.exp())).collect();
        let log_stresses: Vec<f64> = sums.iter().map(|sums| sums.stress().ln()).collect();
        let stress = log_stresses.iter().copied().zip(slopes(&log_stresses)).map(|(y, slope)| [y, slope]).collect();
        let loses = fine.hysteresis && sums.iter().any(|sums| sums.losses() > 0.0);
        Some(law(log_speeds, stress, loses.then(|| HysteresisTable::new(&sums))))
    }

    /// The law at another temperature of the `material`, of which `creep_speed` (m/s) is v_c at the reference temperature:
    /// its tables are those at the reference temperature.
    #[must_use]
    pub fn at_temperature_of(&self, material: &Material, creep_speed: f64) -> Self {
        Self { creep_speed: creep_speed_at(creep_speed, material), ..self.clone() }
    }

    /// Whether friction changes with the speed.
    // Inlined, it may be read before it is known that there is such a law, which valgrind takes for an error.
    #[inline(never)]
    pub fn depends_on_speed(&self) -> bool {
        self.log_speeds.count > 1
    }

    /// Whether the waves rub, so that masses can stick.
    pub fn rubs(&self) -> bool {
        self.hysteresis.is_some()
    }

    /// v_c at the layer's temperature, m/s.
    pub fn creep_speed(&self) -> f64 {
        self.creep_speed
    }

    /// The speeds that the law is tabulated for, m/s at the layer's temperature, ascending.
    pub fn speeds(&self) -> impl Iterator<Item = f64> {
        self.log_speeds.values().map(|log_speed| self.creep_speed * (log_speed - self.log_speeds.first).exp())
    }

    /// Bound of μ_h F_N (N) under F_N (N) at any speed.
    pub fn largest_hysteresis(&self, normal: f64) -> f64 {
        self.hysteresis.as_ref().map_or(0.0, |table| table.largest * normal.max(0.0))
    }

    /// The contact at rest under the normal force F_N (N).
    #[inline(never)]
    pub fn at_rest(&self, normal: f64) -> FineContact {
        self.contact(normal, 0.0)
    }

    /// The contact under F_N (N) at a `speed` of either sign, m/s.
    pub fn contact(&self, normal: f64, speed: f64) -> FineContact {
        self.under(normal).at(speed)
    }

    /// The law under F_N, N.
    pub fn under(&self, normal: f64) -> PressedContact<'_> {
        let log_pressure = if normal > 0.0 { (normal / self.area).ln() } else { f64::NEG_INFINITY };
        PressedContact { fine: self, normal, log_pressure }
    }

    /// ln √Σ at a number of steps of the speed, and its slope by that.
    fn log_stress(&self, steps: f64) -> [f64; 2] {
        let last = self.log_speeds.last();
        if self.log_speeds.count == 1 {
            return self.stress[0];
        }
        if steps >= last {
            // With a viscosity the modulus grows with the speed without end.
            let [value, slope] = self.stress[self.stress.len() - 1];
            return [value + slope * (steps - last), slope];
        }
        let (i, t) = self.log_speeds.interval(steps);
        let (here, next) = (self.stress[i], self.stress[i + 1]);
        let (value, slope) = (hermite(t), hermite_slopes(t));
        let of = |basis: &[f64; 4]| basis[0] * here[0] + basis[1] * here[1] + basis[2] * next[0] + basis[3] * next[1];
        [of(&value), of(&slope)]
    }
}

impl PressedContact<'_> {
    /// The contact at rest.
    pub fn at_rest(&self) -> FineContact {
        self.at(0.0)
    }

    /// The contact at a `speed` of either sign, m/s.
    pub fn at(&self, speed: f64) -> FineContact {
        let Self { fine, normal, log_pressure } = *self;
        if normal <= 0.0 {
            return FineContact::default();
        }
        let size = speed.abs();
        let slips = size > fine.creep_speed;
        // The place in the table of speeds, as a number of steps, and its derivative by the speed.
        let steps = if slips { (size / fine.creep_speed).ln() / fine.log_speeds.step } else { 0.0 };
        let by_speed = if slips { 1.0_f64.copysign(speed) / (fine.log_speeds.step * size) } else { 0.0 };
        let [log_stress, stress_slope] = if slips { fine.log_stress(steps) } else { fine.stress[0] };
        let x = log_pressure - log_stress;
        let pressed = x.exp();
        let whole = 1.0 / (1.0 + pressed);

        // The part of the area that touches, and its derivative by ln p.
        let [share, by_log] = fine.share.at(x, pressed, whole);
        let share =
            ContactQuantity { value: share, by_normal: by_log / normal, by_speed: -by_log * stress_slope * by_speed };

        // μ_h = R/(1 + p/√Σ), R of the table.
        let Some(table) = &fine.hysteresis else {
            return FineContact { share, hysteresis: ContactQuantity::default() };
        };
        let last = fine.log_speeds.last();
        let [ratio, along_pressure, along_speed] = table.at(x, steps.min(last));
        let along_speed = if steps < last { along_speed } else { 0.0 };
        let by_log_pressed = (along_pressure - ratio * pressed * whole) * whole;
        let hysteresis = ContactQuantity {
            value: normal * ratio * whole,
            by_normal: ratio * whole + by_log_pressed,
            by_speed: normal * (along_speed * whole - stress_slope * by_log_pressed) * by_speed,
        };
        FineContact { share, hysteresis }
    }
}

impl ShareTable {
    /// p/√Σ from which on all of the area touches, but for 1e-15 of it, and up to which it is a line, but for 1e-6.
    const ENDS: (f64, f64) = (1.0e-3, 3.2);

    fn new() -> Self {
        let (first, last) = (Self::ENDS.0.ln(), Self::ENDS.1.ln());
        let count = ((last - first) / SHARE_STEP).ceil() as usize + 1;
        let log_pressures = EvenSteps { first, step: (last - first) / (count - 1) as f64, count };
        let value = |x: f64| libm::erf(PI.sqrt() * x.exp()) * (1.0 + (-x).exp());
        let values: Vec<f64> = log_pressures.values().map(value).collect();
        let nodes = values.iter().copied().zip(slopes(&values)).map(|(value, slope)| [value, slope]).collect();
        Self { log_pressures, nodes }
    }

    /// erf(√π p/√Σ) at x = ln(p/√Σ), `pressed` = e^x and `whole` = 1/(1 + e^x), and its derivative by x.
    fn at(&self, x: f64, pressed: f64, whole: f64) -> [f64; 2] {
        let EvenSteps { first, step, .. } = self.log_pressures;
        let place = (x - first) / step;
        if place < 0.0 {
            return [2.0 * pressed, 2.0 * pressed];
        }
        if place >= self.log_pressures.last() {
            return [1.0, 0.0];
        }
        let (i, t) = self.log_pressures.interval(place);
        let (here, next) = (self.nodes[i], self.nodes[i + 1]);
        let of = |basis: [f64; 4]| basis[0] * here[0] + basis[1] * here[1] + basis[2] * next[0] + basis[3] * next[1];
        let (value, slope) = (of(hermite(t)), of(hermite_slopes(t)) / step);
        let part = pressed * whole;
        [value * part, (slope + value * whole) * part]
    }
}

/// The sums of the bands at one speed.
#[derive(Clone, Debug)]
struct BandSums {
    /// √Σ_b (Pa) of each band, and ½ h'_b² L_b (Pa).
    bands: Vec<[f64; 2]>,
    /// Σ, Pa².
    whole: f64,
}

impl BandSums {
    fn new(bands: &[FineBand], material: &Material, speed: f64) -> Self {
        let mut whole = 0.0;
        let band = |band: &FineBand| {
            let WaveModuli { square, loss } = band.moduli(material, speed);
            let own = band.gradient_square * square;
            let middle = whole + 0.5 * own;
            whole += own;
            [middle.sqrt(), 0.5 * band.gradient_square * loss]
        };
        let bands = bands.iter().map(band).collect();
        Self { bands, whole }
    }

    /// √Σ, Pa.
    fn stress(&self) -> f64 {
        self.whole.sqrt().max(f64::MIN_POSITIVE)
    }

    /// ½ Σ_b h'_b² L_b, Pa: the largest μ_h p.
    fn losses(&self) -> f64 {
        self.bands.iter().map(|band| band[1]).sum()
    }

    /// μ_h under the pressure p, Pa.
    fn friction(&self, pressure: f64) -> f64 {
        let band = |[stress, loss]: &[f64; 2]| {
            let in_contact = libm::erf(SQRT_2 * pressure / stress);
            loss * in_contact * (0.75 + 0.25 * in_contact * in_contact)
        };
        self.bands.iter().map(band).sum::<f64>() / pressure
    }

    /// √Σ_b of the longest waves over √Σ.
    fn least_share(&self) -> f64 {
        let least = self.bands.iter().map(|band| band[0]).find(|&stress| stress > 0.0);
        least.map_or(1.0, |least| least / self.stress())
    }
}

impl HysteresisTable {
    /// The table of the `sums` at each speed.
    fn new(sums: &[BandSums]) -> Self {
        let least = sums.iter().map(BandSums::least_share).fold(1.0, f64::min);
        let (first, last) = ((LINEAR * least / SQRT_2).ln(), (FULL / SQRT_2 / LINEAR).ln());
        let count = ((last - first) / PRESSURE_STEP).ceil() as usize + 1;
        let log_pressures = EvenSteps { first, step: PRESSURE_STEP, count };
        let row = |sums: &BandSums| {
            let stress = sums.stress();
            log_pressures.values().map(|x| sums.friction(stress * x.exp()) * (1.0 + x.exp())).collect::<Vec<f64>>()
        };
        // Derivatives along the pressure in each row, and along the speed in each column.
        let rows: Vec<Vec<f64>> = sums.iter().map(row).collect();
        let along_pressure: Vec<Vec<f64>> = rows.iter().map(|row| slopes(row)).collect();
        let (along_speed, mixed) = (columns_slopes(&rows), columns_slopes(&along_pressure));
        let node = |j: usize, i: usize| [rows[j][i], along_pressure[j][i], along_speed[j][i], mixed[j][i]];
        let nodes: Vec<[f64; 4]> =
            (0..rows.len()).flat_map(|j| (0..count).map(move |i| (j, i))).map(|(j, i)| node(j, i)).collect();
        let largest = nodes.iter().map(|node| node[0]).fold(0.0, f64::max);
        Self { log_pressures, nodes, largest }
    }

    /// The value at x = ln(p/√Σ) and at a number of steps of the speed within the table, its derivative by x, and that by the
    /// number of steps.
    fn at(&self, x: f64, steps: f64) -> [f64; 3] {
        let EvenSteps { first, step, count } = self.log_pressures;
        let speeds = EvenSteps { first: 0.0, step: 1.0, count: self.nodes.len() / count };
        // Beyond its ends the value is that at the end.
        let place = ((x - first) / step).clamp(0.0, self.log_pressures.last());
        let within = x > first && x < first + step * self.log_pressures.last();
        let ((i, s), (j, t)) = (self.log_pressures.interval(place), speeds.interval(steps));
        let (value, slope) = (hermite(s), hermite_slopes(s));
        // Along a row: the value and its derivative by the speed, and of both the derivatives by the pressure.
        let along = |row: usize| {
            let [here, next] = [self.nodes[row * count + i], self.nodes[row * count + i + 1]];
            let of = |basis: &[f64; 4], which: usize, slope: usize| {
                basis[0] * here[which] + basis[1] * here[slope] + basis[2] * next[which] + basis[3] * next[slope]
            };
            [of(&value, 0, 1), of(&value, 2, 3), of(&slope, 0, 1), of(&slope, 2, 3)]
        };
        let (low, high) = (along(j), along((j + 1).min(speeds.count - 1)));
        let between = |basis: [f64; 4], which: usize| {
            basis[0] * low[which] + basis[1] * low[which + 1] + basis[2] * high[which] + basis[3] * high[which + 1]
        };
        let by_pressure = if within { between(hermite(t), 2) / step } else { 0.0 };
        [between(hermite(t), 0), by_pressure, between(hermite_slopes(t), 0)]
    }
}

impl EvenSteps {
    /// The numbers.
    fn values(self) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |i| self.first + self.step * i as f64)
    }

    /// The number of steps to the last.
    fn last(&self) -> f64 {
        (self.count - 1) as f64
    }

    /// The interval at a number of steps, and the fraction of it that is passed there.
    fn interval(&self, steps: f64) -> (usize, f64) {
        let i = (steps as usize).min(self.count.saturating_sub(2));
        (i, steps - i as f64)
    }
}

/// The cubics of Hermite at the fraction `t` of an interval: of the value and the slope at its start, and at its end.
fn hermite(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [(1.0 + 2.0 * t) * s * s, t * s * s, t * t * (3.0 - 2.0 * t), -t * t * s]
}

/// Their slopes.
fn hermite_slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-6.0 * t * s, s * (1.0 - 3.0 * t), 6.0 * t * s, t * (3.0 * t - 2.0)]
}

/// Derivatives of values in even steps by the number of steps, of the fourth order; lower where there are fewer values.
fn slopes(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let at = |i: usize| match n {
        1 => 0.0,
        2 => values[1] - values[0],
        3 | 4 => {
            let i = i.clamp(1, n - 2);
            0.5 * (values[i + 1] - values[i - 1])
        }
        _ => {
            // Five values around, or the nearest to the end.
            let first = i.saturating_sub(2).min(n - 5);
            let weights = match i - first {
                0 => [-25.0, 48.0, -36.0, 16.0, -3.0],
                1 => [-3.0, -10.0, 18.0, -6.0, 1.0],
                2 => [1.0, -8.0, 0.0, 8.0, -1.0],
                3 => [-1.0, 6.0, -18.0, 10.0, 3.0],
                _ => [3.0, -16.0, 36.0, -48.0, 25.0],
            };
            weights.iter().zip(&values[first..]).map(|(weight, value)| weight * value).sum::<f64>() / 12.0
        }
    };
    (0..n).map(at).collect()
}

/// As [`slopes`], along the columns.
fn columns_slopes(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut found = rows.to_vec();
    for i in 0..rows[0].len() {
        let column: Vec<f64> = rows.iter().map(|row| row[i]).collect();
        found.iter_mut().zip(slopes(&column)).for_each(|(row, slope)| row[i] = slope);
    }
    found
}

/// ln v from the creep speed (m/s) on until the longest waves, of `wave_number` (rad/m), pass faster than all of the material's
/// processes.
fn log_speeds(creep_speed: f64, wave_number: f64, material: &Material) -> EvenSteps {
    let fastest = material.fastest_rate().map_or(0.0, |rate| rate / wave_number * MARGIN);
    let decades = (fastest / creep_speed).max(1.0).log10();
    let steps = (decades * PER_DECADE).ceil();
    let step = if steps > 0.0 { decades * std::f64::consts::LN_10 / steps } else { 1.0 };
    EvenSteps { first: creep_speed.ln(), step, count: steps as usize + 1 }
}
