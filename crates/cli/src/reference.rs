//! What the program says of itself: the page of all keys, outputs and options, completions of shells, manual pages.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use asperity::element::MEASURED_TABLE;
use asperity::outputs::{OutputEntry, catalogue};
use asperity::patch::{self, PatchKind, PatchOutputEntry};
use asperity::scene::{
    Absent, KeyEntry, LIP_PRESSURES, MOTION, POINTS, SOFTENING, SealGroup, Unit, patch_keys, scene_keys, seal_keys,
};
use asperity::seal;
use asperity::tables::{Dimension, Role, Unit as TableUnit, UnitRule};
use asperity_study::calibration::FRICTION;
use asperity_study::motion::{PATCH_MOTION, SEAL_MOTION};
use asperity_study::{Error, fit, rank};
use clap::{Arg, Args, Command};

use super::cli::values::example;
use super::files::print;

#[derive(Debug, Args)]
#[command(after_help = example!("asperity completions bash"))]
pub(crate) struct Completions {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity manual -o man"))]
pub(crate) struct Manual {
    /// The folder to write the pages to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}

const NAME: &str = "asperity";

/// `asperity reference`: prints docs/reference.md.
pub(super) fn reference(program: Command) -> Result<(), Error> {
    print(&page(program))
}

/// `asperity completions SHELL`.
pub(super) fn completions(command: &Completions, mut program: Command) -> Result<(), Error> {
    let mut script = Vec::new();
    clap_complete::generate(command.shell, &mut program, NAME, &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// `asperity manual -o FOLDER`.
pub(super) fn manual(command: &Manual, program: Command) -> std::io::Result<()> {
    fs::create_dir_all(&command.output)?;
    clap_mangen::generate_to(program, &command.output)
}

const HEAD: &str = "# Reference

All keys of scenes, patches and seals, all outputs, and all commands with their options. This page is made by
`asperity reference` from the tables that the program itself reads.

Numbers are in SI units. A number that has a unit may also be a text with another one: `\"2 bar\"`, `\"25 µm\"`,
`\"60 °C\"`, `\"8 MPa\"`, `\"1 kHz\"`, also behind numbers of options (`--pressures 1bar,2bar`). `[]` stands behind
tables of which there may be several. An absent key has the value under *absent*; one that is required must be there
wherever its table is. *M* marks keys of scenes with a `[material]` alone, *D* those of scenes without, whose links
have constants of their own; else *only* names the kinds or shapes of the table that have the key.
";

/// What has no rows of its own: paths of other keys as keys.
const UNCERTAIN: &str = "
Beside it any number of the scene by its path in quotation marks, as `\"friction.rate_shear.strength\"`, set to one of
`{ relative = 0.1 }` (log-normal, the standard deviation of the logarithm), `{ factor = 2 }` (log-uniform, from 1/2 to 2
times) and `{ absolute = 2.0 }` (normal, the standard deviation in SI units or as a text with its unit);
`\"material.prony\" = { relative = 0.05 }`, `\"surface.spectrum\" = { relative = 0.2 }`, also with `each = \"decade\"`, and
`\"surface\" = \"seed\"`: [what is not known](decide.md).
";

/// What stands above the names of columns.
const COLUMNS: &str = "
## Columns of files

A column is what its name says: by one of these names or symbols, whole, where case, blanks and `_` do not count, or by
two of them behind each other. Its unit stands beside it in brackets, `speed [mm/s]`, or in the row below the names. What
else a file has is left out, which is told. A column with another name is said to be one of these: in a scene by
`{ path = \"…\", columns = { modulus = \"E_1\" } }` in place of the path, of a profile by the key `columns`; of data by
`--column speed=v2`, in Python by `columns={\"speed\": \"v2\"}`; each with its name or its number from 1.
";

/// Kinds of files, and what their columns may hold.
const FILES: [(&str, &[Role]); 14] = [
    ("A profile: `surface.path`, `asperity surface`", &asperity_formats::profile::ROLES),
    ("A spectrum: `surface.fine.spectrum`", asperity_formats::SPECTRUM.roles),
    ("A softening: `surface.fine.softening`", SOFTENING.roles),
    ("A Prony series: `material.prony`", asperity_formats::SERIES.roles),
    ("A motion: `excitation.file`", MOTION.roles),
    ("Measured friction of a patch or a lip: `table.path`", MEASURED_TABLE.roles),
    ("Points of a patch: `patch.path`", POINTS.roles),
    ("A motion of a patch: `asperity simulate --motion`", PATCH_MOTION.roles),
    ("The pressure on a lip: `seal.pressure`", LIP_PRESSURES.roles),
    ("A motion of a seal: `asperity simulate --motion`", SEAL_MOTION.roles),
    ("Moduli: `asperity fit`", &fit::ROLES),
    ("Shift factors: `asperity fit --shifts`", fit::SHIFTS.roles),
    ("Measured friction: `--data` of `asperity calibrate`, `compare`, `rank` and `sweep`", FRICTION.roles),
    ("Weights: `asperity rank --weights`", rank::WEIGHTS.roles),
];

/// A table for each kind of file.
fn column_tables() -> String {
    let mut text = String::new();
    for (title, roles) in FILES {
        let _ = writeln!(text, "\n### {title}\n\n| column | unit | names and symbols |\n|---|---|---|");
        for role in roles {
            let unit = match (role.dimension, role.unit) {
                (Dimension::Number, _) => String::new(),
                (dimension, UnitRule::Named) => format!("{}, named", TableUnit::si(dimension)),
                (dimension, _) => TableUnit::si(dimension).to_string(),
            };
            let _ = writeln!(text, "| `{}` | {unit} | {} |", role.key, cell(role.names));
        }
    }
    text
}

/// The page, of a `program` with these commands.
pub(super) fn page(mut program: Command) -> String {
    let mut page = HEAD.to_owned();
    page += &format!("\n## Keys of a scene\n{}{UNCERTAIN}", key_tables(&scene_keys()));
    page += &format!("\n## Keys of a patch\n{}", key_tables(&patch_keys()));
    page += &format!("\n## Keys of a seal\n{}", key_tables(&seal_keys()));
    page += "\n## Outputs of a scene\n\nBy the groups of `[fmu] outputs`; those of `elements` are of each mass, `element[i].…`.\n";
    page += &output_tables(&outputs_of_scenes());
    page += "\n## Outputs of a patch\n\nBy the groups of `[fmu] outputs`; those of `elements` are of each element, `element[i,j].…`. *only* names the key\nof `[patch]` without which there is no such output.\n";
    page += &output_tables(&outputs_of_patches());
    page += "\n## Outputs of a seal\n\nBy the groups of `[fmu] outputs`; those of `cells` are of each cell.\n";
    page += &output_tables(&outputs_of_seals());
    page += COLUMNS;
    page += &column_tables();
    page += "\n## Commands\n\nAll of them take `-q`, `--quiet`: results and warnings alone, neither notes nor progress; and `-v`,\n`--verbose`: every note where only some or their number would be printed. The examples run in a checkout of the\nrepository.\n";
    program.build();
    for of in program.get_subcommands().filter(|of| !of.is_hide_set() && of.get_name() != "help") {
        page += &options(of);
    }
    page
}

/// A table for each table of the file.
fn key_tables(keys: &[KeyEntry]) -> String {
    let mut text = String::new();
    let table_of = |key: &KeyEntry| key.path.rsplit_once('.').map_or("", |(table, _)| table).to_owned();
    let mut tables: Vec<String> = Vec::new();
    for key in keys {
        if !tables.contains(&table_of(key)) {
            tables.push(table_of(key));
        }
    }
    for table in tables {
        let title = if table.is_empty() { "Above all tables".into() } else { format!("`{table}`") };
        let _ = writeln!(
            text,
            "\n### {title}\n\n| key | holds | unit | absent | only | meaning |\n|---|---|---|---|---|---|"
        );
        for key in keys.iter().filter(|key| table_of(key) == table) {
            let name = key.path.rsplit('.').next().unwrap_or_default();
            let only = match key.of_material {
                Some(true) => "M".to_owned(),
                Some(false) => "D".to_owned(),
                None => key.kinds.join(", "),
            };
            let (allowed, unit, meaning) = (cell(&key.allowed), plain_unit(key.unit), cell(key.meaning));
            let absent = absent(key.absent);
            let _ = writeln!(text, "| `{name}` | {allowed} | {unit} | {absent} | {only} | {meaning} |");
        }
    }
    text
}

/// An output in a table.
struct OutputLine {
    group: &'static str,
    name: String,
    unit: String,
    only: &'static str,
    description: String,
}

fn outputs_of_scenes() -> Vec<OutputLine> {
    let line = |entry: OutputEntry| OutputLine {
        group: entry.group.word(),
        name: entry.name.to_owned(),
        unit: plain_unit(entry.unit),
        only: "",
        description: entry.description.to_owned(),
    };
    catalogue().map(line).collect()
}

fn outputs_of_patches() -> Vec<OutputLine> {
    let only = |of: PatchKind| match of {
        PatchKind::All => "",
        PatchKind::Tread => "transport",
        PatchKind::Warm => "heat",
        PatchKind::Damped => "damping",
    };
    let line = |entry: PatchOutputEntry| OutputLine {
        group: entry.group.word(),
        name: entry.name,
        unit: entry.units.into_iter().map(plain_unit).collect::<Vec<_>>().join(", "),
        only: only(entry.of),
        description: entry.description,
    };
    patch::catalogue().into_iter().map(line).collect()
}

fn outputs_of_seals() -> Vec<OutputLine> {
    let line = |(name, unit, group, description): (String, Unit, SealGroup, String)| OutputLine {
        group: group.word(),
        name,
        unit: plain_unit(unit),
        only: "",
        description,
    };
    seal::catalogue().into_iter().map(line).collect()
}

/// A table for each group of outputs.
fn output_tables(outputs: &[OutputLine]) -> String {
    let mut text = String::new();
    let mut group = "";
    for line in outputs {
        // Writing to a text cannot fail.
        if line.group != group {
            group = line.group;
            let _ = writeln!(text, "\n### `{group}`\n\n| output | unit | only | meaning |\n|---|---|---|---|");
        }
        let OutputLine { name, unit, only, description, .. } = line;
        let _ = writeln!(text, "| `{name}` | {unit} | {only} | {} |", cell(description));
    }
    text
}

fn absent(absent: Absent) -> String {
    match absent {
        Absent::Refused => "required".to_owned(),
        Absent::Value(value) => format!("`{value}`"),
        Absent::Follows(what) => what.to_owned(),
        Absent::None => String::new(),
    }
}

fn plain_unit(unit: Unit) -> String {
    if unit == Unit::One { String::new() } else { unit.name().replace('.', " ") }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn options(command: &Command) -> String {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let mut text = format!("\n### `{NAME} {}`\n\n{about}.\n", command.get_name());
    text += "\n| option | meaning |\n|---|---|\n";
    let given = |argument: &&Arg| !argument.is_hide_set() && !argument.is_global_set() && argument.get_id() != "help";
    for argument in command.get_arguments().filter(given) {
        let names: Vec<String> = argument
            .get_short()
            .map(|short| format!("-{short}"))
            .into_iter()
            .chain(argument.get_long().map(|long| format!("--{long}")))
            .collect();
        let takes_value = argument.get_action().takes_values();
        let values = argument.get_value_names().filter(|_| takes_value).unwrap_or_default();
        let values: String = values.iter().map(|value| format!(" {value}")).collect();
        let meaning = argument.get_help().map(ToString::to_string).unwrap_or_default();
        let defaults: Vec<_> = argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
        let default = if takes_value && !defaults.is_empty() {
            format!(". Default: {}", defaults.join(" "))
        } else {
            String::new()
        };
        let option = format!("{}{values}", names.join(", "));
        let _ = writeln!(text, "| `{}` | {} |", option.trim(), cell(&format!("{meaning}{default}")));
    }
    let example = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    for line in example.lines().skip(1) {
        let _ = write!(text, "\n  {line}");
    }
    text += "\n";
    text
}
