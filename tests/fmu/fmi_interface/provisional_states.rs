//! A run that did steps again is where a run is that went there at once: its outputs and their derivatives, in whatever way
//! its state was reached.

use asperity::patch::COORDINATES;
use asperity_fmi::{Kind, Role};

use crate::common::root;
use crate::common::sweeps::{Grid, REST, WARM, separation};
use crate::fmu::fmi_interface::master::{DISCARD, ERROR, EVERYTHING, Fmu, OK};

/// A power of two that all values are multiples of, as the steps are of another: no rounding tells two ways to a point
/// apart.
const QUANTUM: f64 = 1.0 / (1_u64 << 34) as f64;

fn on_grid(value: f64) -> f64 {
    (value / QUANTUM).round() * QUANTUM
}

/// What is driven: a layer, an element or a patch.
struct Driven {
    new: fn() -> Fmu,
    inputs: &'static [&'static str],
    /// The inputs at a step, of an uneven motion.
    at: fn(u32) -> Vec<f64>,
    /// The shortest step, s.
    h: f64,
}

const LAYER: Driven = Driven {
    new: || Fmu::of(EVERYTHING, false),
    inputs: &["u", "w"],
    at: |step| {
        let k = f64::from(step);
        [1e-6 * (0.9 * k).sin(), -2e-6 - 1e-6 * (0.5 * k).cos()].map(on_grid).to_vec()
    },
    h: 1.0 / (1 << 17) as f64,
};

const ELEMENT: Driven = Driven {
    new: || Fmu::of_table(&Grid::plain().text(), false),
    inputs: &["u", "w"],
    at: |step| {
        let k = f64::from(step);
        let w = separation(1e-4, 2e5, WARM) - REST;
        [1e-6 * (0.9 * k).sin(), w + 1e-7 * (0.5 * k).sin()].map(on_grid).to_vec()
    },
    h: 1.0 / (1 << 10) as f64,
};

const PAD: &str = "
name = 'pad'
table = { path = 'block.table.csv' }
patch = { shape = 'flat', length = 0.01, width = 0.01, nx = 5, ny = 4 }
fmu = { outputs = ['forces', 'dissipation', 'contact', 'friction', 'energy', 'tangent'] }
";

const PATCH: Driven = Driven {
    new: || Fmu::of_patch(PAD, &root().join("tests/reference/patch/block.table.csv")),
    inputs: &COORDINATES,
    at: |step| {
        let k = f64::from(step);
        let (x, y, z) = (1e-4 * (0.9 * k).sin(), 2e-5 * (1.3 * k).sin(), -1e-5 + 2e-6 * (0.5 * k).cos());
        [x, y, z, 1e-5 * (0.4 * k).sin(), 0.0, 1e-3 * (0.7 * k).sin()].map(on_grid).to_vec()
    },
    h: 1.0 / (1 << 10) as f64,
};

impl Driven {
    /// The size of a step, s: half of the next at least, so that predictions go on at the rate of the last step.
    fn step(&self, step: u32) -> f64 {
        self.h * [1.0, 2.0, 2.0, 4.0, 2.0][step as usize % 5]
    }

    fn set(&self, fmu: &Fmu, values: &[f64]) {
        let all = self.inputs.iter().zip(values);
        all.for_each(|(name, &value)| assert_eq!(fmu.set_real(name, value), OK));
    }

    fn rate(&self, fmu: &Fmu, rates: &[f64]) {
        let all = self.inputs.iter().zip(rates);
        all.for_each(|(name, &rate)| assert_eq!(fmu.set_rate(name, rate), OK));
    }

    /// A run at its start.
    fn started(&self) -> Fmu {
        let fmu = (self.new)();
        self.start(&fmu);
        fmu
    }

    fn start(&self, fmu: &Fmu) {
        assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
        self.set(fmu, &(self.at)(0));
        assert_eq!(fmu.exit(), OK, "{:?}", fmu.messages());
    }

    /// Goes on by values alone, step after step.
    fn go(&self, fmu: &Fmu, from: u32, to: u32) {
        for step in from..to {
            self.set(fmu, &(self.at)(step));
            self.advance(fmu, step);
        }
    }

    fn advance(&self, fmu: &Fmu, step: u32) {
        assert_eq!(fmu.step(fmu.last_successful_time(), self.step(step)), OK, "{:?}", fmu.messages());
    }

    /// A run that goes by rates straight from value to value, and in the last step on as it came.
    fn directly(&self, to: u32) -> Fmu {
        let fmu = self.started();
        let rates = |step: u32| -> Vec<f64> {
            let ends = (self.at)(step + 1).into_iter().zip((self.at)(step));
            ends.map(|(end, begin)| (end - begin) / self.step(step)).collect()
        };
        for step in 0..to {
            self.set(&fmu, &(self.at)(step));
            self.rate(&fmu, &rates(if step + 1 == to { step - 1 } else { step }));
            self.advance(&fmu, step);
        }
        fmu
    }

    /// The outputs, their derivatives by each input and by all, and by time where they have such; not what was spent.
    fn seen(&self, fmu: &Fmu) -> Vec<(String, u64)> {
        let reals = fmu.variables.entries().filter_map(|(reference, entry)| match entry.role {
            Role::Output { .. } if entry.kind == Kind::Real && !entry.name.starts_with("solver.") => {
                Some((reference, entry.name.clone()))
            }
            _ => None,
        });
        let (references, names): (Vec<u32>, Vec<String>) = reals.unzip();
        let inputs: Vec<u32> = self.inputs.iter().map(|name| fmu.reference(name)).collect();
        let unit = |i: usize| (0..inputs.len()).map(|k| if k == i { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        let all = (0..inputs.len()).map(|k| 0.3 - 0.5 * k as f64).collect();
        let mut seen = Vec::new();
        for (i, by) in (0..inputs.len()).map(unit).chain([all]).enumerate() {
            let mut values = vec![f64::NAN; references.len()];
            assert_eq!(fmu.get_derivatives(&references, &inputs, &by, &mut values), OK, "{:?}", fmu.messages());
            let named = names.iter().zip(&values).map(|(name, value)| (format!("d {name} by {i}"), value.to_bits()));
            seen.extend(named);
        }
        for (name, &reference) in names.iter().zip(&references) {
            seen.push((name.clone(), fmu.real(name).to_bits()));
            let mut rate = [f64::NAN];
            if fmu.get_rates(&[reference], &[1], &mut rate) == OK {
                seen.push((format!("d {name} by time"), rate[0].to_bits()));
            }
        }
        fmu.messages();
        assert!(seen.iter().any(|(name, bits)| name.contains(" by 1") && f64::from_bits(*bits) != 0.0));
        seen
    }

    fn check(&self, fmu: &Fmu, to: u32, what: &str) {
        for ((name, found), (_, right)) in self.seen(fmu).into_iter().zip(self.seen(&self.directly(to))) {
            assert_eq!(f64::from_bits(found), f64::from_bits(right), "{what}, step {to}: {name}");
        }
    }
}

/// After steps that were done again; with a state kept, taken back, written over and serialised between them; after a reset,
/// a discard, an error and the end.
#[test]
fn derivatives_after_a_repetition_are_those_of_a_run_that_went_there_directly() {
    for driven in [LAYER, ELEMENT, PATCH] {
        let fmu = driven.started();
        for to in 2..12 {
            driven.go(&fmu, if to == 2 { 0 } else { to - 1 }, to);
            driven.check(&fmu, to, "in the run");
        }
        // A value set without a step changes nothing.
        let (mut state, bytes) = (fmu.state(), fmu.frozen());
        driven.set(&fmu, &(driven.at)(3));
        driven.check(&fmu, 11, "with values set");
        driven.go(&fmu, 11, 15);
        driven.check(&fmu, 15, "after a state was kept");
        let other = driven.started();
        other.thaw(&bytes);
        driven.check(&other, 11, "serialised");
        driven.go(&other, 11, 15);
        driven.check(&other, 15, "after it was serialised");
        for what in ["taken back", "taken back again"] {
            assert_eq!(fmu.set_state(state), OK);
            driven.check(&fmu, 11, what);
            driven.go(&fmu, 11, 14);
            driven.check(&fmu, 14, what);
        }
        // Over the state kept, of the step from which the next goes back.
        assert_eq!((fmu.get_state(&mut state), fmu.reset()), (OK, OK));
        driven.start(&fmu);
        driven.go(&fmu, 0, 2);
        assert_eq!(fmu.set_state(state), OK);
        driven.check(&fmu, 14, "after a reset");
        driven.go(&fmu, 14, 16);
        driven.check(&fmu, 16, "after a reset");
        // A step that is refused, whose repetition was done.
        driven.set(&fmu, &(driven.at)(16));
        assert_eq!(fmu.set_rate(driven.inputs[0], 1e40), OK);
        let refused = fmu.step(fmu.last_successful_time(), driven.step(16));
        assert!(refused == DISCARD || refused == ERROR, "{refused}");
        if refused == ERROR {
            assert_eq!(fmu.set_state(state), OK);
            driven.go(&fmu, 14, 16);
        }
        fmu.messages();
        driven.check(&fmu, 16, "after a step that was refused");
        assert_eq!(fmu.terminate(), OK);
        driven.check(&fmu, 16, "at the end");
    }
}

/// Given a rate for the first step alone, values that go on evenly are what is extrapolated: the bits are those of a master
/// that gives the rates, and nothing is done again.
#[test]
fn a_constant_rate_gives_the_bits_of_rates() {
    for driven in [LAYER, ELEMENT, PATCH] {
        let (h, start) = (driven.h, (driven.at)(0));
        let change: Vec<f64> =
            (driven.at)(1).iter().zip(&start).map(|(next, at)| on_grid(0.01 * (next - at))).collect();
        let rates: Vec<f64> = change.iter().map(|change| change / h).collect();
        let run = |with_rates: bool| {
            let fmu = driven.started();
            for step in 0..40 {
                let moved = start.iter().zip(&change).map(|(at, change)| at + f64::from(step) * change);
                driven.set(&fmu, &moved.collect::<Vec<_>>());
                if with_rates || step == 0 {
                    driven.rate(&fmu, &rates);
                }
                assert_eq!(fmu.step(h * f64::from(step), h), OK, "{:?}", fmu.messages());
            }
            if fmu.variables.entries().any(|(_, entry)| entry.name == "solver.repeated") {
                let mut repeated = [-1];
                assert_eq!(fmu.get_integers(&[fmu.reference("solver.repeated")], &mut repeated), OK);
                assert_eq!(repeated, [0]);
            }
            assert!(change.iter().all(|change| *change == on_grid(*change)) && change.iter().any(|c| *c != 0.0));
            fmu.bits()
        };
        assert_eq!(run(false), run(true));
    }
}
