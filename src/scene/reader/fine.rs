//! Reading of the roughness below the profile, `surface.fine`, and what else of a scene must go with it.

use super::surface::Findings;
use super::table::{Entry, Result, TableReader};
use crate::scene::fine_roughness::{Convention, SOFTENING};
use crate::scene::keys::SurfaceKind;
use crate::scene::{FineRoughness, FineWaves, RoughnessSpectrum, Scene, Softening, Surface};

/// The forms: the key by which each is told, the first one that is there, and its other keys.
const FORMS: [(&str, &[&str]); 5] = [
    ("modulus", &["rms_slope"]),
    ("spectrum", &["longest", "shortest", "convention"]),
    ("split", &["shortest"]),
    ("hurst", &["rms_slope", "longest", "shortest"]),
    ("shortest", &[]),
];

/// The forms in words.
const EXPECTED: &str = "hurst, rms_slope, longest and shortest; spectrum, longest and shortest; split and shortest; \
                        shortest alone; or rms_slope and modulus";

/// The roughness below the `surface` of the table `surface_entry`, which it may split; the files that it names are
/// added to those `found`.
pub(super) fn read(
    surface_entry: &Entry<'_>,
    surface: Surface,
    found: &mut Findings,
) -> Result<(Surface, Option<FineRoughness>)> {
    let mut surface_table = surface_entry.open()?;
    let Some(entry) = surface_table.entry("fine") else { return Ok((surface, None)) };
    let kind = surface_table.required("kind")?.choice::<SurfaceKind>()?;
    let mut table = entry.open()?;
    table.check_keys()?;
    let (surface, waves) = read_waves(&entry, &mut table, kind, surface, found)?;
    if !waves.has_bands() {
        for name in ["creep_speed", "hysteresis", "softening"] {
            if let Some(entry) = table.entry(name) {
                return Err(entry.refuse("no such key beside modulus, which is the same at every speed"));
            }
        }
    }
    let fine = FineRoughness {
        waves,
        creep_speed: table.optional_number("creep_speed")?,
        hysteresis: table.entry("hysteresis").map_or(Ok(true), |entry| entry.flag())?,
        softening: match table.entry("softening") {
            Some(entry) if entry.is_file() => found.read_table(
                &entry,
                |formats, bytes, columns| formats.table(bytes, &SOFTENING, columns),
                |table| Ok((Softening::of_table(table), Vec::new())),
            )?,
            Some(entry) => Softening::Factor(entry.number()?),
            None => Softening::Factor(1.0),
        },
        factors: None,
    };
    if let Err(clash) = fine.check(&surface) {
        return Err(table.required(clash.key)?.refuse(clash.expected));
    }
    table.finish()?;
    Ok((surface, Some(fine)))
}

fn read_waves(
    entry: &Entry<'_>,
    table: &mut TableReader<'_>,
    kind: SurfaceKind,
    surface: Surface,
    found: &mut Findings,
) -> Result<(Surface, FineWaves)> {
    let Some((form, keys)) = FORMS.into_iter().find(|(name, _)| table.has(name)) else {
        return Err(entry.refuse(EXPECTED));
    };
    let others = FORMS.into_iter().flat_map(|(name, keys)| keys.iter().copied().chain([name]));
    for other in others.filter(|other| *other != form && !keys.contains(other)) {
        if let Some(entry) = table.entry(other) {
            return Err(entry.refuse(format_args!("no such key beside {form}; surface.fine has {EXPECTED}")));
        }
    }
    let waves = match form {
        "modulus" => FineWaves::Modulus { rms_slope: table.number("rms_slope")?, modulus: table.number("modulus")? },
        "spectrum" => {
            let convention: Convention = table.optional_choice("convention")?.unwrap_or_default();
            let file = table.required("spectrum")?;
            let (longest, shortest) = (table.number("longest")?, table.number("shortest")?);
            let spectrum = found.read_table(
                &file,
                |formats, bytes, columns| formats.spectrum(bytes, convention, columns),
                |table| Ok((RoughnessSpectrum::of_table(table), Vec::new())),
            )?;
            FineWaves::Table { spectrum, longest, shortest }
        }
        "split" => {
            let (entry, shortest) = (table.required("split")?, table.number("shortest")?);
            let split = entry.number()?;
            if kind != SurfaceKind::File {
                return Err(entry.refuse("no such key without kind = \"file\": a line is split that was measured"));
            }
            let parts = surface.split(split).map_err(|expected| entry.refuse(expected))?;
            return Ok((parts.profile, FineWaves::Split { split, shortest, spectrum: parts.finer }));
        }
        "hurst" => FineWaves::SelfAffine {
            hurst: table.number("hurst")?,
            rms_slope: table.number("rms_slope")?,
            longest: table.number("longest")?,
            shortest: table.number("shortest")?,
        },
        _ => FineWaves::Continued { shortest: table.number("shortest")? },
    };
    Ok((surface, waves))
}

/// Refuses what does not go with the roughness below the profile in the rest of the scene.
pub(super) fn check_rest(surface_entry: &Entry<'_>, material_entry: Option<&Entry<'_>>, scene: &Scene) -> Result<()> {
    let fine = scene.fine.as_ref();
    if let Some((key, expected)) = fine.and_then(|fine| fine.misses(scene.friction.as_ref())) {
        let entry = surface_entry.open()?.required("fine")?;
        return Err(match key {
            Some(key) => entry.open()?.required(key)?.refuse(expected),
            None => entry.refuse(expected),
        });
    }
    let material = scene.material.as_ref().filter(|material| material.heat.is_some());
    let (Some(entry), Some(material)) = (material_entry, material) else { return Ok(()) };
    let heat = entry.open()?.required("heat")?;
    match (fine.map(|fine| fine.waves.has_bands()), material.wlf.is_some()) {
        (None, _) => Err(heat.refuse("no such key without surface.fine, whose waves make the heat")),
        (Some(false), _) => {
            Err(heat.refuse("no such key beside surface.fine.modulus, which is the same at every temperature"))
        }
        (_, false) => Err(heat.refuse("no such key without material.wlf, which says what a temperature does")),
        (Some(true), true) => Ok(()),
    }
}
