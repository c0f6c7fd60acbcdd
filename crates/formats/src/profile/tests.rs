use asperity::scene::{
    Depth, FileFormats as _, HeightMap, LengthUnit, LoadedProfile, MapError, Missing, ProfileOptions, Surface,
    ThirdColumn, Tilt,
};
use asperity::tables::ContentError;

use crate::Instruments;

fn options() -> ProfileOptions {
    ProfileOptions::default()
}

fn filled() -> ProfileOptions {
    ProfileOptions { missing: Missing::Fill, ..options() }
}

fn load(bytes: &[u8], options: &ProfileOptions) -> Result<LoadedProfile, ContentError> {
    Instruments.surface(bytes, options)
}

fn points_of(bytes: &[u8], options: &ProfileOptions) -> Vec<(f64, f64)> {
    let surface = load(bytes, options).unwrap_or_else(|error| unreachable!("{error:?}")).surface;
    surface.x().iter().copied().zip(surface.z().iter().copied()).collect()
}

/// Columns of x and z, or of z alone.
fn given(columns: &[&str]) -> Vec<(String, String)> {
    let axes = ["x", "z"].into_iter().skip(2 - columns.len());
    axes.zip(columns).map(|(axis, name)| (axis.to_owned(), (*name).to_owned())).collect()
}

fn points(text: &str) -> Vec<(f64, f64)> {
    points_of(text.as_bytes(), &options())
}

fn refused(bytes: &[u8], options: &ProfileOptions) -> (usize, String) {
    match load(bytes, options) {
        Err(error) => (error.line.unwrap_or(0), error.to_string()),
        Ok(parsed) => unreachable!("accepted as {parsed:?}"),
    }
}

fn refusal(bytes: &[u8], periodic: bool) -> (usize, String) {
    refused(bytes, &ProfileOptions { periodic, ..options() })
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
        "a header of five words\n0 1\n1 2",
    ];
    for text in texts {
        assert_eq!(points(text), [(0.0, 1.0), (1.0, 2.0)], "{text:?}");
    }
}

const MISSING_REFUSED: [&str; 3] = [
    "z = \"high\": expected a number from -1e30 to 1e30, or missing = \"fill\" where heights are missing",
    "z = \"\": expected a number from -1e30 to 1e30, or missing = \"fill\" where heights are missing",
    "z = \"nan\": expected a number from -1e30 to 1e30, or missing = \"fill\" where heights are missing",
];

#[test]
fn refuses_what_is_no_profile() {
    let cases: [(&str, usize, &str); 13] = [
        ("", 1, "points = 0: expected at least 2 points for a profile"),
        ("x,z\n\n", 2, "points = 0: expected at least 2 points for a profile"),
        ("0,1\n", 1, "points = 1: expected at least 2 points for a profile"),
        ("0,1\n1,high\n", 2, MISSING_REFUSED[0]),
        ("0,1\n1,\n", 2, MISSING_REFUSED[1]),
        ("zero,1\n1,2", 2, "points = 1: expected at least 2 points for a profile"),
        ("x,z\nx,z\n1,2", 3, "points = 1: expected at least 2 points for a profile"),
        ("0,1\n1,nan", 2, MISSING_REFUSED[2]),
        ("0,1\n1e999,2", 2, "x = \"1e999\": expected a number from -1e30 to 1e30"),
        (
            "0,1\n1,2,3",
            2,
            "columns = 3 in \"1,2,3\": expected two, x and z, separated by comma, semicolon, tab or blanks; third_column \
             says what a third one means",
        ),
        (
            "0\n1",
            1,
            "spacing = not given: expected the distance of the points in m, spacing = 1e-5 (--spacing 1e-5), for the only \
             column holds heights without x",
        ),
        ("# x falls\n0 1\n2 1\n1 1", 4, "x = 1.0: expected a number > 2.0, the x of the point before, for x must rise"),
        ("0 1\n2 1\n\n2 3", 4, "x = 2.0: expected each x once, but the point before has x = 2.0 too"),
    ];
    for (text, line, message) in cases {
        assert_eq!(refusal(text.as_bytes(), false), (line, message.to_owned()), "{text:?}");
    }
}

#[test]
fn reads_the_encodings_of_instruments() {
    let text = "Länge;Höhe\r\nx [µm];z [nm]\r\n0;1,5\r\n10;-2\r\n";
    let [little, big] =
        [u16::to_le_bytes, u16::to_be_bytes].map(|bytes| text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>());
    let latin: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap_or(b'?')).collect();
    let marked = |mark: &[u8], bytes: &[u8]| [mark, bytes].concat();
    let encoded = [
        text.as_bytes().to_vec(),
        marked(b"\xef\xbb\xbf", text.as_bytes()),
        marked(b"\xff\xfe", &little),
        marked(b"\xfe\xff", &big),
        little,
        big,
        latin,
        text.replace("\r\n", "\r").into_bytes(),
    ];
    for (i, bytes) in encoded.iter().enumerate() {
        assert_eq!(points_of(bytes, &options()), [(0.0, 1.5e-9), (1e-5, -2e-9)], "encoding {i}");
    }
    let (line, message) = refusal(b"0 1\0\n1 2", false);
    assert_eq!((line, message.as_str()), (1, "bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1"));
}

/// The unit is taken from where instruments write it, and given in the options it counts more.
#[test]
fn units_are_read_from_the_header() {
    let cases = [
        ("x [mm]\tz [µm]\n", 1e3, 1e6),
        ("x / mm; z / \u{3bc}m\n", 1e3, 1e6),
        ("x [mm] z [nm]\n", 1e3, 1e9),
        ("x / mm z / nm\n", 1e3, 1e9),
        ("Lateral;Height\nmm;µm\n", 1e3, 1e6),
        ("Lateral;Height\n(Millimeters);(Micrometers)\n", 1e3, 1e6),
        ("# x_mm z_um\n", 1e3, 1e6),
        ("x [m],z [m]\n", 1.0, 1.0),
        ("Instrument\nX-Unit;mm\nZ-Unit;µm\n", 1e3, 1e6),
        ("Instrument\nUnits: x [mm] z [µm]\n", 1e3, 1e6),
        ("Instrument\nUnits = Microns\nspeed 0.5 mm/s\n\n", 1e6, 1e6),
        ("Instrument\nstylus tip 2 µm\nx,z\n", 1.0, 1.0),
    ];
    for (header, x_per_metre, z_per_metre) in cases {
        let found = points(&format!("{header}0 2.5\n8.5 -1\n"));
        assert_eq!(found, [(0.0, 2.5 / z_per_metre), (8.5 / x_per_metre, -1.0 / z_per_metre)], "{header:?}");
    }
    let given = ProfileOptions { z_unit: Some(LengthUnit::Nanometre), ..options() };
    assert_eq!(points_of(b"x [mm];z [mm]\n0;1\n1;2\n", &given), [(0.0, 1e-9), (1e-3, 2e-9)]);
    // Two words are names of two columns, whatever follows.
    assert_eq!(refusal(b"Instrument A\nX-Unit;mm\n0 2.5\n8.5 -1\n", false).0, 1);
    assert_eq!(refusal(b"Name;test\nX-Unit: mm\nZ-Unit: \xc2\xb5m\n[DATA]\n0 2.5\n8.5 -1\n", false).0, 1);
    // A unit of one axis alone is that of no other.
    assert_eq!(refusal(b"X_(microns),y1\n0,1\n1,2", false).0, 1);
}

#[test]
fn long_headers_of_words_and_numbers_are_passed_over() {
    let header = "Serial 4711\n1000\nDate;2026-01-02;12:30\nSpeed\t0.5\nPoints\n2;\nx0=0.5 dx=0.1\n---\n";
    for data in ["0 1\n1 2", "0;1\n1;2\n", "0,1\n1,2", "0\t1\n1\t2"] {
        assert_eq!(points(&format!("{header}{data}")), [(0.0, 1.0), (1.0, 2.0)], "{data:?}");
    }
    assert_eq!(points(&format!("{header}0 1\n1 2\nRa 3\n")), [(0.0, 1.0), (1.0, 2.0)], "results below");
    let (line, message) = refusal(format!("{header}0 1\n1 2\nend 3\n2 3\n").as_bytes(), false);
    assert_eq!((line, message.as_str()), (11, "x = \"end\": expected a number from -1e30 to 1e30"));
}

#[test]
fn decimal_commas_and_quotation_marks() {
    for text in ["0,5 1,5\n1 -2,5e-1", "0,5;1,5\n1,0;-0,25", "0,5\t1,5\n1\t-,25", "\"0.5\",\"1.5\"\n1,\"-0.25\""] {
        assert_eq!(points(text), [(0.5, 1.5), (1.0, -0.25)], "{text:?}");
    }
}

#[test]
fn heights_that_are_missing_are_refused_or_filled() {
    for gap in ["NaN", "***", "", "---", "n/a", "BAD"] {
        let text = format!("0;***\n1;1\n2;{gap}\n4;{gap}\n5;3\n6;2\n7;NaN\n");
        let between = [(1.0, 1.0), (2.0, 1.5), (4.0, 2.5), (5.0, 3.0), (6.0, 2.0)];
        assert_eq!(points_of(text.as_bytes(), &filled()), between, "{gap:?}");
        assert_eq!(refusal(text.as_bytes(), false).0, 1, "{gap:?}");
    }
    assert_eq!(points_of(b"0\t1\n1\t\n2\t2\n", &filled()), [(0.0, 1.0), (1.0, 1.5), (2.0, 2.0)]);
    assert_eq!(points_of(b"0;1\n1;1e38\n2;2", &filled()), [(0.0, 1.0), (1.0, 1.5), (2.0, 2.0)]);
    assert_eq!(refused(b"0;1\n1;high\n2;1", &filled()).0, 2);
    let (_, message) = refused(b"0;***\n1;\n", &filled());
    assert_eq!(message, "points = 0: expected at least 2 points for a profile");
}

#[test]
fn a_third_column_marks_points() {
    let third = |third_column| ProfileOptions { third_column: Some(third_column), ..filled() };
    let cases = [
        ("0;1;0\n1;9;1\n2;2;0", third(ThirdColumn::Invalid)),
        ("0;1;no\n1;9;x\n2;2;", third(ThirdColumn::Invalid)),
        ("0 1 1\n1 9 0\n2 2 1.0", third(ThirdColumn::Valid)),
        ("x,z,invalid\n0,1,false\n1,9,true\n2,2,no", filled()),
        ("x\tz\tvalid\n0\t1\t1\n1\t\t0\n2\t2\t1", filled()),
    ];
    for (text, options) in cases {
        assert_eq!(points_of(text.as_bytes(), &options), [(0.0, 1.0), (1.0, 1.5), (2.0, 2.0)], "{text:?}");
    }
    assert_eq!(points_of(b"x z invalid\n0 1 1\n1 9 0\n", &third(ThirdColumn::Ignore)), [(0.0, 1.0), (1.0, 9.0)]);
    let (line, message) = refusal(b"x,z,invalid\n0,1,0\n1,2,1\n", false);
    let expected = "third column = \"1\": expected valid points alone, or missing = \"fill\"";
    assert_eq!((line, message.as_str()), (3, expected));
}

#[test]
fn tilt_is_removed() {
    let level = ProfileOptions { tilt: Tilt::Remove, ..options() };
    let heights = |text: &str| points_of(text.as_bytes(), &level).into_iter().map(|point| point.1).collect::<Vec<_>>();
    assert_eq!(heights("0 1\n1 3\n3 7\n"), [0.0; 3]);
    // The point in the middle has two steps beside it and weighs twice: the line is z = x - 0.25.
    assert_eq!(heights("-1 -0.5\n0 -1\n1 1.5\n"), [0.75, -0.75, 0.75]);
}

#[test]
fn a_line_is_of_areal_measurements_alone() {
    let (_, message) = refused(b"0 1\n1 2\n", &ProfileOptions { line: Some(2), ..options() });
    assert!(message.starts_with("line = 2: expected no such number"), "{message}");
}

#[test]
fn periodic_ends_meet() {
    let (line, message) = refusal(b"0 1\n1 2\n2 1.5", true);
    let expected = "z = 1.5: expected 1.0, the first height, for a periodic profile ends at the height it starts from; \
                    asperity surface --mirror makes a period of one that ends";
    assert_eq!((line, message.as_str()), (3, expected));
    let (_, message) = refusal(b"0 1\n1 1", true);
    assert_eq!(message, "points = 2: expected at least 3 points for a periodic profile");
    let periodic = ProfileOptions { periodic: true, ..options() };
    let closed = points_of(b"0 1\n1 2\n2 1.0000000000000002", &periodic);
    assert_eq!(closed, [(0.0, 1.0), (1.0, 2.0), (2.0, 1.0)]);
}

/// Columns by their names, in any order and among others; where names do not tell, by what is chosen.
#[test]
fn columns_are_found_by_their_names_or_chosen() {
    let profile = [(0.0, 1.0), (1e-3, 2.0), (3e-3, 1.0)];
    let texts = [
        "index,x [mm],z [m]\n1,0,1\n2,1,2\n3,3,1",
        "z [m];x [mm]\n1;0\n2;1\n1;3",
        "No. [mm];x [mm];z [m]\n1;0;1\n2;1;2\n3;3;1",
        "X [mm] Y [mm] Z [m]\n0 5 1\n1 5 2\n3 5 1",
        "time [s]\tdistance [mm]\theight [m]\n0\t0\t1\n.1\t1\t2\n.2\t3\t1",
        "Distance;Profile\nmm;m\n0;1\n1;2\n3;1\nRa;0.5\n",
        "# Strecke [mm]; Höhe [m]\n0;1\n1;2\n3;1",
    ];
    let ignoring = ProfileOptions { third_column: Some(ThirdColumn::Ignore), ..options() };
    for text in texts {
        assert_eq!(points(text), profile, "{text:?}");
        assert_eq!(points_of(text.as_bytes(), &ignoring), profile, "{text:?}");
    }
    let chosen = |columns: &[&str]| ProfileOptions { columns: given(columns), ..options() };
    let many = b"a [mm],left [m],right [m]\n0,1,9\n1,2,9\n3,1,9";
    for columns in [["a", "left"], ["1", "2"], ["a [mm]", "left [m]"], ["A", "LEFT"]] {
        let options = ProfileOptions {
            x_unit: Some(LengthUnit::Millimetre),
            z_unit: Some(LengthUnit::Metre),
            ..chosen(&columns)
        };
        assert_eq!(points_of(many, &options), profile, "{columns:?}");
    }
    let (_, message) = refused(many, &chosen(&["b", "left"]));
    assert!(message.starts_with("columns = \"b\": expected one of \"a [mm]\", \"left [m]\""), "{message}");
}

#[test]
fn names_and_numbers_that_do_not_tell_are_refused() {
    let cases = [
        ("left [mm],right [mm]\n0,0.1\n1,1.1\n2,2.1\n", 1, "columns = \"left [mm], right [mm]\": expected columns ="),
        ("time [s],z [m]\n0,1\n1,2\n", 1, "columns = \"time [s], z [m]\": expected columns ="),
        ("x,z1,z2\n0,1,2\n1,2,3\n", 1, "columns = \"x, z1, z2\": expected columns ="),
        ("x [parsec],z [m]\n0,1\n1,2\n", 1, "unit of column 1 \"x [parsec]\" = \"parsec\": expected one of m, mm, µm"),
        ("x [Hz],z [m]\n0,1\n1,2\n", 1, "columns = \"x [Hz], z [m]\""),
        ("Distance travelled mm Height um\n0 1\n1 2\n", 1, "columns = 5 names above 2 columns"),
        ("# all in mm\nx,z\n0,1\n1,2\n", 1, "units = \"all in mm\": expected the units beside the names, as in x [mm]"),
        ("log x [mm],z [mm]\n0,1\n1,2\n", 1, "columns = \"log x [mm], z [mm]\": expected columns ="),
        ("1 0 5\n2 1 6\n3 3 5\n", 1, "columns = 3: expected two, x and z"),
        ("x,z\n0,1.5\n1,-9999\n2,1.4\n3,-9999\n", 3, "z = -9999.0 (2 times, more than 10 times the range"),
        ("x,z\n0,0\n1e-200,1\n2e-200,0\n", 2, "points = steps along x down to 1e-200 m: expected"),
        ("x,z\n0,0\n5e-5,1e-5\n1e-4,0\n1e23,1e-5\n", 3, "x = 5e-5: expected steps along x of at least 1e-12"),
        ("x;z\n0;1,5\n1;2.5\n", 3, "z = \"2.5\": expected a number with the sign before its decimals"),
    ];
    for (text, line, message) in cases {
        let (found, error) = refusal(text.as_bytes(), false);
        assert!(found == line && error.starts_with(message), "{text:?}: {found} {error}");
    }
    let ignoring = ProfileOptions { third_column: Some(ThirdColumn::Ignore), ..options() };
    for numbered in [&b"1 0 5\n2 1 6\n3 3 5\n"[..], b"0 0 5\n1 0 6\n3 0 5\n"] {
        let (_, message) = refused(numbered, &ignoring);
        assert!(message.starts_with("columns = 3: expected two, x and z"), "{message}");
    }
    let filled = points_of(b"x,z\n0,1.5\n1,-9999\n2,1\n3,-9999\n4,1.25\n", &filled());
    assert_eq!(filled, [(0.0, 1.5), (1.0, 1.25), (2.0, 1.0), (3.0, 1.125), (4.0, 1.25)]);
}

#[test]
fn a_column_of_heights_and_a_matrix_have_a_spacing() {
    let spaced = |spacing: &[f64]| ProfileOptions { spacing: spacing.to_vec(), ..options() };
    assert_eq!(points_of(b"z_um\n1\n2\n4\n", &spaced(&[0.5])), [(0.0, 1e-6), (0.5, 2e-6), (1.0, 4e-6)]);
    assert_eq!(refused(b"z [mm]\n0,5\n1,5\n", &spaced(&[0.5])).0, 1, "decimal commas, or two columns");
    let matrix = b"1 2 3\n4 5 7\n7 8 9\n";
    assert_eq!(points_of(matrix, &spaced(&[0.5, 2.0])), [(0.0, 4.0), (0.5, 5.0), (1.0, 7.0)]);
    let first = ProfileOptions { line: Some(1), ..spaced(&[0.5, 2.0]) };
    assert_eq!(points_of(matrix, &first), [(0.0, 1.0), (0.5, 2.0), (1.0, 3.0)]);
    let (_, message) = refused(matrix, &ProfileOptions { line: Some(4), ..first });
    assert_eq!(message, "line = 4: expected a whole number from 1 to 3");
    assert!(refused(b"x,z\n0,1\n1,2\n", &spaced(&[1.0])).1.starts_with("spacing = given: expected none"));
}

/// Points x, y, z with several y are a map, of which the middle line is taken; an FMU carries that line.
#[test]
fn points_on_a_grid_are_a_map() {
    let text = "x [mm],y [mm],z [um]\n0,0,1\n1,0,2\n2,0,3\n0,1,4\n1,1,5\n2,1,6\n0,2,7\n1,2,8\n2,2,9\n";
    let parsed = load(text.as_bytes(), &options()).unwrap_or_else(|error| unreachable!("{error:?}"));
    assert_eq!(parsed.surface.z(), [4e-6, 5e-6, 6e-6]);
    let (_, message) = refused(b"x,y,z\n0,0,1\n1,0,2\n0,1,4\n", &options());
    assert!(message.starts_with("points = 3 points with 2 values of x and 2 of y: expected a grid"), "{message}");
}

#[test]
fn what_was_assumed_is_said() {
    let assumed = |text: &str| {
        let parsed = load(text.as_bytes(), &options()).unwrap_or_else(|error| unreachable!("{error:?}"));
        parsed.notes.iter().filter(|note| note.assumed).count()
    };
    assert_eq!(assumed("x [mm],z [mm]\n0,1\n1,2"), 0);
    assert_eq!(assumed("x,z\n0,1\n1,2"), 1);
    assert_eq!(assumed("0,1\n1,2"), 1);
    assert_eq!(assumed("x [mm],depth [mm]\n0,1\n1,2"), 1);
}

#[test]
fn depths_grow_downwards() {
    let heights = |name: &str, numbers: [f64; 3], depth: Option<Depth>| {
        let rows: String = numbers.iter().enumerate().map(|(i, z)| format!("{i},{z}\n")).collect();
        let options = ProfileOptions { depth, ..options() };
        surface(&format!("x [m],{name} [m]\n{rows}"), &options).z().to_vec()
    };
    let (grooves, below) = ([0.0, 0.5, 0.0], [0.0, -0.5, -0.25]);
    assert_eq!(heights("Depth", grooves, None), [0.0, -0.5, 0.0]);
    assert_eq!(heights("profile depth", grooves, Some(Depth::Up)), grooves);
    assert_eq!(heights("height", grooves, Some(Depth::Down)), [0.0, -0.5, 0.0]);
    assert_eq!((heights("Tiefe", below, None), heights("height", grooves, None)), (below.to_vec(), grooves.to_vec()));
    let map = "x [m],y [m],depth [m]\n0,0,1\n1,0,0\n0,1,0\n1,1,2\n";
    let whole = surface(map, &options());
    assert_eq!((whole.z(), whole.map().map(HeightMap::heights)), (&[-1.0, 0.0][..], Some(&[-1.0, 0.0, 0.0, -2.0][..])));
}

fn surface(text: &str, options: &ProfileOptions) -> Surface {
    load(text.as_bytes(), options).unwrap_or_else(|error| unreachable!("{error:?}")).surface
}

fn spaced() -> ProfileOptions {
    ProfileOptions { spacing: vec![1e-5, 2e-5], ..options() }
}

/// Each row is a line along x, rows follow in +y; a period goes on from the last point to the first one.
#[test]
fn a_matrix_is_a_map() {
    let text = "1,2,3,1\n4,5,6,1\n7,8,9,1\n";
    let found = surface(text, &spaced());
    let map = found.map().unwrap_or_else(|| unreachable!("{:?}", found.map_error()));
    assert_eq!((map.nx(), map.ny(), map.spacing(), map.line(2)), (4, 3, [1e-5, 2e-5], &[7.0, 8.0, 9.0, 1.0][..]));
    assert_eq!((found.x().len(), found.z()), (4, &[4.0, 5.0, 6.0, 1.0][..]));
    let periodic = ProfileOptions { periodic: true, line: Some(1), ..spaced() };
    let found = surface(text, &periodic);
    assert_eq!((found.x()[4], found.z()), (4e-5, &[1.0, 2.0, 3.0, 1.0, 1.0][..]));
    assert_eq!(found.map().map(HeightMap::nx), Some(4));
    // The edges of one period that both stand there.
    let found = surface("1,2,3,1\n4,5,6,4\n1,2,3,1\n", &periodic);
    assert_eq!(found.z(), [1.0, 2.0, 3.0, 1.0]);
    assert_eq!(found.map().map(|map| (map.nx(), map.ny())), Some((3, 2)));
}

/// In any order of lines, with names and units or without; y may fall.
#[test]
fn points_on_a_grid_need_no_names() {
    let named = "x [mm];y [mm];z [um]\n0;1;4\n1;1;5\n0;0;1\n1;0;2\n0;2;7\n1;2;8\n";
    let found = surface(named, &options());
    let map = found.map().unwrap_or_else(|| unreachable!("{:?}", found.map_error()));
    assert_eq!((map.nx(), map.ny(), map.spacing()), (2, 3, [1e-3, 1e-3]));
    assert!((map.line(2)[1] - 8e-6).abs() < 1e-18);
    let bare = "0 0 1\n1 0 2\n0 2 3\n1 2 4\n";
    assert_eq!(surface(bare, &options()).map().map(HeightMap::spacing), Some([1.0, 2.0]));
    assert!(refused(b"0 0 1\n1 0 2\n0 2 3\n", &options()).1.starts_with("columns = 3: expected two"));
    let uneven = surface("x,y,z\n0,0,1\n1,0,2\n3,0,2\n0,1,3\n1,1,4\n3,1,3\n", &options());
    assert_eq!((uneven.map().is_none(), uneven.map_error()), (true, Some(&MapError::Uneven("x"))));
}

/// On the straight line between their neighbours in a line, the nearest at its ends; a line without any, from those
/// beside it.
#[test]
fn gaps_of_a_map_are_refused_or_filled() {
    let text = "nan,2,nan,4\nnan,nan,nan,nan\n1,1,3,nan\n";
    let line = ProfileOptions { line: Some(3), ..spaced() };
    let (_, message) = refused(text.as_bytes(), &line);
    assert!(message.starts_with("z[4] = missing"), "{message}");
    let whole_line = surface("nan,2,3\n1,1,3\n", &ProfileOptions { line: Some(2), ..spaced() });
    let error = whole_line.map_error().map(ToString::to_string).unwrap_or_default();
    assert!(error.contains("missing = \"fill\": 1 are missing, the first in line 1, point 1"), "{error}");
    let fill = ProfileOptions { missing: Missing::Fill, ..line };
    let filled = surface(text, &fill);
    let map = filled.map().unwrap_or_else(|| unreachable!("{:?}", filled.map_error()));
    assert_eq!(map.heights(), [2.0, 2.0, 3.0, 4.0, 1.5, 1.5, 3.0, 3.5, 1.0, 1.0, 3.0, 3.0]);
    // A period has no ends.
    assert_eq!(surface(text, &ProfileOptions { periodic: true, ..fill }).z(), [1.0, 1.0, 3.0, 3.0, 1.0]);
}

/// Whatever the columns are called that are chosen.
#[test]
fn units_belong_to_columns() {
    let chosen = |columns: &[&str]| ProfileOptions { columns: given(columns), ..options() };
    let text = b"Distance [mm];Texture [\xc2\xb5m];Dropout\n0,0;1,5;0\n1,0;3,0;0\n";
    let profile = [(0.0, 1.5e-6), (1e-3, 3e-6)];
    assert_eq!(points_of(text, &chosen(&["Distance", "Texture"])), profile);
    let odd = b"Odometer [mm];Laser left\n;[um]\n0,0;1,5\n1,0;3,0\n";
    assert_eq!(points_of(odd, &chosen(&["Odometer", "Laser left"])), profile);
    let alone = ProfileOptions { spacing: vec![1e-3], ..chosen(&["Texture"]) };
    assert_eq!(points_of(text, &alone), profile);
    let (_, message) = refused(b"Distance [mm],Sensor [V]\n0,1\n1,2\n", &chosen(&["1", "2"]));
    assert!(message.starts_with("unit of column 2 \"Sensor [V]\" = \"V\": expected one of m, mm"), "{message}");
    assert!(message.ends_with("or z_unit in the scene"), "{message}");
}

/// Of waves that meet, on a plane: with it the ends do not meet, without it they do.
#[test]
fn the_tilt_of_a_periodic_map_is_that_of_the_map() {
    let wave = |i: usize, count: f64| (std::f64::consts::TAU * i as f64 / count).sin();
    let height = |i: usize, j: usize| wave(i, 32.0) + wave(j, 16.0) + 4.0 * i as f64 - 3.0 * j as f64;
    let row = |j: usize| (0..32).map(|i| height(i, j).to_string()).collect::<Vec<_>>().join(",");
    let text = (0..16).map(row).collect::<Vec<_>>().join("\n");
    let kept = ProfileOptions { periodic: true, ..spaced() };
    let found = surface(&text, &ProfileOptions { tilt: Tilt::Remove, line: Some(3), ..kept });
    let map = found.map().unwrap_or_else(|| unreachable!("{:?}", found.map_error()));
    // Its plane takes some of the waves with it.
    assert!(map.tilt().iter().all(|slope| slope.abs() < 1e-6) && (0.5..1.0).contains(&map.rms_height()));
    assert_eq!((found.z()[..32].to_vec(), found.z()[32]), (map.line(2).to_vec(), map.line(2)[0]));
}
