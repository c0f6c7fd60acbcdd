//! Small FMUs to fuzz, layers and an element, with the checks of every call.

use std::ffi::{CStr, CString, c_char, c_void};
use std::ops::Deref;
use std::sync::{Mutex, OnceLock};
use std::{env, fmt, fs, process, ptr};

use asperity::scene::OutputGroup;
use asperity_fmi::bindings::*;
use asperity_fmi::{Kind, PATCH_FILE, Role, SCENE_FILE, TABLE_FILE, VariableRef};

use super::master::{self, Instance};
use super::patches::{self, PATCHES};

pub use super::master::{DISCARD, OK};

/// The largest `solver.max_steps`.
pub const MAX_STEPS: i32 = 40;

/// A folder with a scene or a table, and the variables of its FMU.
pub struct Site {
    pub guid: CString,
    pub location: CString,
    pub reals: Vec<u32>,
    pub integers: Vec<u32>,
    /// The two inputs that cases set most: u and w; of a patch x and z.
    pub inputs: [u32; 2],
    /// Real parameters, and other inputs of a patch.
    pub numbers: Vec<u32>,
    /// String parameters.
    pub texts: Vec<u32>,
    /// The number of steps and the processor time; an element has neither.
    pub max_steps: Option<u32>,
    time: Option<u32>,
    /// A new instance as a byte string.
    pub fresh: Vec<u8>,
    /// Instances for further cases: reading the scene takes longer than most cases.
    pool: Mutex<Vec<(usize, usize)>>,
}

/// Layers without friction on a flat surface, with all kinds of links and friction on a wave and on points, of a
/// material; and an element.
pub fn sites() -> &'static [Site] {
    static SITES: OnceLock<Vec<Site>> = OnceLock::new();
    SITES.get_or_init(|| {
        let scenes = SCENES.iter().map(|text| (SCENE_FILE, with_all_outputs(text)));
        let resources = scenes.chain([(TABLE_FILE, table())]);
        resources.enumerate().map(|(number, (file, text))| Site::new(number, file, &text)).collect()
    })
}

/// Patches.
pub fn patch_sites() -> &'static [Site] {
    static SITES: OnceLock<Vec<Site>> = OnceLock::new();
    SITES.get_or_init(|| {
        (0..PATCHES.len()).map(|i| Site::new(sites().len() + i, PATCH_FILE, &patches::text(i))).collect()
    })
}

/// Number of cases after which an instance is freed.
const MAX_USES: usize = 200;

const SCENES: [&str; 7] = [
    "name = 'bare'\nlayer = { masses = 1, spacing = 1e-4, mass = 1e-7, vertical = { stiffness = 2e3 } }\n\
     surface = { kind = 'flat' }\nsolver = { max_steps = 30 }\n",
    "name = 'loose'\nlayer = { masses = 1, spacing = 1e-4, mass = 1e-7 }\nsurface = { kind = 'flat' }\n\
     solver = { method = 'auto', max_steps = 30 }\n",
    "solver = { method = 'event', relative_tolerance = 1e-4, max_steps = 30 }\n",
    "solver = { method = 'step', relative_tolerance = 1e-4, max_steps = 30 }\n",
    "solver = { method = 'auto', relative_tolerance = 1e-4, max_steps = 30 }\n",
    "solver = { method = 'auto', relative_tolerance = 1e-4, max_steps = 30, reduce = 0.05 }\ninput = { extrapolation = 'hold' }\n",
    RUBBER,
];

/// Two masses with all kinds of links, friction and outputs, under a carrier that is a body.
const EVERYTHING: &str = "
name = 'everything'
[layer]
masses = 2
spacing = 0.7e-4
mass = 1.0e-7
roughness = { kind = 'points', z = [0.0, 1e-7] }
vertical = { stiffness = 2e3, damping = 8e-3, maxwell = [{ stiffness = 1e3, relaxation_time = 1e-4 }] }
horizontal = { stiffness = 1e3, damping = 8e-3, maxwell = [{ stiffness = 5e2, relaxation_time = 1e-5 }] }
lateral_x = { stiffness = 5e2, damping = 2e-3, maxwell = [{ stiffness = 2e2, relaxation_time = 1e-5 }] }
lateral_z = { stiffness = 3e2, damping = 2e-3 }
[surface]
kind = 'points'
x = [0.0, 1e-4, 2e-4]
z = [0.0, 1e-6, 0.0]
periodic = true
[friction]
coulomb = 0.3
shear_force = 1e-5
[carrier.x]
mass = 1e-6
stiffness = 2e3
damping = 1e-2
[carrier.z]
mass = 1e-6
damping = 1e-1
load = 1e-3
";

/// Two masses of a material on a fitted foundation, with the adhesion that depends on speed and temperature, on the roughness below the profile.
const RUBBER: &str = "name = 'rubber'
layer = { foundation = 'layer', masses = 2, spacing = 0.7e-4, thickness = 1e-3, width = 1e-2, roughness = { kind = 'points', z = [0.0, 1e-7] } }
material = { density = 1.1e3, poisson_ratio = 0.49, equilibrium_modulus = 2e6, viscosity = 10.0, \
    prony = [{ modulus = 5e6, relaxation_time = 1e-5 }], \
    wlf = { c1 = 7.52, c2 = 119.75, reference_temperature = 293.15, temperature = 313.15 }, \
    heat = { conductivity = 0.25, capacity = 1.7e3 } }
input = { temperature = true }
surface = { kind = 'sinusoid', amplitude = 1e-6, wavelength = 1e-4, points_per_wavelength = 8, \
    fine = { hurst = 0.8, rms_slope = 1.0, longest = 2e-5, shortest = 5e-6 } }
friction = { coulomb = 0.3, shear_strength = 1e4, \
    rate_shear = { strength = 1e5, reference_speed = 6e-3, sharpness = 0.1 } }
solver = { method = 'auto', relative_tolerance = 1e-3, max_steps = 30 }
";

/// The text of a scene with all outputs; one without a name gets the missing tables, too.
fn with_all_outputs(text: &str) -> String {
    let base = if text.starts_with("name") { "" } else { EVERYTHING };
    let shown = |group: &&OutputGroup| **group != OutputGroup::Carrier || base.contains("[carrier.");
    let groups: Vec<String> =
        OutputGroup::ALL.iter().filter(shown).map(|group| format!("'{}'", group.word())).collect();
    format!("{text}fmu = {{ outputs = [{}] }}\n{base}", groups.join(", "))
}

/// A table of three speeds, three pressures and two temperatures, around w = 0.
pub fn table() -> String {
    let head = "# asperity sweep = 1\n# scene = swept\n# nominal_area = 4e-5 m2\n# rest_separation = 2e-6 m\n\
        speed [m/s],pressure [Pa],temperature [K],status,friction [1],friction_hysteresis [1],contact_ratio [1],\
        P_damper [W],P_friction [W],separation [m],tangential_stiffness [N/m]\n";
    let mut table = head.to_owned();
    for (speed, place) in [(1e-3, -1.0), (1e-2, 0.0), (1.0, 2.0)] {
        for (pressure, height) in [(1e5, 3e-6), (2e5, 1e-6), (5e5, -2e-6)] {
            for (kelvin, shift) in [(290, 0.2), (300, 0.0)] {
                let (at, above) = (place + shift, height + 1e-7 * place);
                let friction = 0.8 - 0.1 * at * at;
                let rest = format!("{friction},{},0.2,1e-3,2e-3,{above:e},2e4", 0.4 * friction);
                table += &format!("{speed:e},{pressure:e},{kelvin},steady,{rest}\n");
            }
        }
    }
    table
}

impl Site {
    fn new(number: usize, file: &str, text: &str) -> Self {
        let folder = env::temp_dir().join(format!("asperity-fmu-{}-{number}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        let file = folder.join(file);
        fs::write(&file, text).unwrap();
        if file.ends_with(PATCH_FILE) {
            patches::write_files(&folder, patches::POINTS);
        }
        let (guid, variables) = master::describe(&file);
        let of = |take: &dyn Fn(&VariableRef) -> bool| {
            variables.entries().filter(|(_, entry)| take(entry)).map(|(reference, _)| reference).collect::<Vec<_>>()
        };
        let is_output = |entry: &VariableRef| entry.is_calculated() && entry.name != "solver.run_time";
        let named = |name: &str| of(&|entry| entry.name == name).first().copied();
        let mut site = Self {
            guid: CString::new(guid).unwrap(),
            location: CString::new(folder.to_str().unwrap()).unwrap(),
            reals: of(&|entry| is_output(entry) && entry.kind == Kind::Real),
            integers: of(&|entry| is_output(entry) && entry.kind == Kind::Integer),
            inputs: [0, if named("u").is_some() { 1 } else { 2 }],
            numbers: of(&|entry| match entry.role {
                Role::Parameter(_) => entry.kind == Kind::Real,
                Role::Input(_) => named("u").is_none() && !["x", "z"].contains(&entry.name.as_str()),
                _ => false,
            }),
            texts: of(&|entry| entry.kind == Kind::Text),
            max_steps: named("solver.max_steps"),
            time: named("solver.run_time"),
            fresh: Vec::new(),
            pool: Mutex::default(),
        };
        site.fresh = site.fresh_bytes();
        site
    }

    fn fresh_bytes(&self) -> Vec<u8> {
        let instance = Instance { c: self.instantiate(false) };
        let bytes = frozen(instance);
        instance.free();
        bytes.unwrap()
    }

    /// An instance in the state of a new one, and the number of cases that it was used in.
    pub fn take(&'static self) -> (Fmu, usize) {
        let (c, uses) =
            self.pool.lock().unwrap().pop().unwrap_or_else(|| (self.instantiate(false).expose_provenance(), 0));
        (Fmu::new(self, ptr::with_exposed_provenance_mut(c)), uses)
    }

    /// Keeps an instance for another case, or frees it.
    pub fn give_back(&self, fmu: Fmu, uses: usize) {
        if uses < MAX_USES && fmu.reset() == OK && fmu.set_debug_logging(false, &[]) == OK {
            self.pool.lock().unwrap().push((fmu.c.expose_provenance(), uses + 1));
        } else {
            fmu.free();
        }
    }

    pub fn instantiate(&self, logging: bool) -> fmi2Component {
        let kind = fmi2Type_fmi2CoSimulation;
        let (guid, location, callbacks) = (self.guid.as_ptr(), self.location.as_ptr(), callbacks());
        // SAFETY: strings and callbacks that live.
        unsafe {
            asperity_fmi::fmi2Instantiate(c"fuzzed".as_ptr(), kind, guid, location, &callbacks, 0, logging.into())
        }
    }
}

/// Reads every message; fails on one of a panic caught at the interface.
unsafe extern "C" fn receive(
    _environment: *mut c_void,
    _instance: *const c_char,
    status: fmi2Status,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: strings of the FMU's.
    let [category, text] = [category, text].map(|string| unsafe { CStr::from_ptr(string) });
    assert!(category.to_str().is_ok_and(|name| name.starts_with("log")));
    assert!(text.to_str().is_ok_and(|text| !text.is_empty()));
    if status == fmi2Status_fmi2Fatal {
        fail(&text.to_string_lossy());
    }
}

/// Aborts, since a panic cannot leave a C function.
fn fail(message: &str) {
    eprintln!("{message}");
    process::abort();
}

pub fn callbacks() -> fmi2CallbackFunctions {
    master::callbacks_with(receive, ptr::null_mut())
}

/// Prints a case if FUZZ_SHOW is set.
pub fn show(case: &impl fmt::Debug) {
    static SHOWN: OnceLock<bool> = OnceLock::new();
    if *SHOWN.get_or_init(|| env::var_os("FUZZ_SHOW").is_some()) {
        eprintln!("{case:#?}");
    }
}

/// Checks that `status` is valid and not fmi2Fatal.
pub fn checked(status: fmi2Status) -> fmi2Status {
    assert!(status == OK || status == DISCARD || status == fmi2Status_fmi2Error, "status {status}");
    status
}

/// An instance and its site; not freed on drop.
#[derive(Clone, Copy)]
pub struct Fmu {
    instance: Instance,
    pub site: &'static Site,
}

impl Deref for Fmu {
    type Target = Instance;

    fn deref(&self) -> &Instance {
        &self.instance
    }
}

/// The bits of all outputs except the processor time.
pub type Outputs = Vec<u64>;

impl Fmu {
    /// The instance `c` of a site.
    pub fn new(site: &'static Site, c: fmi2Component) -> Self {
        Self { instance: Instance { c }, site }
    }

    /// The outputs; `None` where they cannot be read.
    pub fn outputs(&self) -> Option<Outputs> {
        let (reals, integers) = (&self.site.reals, &self.site.integers);
        let (mut values, mut counts) = (vec![f64::NAN; reals.len()], vec![-9; integers.len()]);
        let (first, second) = (self.get_reals(reals, &mut values), self.get_integers(integers, &mut counts));
        let (first, second) = (checked(first), checked(second));
        if first != OK {
            assert!(values.iter().all(|value| value.is_nan()), "written though refused");
            return None;
        }
        assert!(second == OK && values.iter().all(|value| value.is_finite()), "{values:?}");
        Some(values.iter().map(|value| value.to_bits()).chain(counts.iter().map(|&count| count as u64)).collect())
    }

    /// The outputs after a successful step, all of which must be readable.
    pub fn outputs_of_step(&self) -> Outputs {
        if let Some(reference) = self.site.time {
            let mut time = [f64::NAN];
            assert_eq!(self.get_reals(&[reference], &mut time), OK);
            assert!(time[0] >= 0.0);
        }
        self.outputs().expect("outputs after a step")
    }

    /// The time reached, where it can be read.
    pub fn time(&self) -> Option<f64> {
        let mut time = f64::NAN;
        // SAFETY: as above.
        let status =
            unsafe { asperity_fmi::fmi2GetRealStatus(self.c, fmi2StatusKind_fmi2LastSuccessfulTime, &mut time) };
        (checked(status) == OK).then_some(time)
    }

    /// A new FMU state; NULL where that is not allowed.
    pub fn keep(&self) -> fmi2FMUstate {
        keep(self.instance)
    }

    pub fn forget(&self, state: fmi2FMUstate) {
        forget(self.instance, state);
    }

    /// A state as a byte string.
    pub fn serialised(&self, state: fmi2FMUstate) -> Option<Vec<u8>> {
        serialised(self.instance, state)
    }

    /// The state of the instance as a byte string.
    pub fn frozen(&self) -> Option<Vec<u8>> {
        frozen(self.instance)
    }

    /// `solver.max_steps`; 0 for an element.
    pub fn max_steps(&self) -> i32 {
        let Some(reference) = self.site.max_steps else { return 0 };
        let mut steps = [0];
        if checked(self.get_integers(&[reference], &mut steps)) == OK { steps[0] } else { 0 }
    }

    /// Initialises a new instance; whether that succeeded.
    pub fn start(&self, [u, w, u_rate, w_rate]: [f64; 4]) -> bool {
        checked(self.setup_all(None, 0.0, None)) == OK
            && checked(self.enter()) == OK
            && checked(self.set_reals(&self.site.inputs, &[u, w])) == OK
            && self.set_rates([u_rate, w_rate]) == OK
            && checked(self.exit()) == OK
    }

    pub fn set_rates(&self, rates: [f64; 2]) -> fmi2Status {
        checked(self.instance.set_rates(&self.site.inputs, &[1, 1], &rates))
    }

    pub fn step(&self, point: f64, h: f64) -> fmi2Status {
        checked(self.instance.step(point, h))
    }

    /// A step with its checks: finite outputs where it was done, no change where it was refused.
    pub fn checked_step(&self, point: f64, h: f64) -> fmi2Status {
        let (outputs, time, kept) = (self.outputs(), self.time(), self.keep());
        let status = self.step(point, h);
        let frozen = if status == OK { None } else { self.serialised(kept) };
        if !kept.is_null() {
            self.forget(kept);
        }
        if status == OK {
            self.outputs_of_step();
            assert_eq!(self.last_step(), (OK, OK));
            let (before, after) = (time.expect("time before a step"), self.time().expect("time after a step"));
            assert!(after == point + h || (after == before && before + h == before), "{before} + {h}: {after}");
            return status;
        }
        assert_eq!(self.outputs(), outputs);
        assert!(self.time().is_none_or(|after| time.is_none_or(|before| before == after)));
        // The lifecycle and the status of the last step, a byte each, and the checksum tell of it.
        if let (Some(before), Some(after)) = (frozen, self.frozen()) {
            let end = before.len() - CHECKSUM;
            let changed = before[..end].iter().zip(&after).filter(|(before, after)| before != after).count();
            assert!(before.len() == after.len() && changed <= 2, "{changed} bytes changed by a step that was refused");
        }
        status
    }

    /// Checks that derivatives of all outputs by the inputs and of the forces by time are finite or refused.
    pub fn check_derivatives(&self, direction: [f64; 2]) {
        let (reals, mut values) = (&self.site.reals, vec![0.0; self.site.reals.len()]);
        let first = self.get_derivatives(reals, &self.site.inputs, &direction, &mut values);
        assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
        // F_x and F_z are the first, of a patch force.x and force.y.
        let second = self.get_rates(&reals[..2], &[1, 1], &mut values);
        assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
        checked(first);
        checked(second);
    }
}

fn keep(instance: Instance) -> fmi2FMUstate {
    let mut state = ptr::null_mut();
    assert_eq!(checked(instance.get_state(&mut state)) == OK, !state.is_null());
    state
}

fn forget(instance: Instance, mut state: fmi2FMUstate) {
    assert_eq!(instance.free_state(&mut state), OK);
    assert!(state.is_null());
}

fn serialised(instance: Instance, state: fmi2FMUstate) -> Option<Vec<u8>> {
    let mut size = 0;
    // SAFETY: an instance that lives, any handle.
    let status = unsafe { asperity_fmi::fmi2SerializedFMUstateSize(instance.c, state, &mut size) };
    if checked(status) != OK {
        return None;
    }
    let mut bytes = vec![0_u8; size];
    assert_eq!(instance.serialise(state, &mut bytes), OK);
    Some(bytes)
}

fn frozen(instance: Instance) -> Option<Vec<u8>> {
    let state = keep(instance);
    let bytes = serialised(instance, state);
    if !state.is_null() {
        forget(instance, state);
    }
    bytes
}

/// Length of the checksum at the end of a serialised state, bytes.
pub const CHECKSUM: usize = 16;
