//! The summary of a lip with a film.

use asperity::scene::{Air, RoughSide, SealFile};
use asperity::seal::Seal;

use super::patch::named;
use super::words::LabelledLine;
use crate::decimals::short;

/// The summary of a seal.
pub fn described_seal(seal: &Seal) -> Vec<LabelledLine> {
    [vec![("Name", seal.name().to_owned())], seal_rows(seal)].concat()
}

/// The summary without the name.
pub fn seal_rows(seal: &Seal) -> Vec<LabelledLine> {
    let file = seal.file();
    let groups: Vec<&str> = seal.groups().iter().map(|group| group.word()).collect();
    let mut rows = vec![
        ("Seal", seal.description()),
        ("Lip", lip(seal)),
        ("Rough side", rough_side(file.rough).to_owned()),
        ("Table", format!("{}, {} points", named(seal.table()), seal.table().grid.count())),
    ];
    if seal.table().is_measured() {
        rows.push(("Film", "none: contacts bear all, with the friction measured; [fluid] has no effect".to_owned()));
    } else {
        let film = match file.start {
            Some(content) => format!("{content:e} m at the start"),
            None => "at the start what is there after a long rest".to_owned(),
        };
        rows.extend([
            ("Fluid", fluid(seal)),
            ("Air side", air(file).to_owned()),
            ("Sealed side", format!("flooded to {:e} m", file.supply)),
            ("Film", film),
        ]);
    }
    if seal.has_temperatures() {
        rows.push(("Temperature", format!("an input, {} K at the start", seal.temperature())));
    }
    rows.push(("Outputs", format!("{}: {} variables", groups.join(", "), seal.variables().len())));
    rows
}

fn lip(seal: &Seal) -> String {
    let SealFile { length, stiffness, approach_stiffness, sets, .. } = seal.file();
    let (least, largest) = seal.sealed_pressures();
    let pressed = sets.iter().flat_map(|set| &set.pressures).copied().fold(0.0, f64::max);
    let sealed = match sets.len() {
        1 => "any sealed pressure".to_owned(),
        sets => format!("sealed pressures from {least} to {largest} Pa by {sets} sets"),
    };
    let spring = match stiffness {
        Some(stiffness) => format!("gives way by {stiffness:e} N/m along the motion"),
        None => "rigid along the motion".to_owned(),
    };
    let lifts = approach_stiffness.map_or(String::new(), |stiffness| format!(", {stiffness:e} Pa/m as it is lifted"));
    format!(
        "{} mm wide, {length} m long, pressed by up to {} MPa, {sealed}; {spring}{lifts}",
        short(1e3 * seal.width(), 4),
        short(1e-6 * pressed, 3)
    )
}

fn rough_side(side: RoughSide) -> &'static str {
    match side {
        RoughSide::Moving => "the rod",
        RoughSide::Standing => "the lip",
    }
}

fn fluid(seal: &Seal) -> String {
    let viscosity = &seal.file().viscosity;
    let at = |kelvin: f64| short(viscosity.at(kelvin), 3);
    if !viscosity.depends_on_temperature() {
        return format!("{} Pa s", at(0.0));
    }
    let given = viscosity.temperatures().map(|kelvin| format!("{} Pa s at {kelvin} K", at(kelvin)));
    let law = if viscosity.temperatures().count() == 2 { "Andrade's law" } else { "Vogel's law" };
    format!("{}, by {law}; {} Pa s at the start", given.collect::<Vec<_>>().join(", "), at(seal.temperature()))
}

fn air(file: &SealFile) -> &'static str {
    match file.air {
        Air::Returns => "the film that left comes back",
        Air::Dry => "dry: nothing comes back",
        Air::Flooded => "flooded",
    }
}
