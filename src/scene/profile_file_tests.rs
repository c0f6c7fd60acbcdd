use super::*;

fn points(text: &str) -> Vec<(f64, f64)> {
    let surface = parse(text.as_bytes(), false).unwrap_or_else(|error| unreachable!("{error:?} in {text:?}"));
    surface.x.into_iter().zip(surface.z).collect()
}

fn refusal(bytes: &[u8], periodic: bool) -> (usize, String) {
    match parse(bytes, periodic) {
        Err(error) => (error.line, error.problem.about(error.column)),
        Ok(surface) => unreachable!("accepted as {surface:?}"),
    }
}

#[test]
fn reads_every_separator() {
    let texts = [
        "0,1.5\n0.5,-2e-1\n",
        "0 , 1.5\n0.5 , -2e-1",
        "0;1.5\n0.5;-2e-1",
        "0\t1.5\n0.5\t-2e-1\n",
        "  0   1.5 \n  0.5   -2e-1  \n",
        "0 \t 1.5\n0.5 \t -2e-1",
        "0,0;1,5\n0,5;-2,0e-1",
        "0,0\t1,5\n0,5\t-0,2",
    ];
    for text in texts {
        assert_eq!(points(text), [(0.0, 1.5), (0.5, -0.2)], "{text:?}");
    }
}

#[test]
fn skips_one_header_comments_blank_lines_and_marks() {
    let texts = [
        "x,z\n0,1\n1,2\n",
        "\u{feff}x [m]; z [m]\r\n0;1\r\n1;2\r\n",
        "\u{feff}0,1\n1,2",
        "# measured\n\nplace height\n0 1\n\n# end of the scratch\n1 2\n\n",
        "X_(microns),y1\n0,1\n1,2",
        "a header of five words\n0 1\n1 2",
    ];
    for text in texts {
        assert_eq!(points(text), [(0.0, 1.0), (1.0, 2.0)], "{text:?}");
    }
}

#[test]
fn reads_numbers_below_a_header_in_an_old_encoding() {
    let surface = parse(b"x/\xb5m;z/\xb5m\n0;1\n1;2\n", false);
    assert_eq!(surface.map(|surface| surface.z), Ok(vec![1.0, 2.0]));
}

#[test]
fn refuses_what_is_no_profile() {
    let cases: [(&str, usize, &str); 13] = [
        ("", 1, "points = 0: expected at least 2 points for a profile"),
        ("x,z\n\n", 2, "points = 0: expected at least 2 points for a profile"),
        ("0,1\n", 1, "points = 1: expected at least 2 points for a profile"),
        ("0,1\n1,high\n", 2, "z = \"high\": expected a number from -1e30 to 1e30"),
        ("0,1\n1,\n", 2, "z = \"\": expected a number from -1e30 to 1e30"),
        ("zero,1\n1,2", 1, "x = \"zero\": expected a number from -1e30 to 1e30"),
        ("x,z\nx,z\n1,2", 2, "x = \"x\": expected a number from -1e30 to 1e30"),
        ("0,1\n1,nan", 2, "z = \"nan\": expected a number from -1e30 to 1e30"),
        ("0,1\n1e999,2", 2, "x = \"1e999\": expected a number from -1e30 to 1e30"),
        (
            "0,1\n1,2,3",
            2,
            "columns = 3 in `1,2,3`: expected two, x and z, separated by comma, semicolon, tab or blanks",
        ),
        ("0\n1", 1, "columns = 1 in `0`: expected two, x and z, separated by comma, semicolon, tab or blanks"),
        ("# x falls\n0 1\n2 1\n1 1", 4, "x = 1.0: expected a number > 2.0, the x of the point before, for x must rise"),
        ("0 1\n2 1\n\n2 3", 4, "x = 2.0: expected each x once, but the point before has x = 2.0 too"),
    ];
    for (text, line, message) in cases {
        assert_eq!(refusal(text.as_bytes(), false), (line, message.to_owned()), "{text:?}");
    }
}

#[test]
fn refuses_other_encodings() {
    let (line, message) = refusal(b"\xff\xfe0\0;\x001\0", false);
    assert_eq!((line, message.as_str()), (1, "bytes that are zero: expected text in UTF-8, not UTF-16 or binary data"));
}

#[test]
fn periodic_ends_meet() {
    let (line, message) = refusal(b"0 1\n1 2\n2 1.5", true);
    let expected = "z = 1.5: expected 1.0, the first height, for a periodic profile ends at the height it starts from";
    assert_eq!((line, message.as_str()), (3, expected));
    let (_, message) = refusal(b"0 1\n1 1", true);
    assert_eq!(message, "points = 2: expected at least 3 points for a periodic profile");
    let surface = parse(b"0 1\n1 2\n2 1.0000000000000002", true);
    assert_eq!(surface.map(|surface| surface.z), Ok(vec![1.0, 2.0, 1.0]));
}
