//! The master's logger, called with finished messages. The other callbacks are never used.
#![allow(unsafe_code)]

use std::ffi::CString;
use std::ptr;

use super::bindings::{self, fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment, fmi2Status};
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
    /// `functions` is NULL or points to the master's callbacks, which can be called for as long as this lives.
    pub(super) unsafe fn new(functions: *const fmi2CallbackFunctions, instance_name: &str) -> Self {
        // SAFETY: NULL or valid by the caller's promise.
        let functions = unsafe { functions.as_ref() };
        Self {
            logger: functions.and_then(|functions| functions.logger),
            environment: functions.map_or(ptr::null_mut(), |functions| functions.componentEnvironment),
            instance_name: c_text(instance_name),
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
