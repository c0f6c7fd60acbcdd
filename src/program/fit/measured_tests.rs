use std::f64::consts::TAU;

use super::*;

fn read(text: &str) -> Measured {
    parse(text.as_bytes(), &[]).unwrap_or_else(|refusal| panic!("{text}: {refusal}"))
}

fn refusal(text: &str) -> String {
    parse(text.as_bytes(), &[]).unwrap_err().to_string()
}

/// 2 Hz, E' = 3 MPa, E'' = 0.6 MPa, 20 °C, however they are written.
#[test]
fn tables_as_people_and_instruments_write_them() {
    let texts = [
        "frequency [Hz],E' [MPa],E'' [MPa],T [K]\n2,3,0.6,293.15\n",
        "\u{feff}f (Hz);E' (kPa);E'' (Pa);temperature [°C]\r\n2;3000;6e5;20\r\n",
        "# by hand\n\ntan delta\ttemperature (C)\tstorage modulus [GPa]\tf [kHz]\n0,2\t20,0\t0,003\t0,002\n",
        "Frequency,Storage modulus,Loss modulus,Temperature\nHz,MPa,MPa,°C\n2,3,0.6,20",
        "\"Frequency, Hz\",\"E\"\" [MPa]\",\"E' [MPa]\",\"T (K)\"\n\"2\",\"0.6\",\"3\",\"293.15\"\n",
        "omega [rad/s];E' [MPa];loss modulus;T [K];;\n12.566370614359172;3;0.6;293.15;;\n",
    ];
    for text in texts {
        let row = read(text).rows[0];
        // Rounding of the conversions.
        let close = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-15;
        let Sample { omega, storage, loss } = row.sample;
        assert!(close(omega, 2.0 * TAU) && close(storage, 3e6) && close(loss, 6e5), "{text}: {row:?}");
        assert!(close(row.temperature.unwrap(), 293.15), "{text}: {row:?}");
    }
}

#[test]
fn latin_1_is_read_too() {
    let bytes = b"f [Hz];E' [N/mm\xb2];tan d;Temp. [\xb0C]\r\n1;2;0,1;-10\r\n";
    let measured = parse(bytes, &[]).unwrap();
    assert_eq!(measured.rows[0].temperature, Some(263.15));
    assert_eq!(measured.rows[0].sample.storage, 2e6);
}

#[test]
fn what_is_assumed_is_told() {
    let notes = |text: &str| read(text).notes;
    assert_eq!(
        notes("f,E' [MPa],E''\n1,2,3"),
        ["column 1 (f) names no unit: taken as Hz", "column 3 (E'') names no unit: taken as that of the other modulus"]
    );
    assert_eq!(
        notes("omega,E',tan(d)\n1,2,3"),
        ["column 1 (omega) names no unit: taken as rad/s", "column 2 (E') names no unit: taken as Pa"]
    );
    assert_eq!(notes("f [Hz],E' [Pa],E'' [Pa],tan(d)\n1,2,3,9"), ["E'' is there as well as tan delta: E'' counts"]);
    assert_eq!(read("f [Hz],E' [Pa],E'' [Pa],tan(d)\n1,2,3,9").rows[0].sample.loss, 3.0);
}

#[test]
fn a_column_is_left_out_by_its_name() {
    let text = "Point,f [Hz],E' [Pa],E'' [Pa]\na,1,2,3";
    assert!(refusal(text).starts_with("1: column 1 = \"Point\": expected a quantity and its unit, such as"));
    let ignored = |name: &str| parse(text.as_bytes(), &[name.to_owned()]);
    assert_eq!(ignored("Point").unwrap().rows.len(), 1);
    let message = "1: --ignore point: expected one of the headers: Point, f [Hz], E' [Pa], E'' [Pa]";
    assert_eq!(ignored("point").unwrap_err().to_string(), message);
}

#[test]
fn what_is_wrong_is_refused_with_line_and_column() {
    const POSITIVE: &str = "expected a number above 0 (from 1e-30 to 1e30 in SI units)";
    let head = "f [Hz],E' [MPa],E'' [MPa]";
    let cases = [
        (format!("{head}\n1,2,3\n\n2,x,3"), format!("4: column 2 (E' [MPa]) = \"x\": {POSITIVE}")),
        (format!("{head}\n1,2,-3"), format!("2: column 3 (E'' [MPa]) = \"-3\": {POSITIVE}")),
        (format!("{head}\n0,2,3"), format!("2: column 1 (f [Hz]) = \"0\": {POSITIVE}")),
        (format!("{head}\n1,,3"), format!("2: column 2 (E' [MPa]): {POSITIVE}")),
        (format!("{head}\n1,nan,3"), format!("2: column 2 (E' [MPa]) = \"nan\": {POSITIVE}")),
        (format!("{head}\n1,1e-40,3"), format!("2: column 2 (E' [MPa]) = \"1e-40\": {POSITIVE}")),
        (format!("{head}\n1,2"), "2: 2 columns: expected 3, as many as headers".into()),
        (head.into(), "2: expected a row of numbers".into()),
        (String::new(), "1: expected a line of headers, then rows".into()),
        ("f [Hz],E'' [Pa]\n1,2".into(), "1: expected a column of the storage modulus: E' [MPa]".into()),
        ("f [Hz],E' [Pa]\n1,2".into(), "1: expected a column of the loss: E'' [MPa] or tan delta".into()),
        ("E' [Pa],E'' [Pa]\n1,2".into(), "1: expected a frequency column: f [Hz] or omega [rad/s]".into()),
        (
            "f [Hz],omega,E' [Pa],E'' [Pa]\n1,2,3,4".into(),
            "1: column 2 = \"omega\": expected one column of a kind: f [Hz] is there already; leave one out by \
             --ignore NAME"
                .into(),
        ),
        (
            "f [Hz],E' [Pa],E'' [Pa],temperature\n1,2,3,4".into(),
            "1: column 4 = \"temperature\": expected a unit, °C or K, as in temperature [°C]".into(),
        ),
        (
            "f [Hz],E' [Pa],E'' [Pa],T [°C]\n1,2,3,-300".into(),
            "2: column 4 (T [°C]) = \"-300\": expected a temperature above 0 K".into(),
        ),
        ("a\0".into(), "1: bytes that are zero: expected text in UTF-8 or Latin-1, not UTF-16 or binary data".into()),
    ];
    for (text, message) in cases {
        assert_eq!(refusal(&text), message, "{text}");
    }
    for (text, header) in [("1,2,3\n4,5,6", "1"), ("f [Hz],E' [psi],E'' [Pa]\n1,2,3", "E' [psi]")] {
        let wanted = format!("= \"{header}\": expected a quantity and its unit");
        assert!(refusal(text).contains(&wanted), "{}", refusal(text));
    }
}
