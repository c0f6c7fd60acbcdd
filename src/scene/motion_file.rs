//! Files of a motion that was measured or comes from another program: displacements, loads and temperature over time,
//! linear between the rows.

use super::carrier::{CarrierBodies, CarrierBody};
use super::carrier::{Force, Path, Phase};
use super::material::Wlf;
use crate::tables::{
    Choice, Column, ContentError, Dimension, Format, POSITIVE, ReadingNote, Table, Wanted, Words, decode,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OfMotion {
    Time,
    U,
    W,
    Load,
    /// F_z as a tester has it: a load where the carrier bears one, or else what came of the motion.
    NormalForce,
    Pull,
    Pressure,
    Temperature,
}

const MOTION: Format<OfMotion, 7> = Format {
    least: 2,
    rises: true,
    ..Format::new(
        &[
            Words::new(OfMotion::Time, Dimension::Time, "time t zeit", ""),
            Words::new(OfMotion::U, Dimension::Length, "u x", "displacement carrier"),
            Words::new(OfMotion::W, Dimension::Length, "w z", "displacement carrier"),
            Words::new(OfMotion::Load, Dimension::Force, "load", "normal force"),
            Words::new(
                OfMotion::NormalForce,
                Dimension::Force,
                "fz fn normal normalkraft f+z f+n",
                "force vertical z n f measured",
            ),
            Words::new(OfMotion::Pull, Dimension::Force, "pull", "tangential force"),
            Words::new(OfMotion::Pressure, Dimension::Pressure, "pressure", "mean"),
            Words::new(OfMotion::Temperature, Dimension::Temperature, "temperature temp", ""),
        ],
        [
            Wanted::new(&[OfMotion::Time], "time", "times"),
            Wanted::new(&[OfMotion::U], "u", "displacements u").optional_by_name(),
            Wanted::new(&[OfMotion::W], "w", "displacements w").optional_by_name(),
            Wanted {
                choice: Choice::FirstQuantity,
                ..Wanted::new(&[OfMotion::Load, OfMotion::NormalForce], "load", "loads").optional()
            },
            Wanted::new(&[OfMotion::Pull], "pull", "tangential forces").optional(),
            Wanted::new(&[OfMotion::Pressure], "pressure", "pressures").optional(),
            Wanted::new(&[OfMotion::Temperature], "temperature", "temperatures").optional().within(POSITIVE),
        ],
        "time, u and w, of which one that rests may be missing, and of a body along an axis, which has no u or w but by \
         its drive, load, pressure or pull; temperature where it is an input",
    )
};

/// The phases between the rows of a file, for a carrier whose bodies are these. u and w count from the first row: the
/// carrier moves from where it stands.
///
/// A temperature is held from row to row.
pub(super) fn read_motion(
    bytes: &[u8],
    carrier: &CarrierBodies,
) -> Result<(Vec<Phase>, Vec<ReadingNote>), ContentError> {
    let text = decode(bytes)?;
    let Table { mut columns, rows, mut notes, line, .. } = MOTION.read(&text)?;
    if let Some(measured) = columns[3].take_if(|column| is_measured(column) && carrier.z.is_none()) {
        notes.retain(|note| !note.text.contains(&measured.label()));
        let text = format!("{} is left out: without [carrier.z] it comes of w", measured.label());
        notes.push(ReadingNote { text, assumed: true });
    }
    check_forces(&columns, line, carrier)?;
    notes.extend(resting(&columns, line, carrier)?);
    let first = rows.first().copied().unwrap_or_default();
    if first[1..3] != [0.0, 0.0] {
        let text = format!("u and w count from the first row, {:?} m and {:?} m", first[1], first[2]);
        notes.push(ReadingNote { text, assumed: true });
    }
    let phase = |rows: &[[f64; 7]]| {
        let ([here, there], duration) = ([rows[0], rows[1]], rows[1][0] - rows[0][0]);
        let rate = |column: usize| (there[column] - here[column]) / duration;
        let path = |column: usize| Path { rate: rate(column), ..Path::default() };
        let force =
            |column: usize| columns[column].as_ref().map(|_| Force { start: Some(here[column]), change: path(column) });
        Phase {
            duration,
            u: path(1),
            w: path(2),
            load: force(3),
            pull: force(4),
            pressure: force(5),
            temperature: columns[6].as_ref().map(|_| here[6]),
            is_row: true,
            ..Phase::default()
        }
    };
    Ok((rows.windows(2).map(phase).collect(), notes))
}

/// What is said of displacements that the file does not have and that nothing else moves; refused where it has nothing
/// but times.
fn resting(
    columns: &[Option<Column<OfMotion>>; 7],
    line: Option<usize>,
    carrier: &CarrierBodies,
) -> Result<Option<ReadingNote>, ContentError> {
    if columns[1..].iter().all(Option::is_none) {
        return Err(ContentError::value(line, "columns", "time alone", MOTION.expected));
    }
    let rests = |column: &Option<_>, body: &Option<CarrierBody>| column.is_none() && !is_free(body);
    let names = match [rests(&columns[1], &carrier.x), rests(&columns[2], &carrier.z)] {
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

fn is_measured(column: &Column<OfMotion>) -> bool {
    column.quantity == OfMotion::NormalForce
}

/// Refuses forces on an axis along which the carrier is no body, and two loads.
fn check_forces(
    [_, _, _, load, pull, pressure, _]: &[Option<Column<OfMotion>>; 7],
    line: Option<usize>,
    carrier: &CarrierBodies,
) -> Result<(), ContentError> {
    let no_z = "no load and no pressure without [carrier.z]";
    let refused = [
        (pressure, load.is_some(), "no load beside pressure"),
        (load, carrier.z.is_none(), no_z),
        (pressure, carrier.z.is_none(), no_z),
        (pull, carrier.x.is_none(), "no pull without [carrier.x]"),
    ];
    match refused.into_iter().find(|(column, is_refused, _)| column.is_some() && *is_refused) {
        Some((Some(column), _, expected)) => Err(ContentError::value(line, "columns", &column.label(), expected)),
        _ => Ok(()),
    }
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

    #[test]
    fn rows_are_ends_of_straight_motions() {
        let text = "time [ms], u [mm], w [µm], load [N]\n0, 1, 0, 5\n2, 1.5, -40, 5\n3, 1.5, -40, 6\n";
        let on_body = CarrierBodies { z: Some(CarrierBody::default()), ..CarrierBodies::default() };
        let (phases, notes) = read_motion(text.as_bytes(), &on_body).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        assert!(phases.len() == 2 && close(phases[0].duration, 2e-3) && close(phases[0].u.rate, 0.25));
        assert!(close(phases[0].w.rate, -0.02) && phases[1].w.rate == 0.0 && phases[1].pull.is_none());
        let load = phases[1].load.unwrap();
        assert!(load.start == Some(5.0) && close(load.change.rate, 1e3));
        assert!(notes.iter().any(|note| note.text.contains("first row")), "{notes:?}");
    }

    #[test]
    fn files_that_are_no_motion_are_refused() {
        for text in [
            "time, v\n0, 1\n1, 2\n",
            "0, 1\n1, 2\n",
            "time, u, w\n0, 1, 2\n0, 1, 2\n",
            "time, u, w\n0, 1, x\n1, 1, 2\n",
            "",
        ] {
            assert!(read_motion(text.as_bytes(), &CarrierBodies::default()).is_err(), "{text}");
        }
    }

    /// Those rest, which is said; without names there is no telling which of them is missing.
    #[test]
    fn displacements_that_are_missing_rest() {
        let read = |text: &str| read_motion(text.as_bytes(), &CarrierBodies::default()).unwrap();
        for (name, other, [u, w]) in [("u", "w", [0.25, 0.0]), ("w", "u", [0.0, 0.25])] {
            let (phases, notes) = read(&format!("time [s], {name} [m]\n0, 0\n2, 0.5\n"));
            assert_eq!([phases[0].u.rate, phases[0].w.rate], [u, w]);
            let said = format!("no column {other}: it stays as at the start");
            assert!(notes.iter().any(|note| note.assumed && note.text == said), "{notes:?}");
        }
        let on_body = CarrierBodies { z: Some(CarrierBody::default()), ..CarrierBodies::default() };
        let (_, notes) = read_motion(b"time [s], u [m], load [N]\n0, 0, 5\n2, 0.5, 5\n", &on_body).unwrap();
        assert!(notes.iter().all(|note| !note.assumed), "{notes:?}");
        let (phases, notes) = read("time [s], temperature [K]\n0, 300\n2, 310\n");
        assert_eq!([phases[0].u.rate, phases[0].w.rate], [0.0, 0.0]);
        let said = "no columns u and w: they stay as at the start";
        assert!(notes.iter().any(|note| note.assumed && note.text == said), "{notes:?}");
    }

    /// A tester's log has the forces that came of the motion; a load is none.
    #[test]
    fn measured_forces_are_left_out_or_loads() {
        let none = CarrierBodies::default();
        let on_body = CarrierBodies { z: Some(CarrierBody::default()), ..CarrierBodies::default() };
        let log = |name: &str| format!("time [s],Fx [N],u [mm],{name},w [mm]\n0,1,0,5,-0.01\n1,1,1,5,-0.01\n");
        for name in ["Fz [N]", "F_z [N]", "Fn [N]", "Normal force [N]", "normal_force_N"] {
            let (phases, notes) = read_motion(log(name).as_bytes(), &none).unwrap();
            let said = format!("column 4 ({name}) is left out: without [carrier.z] it comes of w");
            assert!(phases[0].load.is_none(), "{name}");
            assert!(notes.iter().any(|note| note.assumed && note.text == said), "{name} {notes:?}");
            let (phases, _) = read_motion(log(name).as_bytes(), &on_body).unwrap();
            assert_eq!(phases[0].load.and_then(|load| load.start), Some(5.0), "{name}");
        }
        let refused = read_motion(log("load [N]").as_bytes(), &none).unwrap_err().to_string();
        let expected = "columns = column 4 (load [N]): expected no load and no pressure without [carrier.z]";
        assert_eq!(refused, expected);
    }
}
