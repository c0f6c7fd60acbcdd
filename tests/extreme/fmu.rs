//! A run of a case through the C interface, in this process.

use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use crate::catalogue::{Answer, Case, Steps};
use crate::master::{DISCARD, ERROR, Fmu, OK};
use crate::rules::Finding;
use crate::run::{self, Outcome, Stop, Watch};

/// Follows the script, or the excitation in even communication steps with the rates given.
pub fn by_fmu(case: &Case, method: &str, tight: f64) -> Outcome {
    let text = run::scene_text(case, method, tight);
    let scene = run::scene(case, method, tight);
    let mut drive = Drive::new(case, &text, &scene);
    let result = match &case.script {
        Some(script) => script.steps.iter().try_for_each(|steps| drive.follow(steps)),
        None => drive.follow_excitation(&scene, case.fmu_steps.unwrap_or(1)),
    };
    drive.watch.end(result.err())
}

struct Drive {
    fmu: Fmu,
    watch: Watch,
    time: f64,
    /// u and w as they are given, m.
    position: [f64; 2],
    reals: (Vec<u32>, Vec<usize>),
    integers: (Vec<u32>, Vec<usize>),
    /// The library along the same pieces, as long as every rate is given.
    twin: Option<(Simulation, Watch)>,
}

impl Drive {
    fn new(case: &Case, text: &str, scene: &Scene) -> Self {
        let fmu = Fmu::of(text, false);
        let watch = Watch::new(scene, case.undamped);
        let beside = Watch::new(scene, case.undamped);
        // The inputs, then the outputs in their order.
        let numbered = |real: bool| {
            let of_kind = move |(_, variable): &(usize, &asperity::outputs::Variable)| {
                (variable.kind == asperity::outputs::OutputType::Real) == real
            };
            let indices: Vec<usize> = watch.variables.iter().enumerate().filter(of_kind).map(|(i, _)| i).collect();
            (indices.iter().map(|&i| i as u32 + 2).collect(), indices)
        };
        let (reals, integers) = (numbered(true), numbered(false));
        let start = case.start;
        assert_eq!((fmu.setup(start.time), fmu.enter()), (OK, OK), "{}", case.name);
        let first = scene.excitation.first();
        let rates = [
            first.map_or(start.u_rate, |phase| phase.u.at(0.0).speed),
            first.map_or(start.w_rate, |phase| phase.w.at(0.0).speed),
        ];
        let position = [start.u, start.w];
        for (name, (value, rate)) in ["u", "w"].into_iter().zip(position.into_iter().zip(rates)) {
            assert_eq!((fmu.set_real(name, value), fmu.set_rate(name, rate)), (OK, OK), "{}", case.name);
        }
        assert_eq!(fmu.exit(), OK, "{}: {:?}", case.name, fmu.messages());
        let from = Start { u_rate: rates[0], w_rate: rates[1], ..start };
        let twin = Simulation::new(scene, &from).ok().map(|simulation| (simulation, beside));
        let mut drive = Self { fmu, watch, time: start.time, position, reals, integers, twin };
        drive.look();
        drive.compare();
        drive
    }

    /// Reads every output as a master does.
    fn read(&mut self) {
        let mut values = vec![f64::NAN; self.reals.0.len()];
        assert_eq!(self.fmu.get_reals(&self.reals.0, &mut values), OK);
        self.reals.1.iter().zip(&values).for_each(|(&i, &value)| self.watch.values[i] = value);
        let mut values = vec![0; self.integers.0.len()];
        assert_eq!(self.fmu.get_integers(&self.integers.0, &mut values), OK);
        self.integers.1.iter().zip(&values).for_each(|(&i, &value)| self.watch.values[i] = f64::from(value));
    }

    fn look(&mut self) {
        self.read();
        let carrier = ["u", "w"].map(|name| self.fmu.real(name));
        self.watch.note(self.time, carrier);
    }

    /// Takes the twin along a step that the instance has done.
    fn take_along(&mut self, h: f64, given: [f64; 2], rates: [Option<f64>; 2]) {
        let ([Some(u_rate), Some(w_rate)], Some((simulation, _))) = (rates, &mut self.twin) else {
            self.twin = None;
            return;
        };
        let (u, w) = simulation.carrier();
        let path = |stands: f64, value: f64, rate: f64| {
            // A position that is given but for its rounding is where the carrier stands.
            let same = (stands - value).abs() <= 4.0 * f64::EPSILON * stands.abs().max(value.abs());
            Path { rate: if same { rate } else { (value + h * rate - stands) / h }, ..Path::default() }
        };
        let motion =
            Motion { duration: h, u: path(u, given[0], u_rate), w: path(w, given[1], w_rate), ..Motion::default() };
        match simulation.advance(&motion) {
            Ok(()) => self.compare(),
            Err(error) => self.note("same", format!("the library stops where the instance does not: {error}")),
        }
    }

    /// The instance and the library give the same, bit for bit.
    fn compare(&mut self) {
        let Some((simulation, watch)) = &mut self.twin else { return };
        simulation.evaluate(&watch.variables, &mut watch.values);
        let pairs = watch.variables.iter().zip(watch.values.iter().zip(&self.watch.values));
        let differs = pairs
            .filter(|(variable, _)| variable.name != "solver.run_time")
            .find(|(_, (library, instance))| library.to_bits() != instance.to_bits());
        if let Some((variable, (library, instance))) = differs {
            let text = format!("t = {:e}: {} is {instance:e}, {library:e} by the library", self.time, variable.name);
            self.twin = None;
            self.note("same", text);
        }
    }

    fn follow(&mut self, steps: &Steps) -> Result<(), Stop> {
        for (position, jump) in self.position.iter_mut().zip(steps.jump) {
            *position = jump.unwrap_or(*position);
        }
        for i in 0..steps.count {
            self.step(steps.h[i % steps.h.len()], steps.rate, steps.expect)?;
        }
        Ok(())
    }

    fn follow_excitation(&mut self, scene: &Scene, count: usize) -> Result<(), Stop> {
        for phase in &scene.excitation {
            let start = self.position;
            let at = |i: usize| phase.duration * i as f64 / count as f64;
            for i in 0..count {
                let h = at(i + 1) - at(i);
                let rates = [phase.u.change(at(i), h) / h, phase.w.change(at(i), h) / h];
                self.position = [start[0] + phase.u.at(at(i)).position, start[1] + phase.w.at(at(i)).position];
                self.step(h, rates.map(Some), Answer::Ok)?;
            }
            self.position =
                [start[0] + phase.u.at(phase.duration).position, start[1] + phase.w.at(phase.duration).position];
        }
        Ok(())
    }

    /// One step; where it has to fail, what was before it has to be kept, and a good one has to go on from there.
    fn step(&mut self, h: f64, rates: [Option<f64>; 2], expect: Answer) -> Result<(), Stop> {
        let before = (self.fmu.bits(), self.fmu.last_successful_time());
        let mut state = self.fmu.state();
        let given = self.position;
        self.give(given, rates);
        let status = self.fmu.step(self.time, h);
        let answer = match status {
            OK => Answer::Ok,
            DISCARD => Answer::Discard,
            ERROR => Answer::Error,
            other => return Err(Stop { name: "status", text: format!("status {other}") }),
        };
        if answer == Answer::Ok {
            self.time = self.fmu.last_successful_time();
            for (position, rate) in self.position.iter_mut().zip(rates) {
                *position += rate.unwrap_or_default() * h;
            }
            self.look();
            self.take_along(h, given, rates);
        } else {
            // In the state error that time is not to be asked for.
            let time = if answer == Answer::Error { before.1 } else { self.fmu.last_successful_time() };
            if (self.fmu.bits(), time) != before {
                self.note("kept", format!("{answer:?} of a step of {h:e} s changed the outputs"));
            }
            if self.fmu.set_state(state) != OK {
                self.note("kept", format!("after {answer:?} the state before is not taken"));
            }
        }
        assert_eq!(self.fmu.free_state(&mut state), OK);
        let said = self.fmu.messages().into_iter().map(|message| message.text).collect::<Vec<_>>().join("; ");
        if answer != expect {
            // The instance says no more of an error than its text.
            let gave_up = answer == Answer::Discard && said.contains("the limit solver.max_steps");
            let name = if gave_up { "TooManySteps" } else { "answer" };
            return Err(Stop { name, text: format!("{answer:?}, not {expect:?}, for a step of {h:e} s: {said}") });
        }
        if answer != Answer::Ok {
            if said.is_empty() {
                self.note("reason", format!("{answer:?} without a reason"));
            }
            // What was given goes back to where the carrier stands.
            let bad = |position: f64| !position.is_finite();
            let [u, w] = ["u", "w"].map(|name| self.fmu.real(name));
            self.position = [
                if bad(self.position[0]) { u } else { self.position[0] },
                if bad(self.position[1]) { w } else { self.position[1] },
            ];
        }
        Ok(())
    }

    fn give(&mut self, position: [f64; 2], rates: [Option<f64>; 2]) {
        for (name, (value, rate)) in ["u", "w"].into_iter().zip(position.into_iter().zip(rates)) {
            assert_eq!(self.fmu.set_real(name, value), OK);
            if let Some(rate) = rate {
                assert_eq!(self.fmu.set_rate(name, rate), OK);
            }
        }
    }

    fn note(&mut self, rule: &'static str, text: String) {
        self.watch.outcome.findings.push(Finding { rule, text });
    }
}
