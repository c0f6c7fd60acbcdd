//! The host's side: its logger, called with finished messages (the other callbacks are never used); its floating-point
//! environment; the file that it loaded the library from.
#![allow(unsafe_code)]

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
use std::arch::asm;
use std::ffi::{CStr, CString, c_void};
use std::path::PathBuf;
use std::ptr;

use super::bindings::{
    self, fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status, fmi2String,
};
use super::error::Status;
use super::log::Message;

/// The master's logger and what it is called with.
#[derive(Debug)]
pub(super) struct Callbacks {
    logger: fmi2CallbackLogger,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
}

impl Callbacks {
    /// Copies the logger and its environment from `functions`. Where that or the logger is NULL, messages are dropped.
    ///
    /// # Safety
    /// `functions` is NULL or points to the master's callbacks, which can be called for as long as this lives;
    /// `instance_name` is NULL or a string.
    pub(super) unsafe fn new(functions: *const fmi2CallbackFunctions, instance_name: fmi2String) -> Self {
        // SAFETY: NULL or valid by the caller's promise.
        let functions = unsafe { functions.as_ref() };
        let instance_name = match instance_name.is_null() {
            true => CString::default(),
            // SAFETY: not NULL, so a string by the caller's promise.
            false => unsafe { CStr::from_ptr(instance_name) }.to_owned(),
        };
        Self {
            logger: functions.and_then(|functions| functions.logger),
            environment: functions.map_or(ptr::null_mut(), |functions| functions.componentEnvironment),
            instance_name,
        }
    }

    /// Passes the messages to the logger.
    pub(super) fn deliver(&self, messages: Vec<Message>) {
        let Some(logger) = self.logger else { return };
        for message in messages {
            let category = c_text(message.category.name());
            // The logger takes the text as a format: without arguments, every % must stand for itself.
            let text = c_text(&message.text.replace('%', "%%"));
            let name = self.instance_name.as_ptr();
            // SAFETY: the logger is the master's by the promise of `new`; the strings live until it returns, and the
            // format asks for no arguments.
            unsafe { logger(self.environment, name, message.status.into(), category.as_ptr(), text.as_ptr()) };
        }
    }
}

impl From<Status> for fmi2Status {
    fn from(status: Status) -> Self {
        match status {
            Status::Ok => bindings::fmi2Status_fmi2OK,
            Status::Warning => bindings::fmi2Status_fmi2Warning,
            Status::Discard => bindings::fmi2Status_fmi2Discard,
            Status::Error => bindings::fmi2Status_fmi2Error,
            Status::Fatal => bindings::fmi2Status_fmi2Fatal,
        }
    }
}

fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// The default floating-point environment, which Rust's arithmetic takes for granted: rounding to nearest, no traps, no
/// flushing to zero. That of the host returns when this is dropped, with its exception flags.
#[derive(Debug)]
pub(super) struct DefaultFloatingPoint {
    host: Registers,
}

impl DefaultFloatingPoint {
    /// Puts the host's environment by.
    pub(super) fn enter() -> Self {
        let host = Registers::read();
        Registers::DEFAULT.write();
        Self { host }
    }
}

impl Drop for DefaultFloatingPoint {
    fn drop(&mut self) {
        self.host.write();
    }
}

/// MXCSR, control and flags in one, and control and status of the x87, which C libraries may use.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
struct Registers {
    mxcsr: u32,
    x87_control: u16,
    x87_status: u16,
}

#[cfg(target_arch = "x86_64")]
impl Registers {
    /// With every flag of the x87: none is one too many.
    const DEFAULT: Self = Self { mxcsr: 0x1f80, x87_control: 0x037f, x87_status: Self::X87_FLAGS };
    const X87_FLAGS: u16 = 0x3f;

    fn read() -> Self {
        let mut read = Self::DEFAULT;
        let (mxcsr, control) = (&raw mut read.mxcsr, &raw mut read.x87_control);
        // SAFETY: two registers are stored into fields of their size.
        unsafe {
            asm!("stmxcsr [{}]", "fnstcw [{}]", in(reg) mxcsr, in(reg) control, options(nostack, preserves_flags))
        };
        read.x87_status = Self::x87_status();
        read
    }

    fn x87_status() -> u16 {
        let status;
        // SAFETY: it reads a register.
        unsafe { asm!("fnstsw ax", out("ax") status, options(nomem, nostack, preserves_flags)) };
        status
    }

    fn write(self) {
        if Self::x87_status() & !self.x87_status & Self::X87_FLAGS != 0 {
            // Otherwise a flag raised here would trap as soon as the host's control word unmasks it.
            // SAFETY: it clears the flags of the x87.
            unsafe { asm!("fnclex", options(nomem, nostack, preserves_flags)) };
        }
        let (mxcsr, control) = (&raw const self.mxcsr, &raw const self.x87_control);
        // SAFETY: the values are the default, or were read from there; a trap that one unmasks is the host's.
        unsafe {
            asm!(
                "fldcw [{}]", "ldmxcsr [{}]", in(reg) control, in(reg) mxcsr,
                options(nostack, preserves_flags, readonly),
            );
        }
    }
}

/// FPCR and FPSR.
#[cfg(target_arch = "aarch64")]
#[derive(Clone, Copy, Debug)]
struct Registers {
    control: u64,
    status: u64,
}

#[cfg(target_arch = "aarch64")]
impl Registers {
    const DEFAULT: Self = Self { control: 0, status: 0 };

    fn read() -> Self {
        let (control, status);
        // SAFETY: it reads two registers.
        unsafe { asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) status, options(nomem, nostack)) };
        Self { control, status }
    }

    fn write(self) {
        // SAFETY: the values are the default, or were read from there; a trap that one unmasks is the host's.
        unsafe {
            asm!("msr fpsr, {}", "msr fpcr, {}", in(reg) self.status, in(reg) self.control, options(nomem, nostack));
        }
    }
}

/// Other processors keep the host's environment.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[derive(Clone, Copy, Debug)]
struct Registers;

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
impl Registers {
    const DEFAULT: Self = Self;

    fn read() -> Self {
        Self
    }

    fn write(self) {}
}

/// The file of the shared library that this code is in; `None` where the system does not say.
#[cfg(unix)]
pub(super) fn library_file() -> Option<PathBuf> {
    use std::ffi::{OsStr, c_char, c_int};
    use std::os::unix::ffi::OsStrExt;

    /// `Dl_info` of dlfcn.h.
    #[repr(C)]
    struct Info {
        file: *const c_char,
        base: *mut c_void,
        symbol: *const c_char,
        address: *mut c_void,
    }
    unsafe extern "C" {
        fn dladdr(address: *const c_void, info: *mut Info) -> c_int;
    }
    let mut info = Info { file: ptr::null(), base: ptr::null_mut(), symbol: ptr::null(), address: ptr::null_mut() };
    // SAFETY: the address is one of this code, and what is filled lives.
    let found = unsafe { dladdr((library_file as fn() -> Option<PathBuf>) as *const c_void, &mut info) };
    if found == 0 || info.file.is_null() {
        return None;
    }
    // SAFETY: a string that the loader keeps as long as the library is loaded.
    let file = unsafe { CStr::from_ptr(info.file) };
    Some(PathBuf::from(OsStr::from_bytes(file.to_bytes())))
}

/// The file of the shared library that this code is in; `None` where the system does not say.
#[cfg(windows)]
pub(super) fn library_file() -> Option<PathBuf> {
    use std::ffi::OsString;
    use std::os::windows::ffi::OsStringExt;

    /// That the name is an address, and the count of references stays as it is.
    const FROM_ADDRESS_UNCOUNTED: u32 = 4 | 2;
    unsafe extern "system" {
        fn GetModuleHandleExW(flags: u32, name: *const c_void, module: *mut *mut c_void) -> i32;
        fn GetModuleFileNameW(module: *mut c_void, name: *mut u16, size: u32) -> u32;
    }
    let address = (library_file as fn() -> Option<PathBuf>) as *const c_void;
    let (mut module, mut name) = (ptr::null_mut(), vec![0_u16; 32_768]);
    // SAFETY: the address is one of this code; what is filled lives and has the size given.
    let length = unsafe {
        if GetModuleHandleExW(FROM_ADDRESS_UNCOUNTED, address, &mut module) == 0 {
            return None;
        }
        GetModuleFileNameW(module, name.as_mut_ptr(), name.len() as u32) as usize
    };
    (1..name.len()).contains(&length).then(|| PathBuf::from(OsString::from_wide(&name[..length])))
}
