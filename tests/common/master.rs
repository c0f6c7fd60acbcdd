//! A small master: a scene in a folder, an instance of it, and every function as a method.

use std::ffi::{CStr, CString, c_char, c_void};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fs, mem, process, ptr};

use asperity::element::{FrictionTable, PointContact};
use asperity::patch::Patch;
use asperity::scene::Scene;
use asperity::seal::Seal;
use asperity_fmi::bindings::*;
use asperity_fmi::{Definition, PATCH_FILE, SCENE_FILE, SEAL_FILE, Sources, TABLE_FILE, VariableTable};

pub const OK: fmi2Status = fmi2Status_fmi2OK;
pub const DISCARD: fmi2Status = fmi2Status_fmi2Discard;
pub const ERROR: fmi2Status = fmi2Status_fmi2Error;

/// Two masses above a wave.
pub const SCENE: &str = r#"
name = "interface"
[layer]
masses = 2
spacing = 1.0e-4
mass = 1.0e-7
[layer.vertical]
stiffness = 2.0e3
damping = 8.0e-3
maxwell = [ { stiffness = 1.0e3, relaxation_time = 1.0e-4 } ]
[layer.horizontal]
stiffness = 1.0e3
damping = 8.0e-3
[surface]
kind = "file"
path = "profile.csv"
periodic = true
[friction]
coulomb = 0.3
[fmu]
outputs = ["forces", "contact"]
"#;

/// Three masses over the same wave, with all kinds of links, friction and outputs.
pub const EVERYTHING: &str = r#"
name = "everything"
[layer]
masses = 3
spacing = 0.7e-4
mass = 1.0e-7
vertical = { stiffness = 2e3, damping = 8e-3, maxwell = [{ stiffness = 1e3, relaxation_time = 1e-4 }] }
horizontal = { stiffness = 1e3, damping = 8e-3, maxwell = [{ stiffness = 5e2, relaxation_time = 1e-5 }] }
lateral_x = { stiffness = 5e2, damping = 2e-3, maxwell = [{ stiffness = 2e2, relaxation_time = 1e-5 }] }
lateral_z = { stiffness = 3e2, damping = 2e-3 }
[surface]
kind = "file"
path = "profile.csv"
periodic = true
[friction]
coulomb = 0.3
shear_force = 1e-5
[fmu]
outputs = ["forces", "dissipation", "friction", "contact", "energy", "tangent", "solver", "elements"]
"#;

/// A folder that is removed when it is no longer needed.
pub struct Folder(PathBuf);

impl Folder {
    /// A new folder whose name ends in `name`.
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("asperity-{}-{count}{name}", process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A folder with `scene` and its profile in it.
    pub fn with_scene(name: &str, scene: &str) -> Self {
        let folder = Self::new(name);
        fs::write(folder.scene_file(), scene).unwrap();
        fs::write(folder.path().join("profile.csv"), "x,z\n0,0\n1e-4,1e-6\n2e-4,0\n").unwrap();
        folder
    }

    /// A folder with an element's table in it.
    pub fn with_table(table: &str) -> Self {
        let folder = Self::new("table");
        fs::write(folder.path().join(TABLE_FILE), table).unwrap();
        folder
    }

    /// A folder with a patch and its table in it.
    pub fn with_patch(patch: &str, table: &Path) -> Self {
        let folder = Self::new("patch");
        fs::write(folder.path().join(PATCH_FILE), patch).unwrap();
        fs::copy(table, folder.path().join(table.file_name().unwrap())).unwrap();
        folder
    }

    /// A folder with a seal and the files that it names, which lie in `source`.
    pub fn with_seal(seal: &str, source: &Path) -> Self {
        let folder = Self::new("seal");
        let file = folder.path().join(SEAL_FILE);
        fs::write(&file, seal).unwrap();
        for name in seal.split('"').filter(|text| text.ends_with(".csv")) {
            fs::copy(source.join(name), folder.path().join(name)).unwrap();
        }
        folder
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn text(&self) -> &str {
        self.0.to_str().unwrap()
    }

    pub fn scene_file(&self) -> PathBuf {
        self.0.join(SCENE_FILE)
    }

    /// The GUID and the variables of the scene, the table or the patch in it.
    pub fn description(&self) -> (String, VariableTable) {
        let files = [PATCH_FILE, SEAL_FILE, TABLE_FILE, SCENE_FILE].map(|file| self.0.join(file));
        describe(files.iter().find(|file| file.is_file()).unwrap())
    }
}

/// The GUID and the variables of a scene, a table or a patch, which the file's name tells.
pub fn describe(file: &Path) -> (String, VariableTable) {
    let definition: Definition = if file.ends_with(PATCH_FILE) {
        Patch::load(file).unwrap().into()
    } else if file.ends_with(SEAL_FILE) {
        Seal::load(file).unwrap().into()
    } else if file.ends_with(TABLE_FILE) {
        PointContact::new(FrictionTable::load(file).unwrap()).into()
    } else {
        Scene::load(file).unwrap().into()
    };
    let variables = definition.variables();
    (asperity_fmi::guid(&Sources::new(file, &*definition).unwrap(), &variables), variables)
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A message as the logger received it.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub instance: String,
    pub status: fmi2Status,
    pub category: String,
    pub text: String,
}

pub type Messages = Mutex<Vec<Message>>;

unsafe extern "C" fn receive(
    environment: *mut c_void,
    instance: *const c_char,
    status: fmi2Status,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: the strings are the FMU's; the environment is what `callbacks` gave.
    unsafe {
        let string = |pointer| CStr::from_ptr(pointer).to_str().unwrap().to_owned();
        let message = Message { instance: string(instance), status, category: string(category), text: string(text) };
        environment.cast::<Messages>().as_ref().unwrap().lock().unwrap().push(message);
    }
}

/// Callbacks that collect messages.
pub fn callbacks(messages: &Messages) -> fmi2CallbackFunctions {
    callbacks_with(receive, ptr::from_ref(messages).cast_mut().cast())
}

pub type Receive = unsafe extern "C" fn(*mut c_void, *const c_char, fmi2Status, *const c_char, *const c_char);

/// Callbacks of which `receive` gets the messages; memory functions and stepFinished are NULL, so that a call of them
/// would crash.
pub fn callbacks_with(receive: Receive, environment: *mut c_void) -> fmi2CallbackFunctions {
    type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, fmi2Status, *const c_char, *const c_char, ...);
    // SAFETY: Rust cannot define a variadic function; one that ignores the variadic part is called in the same way.
    let logger = unsafe { mem::transmute::<Receive, Logger>(receive) };
    fmi2CallbackFunctions {
        logger: Some(logger),
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: environment,
    }
}

/// The arguments of fmi2Instantiate.
pub struct Request {
    pub name: Option<String>,
    pub kind: fmi2Type,
    pub guid: Option<String>,
    pub location: Option<String>,
    pub functions: *const fmi2CallbackFunctions,
    pub logging: bool,
}

impl Request {
    pub fn send(&self) -> fmi2Component {
        let [name, guid, location] =
            [&self.name, &self.guid, &self.location].map(|text| text.clone().map(|text| CString::new(text).unwrap()));
        let pointer = |text: &Option<CString>| text.as_ref().map_or(ptr::null(), |text| text.as_ptr());
        let (name, guid, location) = (pointer(&name), pointer(&guid), pointer(&location));
        // SAFETY: strings that live, NULL or callbacks that live.
        unsafe {
            asperity_fmi::fmi2Instantiate(name, self.kind, guid, location, self.functions, 0, self.logging.into())
        }
    }
}

/// An instance and its messages.
pub struct Fmu {
    instance: Instance,
    pub variables: VariableTable,
    messages: Box<Messages>,
    _folder: Folder,
}

impl Fmu {
    /// An instance of [`SCENE`].
    pub fn new() -> Self {
        Self::of(SCENE, false)
    }

    pub fn of(scene: &str, logging: bool) -> Self {
        Self::in_folder(Folder::with_scene("", scene), logging)
    }

    /// An instance of an element of `table`.
    pub fn of_table(table: &str, logging: bool) -> Self {
        Self::in_folder(Folder::with_table(table), logging)
    }

    /// An instance of a patch with the table at `table`.
    pub fn of_patch(patch: &str, table: &Path) -> Self {
        Self::in_folder(Folder::with_patch(patch, table), false)
    }

    /// An instance of a seal whose files lie in `source`.
    pub fn of_seal(seal: &str, source: &Path) -> Self {
        Self::in_folder(Folder::with_seal(seal, source), false)
    }

    fn in_folder(folder: Folder, logging: bool) -> Self {
        let (guid, variables) = folder.description();
        let messages = Box::new(Messages::default());
        let functions = callbacks(&messages);
        let location = format!("file://{}", folder.text());
        let request = Request {
            name: Some("a name".into()),
            kind: fmi2Type_fmi2CoSimulation,
            guid: Some(guid),
            location: Some(location),
            functions: &functions,
            logging,
        };
        let c = request.send();
        assert!(!c.is_null(), "{:?}", messages.lock());
        Self { instance: Instance { c }, variables, messages, _folder: folder }
    }

    /// An instance of [`SCENE`] in the initialisation mode.
    pub fn initialising() -> Self {
        Self::initialising_with(SCENE)
    }

    pub fn initialising_with(scene: &str) -> Self {
        let fmu = Self::of(scene, false);
        assert_eq!((fmu.setup(0.0), fmu.enter()), (OK, OK));
        fmu
    }

    /// An instance of [`SCENE`] that can step from time 0.
    pub fn running() -> Self {
        Self::running_with(SCENE)
    }

    pub fn running_with(scene: &str) -> Self {
        let fmu = Self::initialising_with(scene);
        assert_eq!(fmu.exit(), OK);
        fmu
    }

    /// The messages since the last call.
    pub fn messages(&self) -> Vec<Message> {
        mem::take(&mut self.messages.lock().unwrap())
    }

    /// Goes on from a byte string.
    pub fn thaw(&self, bytes: &[u8]) {
        let mut state = ptr::null_mut();
        assert_eq!(self.deserialise(bytes, &mut state), OK, "{:?}", self.messages());
        assert_eq!((self.set_state(state), self.free_state(&mut state)), (OK, OK));
    }

    /// The text of the one message since the last call.
    pub fn message(&self) -> String {
        let messages = self.messages();
        assert_eq!(messages.len(), 1, "{messages:?}");
        messages[0].text.clone()
    }

    /// The value reference of the variable `name`.
    pub fn reference(&self, name: &str) -> u32 {
        self.variables.entries().find(|(_, entry)| entry.name == name).unwrap().0
    }

    pub fn setup(&self, start: f64) -> fmi2Status {
        self.setup_all(None, start, None)
    }

    /// All outputs but the processor time, bit by bit.
    pub fn bits(&self) -> Vec<u64> {
        let is_time = |entry: &asperity_fmi::VariableRef| entry.name == "solver.run_time";
        let outputs = self.variables.entries().filter(|(_, entry)| entry.is_calculated());
        let bits = |(reference, entry): (u32, &asperity_fmi::VariableRef)| match entry.kind {
            asperity_fmi::Kind::Real => self.real(&entry.name).to_bits(),
            _ => {
                let mut value = [0];
                assert_eq!(self.get_integers(&[reference], &mut value), OK);
                u64::from(value[0].unsigned_abs())
            }
        };
        outputs.filter(|(_, entry)| !is_time(entry)).map(bits).collect()
    }

    pub fn real(&self, name: &str) -> f64 {
        let mut value = [f64::NAN];
        assert_eq!(self.get_reals(&[self.reference(name)], &mut value), OK, "{name}");
        value[0]
    }

    pub fn set_real(&self, name: &str, value: f64) -> fmi2Status {
        self.set_reals(&[self.reference(name)], &[value])
    }

    pub fn set_rate(&self, name: &str, rate: f64) -> fmi2Status {
        self.set_rates(&[self.reference(name)], &[1], &[rate])
    }
}

impl Deref for Fmu {
    type Target = Instance;

    fn deref(&self) -> &Instance {
        &self.instance
    }
}

/// A component that lives as long as this is used.
#[derive(Clone, Copy)]
pub struct Instance {
    pub c: fmi2Component,
}

/// The functions, safe here because the instance lives and the slices have the lengths given.
impl Instance {
    pub fn setup_all(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> fmi2Status {
        let (given, tolerance) = (tolerance.is_some().into(), tolerance.unwrap_or_default());
        // SAFETY: see above.
        unsafe {
            asperity_fmi::fmi2SetupExperiment(
                self.c,
                given,
                tolerance,
                start,
                stop.is_some().into(),
                stop.unwrap_or_default(),
            )
        }
    }

    pub fn enter(&self) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2EnterInitializationMode(self.c) }
    }

    pub fn exit(&self) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2ExitInitializationMode(self.c) }
    }

    pub fn step(&self, point: f64, h: f64) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2DoStep(self.c, point, h, 1) }
    }

    pub fn terminate(&self) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2Terminate(self.c) }
    }

    pub fn free(self) {
        // SAFETY: from fmi2Instantiate, and used no more.
        unsafe { asperity_fmi::fmi2FreeInstance(self.c) }
    }

    pub fn reset(&self) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2Reset(self.c) }
    }

    pub fn get_reals(&self, references: &[u32], values: &mut [f64]) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2GetReal(self.c, references.as_ptr(), references.len(), values.as_mut_ptr()) }
    }

    pub fn set_reals(&self, references: &[u32], values: &[f64]) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SetReal(self.c, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    pub fn get_integers(&self, references: &[u32], values: &mut [i32]) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2GetInteger(self.c, references.as_ptr(), references.len(), values.as_mut_ptr()) }
    }

    pub fn set_integers(&self, references: &[u32], values: &[i32]) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SetInteger(self.c, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    pub fn get_text(&self, reference: u32) -> Result<String, fmi2Status> {
        let mut value = ptr::null();
        // SAFETY: see above; the string lives until the next call.
        unsafe {
            match asperity_fmi::fmi2GetString(self.c, &reference, 1, &mut value) {
                OK => Ok(CStr::from_ptr(value).to_str().unwrap().to_owned()),
                status => Err(status),
            }
        }
    }

    pub fn set_text(&self, reference: u32, value: &str) -> fmi2Status {
        let value = CString::new(value).unwrap();
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SetString(self.c, &reference, 1, &value.as_ptr()) }
    }

    pub fn set_rates(&self, references: &[u32], orders: &[i32], rates: &[f64]) -> fmi2Status {
        let (count, orders) = (references.len(), orders.as_ptr());
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SetRealInputDerivatives(self.c, references.as_ptr(), count, orders, rates.as_ptr()) }
    }

    pub fn get_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2GetFMUstate(self.c, state) }
    }

    pub fn set_state(&self, state: fmi2FMUstate) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SetFMUstate(self.c, state) }
    }

    pub fn free_state(&self, state: &mut fmi2FMUstate) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2FreeFMUstate(self.c, state) }
    }

    /// An FMU state.
    pub fn state(&self) -> fmi2FMUstate {
        let mut state = ptr::null_mut();
        assert_eq!(self.get_state(&mut state), OK);
        assert!(!state.is_null());
        state
    }

    /// An FMU state as a byte string.
    pub fn serialised(&self, state: fmi2FMUstate) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: see above.
        assert_eq!(unsafe { asperity_fmi::fmi2SerializedFMUstateSize(self.c, state, &mut size) }, OK);
        let mut bytes = vec![0; size];
        assert_eq!(self.serialise(state, &mut bytes), OK);
        bytes
    }

    /// The instance as it stands as a byte string.
    pub fn frozen(&self) -> Vec<u8> {
        let mut state = self.state();
        let bytes = self.serialised(state);
        assert_eq!(self.free_state(&mut state), OK);
        bytes
    }

    pub fn serialise(&self, state: fmi2FMUstate, bytes: &mut [u8]) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SerializeFMUstate(self.c, state, bytes.as_mut_ptr().cast(), bytes.len()) }
    }

    pub fn deserialise(&self, bytes: &[u8], state: &mut fmi2FMUstate) -> fmi2Status {
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2DeSerializeFMUstate(self.c, bytes.as_ptr().cast(), bytes.len(), state) }
    }

    pub fn get_derivatives(&self, unknowns: &[u32], knowns: &[u32], by: &[f64], values: &mut [f64]) -> fmi2Status {
        let (known, by, values) = (knowns.as_ptr(), by.as_ptr(), values.as_mut_ptr());
        let (n, m) = (unknowns.len(), knowns.len());
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2GetDirectionalDerivative(self.c, unknowns.as_ptr(), n, known, m, by, values) }
    }

    pub fn get_rates(&self, references: &[u32], orders: &[i32], values: &mut [f64]) -> fmi2Status {
        let (count, orders) = (references.len(), orders.as_ptr());
        // SAFETY: see above.
        unsafe {
            asperity_fmi::fmi2GetRealOutputDerivatives(self.c, references.as_ptr(), count, orders, values.as_mut_ptr())
        }
    }

    pub fn set_debug_logging(&self, on: bool, categories: &[&CStr]) -> fmi2Status {
        let categories: Vec<_> = categories.iter().map(|category| category.as_ptr()).collect();
        // SAFETY: see above.
        unsafe { asperity_fmi::fmi2SetDebugLogging(self.c, on.into(), categories.len(), categories.as_ptr()) }
    }

    pub fn last_step(&self) -> (fmi2Status, fmi2Status) {
        let mut value = fmi2Status_fmi2Pending;
        // SAFETY: see above.
        (unsafe { asperity_fmi::fmi2GetStatus(self.c, fmi2StatusKind_fmi2DoStepStatus, &mut value) }, value)
    }

    pub fn last_successful_time(&self) -> f64 {
        let mut time = f64::NAN;
        let kind = fmi2StatusKind_fmi2LastSuccessfulTime;
        // SAFETY: see above.
        assert_eq!(unsafe { asperity_fmi::fmi2GetRealStatus(self.c, kind, &mut time) }, OK);
        time
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        self.instance.free();
    }
}
