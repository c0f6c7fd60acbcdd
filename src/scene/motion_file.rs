//! Files of a motion that was measured or comes from another program: displacements, loads and temperature over time,
//! linear between the rows.

use super::carrier::{CarrierBodies, CarrierBody};
use super::carrier::{Force, Path, Phase};
use super::material::Wlf;
use crate::tables::{ContentError, Dimension, FileKind, POSITIVE, Presence, ReadTable, ReadingNote, Role};

const MOTION_ROLES: [Role; 8] = [
    Role::new("time", "t, times, zeit, elapsed time, test time", Dimension::Time),
    Role {
        presence: Presence::Unnamed,
        ..Role::new("u", "x, displacement u, displacement x, carrier u, carrier x, x displacement", Dimension::Length)
    },
    Role {
        presence: Presence::Unnamed,
        ..Role::new("w", "z, displacement w, displacement z, carrier w, carrier z, z displacement", Dimension::Length)
    },
    Role::new("load", "normal load, load force", Dimension::Force).optional(),
    Role::new(
        "normal_force",
        "Fz, F_z, Fn, F_n, F_N, normal force F_N, measured normal force, force z, z force, vertical force, normalkraft",
        Dimension::Force,
    )
    .optional(),
    Role::new("pull", "tangential pull, pull force", Dimension::Force).optional(),
    Role::new("pressure", "mean pressure", Dimension::Pressure).optional(),
    Role::new("temperature", "T, temp, temperatur", Dimension::Temperature).optional().within(POSITIVE),
];
/// The file of a motion.
pub const MOTION: FileKind = FileKind {
    least: 2,
    rises: true,
    ..FileKind::new(
        "a motion",
        &MOTION_ROLES,
        "time, u and w, of which one that rests may be missing, and of a body along an axis, which has no u or w but by \
         its drive, load, pressure or pull; temperature where it is an input",
    )
};

/// The phases between the rows of a file, for a carrier whose bodies are these, and what is said of it. u and w count from
/// the first row: the carrier moves from where it stands.
///
/// A temperature is held from row to row. A force that a tester has measured along z is a load where the carrier bears one,
/// or else what came of the motion.
pub(super) fn phases(
    table: &ReadTable,
    carrier: &CarrierBodies,
) -> Result<(Vec<Phase>, Vec<ReadingNote>), ContentError> {
    let measured = table.column("normal_force").filter(|_| carrier.z.is_none() || table.column("load").is_some());
    let mut notes = Vec::new();
    if let Some(column) = measured {
        let text = format!("{} is left out: without [carrier.z] it comes of w", column.label());
        notes.push(ReadingNote { text, assumed: true });
    }
    let load = if measured.is_some() || table.column("load").is_some() { "load" } else { "normal_force" };
    check_forces(table, load, carrier)?;
    notes.extend(resting(table, carrier)?);
    let values = |key: &str, row: usize| table.values(key).get(row).copied();
    let rate = |key: &str, row: usize| {
        let [here, there, from, to] =
            [values(key, row)?, values(key, row + 1)?, values("time", row)?, values("time", row + 1)?];
        Some((there - here) / (to - from))
    };
    let first = ["u", "w"].map(|key| values(key, 0).unwrap_or(0.0));
    if first != [0.0, 0.0] {
        let text = format!("u and w count from the first row, {:?} m and {:?} m", first[0], first[1]);
        notes.push(ReadingNote { text, assumed: true });
    }
    let path = |key: &str, row: usize| Path { rate: rate(key, row).unwrap_or(0.0), ..Path::default() };
    let force =
        |key: &str, row: usize| values(key, row).map(|here| Force { start: Some(here), change: path(key, row) });
    let times = table.values("time");
    let phase = |row: usize| Phase {
        duration: times[row + 1] - times[row],
        u: path("u", row),
        w: path("w", row),
        load: force(load, row),
        pull: force("pull", row),
        pressure: force("pressure", row),
        temperature: values("temperature", row),
        is_row: true,
        ..Phase::default()
    };
    Ok(((0..times.len() - 1).map(phase).collect(), notes))
}

/// What is said of displacements that the file does not have and that nothing else moves; refused where it has nothing
/// but times.
fn resting(table: &ReadTable, carrier: &CarrierBodies) -> Result<Option<ReadingNote>, ContentError> {
    if table.columns.len() == 1 {
        return Err(ContentError::value(table.line, "columns", "time alone", MOTION.expected));
    }
    let rests = |key: &str, body: &Option<CarrierBody>| table.column(key).is_none() && !is_free(body);
    let names = match [rests("u", &carrier.x), rests("w", &carrier.z)] {
        [false, false] => return Ok(None),
        [true, false] => "u",
        [false, true] => "w",
        [true, true] => "u and w",
    };
    let (plural, them, stay) = if names.len() > 1 { ("s", "they", "stay") } else { ("", "it", "stays") };
    let text = format!("no column{plural} {names}: {them} {stay} as at the start");
    Ok(Some(ReadingNote { text, assumed: true }))
}

/// Whether forces alone move the carrier along an axis.
fn is_free(body: &Option<CarrierBody>) -> bool {
    body.as_ref().is_some_and(|body| !body.has_drive())
}

/// Refuses forces on an axis along which the carrier is no body, and two loads.
fn check_forces(table: &ReadTable, load: &str, carrier: &CarrierBodies) -> Result<(), ContentError> {
    let no_z = "no load and no pressure without [carrier.z]";
    let refused = [
        ("pressure", table.column(load).is_some(), "no load beside pressure"),
        (load, carrier.z.is_none(), no_z),
        ("pressure", carrier.z.is_none(), no_z),
        ("pull", carrier.x.is_none(), "no pull without [carrier.x]"),
    ];
    for (key, is_refused, expected) in refused {
        if let Some(column) = table.column(key).filter(|_| is_refused) {
            return Err(ContentError::value(table.line, "columns", &column.label(), expected));
        }
    }
    Ok(())
}

/// What a file must not have for a carrier whose bodies are these, with `material.wlf` where the temperature is an input.
pub(super) fn obstacle(phase: &Phase, carrier: &CarrierBodies, temperature: Option<&Wlf>) -> Option<&'static str> {
    let [body_x, body_z] = [&carrier.x, &carrier.z];
    let fits = |kelvin: f64| temperature.is_some_and(|wlf| Wlf { temperature: kelvin, ..*wlf }.check().is_ok());
    let obstacles = [
        (phase.u.rate != 0.0 && is_free(body_x), "no change of u with [carrier.x] that has no drive"),
        (phase.w.rate != 0.0 && is_free(body_z), "no change of w with [carrier.z] that has no drive"),
        (
            phase.temperature.is_some_and(|kelvin| !fits(kelvin)),
            "no temperature without temperature = true in [input], nor one beyond the pole of WLF's equation; temperatures are in K, 20 °C being 293.15 K",
        ),
    ];
    obstacles.into_iter().find_map(|(is_there, expected)| is_there.then_some(expected))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, carrier: &CarrierBodies) -> Result<(Vec<Phase>, Vec<ReadingNote>), ContentError> {
        phases(&MOTION.read_canonical(text.as_bytes())?, carrier)
    }

    fn on_body() -> CarrierBodies {
        CarrierBodies { z: Some(CarrierBody::default()), ..CarrierBodies::default() }
    }

    #[test]
    fn rows_are_ends_of_straight_motions() {
        let text = "time [s],u [m],w [m],load [N]\n0,1e-3,0,5\n2e-3,1.5e-3,-4e-5,5\n3e-3,1.5e-3,-4e-5,6\n";
        let (phases, notes) = read(text, &on_body()).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        assert!(phases.len() == 2 && close(phases[0].duration, 2e-3) && close(phases[0].u.rate, 0.25));
        assert!(close(phases[0].w.rate, -0.02) && phases[1].w.rate == 0.0 && phases[1].pull.is_none());
        let load = phases[1].load.unwrap();
        assert!(load.start == Some(5.0) && close(load.change.rate, 1e3));
        assert!(notes.iter().any(|note| note.text.contains("first row")), "{notes:?}");
    }

    /// Those rest, which is said.
    #[test]
    fn displacements_that_are_missing_rest() {
        let none = CarrierBodies::default();
        for (name, [u, w]) in [("u", [0.25, 0.0]), ("w", [0.0, 0.25])] {
            let (phases, notes) = read(&format!("time [s],{name} [m]\n0,0\n2,0.5\n"), &none).unwrap();
            assert_eq!([phases[0].u.rate, phases[0].w.rate], [u, w]);
            assert!(notes.iter().any(|note| note.assumed), "{notes:?}");
        }
        let (_, notes) = read("time [s],u [m],load [N]\n0,0,5\n2,0.5,5\n", &on_body()).unwrap();
        assert!(notes.iter().all(|note| !note.assumed), "{notes:?}");
        let (phases, notes) = read("time [s],temperature [K]\n0,300\n2,310\n", &none).unwrap();
        assert_eq!([phases[0].u.rate, phases[0].w.rate], [0.0, 0.0]);
        assert!(notes.iter().any(|note| note.assumed), "{notes:?}");
        assert!(read("time [s]\n0\n2\n", &none).is_err());
    }

    /// A tester's log has the forces that came of the motion; a load is none.
    #[test]
    fn measured_forces_are_left_out_or_loads() {
        let none = CarrierBodies::default();
        let log = |name: &str| format!("time [s],u [m],{name} [N],w [m]\n0,0,5,-1e-5\n1,1,5,-1e-5\n");
        let (phases, notes) = read(&log("normal_force"), &none).unwrap();
        assert!(phases[0].load.is_none() && notes.iter().any(|note| note.text.contains("left out")), "{notes:?}");
        let (phases, _) = read(&log("normal_force"), &on_body()).unwrap();
        assert_eq!(phases[0].load.and_then(|load| load.start), Some(5.0));
        let refused = read(&log("load"), &none).unwrap_err();
        assert_eq!((&refused.key[..], &refused.given[..]), ("columns", "column 3 \"load\""));
    }
}
