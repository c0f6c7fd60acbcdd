//! A simulation that is advanced step by step.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use asperity::outputs::{Variable, variables};
use asperity::scene::{Force, Input, Path};
use asperity::simulation::{Interrupt, Motion, SimulationError, SimulationState, Start};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::errors::{Raise as _, check_dt, no_output};
use crate::scene::Scene;
use crate::state::state_class;

state_class!(State, SimulationState, "a simulation");

/// A run of a scene, advanced step by step.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Simulation {
    run: Mutex<asperity::simulation::Simulation>,
    variables: Vec<Variable>,
    inputs: Vec<Input>,
    /// The exception that stopped a motion.
    raised: Arc<Mutex<Option<PyErr>>>,
}

impl Simulation {
    /// The run. It does not wait for a thread that advances it: that one may wait for the interpreter's lock.
    fn run(&self) -> PyResult<MutexGuard<'_, asperity::simulation::Simulation>> {
        match self.run.try_lock() {
            Ok(run) => Ok(run),
            Err(TryLockError::Poisoned(error)) => Ok(error.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err("the simulation is being advanced elsewhere")),
        }
    }

    fn variable(&self, name: &str) -> PyResult<&Variable> {
        let found = self.variables.iter().find(|variable| variable.name == name);
        found.ok_or_else(|| no_output(name, self.variables.iter().map(|variable| variable.name.as_str())))
    }
}

/// Refuses what is given for an input that the scene does not have, which nothing would read.
fn check_inputs(inputs: &[Input], given: &[(Input, bool)]) -> PyResult<()> {
    let Some((unread, _)) = given.iter().find(|(input, is_given)| *is_given && !inputs.contains(input)) else {
        return Ok(());
    };
    let known: Vec<&str> = inputs.iter().map(|input| input.name()).collect();
    Err(PyValueError::new_err(format!("{}: the scene has no such input; it has {}", unread.name(), known.join(", "))))
}

/// Asks the interpreter for Ctrl-C between the steps of a motion, now and then.
fn signals(raised: Arc<Mutex<Option<PyErr>>>) -> Interrupt {
    const INTERVAL: Duration = Duration::from_millis(100);
    /// The clock is read every so many steps.
    const STEPS: u32 = 16;
    let (count, looked) = (AtomicU32::new(0), Mutex::new(Instant::now()));
    Interrupt::new(move || {
        if !count.fetch_add(1, Ordering::Relaxed).is_multiple_of(STEPS) {
            return false;
        }
        let mut looked = looked.lock().unwrap_or_else(PoisonError::into_inner);
        if looked.elapsed() < INTERVAL {
            return false;
        }
        *looked = Instant::now();
        let Err(error) = Python::attach(|py| py.check_signals()) else { return false };
        *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        true
    })
}

/// A displacement that reaches `target` after `duration`, or changes at a `rate`; else it rests.
fn path(name: &str, duration: f64, now: f64, target: Option<f64>, rate: Option<f64>) -> PyResult<Path> {
    let rate = match (target, rate) {
        (Some(_), Some(_)) => {
            return Err(PyValueError::new_err(format!("{name} and {name}_rate: expected one of them")));
        }
        (Some(target), None) => (target - now) / duration,
        (None, rate) => rate.unwrap_or(0.0),
    };
    Ok(Path { rate, ..Path::default() })
}

/// A force that jumps to a value, if there is one, and changes at a rate.
fn force(start: Option<f64>, rate: Option<f64>) -> Force {
    Force { start, change: Path { rate: rate.unwrap_or(0.0), ..Path::default() } }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (scene, u=0.0, w=0.0, u_rate=0.0, w_rate=0.0, load=0.0, pull=0.0, temperature=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        scene: &Scene,
        u: f64,
        w: f64,
        u_rate: f64,
        w_rate: f64,
        load: f64,
        pull: f64,
        temperature: Option<f64>,
    ) -> PyResult<Self> {
        let inputs = scene.scene.inputs();
        let is_moved = |displacement: f64, rate: f64| displacement != 0.0 || rate != 0.0;
        check_inputs(
            &inputs,
            &[
                (Input::U, is_moved(u, u_rate)),
                (Input::W, is_moved(w, w_rate)),
                (Input::Load, load != 0.0),
                (Input::Pull, pull != 0.0),
                (Input::Temperature, temperature.is_some()),
            ],
        )?;
        let start = Start { time: 0.0, u, w, u_rate, w_rate, load, pull, temperature };
        let run = asperity::simulation::Simulation::new(&scene.scene, &start);
        let mut run = run.map_err(|error: SimulationError| error.raise())?;
        let raised = Arc::default();
        run.set_interrupt(Some(signals(Arc::clone(&raised))));
        Ok(Self { run: Mutex::new(run), variables: variables(&scene.scene), inputs, raised })
    }

    /// Moves the carrier for `dt`.
    #[pyo3(signature = (
        dt, u=None, w=None, *, u_rate=None, w_rate=None, load=None, load_rate=None, pull=None, pull_rate=None,
        temperature=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn advance(
        &self,
        py: Python<'_>,
        dt: f64,
        u: Option<f64>,
        w: Option<f64>,
        u_rate: Option<f64>,
        w_rate: Option<f64>,
        load: Option<f64>,
        load_rate: Option<f64>,
        pull: Option<f64>,
        pull_rate: Option<f64>,
        temperature: Option<f64>,
    ) -> PyResult<()> {
        check_dt(dt)?;
        check_inputs(
            &self.inputs,
            &[
                (Input::U, u.is_some() || u_rate.is_some()),
                (Input::W, w.is_some() || w_rate.is_some()),
                (Input::Load, load.is_some() || load_rate.is_some()),
                (Input::Pull, pull.is_some() || pull_rate.is_some()),
                (Input::Temperature, temperature.is_some()),
            ],
        )?;
        let (now_u, now_w) = self.run()?.driven();
        let motion = Motion {
            duration: dt,
            u: path("u", dt, now_u, u, u_rate)?,
            w: path("w", dt, now_w, w, w_rate)?,
            load: force(load, load_rate),
            pull: force(pull, pull_rate),
            temperature,
        };
        let advanced = py.detach(|| Ok::<_, PyErr>(self.run()?.advance(&motion)))?;
        advanced.map_err(|error| {
            let raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner).take();
            raised.unwrap_or_else(|| error.raise())
        })
    }

    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.run()?.time())
    }

    /// u and w of the carrier.
    #[getter]
    fn carrier(&self) -> PyResult<(f64, f64)> {
        Ok(self.run()?.carrier())
    }

    #[getter]
    fn temperature(&self) -> PyResult<Option<f64>> {
        Ok(self.run()?.temperature())
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        self.variables.iter().map(|variable| variable.name.as_str()).collect()
    }

    #[getter]
    fn units(&self) -> Vec<(&str, &'static str)> {
        self.variables.iter().map(|variable| (variable.name.as_str(), variable.unit.name())).collect()
    }

    /// The value of an output.
    fn value(&self, name: &str) -> PyResult<f64> {
        let variable = self.variable(name)?;
        let mut value = [0.0];
        self.run()?.evaluate(std::slice::from_ref(variable), &mut value);
        Ok(value[0])
    }

    /// The values of all outputs.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut values = vec![0.0; self.variables.len()];
        self.run()?.evaluate(&self.variables, &mut values);
        Ok(values.into_pyarray(py))
    }

    /// The change of an output with a displacement of the carrier, the state held.
    fn derivative(&self, name: &str, u: f64, w: f64) -> PyResult<f64> {
        let variable = self.variable(name)?;
        let mut value = [0.0];
        self.run()?.directional_derivative(std::slice::from_ref(variable), (u, w), &mut value);
        Ok(value[0])
    }

    /// The rates of F_x and F_z.
    fn force_rates(&self) -> PyResult<(f64, f64)> {
        let rates = self.run()?.force_rates();
        Ok((rates.x, rates.z))
    }

    fn state(&self) -> PyResult<State> {
        Ok(State(self.run()?.state()))
    }

    fn set_state(&self, state: &State) -> PyResult<()> {
        let set = self.run()?.set_state(&state.0);
        set.map_err(|error| PyValueError::new_err(error.to_string()))
    }
}
