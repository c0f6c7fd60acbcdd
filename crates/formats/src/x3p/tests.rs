use std::io::{Cursor, Write as _};

use md5::{Digest, Md5};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::*;

/// A file in the making: 4 points by 3 lines, 0.5 µm apart, from 2 µm on, unless a test says otherwise.
struct File {
    folder: &'static str,
    prefix: &'static str,
    feature: &'static str,
    /// The x axis and the z axis.
    axes: [&'static str; 2],
    size: [&'static str; 3],
    data: Vec<u8>,
    mask: Option<Vec<u8>>,
    /// What stands in Record3 in place of a link to the data.
    inline: Option<String>,
    checksum: Option<&'static str>,
}

const EVEN: &str = "<AxisType>I</AxisType><DataType>D</DataType><Increment>5e-7</Increment><Offset>2e-6</Offset>";
const DOUBLE: &str = "<AxisType>A</AxisType><DataType>D</DataType><Increment>1</Increment><Offset>0</Offset>";

/// Heights of three lines of four points.
const HEIGHTS: [f64; 12] = [0.0, 1e-6, 2e-6, 3e-6, 1.5e-6, -1e-6, 0.25e-6, 4e-6, 9e-6, 8e-6, 7e-6, 6e-6];

fn bytes<const N: usize, T: Copy>(values: &[T], of: fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|value| of(*value)).collect()
}

fn file() -> File {
    File {
        folder: "",
        prefix: "p:",
        feature: "SUR",
        axes: [EVEN, DOUBLE],
        size: ["4", "3", "1"],
        data: bytes(&HEIGHTS, f64::to_le_bytes),
        mask: None,
        inline: None,
        checksum: None,
    }
}

impl File {
    fn document(&self) -> String {
        let Self { prefix, feature, axes: [x, z], size: [size_x, size_y, size_z], .. } = self;
        let sum = |data: &[u8]| Md5::digest(data).iter().map(|byte| format!("{byte:02X}")).collect::<String>();
        let point_sum = self.checksum.map_or_else(|| sum(&self.data), str::to_owned);
        let mask = self.mask.as_ref().map_or_else(String::new, |mask| {
            let sum = sum(mask);
            format!("<ValidPointsLink>bindata/valid.bin</ValidPointsLink><MD5ChecksumValidPoints>{sum}</MD5ChecksumValidPoints>")
        });
        let link = format!(
            "<DataLink><PointDataLink>bindata/data.bin</PointDataLink>\
             <MD5ChecksumPointData>{point_sum}</MD5ChecksumPointData>{mask}</DataLink>"
        );
        let data = self.inline.clone().unwrap_or(link);
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a test -->\n<{prefix}ISO5436_2 xmlns:p=\"a\">\n\
             <Record1><FeatureType>{feature}</FeatureType>\
             <Axes><CX>{x}</CX><CY>{EVEN}</CY><CZ>{z}</CZ></Axes></Record1>\
             <Record2><Comment>a &lt; b</Comment></Record2>\
             <Record3><MatrixDimension>\n<SizeX> {size_x} </SizeX><SizeY>{size_y}</SizeY><SizeZ>{size_z}</SizeZ>\
             </MatrixDimension>{data}</Record3></{prefix}ISO5436_2>\n"
        )
    }

    fn archive(&self) -> Vec<u8> {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let document = self.document();
        let mut add = |name: &str, bytes: &[u8]| {
            writer.start_file(format!("{}{name}", self.folder), options).unwrap();
            writer.write_all(bytes).unwrap();
        };
        add("bindata/data.bin", &self.data);
        add("main.xml", document.as_bytes());
        if let Some(mask) = &self.mask {
            add("bindata/valid.bin", mask);
        }
        writer.finish().unwrap().into_inner()
    }

    fn line(&self, line: usize) -> MeasuredPoints {
        let options = ProfileOptions { line: Some(line), missing: Missing::Fill, ..ProfileOptions::default() };
        read(&self.archive(), &options).unwrap_or_else(|error| unreachable!("{error:?}")).line
    }

    fn refusal(&self, line: Option<usize>) -> String {
        let options = ProfileOptions { line, ..ProfileOptions::default() };
        match read(&self.archive(), &options) {
            Err(error) => error.to_string(),
            Ok(read) => unreachable!("accepted as {read:?}"),
        }
    }
}

fn inline(points: &[&str]) -> Option<String> {
    Some(format!(
        "<DataList>{}</DataList>",
        points.iter().map(|point| format!("<Datum>{point}</Datum>\n")).collect::<String>()
    ))
}

#[test]
fn a_line_of_a_binary_file_is_read() {
    for (folder, prefix) in [("", "p:"), ("measured/", ""), ("a/b/", "iso:"), ("./", "p:")] {
        let file = File { folder, prefix, ..file() };
        for line in 1..=3 {
            let raw = file.line(line);
            assert_eq!(raw.x, [0.0, 1.0, 2.0, 3.0].map(|i| 2e-6 + 5e-7 * i), "{folder}");
            assert_eq!(raw.z, HEIGHTS[4 * (line - 1)..4 * line], "{folder}");
        }
    }
}

#[test]
fn every_type_of_value_is_read() {
    let scaled = |values: &str| {
        format!("<AxisType>A</AxisType><DataType>{values}</DataType><Increment>1e-9</Increment><Offset>5e-7</Offset>")
    };
    let counts = [-3000, 0, 7, 32_000, 1, 2, 3, 4, 5, 6, 7, 8];
    let cases = [
        ("I", bytes(&counts.map(|count| count as i16), i16::to_le_bytes)),
        ("L", bytes(&counts, i32::to_le_bytes)),
        ("F", bytes(&counts.map(|count| count as f32), f32::to_le_bytes)),
        ("D", bytes(&counts.map(f64::from), f64::to_le_bytes)),
    ];
    for (values, data) in cases {
        let file = File { axes: [EVEN, scaled(values).leak()], data, ..file() };
        assert_eq!(file.line(1).z, [-3000.0, 0.0, 7.0, 32_000.0].map(|count| 5e-7 + 1e-9 * count), "{values}");
    }
}

/// Three of the twelve points do not count: the mask's bits from the lowest on.
#[test]
fn a_mask_takes_points_out() {
    let file = File { mask: Some(vec![0b1111_1110, 0b1111_1010]), ..file() };
    let gaps = |line: usize| file.line(line).z.iter().map(|z| z.is_nan()).collect::<Vec<_>>();
    assert_eq!(
        (gaps(1), gaps(2), gaps(3)),
        (vec![true, false, false, false], vec![false; 4], vec![true, false, true, false])
    );
    let refusal = file.refusal(Some(3));
    assert!(refusal.starts_with("z[1] = missing: expected a height, or missing = \"fill\""), "{refusal}");
    let mut data = HEIGHTS;
    data[5] = f64::NAN;
    let file = File { data: bytes(&data, f64::to_le_bytes), ..file };
    assert!(file.line(2).z[1].is_nan());
}

#[test]
fn points_that_stand_inline_are_read() {
    let points = ["0", "1e-6", " 2e-6 ", "", "1;2;4e-6", "5e-6", "6e-6", "7e-6"];
    let file = File { size: ["4", "2", "1"], inline: inline(&points), ..file() };
    assert_eq!(file.line(1).z[..3], [0.0, 1e-6, 2e-6]);
    assert!(file.line(1).z[3].is_nan());
    assert_eq!(file.line(2).z, [4e-6, 5e-6, 6e-6, 7e-6]);
    let absolute = "<AxisType>A</AxisType><DataType>D</DataType>";
    let points = ["0;0;1", "2;0;3", "5;0;4", "7;0;2"];
    let file =
        File { feature: "PRF", size: ["4", "1", "1"], axes: [absolute, absolute], inline: inline(&points), ..file };
    assert_eq!((file.line(1).x, file.line(1).z), (vec![0.0, 2.0, 5.0, 7.0], vec![1.0, 3.0, 4.0, 2.0]));
}

/// Places that are stored stand before the heights.
#[test]
fn an_absolute_axis_is_read() {
    let absolute = "<AxisType>A</AxisType><DataType>F</DataType>";
    let point = |x: f32, z: f64| [&x.to_le_bytes()[..], &z.to_le_bytes()].concat();
    let data = [point(0.0, 1e-6), point(0.5, 2e-6), point(2.0, 0.0)].concat();
    let file = File { feature: "PRF", size: ["3", "1", "1"], axes: [absolute, DOUBLE], data, ..file() };
    let raw = file.line(1);
    assert_eq!((raw.x, raw.z), (vec![0.0, 0.5, 2.0], vec![1e-6, 2e-6, 0.0]));
}

/// All lines, in metres; gaps are refused or filled along their line; axes that are stored make no map.
#[test]
fn an_areal_file_is_a_map() {
    let read_map = |file: &File, missing| {
        let options = ProfileOptions { missing, ..ProfileOptions::default() };
        read(&file.archive(), &options).unwrap().map.unwrap()
    };
    let map = read_map(&file(), Missing::Refuse).unwrap();
    assert_eq!((map.nx(), map.ny(), map.heights()), (4, 3, &HEIGHTS[..]));
    assert!(map.spacing().iter().all(|step| (step / 5e-7 - 1.0).abs() < 1e-12));
    let gap = File { mask: Some(vec![0b1111_1101, 0b1111_1111]), ..file() };
    let refusal = read_map(&gap, Missing::Refuse).unwrap_err().to_string();
    assert!(refusal.contains("1 are missing, the first in line 1, point 2"), "{refusal}");
    assert!((read_map(&gap, Missing::Fill).unwrap().heights()[1] - 1e-6).abs() < 1e-18);
}

#[test]
fn a_line_must_be_there() {
    let middle = read(&file().archive(), &ProfileOptions { missing: Missing::Fill, ..ProfileOptions::default() });
    assert!(middle.is_ok_and(|read| read.line.z == file().line(2).z), "none chosen");
    assert_eq!(file().refusal(Some(4)), "line = 4: expected a whole number from 1 to 3, the lines that there are");
    let profile = File { size: ["12", "1", "1"], ..file() };
    assert_eq!(read(&profile.archive(), &ProfileOptions::default()).unwrap().line.z, HEIGHTS);
}

#[test]
fn files_that_contradict_themselves_are_refused() {
    let relative = "<AxisType>R</AxisType>";
    let cases = [
        (File { size: ["4", "4", "1"], ..file() }, "PointDataLink = 96 bytes: expected 128 bytes"),
        (File { size: ["4", "2", "1"], ..file() }, "PointDataLink = more bytes: expected 64 bytes"),
        (File { size: ["4", "3", "2"], ..file() }, "MatrixDimension.SizeZ = 2: expected 1"),
        (File { size: ["-1", "3", "1"], ..file() }, "MatrixDimension.SizeX = -1: expected a whole number"),
        (File { size: ["99999999999", "999999999999", "1"], ..file() }, "MatrixDimension = 99999999999 by"),
        (File { size: ["0", "3", "1"], ..file() }, "MatrixDimension = 0 by 3 points: expected 1 to"),
        (File { feature: "PCL", ..file() }, "FeatureType = PCL: expected PRF or SUR"),
        (File { axes: [relative, DOUBLE], ..file() }, "CX.AxisType = R: expected I or A"),
        (File { axes: [EVEN, EVEN], ..file() }, "CZ.AxisType = I: expected A"),
        (File { axes: ["<AxisType>I</AxisType>", DOUBLE], ..file() }, "CX.Increment = not there"),
        (
            File { axes: [EVEN, "<AxisType>A</AxisType><DataType>Q</DataType>"], ..file() },
            "CZ.DataType = Q: expected one of",
        ),
        (File { checksum: Some("d41d8cd98f00b204e9800998ecf8427e"), ..file() }, "MD5ChecksumPointData = d41d8c"),
        (File { mask: Some(vec![255]), ..file() }, "ValidPointsLink = 1 bytes: expected 2 bytes"),
        (File { inline: inline(&["1", "2"]), ..file() }, "DataList = 2 points: expected 12"),
        (File { inline: inline(&["high"; 12]), ..file() }, "DataList[1] = high: expected coordinates"),
        (File { inline: Some("<DataLink/>".into()), ..file() }, "DataLink.PointDataLink = not there"),
        (
            File { inline: Some("<DataLink><PointDataLink>a</PointDataLink></DataLink>".into()), ..file() },
            "PointDataLink = a:",
        ),
        (
            File { inline: Some("<DataLink><PointDataLink>a\nb</PointDataLink></DataLink>".into()), ..file() },
            "PointDataLink = a b: expected the name of a file of the archive",
        ),
        (File { inline: Some("<a>".repeat(40)), ..file() }, "main.xml = elements too deep in each other"),
        (File { inline: Some("<a></b>".into()), ..file() }, "main.xml = "),
    ];
    for (file, message) in cases {
        let refusal = file.refusal(Some(1));
        assert!(refusal.starts_with(message) && !refusal.contains('\n'), "{refusal}");
    }
}

/// Of a file that was cut or in which bytes were changed nothing is read, and nothing panics.
#[test]
fn damaged_archives_are_refused() {
    let whole = file().archive();
    let options = ProfileOptions { line: Some(1), ..ProfileOptions::default() };
    for end in 0..whole.len() {
        assert!(read(&whole[..end], &options).is_err(), "{end}");
    }
    for i in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[i] ^= 0x55;
        let _ = read(&bytes, &options);
    }
    let empty = ZipWriter::new(Cursor::new(Vec::new())).finish().unwrap().into_inner();
    assert!(read(&empty, &options).is_err());
}

/// A few kilobytes that unpack into a gigabyte are refused by the length that the document says.
#[test]
fn what_unpacks_without_end_is_refused() {
    let bomb = File { data: vec![0; 1 << 24], checksum: Some(""), ..file() };
    assert!(bomb.archive().len() < 1 << 16);
    assert!(bomb.refusal(Some(1)).starts_with("PointDataLink = more bytes: expected 96 bytes"));
}
