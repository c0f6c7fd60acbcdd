//! Measured moduli, as people and instruments write them: what each row says, in SI units.

use std::f64::consts::TAU;

use asperity::scene::Wlf;
use asperity::tables::{ContentError, Dimension, shortened};
use asperity_formats::text::{Block, decode};
use asperity_formats::workbook;

use super::columns::EXPECTED;
use super::compound::{Sample, Test};
use super::conditions::{Condition, conditions_of};
use super::options::FitOptions;
use super::table::{MeasuredPoint, ModuliTable};
use crate::decimals::short;

/// Measured moduli of tension, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MeasuredModuli {
    pub(super) points: Vec<MeasuredPoint>,
    pub(super) test: Test,
    /// Whether the file gives frequencies in Hz, not in rad/s.
    pub(super) in_hertz: bool,
    /// Whether the frequencies were multiplied by a_T already.
    pub(super) reduced: bool,
    /// How the table was read, and what was assumed.
    pub(super) notes: Vec<String>,
}

impl MeasuredModuli {
    /// Reads the moduli in the bytes of a file: all tables of a text, or of a sheet of a workbook, or of several that are
    /// named by their temperatures or frequencies.
    pub(super) fn read(bytes: &[u8], options: &FitOptions) -> Result<Self, ContentError> {
        if workbook::is_workbook(bytes) {
            Self::of_sheets(&workbook::sheets(bytes)?, options)
        } else {
            Self::parse(&decode(bytes)?, options)
        }
    }

    fn of_sheets(sheets: &[(String, String)], options: &FitOptions) -> Result<Self, ContentError> {
        let wanted = |(name, _): &&(String, String)| options.sheet.as_ref().is_none_or(|wanted| wanted == name);
        let chosen: Vec<&(String, String)> = sheets.iter().filter(wanted).collect();
        let refuse = |expected| {
            let found: Vec<&str> = sheets.iter().map(|(name, _)| name.as_str()).collect();
            Err(ContentError::value(None, "sheets", &found.join(", "), expected))
        };
        let names: Vec<&str> = chosen.iter().map(|(name, _)| name.as_str()).collect();
        let sheet = |((name, text), condition): (&(String, String), Option<Condition>)| {
            let of_name = condition.filter(|found| found.dimension == Dimension::Frequency).map(|found| found.value);
            let options = FitOptions { frequency: of_name.or(options.frequency), ..options.clone() };
            Sheet { name: name.clone(), condition, measured: Self::parse(text, &options) }
        };
        let conditions = conditions_of(&names, &options.units);
        let mut read: Vec<Sheet> = chosen.iter().copied().zip(conditions).map(sheet).collect();
        if read.len() > 1 {
            // One that is named as the others is no sheet of something else.
            let series = read.iter().filter(|sheet| sheet.measured.is_ok() && sheet.condition.is_some()).count();
            read.retain(|sheet| sheet.measured.is_ok() || (series > 0 && sheet.condition.is_some()));
        }
        match read.len() {
            0 if names.is_empty() => refuse("one of them for `sheet`"),
            0 => refuse("moduli in one of them; `sheet` NAME says what one lacks"),
            1 => {
                let sheet = read.remove(0);
                let note = format!("sheet {}", sheet.name);
                let mut measured = sheet.with_condition()?;
                measured.notes.insert(0, note);
                Ok(measured)
            }
            _ if read.iter().all(|sheet| sheet.condition.is_some()) => together(read),
            _ => {
                refuse("moduli in one of them alone, or in sheets named by their temperatures, 20 °C, or `sheet` NAME")
            }
        }
    }

    /// Reads all tables of moduli in a text.
    fn parse(text: &str, options: &FitOptions) -> Result<Self, ContentError> {
        let blocks = Block::all(text, true);
        let mut tables: Vec<ModuliTable<'_>> = Vec::new();
        let (mut notes, mut errors) = (Vec::new(), Vec::new());
        for block in &blocks {
            match ModuliTable::read(block, tables.last(), options) {
                Ok(Some(table)) => tables.push(table),
                Ok(None) if block.rows > 1 => notes.push(format!(
                    "lines {} to {}: numbers without names of moduli above them are left out",
                    block.first, block.last
                )),
                Ok(None) => (),
                Err(error) => errors.push((block, error)),
            }
        }
        for (block, error) in errors {
            // A line or two with a name in a preamble are no table that is missed.
            if block.rows > 2 || tables.is_empty() {
                return Err(error);
            }
            notes.push(format!("lines {} to {} are left out: {error}", block.first, block.last));
        }
        let Some(first) = tables.first() else { return Err(no_table(text, &blocks)) };
        if let Some(name) = options.ignore.iter().find(|name| !first.has(name, text)) {
            return Err(refused(first.line, &format!("`ignore` {name}"), "one of the headings"));
        }
        let (test, in_hertz, reduced) = (first.test(), first.in_hertz(), first.is_reduced());
        let mut points = Vec::new();
        let decimal = ModuliTable::decimal(&tables, text)?;
        for table in &tables {
            if (table.test(), table.is_reduced()) != (test, reduced) {
                let expected = "tables of one kind in a file: all of oscillation, or all of relaxation";
                return Err(refused(table.line, "another kind of table", expected));
            }
            if tables.len() > 1 {
                table.check_temperature()?;
            }
            match table.add_points(text, decimal, options, &mut points)? {
                0 => (),
                1 => notes.push("a row whose loss is 0, below what was measured, is left out".into()),
                zeros => notes.push(format!("{zeros} rows whose loss is 0, below what was measured, are left out")),
            }
        }
        notes.splice(0..0, first.notes(options, tables.len()));
        if points.is_empty() {
            return Err(refused(first.line + 1, "", "a row of numbers"));
        }
        Ok(Self { points, test, in_hertz, reduced, notes })
    }

    /// The samples as they stand in the file.
    pub(super) fn samples(&self) -> Vec<Sample> {
        self.points.iter().map(|point| point.sample).collect()
    }

    /// The lines of two rows at one frequency or time whose moduli differ by far more than scatter.
    pub(super) fn contradiction(&self) -> Option<[usize; 2]> {
        /// Ratio of the moduli.
        const FAR: f64 = 1.5;
        let mut sorted: Vec<&MeasuredPoint> = self.points.iter().collect();
        sorted.sort_by(|a, b| a.sample.at.total_cmp(&b.sample.at));
        let differ = |a: &Sample, b: &Sample| {
            let ratio = (a.storage / b.storage).ln().abs();
            (a.at / b.at - 1.0).abs() < 1e-9 && ratio > FAR.ln()
        };
        let found = sorted.windows(2).find(|pair| differ(&pair[0].sample, &pair[1].sample))?;
        Some([found[0].line.min(found[1].line), found[0].line.max(found[1].line)])
    }

    /// The samples at a_T ω, or t/a_T, for the factor of each point.
    pub(super) fn shifted(&self, factor: impl Fn(&MeasuredPoint) -> f64) -> Vec<Sample> {
        self.points.iter().map(|point| point.sample.shifted(factor(point), self.test)).collect()
    }

    /// The points at the reference temperature by known constants: their moduli unchanged.
    pub(super) fn at_reference(&self, wlf: impl Fn(f64) -> Wlf) -> Result<Vec<Sample>, ContentError> {
        /// Far above the shift of any rubber: closer to the pole, a fit would depend on the constants alone.
        const LARGEST: f64 = 1e60;
        let factor = |point: &MeasuredPoint| {
            let Some(temperature) = point.temperature else { return Ok(1.0) };
            let wlf = wlf(temperature);
            let factor = wlf.shift_factor();
            if temperature > wlf.lowest_temperature() && (1.0 / LARGEST..=LARGEST).contains(&factor) {
                return Ok(factor);
            }
            let expected = format!(
                "more than TREF - C2 = {:.2} K, and not close to it: there the shift has its pole",
                wlf.lowest_temperature()
            );
            Err(refused(point.line, &format!("a temperature of {temperature} K"), &expected))
        };
        let shifted = |point: &MeasuredPoint| Ok(point.sample.shifted(factor(point)?, self.test));
        self.points.iter().map(shifted).collect()
    }
}

/// A sheet with what its name says of all its rows.
struct Sheet {
    name: String,
    condition: Option<Condition>,
    measured: Result<MeasuredModuli, ContentError>,
}

impl Sheet {
    /// Its moduli at the temperature of its name, where the rows have none of their own.
    fn with_condition(self) -> Result<MeasuredModuli, ContentError> {
        let mut measured = self.measured.map_err(|error| error.in_sheet(&self.name))?;
        if let Some(Condition { dimension: Dimension::Temperature, value }) = self.condition {
            let rows = measured.points.iter_mut().filter(|point| point.temperature.is_none());
            rows.for_each(|point| point.temperature = Some(value));
        }
        Ok(measured)
    }

    /// Its name, and what is taken from that.
    fn said(&self) -> Option<String> {
        let Condition { dimension, value } = self.condition?;
        let taken = match dimension {
            Dimension::Frequency => format!("{} Hz", short(value / TAU, 6)),
            _ => format!("{} K", short(value, 6)),
        };
        Some(format!("{} at {taken}", self.name))
    }
}

/// The moduli of several sheets.
fn together(sheets: Vec<Sheet>) -> Result<MeasuredModuli, ContentError> {
    let said: Vec<String> = sheets.iter().filter_map(Sheet::said).collect();
    let mut all: Option<MeasuredModuli> = None;
    for sheet in sheets {
        let name = sheet.name.clone();
        let measured = sheet.with_condition()?;
        match &mut all {
            None => all = Some(measured),
            Some(all) if (all.test, all.reduced) != (measured.test, measured.reduced) => {
                let expected = "tables of one kind in a file: all of oscillation, or all of relaxation";
                return Err(ContentError::value(None, &format!("sheet {name}"), "another kind of table", expected));
            }
            Some(all) => all.points.extend(measured.points),
        }
    }
    let mut all = all.ok_or_else(|| ContentError::value(None, "sheets", "none", "one"))?;
    all.notes.insert(0, format!("sheets by their names: {}", said.join(", ")));
    Ok(all)
}

/// The error of what was `found` in a line.
fn refused(line: usize, found: &str, expected: &str) -> ContentError {
    ContentError::value(Some(line), "", &shortened(found), expected)
}

/// No table has what is needed: the nearest that was found, or what is expected.
fn no_table(text: &str, blocks: &[Block<'_>]) -> ContentError {
    match blocks.iter().max_by_key(|block| block.rows) {
        None if text.trim().is_empty() => refused(1, "", "a header line, then rows"),
        None => {
            let begins_with_digit =
                |(_, line): &(usize, &str)| line.trim_start().starts_with(|c: char| c.is_ascii_digit());
            let (line, found) =
                (1..).zip(text.lines()).find(begins_with_digit).unwrap_or((text.lines().count() + 1, ""));
            refused(line, found, "a row of numbers")
        }
        Some(block) => {
            let (line, header) = block.above.last().copied().unwrap_or((block.first, ""));
            refused(line, header, EXPECTED)
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity::tables::Unit;

    use super::*;

    fn read_with(text: &str, options: &FitOptions) -> MeasuredModuli {
        MeasuredModuli::parse(text, options).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    fn read(text: &str) -> MeasuredModuli {
        read_with(text, &FitOptions::default())
    }

    fn refusal(text: &str) -> String {
        with_line(MeasuredModuli::read(text.as_bytes(), &FitOptions::default()).unwrap_err())
    }

    fn with_line(error: ContentError) -> String {
        format!("{}: {error}", error.line.unwrap_or_default())
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
            "omega [rad/s];E' [MPa];loss modulus;T [K];;\n;MPa;MPa;;;\n12.566370614359172;3;0.6;293.15;;\n",
            "# T = 20 °C\n# Frequency (Hz)\tE' (MPa)\tE'' (MPa)\n2\t3\t0.6\n",
            "T=20 °C;Mw=90;\nFreq\tG'\tG\"\tStrain\nrad/s\tMPa\tMPa\t%\n12.566370614359172\t1\t0.2\t1\n",
            "Point,Time [s],f [Hz],E' [MPa],E'' [MPa],Strain [%],T [°F]\na,1,2,3,0.6,9,68\n",
            "log f [Hz];log E' [Pa];tan(d);T [°C]\n0,30102999566398120;6,47712125471966244;0,2;20",
            "f [Hz];|E*| [MPa];delta [°];T [°C]\n2;3.0594117081556709;11.309932474020213;20",
            "f [Hz],|E*| [kPa],tan(d),T [°C]\n2,3059.4117081556709,0.2,20",
            "f [Hz],|E*| [MPa],delta [rad],T [°C]\n2,3.0594117081556709,0.19739555984988078,20",
            "f [Hz],|E*| [MPa],phase (mrad),T [°C]\n2,3.0594117081556709,197.39555984988078,20",
            "f [Hz],|G*| [MPa],phase angle (deg),T [°C]\n2,1.0198039027185569,11.309932474020213,20",
            "f [Hz],E' [MPa],delta [°],T [°C]\n2,3,11.309932474020213,20",
            "T [°C],E' [MPa] 2 Hz,E'' [MPa] 2 Hz,E' [MPa] 20 Hz,E'' [MPa] 20 Hz\n20,3,0.6,4,0.7\n",
            "T;E' 2 Hz;E'' 2 Hz;E' 20 Hz;E'' 20 Hz\n°C;MPa;MPa;MPa;MPa\n20;3;0,6;4;0,7\n",
            ",2 Hz,,20 Hz,\nT [°C],E' [MPa],E'' [MPa],E' [MPa],E'' [MPa]\n20,3,0.6,4,0.7\n",
            "T [°C],E' (f = 2 Hz) [MPa],E' (f = 20 Hz) [MPa],tan d 2 Hz,tan d 20 Hz\n20,3,4,0.2,0.3\n",
            "T [°C],E' [MPa] 2 Hz,tan d 2 Hz\n20,3,0.2\n",
            "Oscillation frequency\tDyn. Storage Modulus\tDyn. Loss Modulus\tTemperature\nHz\tksi\tpsi\t°C\n\
             2\t0.43511321319\t87.022642638\t20\n",
            ",20 °C,,30 °C,\nf [Hz],E' [MPa],E'' [MPa],E' [MPa],E'' [MPa]\n2,3,0.6,2,0.2\n",
            "f [Hz],E' [MPa] 20 °C,E'' [MPa] 20 °C,E' [MPa] 30 °C,E'' [MPa] 30 °C\n2,3,0.6,2,0.2\n",
            "f [Hz],E' [MPa] 20 °C,E' [MPa] 30 °C,E'' [MPa] 30 °C,E'' [MPa] 20 °C\n2,3,2,0.2,0.6\n",
            "[Step]\nNumber of points\t1\nVariables\tTemperature\tFrequency\tStorage modulus\tLoss modulus\n\
             Units\t°C\tHz\tMPa\tMPa\nData point\t20\t2\t3\t0.6\n[Step]\nNumber of points\t1\n\
             Variables\tTemperature\tFrequency\tStorage modulus\tLoss modulus\nUnits\t°C\tHz\tMPa\tMPa\n\
             Data point\t30\t2\t2\t0.2\n",
        ];
        for text in texts {
            let row = read(text).points[0];
            // Ten digits are written.
            let close = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-9;
            let Sample { at, storage, loss } = row.sample;
            assert!(close(at, 2.0 * TAU) && close(storage, 3e6) && close(loss, 6e5), "{text}: {row:?}");
            assert!(close(row.temperature.unwrap(), 293.15), "{text}: {row:?}");
        }
        let last = texts[texts.len() - 4..].iter().map(|text| read(text).points);
        assert!(
            last.map(|points| points[1]).all(|point| point.temperature == Some(303.15) && point.sample.storage == 2e6)
        );
    }

    #[test]
    fn a_column_a_frequency_has_points_at_each() {
        let points = read("T [°C],E' 2 Hz [MPa],E'' 2 Hz [MPa],E' 20 Hz [MPa],E'' 20 Hz [MPa]\n20,3,1,5,2\n30,2,1,,\n");
        let found: Vec<_> = points.points.iter().map(|row| (row.temperature, row.sample)).collect();
        let row = |kelvin, hertz, storage, loss| (Some(kelvin), Sample { at: TAU * hertz, storage, loss });
        let expected = [row(293.15, 2.0, 3e6, 1e6), row(293.15, 20.0, 5e6, 2e6), row(303.15, 2.0, 2e6, 1e6)];
        assert_eq!(found, expected);
        assert!(points.notes.iter().any(|note| note.contains("2 frequencies")), "{:?}", points.notes);
        for (text, message) in [
            (
                "T [°C],E' [Pa] 1 Hz,E' [Pa],E'' [Pa] 1 Hz,E'' [Pa]\n1,2,3,4,5\n",
                "1: column 3 \"E' [Pa]\": expected its frequency",
            ),
            (
                "T [°C],E' [Pa] 1 Hz,E' [Pa] 2 Hz,E'' [Pa] 1 Hz,E'' [Pa] 3 Hz\n1,2,3,4,5\n",
                "1: column 5 \"E'' [Pa] 3 Hz\": expected one column of its kind at 2.0000 Hz",
            ),
            (
                "f [Hz];E' [kPa];E'' [kPa]\n1;5.982;1.204\n10;12.004;2.310",
                "2: column 2 \"E' [kPa]\" = \"5.982\": expected a line",
            ),
        ] {
            assert!(refusal(text).starts_with(message), "{text}\n{}", refusal(text));
        }
        let decided = read("f [Hz];E' [kPa];E'' [kPa]\n0,1;5.982;1.204\n10;12.004;2.310");
        assert_eq!(decided.points[0].sample.storage, 5982e3);
        // So do quoted thousands with decimals.
        assert_eq!(read("f,E',E''\n\n1,\"2,000.0\",\"3,000.0\"\n").points[0].sample.storage, 2000.0);
    }

    #[test]
    fn every_encoding_gives_the_same() {
        let bytes = b"f [Hz];E' [N/mm\xb2];tan d;Temp. [\xb0C]\r\n1;2;0,1;-10\r\n";
        let measured = MeasuredModuli::read(bytes, &FitOptions::default()).unwrap();
        assert_eq!((measured.points[0].temperature, measured.points[0].sample.storage), (Some(263.15), 2e6));
        let text: String = bytes.iter().copied().map(char::from).collect();
        let utf_16: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        assert_eq!(MeasuredModuli::read(&utf_16, &FitOptions::default()), Ok(measured));
    }

    #[test]
    fn relaxation_has_times() {
        let measured = read("t,E_relax\ns,MPa\n0.01,20\n10,11\n");
        assert_eq!(measured.test, Test::Relaxation);
        assert_eq!(measured.samples()[1], Sample { at: 10.0, storage: 11e6, loss: 0.0 });
        assert_eq!(read("Time (min),G(t) (MPa)\n1,2\n").samples()[0], Sample { at: 60.0, storage: 6e6, loss: 0.0 });
    }

    #[test]
    fn frequencies_may_be_reduced_or_given() {
        assert!(read("a_T f [Hz],E' [MPa],E'' [MPa],T [°C]\n1,2,3,20\n").reduced);
        assert!(!read("f [Hz],E' [MPa],E'' [MPa],T [°C]\n1,2,3,20\n").reduced);
        let at = FitOptions { frequency: Some(5.0), ..FitOptions::default() };
        assert_eq!(read_with("T [°C],E' [MPa],E'' [MPa]\n20,2,3\n", &at).points[0].sample.at, 5.0);
        let factors = read("f [Hz],E' [MPa],E'' [MPa],T [°C],log aT\n1,2,3,20,2\n");
        assert_eq!(factors.points[0].shift, Some(100.0));
    }

    #[test]
    fn shear_is_converted_and_assumptions_are_noted() {
        let notes = |text: &str| read(text).notes.join("; ");
        let shear = read_with(
            "f [Hz],G' [MPa],G'' [MPa]\n1,2,3\n",
            &FitOptions { poisson_ratio: 0.25, ..FitOptions::default() },
        );
        assert_eq!(shear.points[0].sample.storage, 5e6);
        assert!(shear.notes.join("; ").contains("moduli of shear: E = 2(1 + ν) G, with ν = 0.25"));
        let named = "f [Hz],Storage modulus [MPa],Loss modulus [MPa]\n1,2,3\n";
        assert!(notes(named).contains("does not say whether of tension or shear: E is assumed"));
        assert_eq!(read_with(named, &FitOptions { shear: true, ..FitOptions::default() }).points[0].sample.loss, 9e6);
        assert!(notes("f,E' [MPa],E'' [MPa]\n1,2,3").contains("frequency = column 1 \"f\" in Hz, assumed"));
        assert!(notes("omega,E',tan(d)\n1,2e6,3").contains("frequency = column 1 \"omega\" in rad/s, assumed"));
        assert!(notes("omega,E',tan(d)\n1,2e6,3").contains("storage_modulus = column 2 \"E'\" in Pa, assumed"));
        let both = "f [Hz],E' [Pa],E'' [Pa],tan(d)\n1,2,3,1.5";
        assert!(notes(both).contains("both E'' and tan delta are given: E'' is used"));
        assert!(notes("Point,f [Hz],E' [Pa],E'' [Pa],F [N]\n1,1,2,3,9").contains("left out: Point, F [N]"));
        assert!(notes("f [Hz],E' [Pa],E'' [Pa]\n1,2,3\n2,2,0\n").contains("a row whose loss is 0"));
    }

    #[test]
    fn a_unit_may_be_given_and_a_column_ignored() {
        let text = "f [Hz],E' [MPa],E'' [MPa],Temperature\n1,2,3,20";
        let units = vec![("temperature".to_owned(), Unit::parse("°C").unwrap())];
        let given = FitOptions { units, ..FitOptions::default() };
        assert_eq!(read_with(text, &given).points[0].temperature, Some(293.15));
        let wide = ",20,,40,\nf [Hz],E' [MPa],E'' [MPa],E' [MPa],E'' [MPa]\n1,2,3,4,5\n";
        assert_eq!(read_with(wide, &given).points[1].temperature, Some(313.15));
        let ignored = |name: &str| {
            MeasuredModuli::parse(text, &FitOptions { ignore: vec![name.to_owned()], ..FitOptions::default() })
        };
        assert_eq!(ignored("Temperature").unwrap().points[0].temperature, None);
        assert_eq!(with_line(ignored("temp").unwrap_err()), "1: `ignore` temp: expected one of the headings");
    }

    #[test]
    fn what_is_wrong_is_refused_with_line_and_column() {
        let head = "f [Hz],E' [MPa],E'' [MPa]";
        let cases = [
            (
                format!("{head}\n1,2,3\n\n2,x,3\n3,2,1"),
                "4: column 2 \"E' [MPa]\" = \"x\": expected a number from 1e-30 to 1e30 in Pa",
            ),
            (
                format!("{head}\n1,2,-3"),
                "2: column 3 \"E'' [MPa]\" = \"-3\": expected a number from 1e-30 to 1e30 in Pa",
            ),
            (format!("{head}\n0,2,3"), "2: column 1 \"f [Hz]\" = \"0\": expected a number from 1e-30 to 1e30 in rad/s"),
            (format!("{head}\n1,,3"), "2: column 2 \"E' [MPa]\": expected a number from 1e-30 to 1e30 in Pa"),
            (
                format!("{head}\n1,1e-40,3"),
                "2: column 2 \"E' [MPa]\" = \"1e-40\": expected a number from 1e-30 to 1e30 in Pa",
            ),
            (head.into(), "2: expected a row of numbers"),
            (String::new(), "1: expected a header line, then rows"),
            ("f [Hz],E'' [Pa]\n1,2".into(), "1: expected a column of the storage modulus: E' [MPa]"),
            ("f [Hz],E' [Pa]\n1,2".into(), "1: expected a column of the loss: E'' [MPa] or tan delta"),
            (
                "T [°C],E' [Pa],E'' [Pa]\n1,2,3".into(),
                "1: expected a frequency column, f [Hz] or omega [rad/s]; or `frequency`",
            ),
            ("f [Hz],|E*| [Pa]\n1,2".into(), "1: expected a column of the phase beside |E*|"),
            (
                "f [Hz],omega [rad/s],E' [Pa],E'' [Pa]\n1,2,3,4".into(),
                "2: column 2 \"omega [rad/s]\" = \"2.0000e0 rad/s\"",
            ),
            (
                "f [Hz],E' [Pa],E' [Pa],E'' [Pa]\n1,2,3,4".into(),
                "1: 2 columns of moduli, 1 of losses, 1 of frequencies: expected a pair",
            ),
            (
                "f [Hz],E' [Pa],E'' [Pa],temperature\n1,2,3,4".into(),
                "2: column 4 \"temperature\" = \"4\": expected the unit beside the name, as in temperature [°C]; or \
                `unit`",
            ),
            (
                "f [Hz],E' [Pa],E'' [Pa],T [°C]\n1,2,3,-300".into(),
                "2: column 4 \"T [°C]\" = \"-300\": expected a number above 0 in K",
            ),
            (
                "f [Hz],E' [furlong],E'' [Pa]\n1,2,3".into(),
                "1: unit of column 2 \"E' [furlong]\" = \"furlong\": expected one of Pa",
            ),
            (
                "f [Hz],E' [MPa],E'' [kPa],tan d\n1,2,0.2,0.1".into(),
                "2: column 4 \"tan d\" = \"0.1\": expected 0.0001, which",
            ),
            ("omega [Hz],E' [Pa],E'' [Pa]\n1,2,3".into(), "1: column 1 \"omega [Hz]\": expected rad/s or 1/s"),
            (
                "f [Hz];E' [Pa];E'' [Pa]\n1,5;2;3\n2.5;2;3".into(),
                "3: column 1 \"f [Hz]\" = \"2.5\": expected numbers with",
            ),
            ("1,2,3\n4,5,6".into(), "1: expected columns by their names with units"),
            (
                ",20,,40,\nf [Hz],E' [Pa],E'' [Pa],E' [Pa],E'' [Pa]\n1,2,3,4,5\n".into(),
                "1: column 2 = \"20\": expected a unit of temperature",
            ),
            (
                "f,E',E''\n1,20,3".into(),
                "2: column 2 \"E'\" = \"20\": expected the unit beside the name, as in E' [MPa]; or `unit` 'E'=MPa': in \
                Pa it",
            ),
            (
                "# moduli in MPa\nf [Hz],E',E''\n1,2e6,3".into(),
                "1: unit = \"moduli in MPa\": expected the unit beside the name, as in E' [MPa]; or `unit`",
            ),
            ("f [Hz],|E*| [Pa],delta\n1,2,3".into(), "1: column 3 \"delta\": expected the unit beside the name"),
            (
                "f [Hz],E' [Pa] 20 °C,E' [Pa] 30 °C,E'' [Pa] 20 °C,E'' [Pa] 40 °C\n1,2,3,4,5\n".into(),
                "1: column 5 \"E'' [Pa] 40 °C\": expected one column of its kind at 303.15 K",
            ),
            (
                "T=20;\nf [Hz] E' [Pa] E'' [Pa]\n1 2 3\n2 3 4\n\nT=30;\nf [Hz] E' [Pa] E'' [Pa]\n1 2 3\n2 3 4\n".into(),
                "1: T=20: expected a unit of temperature, as in 20 °C; or `unit` 'T=°C'",
            ),
            ("a\0".into(), "1: bytes that are zero: expected text in UTF-8, UTF-16 or Latin-1"),
        ];
        for (text, message) in cases {
            assert!(refusal(&text).starts_with(message), "{text}\n{}\n{message}", refusal(&text));
        }
    }

    #[test]
    fn rows_of_several_temperatures_contradict_each_other() {
        let lines = |text: &str| read(text).contradiction();
        let head = "f [Hz],E' [MPa],E'' [MPa]\n";
        assert_eq!(lines(&format!("{head}1,2,1\n2,2.1,1\n1,9,1\n")), Some([2, 4]));
        assert_eq!(lines(&format!("{head}1,2,1\n2,9,1\n1,2.2,1\n")), None);
    }

    fn at(temperature: f64) -> MeasuredModuli {
        let sample = Sample { at: 3.0, storage: 2.0, loss: 1.0 };
        let point =
            MeasuredPoint { line: 7, sample, temperature: Some(temperature), shift: None, vertical: None, set: None };
        MeasuredModuli {
            points: vec![point],
            test: Test::Oscillation,
            in_hertz: true,
            reduced: false,
            notes: Vec::new(),
        }
    }

    fn law(temperature: f64) -> Wlf {
        Wlf { c1: 8.0, c2: 100.0, reference_temperature: 293.15, temperature }
    }

    /// log10 a_T = -8·10/110 ten kelvin above, 8·10/90 ten below: heat acts as slower motion.
    #[test]
    fn points_are_shifted_by_wlf() {
        let omega = |temperature: f64| at(temperature).at_reference(law).unwrap()[0].at;
        assert_eq!(omega(293.15), 3.0);
        assert!((omega(303.15) / 3.0 / 10.0_f64.powf(-80.0 / 110.0) - 1.0).abs() < 1e-12);
        assert!((omega(283.15) / 3.0 / 10.0_f64.powf(80.0 / 90.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn temperatures_at_and_near_the_pole_are_refused() {
        for temperature in [193.15, 150.0, 194.0] {
            let refusal = with_line(at(temperature).at_reference(law).unwrap_err());
            let wanted = format!("7: a temperature of {temperature} K: expected more than TREF - C2 = 193.15");
            assert!(refusal.starts_with(&wanted), "{refusal}");
        }
    }
}
