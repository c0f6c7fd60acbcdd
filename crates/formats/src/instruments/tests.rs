use asperity::scene::ProfileOptions;

use super::*;

fn options() -> ProfileOptions {
    ProfileOptions::default()
}

fn points(bytes: &[u8], options: &ProfileOptions) -> Vec<(f64, f64)> {
    let raw = read(bytes)
        .map(|areal| areal.and_then(|areal| areal.surface(options)))
        .unwrap_or_else(|| unreachable!("no such file"));
    let raw = raw.unwrap_or_else(|error| unreachable!("{error:?}")).line;
    let to_metres = |values: &[f64], axis: usize| -> Vec<f64> {
        values.iter().map(|value| raw.units[axis].map_or(*value, |unit| unit.to_si(*value))).collect()
    };
    to_metres(&raw.x, 0).into_iter().zip(to_metres(&raw.z, 1)).collect()
}

fn refusal(bytes: &[u8], options: &ProfileOptions) -> String {
    match read(bytes).map(|areal| areal.and_then(|areal| areal.surface(options))) {
        Some(Err(error)) => error.to_string(),
        other => unreachable!("{other:?}"),
    }
}

fn near(found: &[(f64, f64)], expected: &[(f64, f64)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().zip(expected) {
        // Numbers of 32 bits have 7 digits.
        assert!(
            (a.0 - b.0).abs() < 1e-6 * b.0.abs().max(1e-9) && (a.1 - b.1).abs() < 1e-6 * b.1.abs().max(1e-9),
            "{a:?} {b:?}"
        );
    }
}

/// Three lines of two points, the middle one with 4 and 5 µm; the last one with a gap.
const MIDDLE: [(f64, f64); 2] = [(0.0, 4e-6), (2e-6, 5e-6)];

fn last() -> ProfileOptions {
    ProfileOptions { line: Some(3), ..options() }
}

#[test]
fn sdf_as_text_and_binary() {
    let header = "aISO-1.0\nManufacID = x\nNumPoints = 2\nNumProfiles = 3\nXscale = 2E-6\nYscale = 1E-6\nZscale = 1E-6\n\
                  Compression = 0\nDataType = 7\n*\n";
    let text = format!("{header}1 2\n4 5\nBAD 6\n*\nend\n*\n");
    near(&points(text.as_bytes(), &options()), &MIDDLE);
    assert!(refusal(text.as_bytes(), &last()).starts_with("z[1] = missing: expected a height"));
    let short = text.replace("4 5\n", "");
    assert!(refusal(short.as_bytes(), &options()).starts_with("heights = 4: expected 2 × 3"));

    let mut bytes = [&b"bISO-1.0"[..], &[b' '; 34]].concat();
    bytes.extend([2_u16, 3].iter().flat_map(|size| size.to_le_bytes()));
    bytes.extend([2e-6_f64, 1e-6, 1e-6, 0.0].iter().flat_map(|scale| scale.to_le_bytes()));
    bytes.extend([0, 5, 0]);
    assert_eq!(bytes.len(), 81);
    bytes.extend([1_i16, 2, 4, 5, i16::MIN, 6].iter().flat_map(|height| height.to_le_bytes()));
    near(&points(&bytes, &options()), &MIDDLE);
    assert!(refusal(&bytes, &last()).starts_with("z[1] = missing"));
    assert!(
        refusal(&bytes[..90], &options()).starts_with("an SDF file of 90 bytes: expected as many as its header says")
    );
}

#[test]
fn sur_of_digital_surf() {
    let mut bytes = vec![0; 512];
    let mut put = |at: usize, part: &[u8]| bytes[at..at + part.len()].copy_from_slice(part);
    put(0, b"DIGITAL SURF");
    put(14, &1_u16.to_le_bytes());
    put(18, &2_u16.to_le_bytes());
    put(86, &1_u16.to_le_bytes());
    put(98, &32_u16.to_le_bytes());
    put(100, &10_i32.to_le_bytes());
    put(108, &2_u32.to_le_bytes());
    put(112, &3_u32.to_le_bytes());
    put(120, &2_f32.to_le_bytes());
    put(124, &1_f32.to_le_bytes());
    put(128, &100_f32.to_le_bytes());
    put(180, b"\xb5m");
    put(196, b"\xb5m");
    put(212, b"nm");
    put(334, &3_u16.to_le_bytes());
    bytes.extend(b"abc");
    bytes.extend([10_i32, 20, 40, 50, 8, 60].iter().flat_map(|height| height.to_le_bytes()));
    near(&points(&bytes, &options()), &MIDDLE);
    assert!(refusal(&bytes, &last()).starts_with("z[1] = missing"));
    bytes[212..214].copy_from_slice(b"V\0");
    assert!(refusal(&bytes, &options()).starts_with("unit of z = \"V\": expected a unit of length"));
}

#[test]
fn text_of_gwyddion() {
    let text = "# Channel: Topo\n# Width: 4 µm\n# Height: 3 µm\n# Value units: m\n1e-6 2e-6\n4e-6 5e-6\n7e-6 8e-6\n";
    near(&points(text.as_bytes(), &options()), &MIDDLE);
    let volts = text.replace("units: m", "units: V");
    assert!(refusal(volts.as_bytes(), &options()).starts_with("Value units = \"V\": expected a unit of length"));
}

fn crg(format: &str, end: &str) -> String {
    format!(
        "$CT\nlong section of nothing\n$\n$ROAD_CRG\nREFERENCE_LINE_END_U = 1.0\nREFERENCE_LINE_INCREMENT = 0.5 ! m\n{end}$\n\
         $KD_Definition\n#:{format}\nD:reference line phi,rad\nD:long section at v = 1.0,m\nD:long section at v = -1.0,m\n$\n$$$$\n"
    )
}

/// The section at v = -1 is the first line across, that at v = 1 the second.
#[test]
fn open_crg_as_text_and_binary() {
    let rows: [[f64; 3]; 3] = [[9.0, 1.0, 2.0], [0.5, 3.0, 4.0], [0.25, 5.0, 6.0]];
    let left = [(0.0, 2.0), (0.5, 4.0), (1.0, 6.0)];
    let right = [(0.0, 1.0), (0.5, 3.0), (1.0, 5.0)];
    for (format, wide) in [("LRFI", 10), ("LDFI", 20), ("KRBI", 0), ("KDBI", 0), ("LRBI", 0), ("LDBI", 0)] {
        let mut bytes = crg(format, "").into_bytes();
        for row in rows {
            let start = bytes.len();
            for value in row {
                match (wide, format.contains('D')) {
                    (0, true) => bytes.extend(value.to_be_bytes()),
                    (0, false) => bytes.extend((value as f32).to_be_bytes()),
                    (wide, _) => bytes.extend(format!("{value:>wide$.5}").bytes()),
                }
            }
            match wide {
                0 if format.starts_with('L') => bytes.resize(start + 80, 0),
                0 => (),
                _ => bytes.push(b'\n'),
            }
        }
        assert_eq!(points(&bytes, &ProfileOptions { line: Some(2), ..options() }), right, "{format}");
        assert_eq!(points(&bytes, &options()), left, "{format}");
    }
    let gap = format!("{} 0.0000000**********   2.00000\n", crg("LRFI", ""));
    assert!(refusal(gap.as_bytes(), &ProfileOptions { line: Some(2), ..options() }).contains("missing"), "{gap}");
    assert!(
        refusal(crg("XXXX", "").as_bytes(), &options())
            .starts_with("an OpenCRG file in the format XXXX: expected one of")
    );
}

#[test]
fn other_files_are_refused_by_their_names() {
    for (bytes, kind) in [
        (&b"GWYP\x01\0"[..], "Gwyddion"),
        (b"ERDFILEV2.00\n1e18,3,-1,1,5,0.5,-1\nEND\n1 2\n3 4\n", "ERD"),
        (b"VK4_\0", "VK4"),
        (b"DSCOMPRESSED", "Digital Surf"),
        (b"\x93NUMPY\x01", "NumPy"),
        (b"PAR1", "Parquet"),
        (b"\x89PNG\r\n", "PNG"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
    ] {
        assert!(foreign(bytes).is_some_and(|error| error.given.contains(kind)), "{kind}");
    }
    assert!(read(b"BMW road\nx,z\n0,1\n1,2\n").is_none());
    assert!(read(b"0 1\n1 2\n").is_none());
}
