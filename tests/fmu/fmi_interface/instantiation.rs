//! Instantiation: its checks, and where the scene is found.

use std::ffi::CStr;
use std::{fs, ptr};

use asperity_fmi::bindings::*;
use asperity_fmi::{fmi2FreeInstance, fmi2GetTypesPlatform, fmi2GetVersion};

use crate::common::assert_names;
use crate::fmu::fmi_interface::master::{ERROR, Folder, Message, Messages, Request, SCENE, callbacks};

#[test]
fn version_and_platform_are_the_standards() {
    // SAFETY: static strings.
    let texts = unsafe { [fmi2GetVersion(), fmi2GetTypesPlatform()].map(|text| CStr::from_ptr(text)) };
    assert_eq!(texts, [c"2.0", c"default"]);
}

/// Tries to make an instance of the scene in `folder` for a GUID, `change` applied to the request: whether it is made, and
/// what is said.
pub fn asked(folder: &Folder, guid: &str, change: impl FnOnce(&mut Request)) -> (bool, Vec<Message>) {
    let messages = Messages::default();
    let functions = callbacks(&messages);
    let mut request = Request {
        name: Some("one".into()),
        kind: fmi2Type_fmi2CoSimulation,
        guid: Some(guid.into()),
        location: Some(folder.text().into()),
        functions: &functions,
        logging: false,
    };
    change(&mut request);
    let c = request.send();
    if !c.is_null() {
        // SAFETY: just made.
        unsafe { fmi2FreeInstance(c) };
    }
    (!c.is_null(), messages.into_inner().unwrap())
}

/// The error's text, if any.
fn attempt(folder: &Folder, change: impl FnOnce(&mut Request)) -> Result<(), String> {
    let (is_made, messages) = asked(folder, &folder.description().0, change);
    if is_made {
        return Ok(());
    }
    assert_eq!(messages.len(), 1);
    assert_eq!((messages[0].status, messages[0].category.as_str()), (ERROR, "logStatusError"));
    Err(messages[0].text.clone())
}

#[test]
fn a_failed_instantiation_returns_null_and_logs_why() {
    let folder = Folder::with_scene("", SCENE);
    assert_eq!(attempt(&folder, |_| ()), Ok(()));
    let refused = |change: fn(&mut Request), expected: &str| {
        let text = attempt(&folder, change).unwrap_err();
        assert!(text.starts_with("fmi2Instantiate: ") && text.contains(expected), "{text}");
    };
    refused(|request| request.kind = fmi2Type_fmi2ModelExchange, "co-simulation");
    refused(|request| request.kind = 7, "co-simulation");
    refused(|request| request.guid = None, "fmuGUID is NULL");
    refused(|request| request.guid = Some("{other}".into()), "{other}");
    refused(|request| request.location = None, "scene.toml");
    refused(|request| request.location = Some("file:///no/such/folder".into()), "/no/such/folder");
    refused(|request| request.location = Some(String::new()), "scene.toml");
}

/// An instance's name is for messages alone. Where something is guessed, a warning says what.
#[test]
fn what_masters_pass_is_understood() {
    let folder = Folder::with_scene("", SCENE);
    let guid = folder.description().0;
    let warnings = |change: &dyn Fn(&mut Request)| {
        let (is_made, messages) = asked(&folder, &guid, change);
        assert!(is_made, "{messages:?}");
        messages.into_iter().map(|message| message.text).collect::<Vec<_>>()
    };
    assert!(warnings(&|_| ()).is_empty());
    assert!(warnings(&|request| request.name = None).is_empty());
    assert!(warnings(&|request| request.name = Some(String::new())).is_empty());
    for other in [guid.trim_matches(['{', '}']).to_owned(), guid.to_uppercase()] {
        let text = warnings(&|request| request.guid = Some(other.clone()));
        assert!(text.len() == 1 && text[0].contains(&guid), "{text:?}");
    }
    let resources = folder.path().join("resources");
    fs::create_dir_all(&resources).unwrap();
    for file in ["scene.toml", "profile.csv"] {
        fs::rename(folder.path().join(file), resources.join(file)).unwrap();
    }
    let text = warnings(&|_| ());
    assert!(text.len() == 1 && text[0].contains("resources"), "{text:?}");
}

#[test]
fn an_invalid_scene_is_reported_with_the_readers_message() {
    let folder = Folder::with_scene("", SCENE);
    let guid = folder.description().0;
    fs::write(folder.scene_file(), SCENE.replace("masses = 2", "masses = 0")).unwrap();
    let (is_made, messages) = asked(&folder, &guid, |_| ());
    assert!(!is_made);
    assert_names(&messages[0].text, "scene.toml:4: layer.masses = 0");
}

#[test]
fn callbacks_and_logger_may_be_null() {
    let folder = Folder::with_scene("", SCENE);
    let (messages, no_logger) = (Messages::default(), |functions: &mut fmi2CallbackFunctions| functions.logger = None);
    let mut functions = callbacks(&messages);
    no_logger(&mut functions);
    assert_eq!(attempt(&folder, |request| request.functions = ptr::null()), Ok(()));
    assert_eq!(attempt(&folder, |request| request.functions = &functions), Ok(()));
    let without = |request: &mut Request| {
        (request.location, request.functions, request.logging) = (None, ptr::null(), true);
    };
    assert!(!asked(&folder, &folder.description().0, without).0);
}

#[test]
fn null_is_no_instance() {
    // SAFETY: NULL is what is tested.
    unsafe {
        fmi2FreeInstance(ptr::null_mut());
        assert_eq!(asperity_fmi::fmi2DoStep(ptr::null_mut(), 0.0, 1.0, 0), ERROR);
    }
}

#[test]
fn resources_are_found_in_every_spelling() {
    let folder = Folder::with_scene(" ä#1 50% a%20b", SCENE);
    let raw = folder.text();
    let encoded = raw.replace('%', "%25").replace(' ', "%20").replace('#', "%23").replace('ä', "%C3%A4");
    for path in [raw, &encoded, &format!("{raw}/"), &format!("{encoded}/")] {
        for start in ["file://", "file:///", "file://localhost", "file:", "FILE://", ""] {
            let location = format!("{start}{path}");
            assert_eq!(attempt(&folder, |request| request.location = Some(location.clone())), Ok(()), "{location}");
        }
    }
}

#[test]
fn the_guid_follows_whatever_would_run_differently() {
    let folder = Folder::with_scene("", SCENE);
    let first = folder.description().0;
    assert_eq!(folder.description().0, first);
    assert_eq!(Folder::with_scene(" elsewhere", SCENE).description().0, first);
    fs::write(folder.path().join("profile.csv"), "x,z\n0,0\n1e-4,2e-6\n2e-4,0\n").unwrap();
    assert_ne!(folder.description().0, first);
    assert_ne!(Folder::with_scene("", &SCENE.replace("0.3", "0.4")).description().0, first);
}
