//! Friction and areas of contact that no rubber has, and which key of the scene is missing or mistaken.

use std::cmp::Ordering;

use asperity::element::{Load, OperatingPoint};
use asperity::scene::{ContactFit, Friction, Kinematics, Scene};

use crate::decimals::{rounded, with_prefix};

/// No rubber is known to have a friction coefficient above it.
const LARGEST_FRICTION: f64 = 3.0;
/// No rubber stands more, K.
const LARGEST_RISE: f64 = 150.0;
/// A real area that is this part of the nominal one is all of it.
const WHOLE: f64 = 0.99;

/// The part of friction that its strain may add to it before that is said.
const STRAINED: f64 = 0.03;

/// The factor by which links may make a contact too wide or too narrow before that is said.
const MISFIT: f64 = 1.2;

/// What was found at a point or in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundFriction {
    /// Where, as in "at 0.1 m/s".
    pub place: String,
    /// Friction coefficient, 1.
    pub friction: f64,
    /// Area that touches over the nominal one, 1: with the roughness below the profile where the scene has it.
    pub area: Option<f64>,
    /// How warm contacts are on the average above the scene's temperature, K; `None` where friction heats nothing.
    pub rise: Option<f64>,
}

/// A point as a place.
pub fn at(point: &OperatingPoint, load: Load) -> String {
    format!("at {}", point.describe(load))
}

/// What of it no rubber on the surface of `scene` has, why, and which key is missing; nothing where all is plausible.
pub fn implausible(scene: &Scene, found: impl IntoIterator<Item = FoundFriction>) -> Vec<String> {
    let found: Vec<FoundFriction> = found.into_iter().collect();
    let is_rubbing = |one: &&FoundFriction| one.friction > LARGEST_FRICTION;
    let is_whole = |one: &&FoundFriction| one.area.is_some_and(|area| area >= WHOLE) && is_unresolved(scene);
    let rubbing: Vec<&FoundFriction> = found.iter().filter(is_rubbing).collect();
    let whole: Vec<&FoundFriction> = found.iter().filter(is_whole).collect();
    let largest = rubbing.iter().max_by(|a, b| a.friction.total_cmp(&b.friction)).map(|largest| {
        let (friction, place) = (rounded(largest.friction, 4), &largest.place);
        let why = why(scene);
        format!("friction is {friction} {place}{}, more than that of any rubber: {why}", more(rubbing.len()))
    });
    // One key is missing for both.
    let is_said = largest.is_some() && scene.fine.is_none();
    let touching = whole.first().filter(|_| !is_said).map(|first| {
        let place = format!("{}{}", first.place, more(whole.len()));
        match scene.fine {
            None => format!("the whole nominal area touches {place}: {NO_FINE}"),
            Some(_) => format!(
                "the roughness of surface.fine is pressed flat {place}, so that the whole nominal area touches: are its shortest \
                 waves (surface.fine.shortest) those of the surface, and the pressure right?"
            ),
        }
    });
    let is_hot = |one: &&FoundFriction| one.rise.is_some_and(|rise| rise > LARGEST_RISE);
    let hot: Vec<&FoundFriction> = found.iter().filter(is_hot).collect();
    let hottest = hot.iter().max_by(|a, b| a.rise.partial_cmp(&b.rise).unwrap_or(Ordering::Equal)).map(|hottest| {
        format!(
            "contacts are {} K above the temperature of the scene {}{}, more than {LARGEST_RISE} K, which rubber does not stand",
            rounded(hottest.rise.unwrap_or_default(), 3),
            hottest.place,
            more(hot.len())
        )
    });
    largest.into_iter().chain(touching).chain(hottest).collect()
}

/// Where friction draws the surface of a layer along the slopes of its profile by more than can be passed over: links that are
/// linear in material coordinates have that strain, and not what elasticity adds at the same order (docs/foundation.md, section 8).
pub fn strained(scene: &Scene, found: impl IntoIterator<Item = FoundFriction>) -> Option<String> {
    scene.foundation.as_ref().filter(|_| scene.layer.kinematics() == Kinematics::Material)?;
    let slope = scene.surface.rms_slope();
    let excess = |one: &FoundFriction| one.friction * slope * slope;
    let found: Vec<FoundFriction> = found.into_iter().filter(|one| excess(one) > STRAINED).collect();
    let most = found.iter().max_by(|a, b| a.friction.total_cmp(&b.friction))?;
    Some(format!(
        "friction of {} on slopes of {} in the root mean square strains the layer along them, {}{}: it comes out {} to {} % too \
         large, which finite strain, layer.kinematics = \"spatial\" and `sweep --method steady` have not",
        rounded(most.friction, 3),
        rounded(slope, 3),
        most.place,
        more(found.len()),
        rounded(50.0 * excess(most), 2),
        rounded(100.0 * excess(most), 2)
    ))
}

/// Where the links of a layer make contacts too wide or too narrow, of what was found to touch: the place, and the share of
/// the masses there.
pub fn misfitted(scene: &Scene, found: impl IntoIterator<Item = (String, f64)>) -> Option<String> {
    let off = |fit: &ContactFit| fit.widening.ln().abs();
    let fits = found.into_iter().filter_map(|(place, share)| Some((place, scene.contact_fit(share)?)));
    let found: Vec<_> = fits.filter(|(_, fit)| off(fit) > MISFIT.ln()).collect();
    let (place, fit) = found.iter().max_by(|a, b| off(&a.1).total_cmp(&off(&b.1)))?;
    let (percent, way) = match fit.widening {
        wide if wide > 1.0 => (wide - 1.0, "wide"),
        narrow => (1.0 - narrow, "narrow"),
    };
    Some(format!(
        "contacts of some {} come out {:.0} % too {way} {place}{}: the links are fitted to all waves of the profile, and against \
         one of twice that length have {} times the stiffness of the surface; `sweep --method steady` has no links",
        with_prefix(rounded(fit.length, 2), fit.length, "m"),
        100.0 * percent,
        more(found.len()),
        rounded(fit.stiffness, 2)
    ))
}

const NO_FINE: &str = "without surface.fine the profile counts as smooth between its points, and the shear strength acts on all \
                       of it; a real surface touches on a part alone: give surface.fine the waves that the profile lacks";

fn more(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        2 => " and at one more point".to_owned(),
        count => format!(" and at {} more points", count - 1),
    }
}

/// Whether shear acts on a surface that is rough, by what is not its own shape.
fn is_unresolved(scene: &Scene) -> bool {
    scene.friction.as_ref().is_some_and(has_shear) && (scene.fine.is_some() || !scene.surface.is_level())
}

fn has_shear(friction: &Friction) -> bool {
    let of_rate = friction.rate_shear.as_ref().map(|rate| [rate.force, rate.strength]).unwrap_or_default();
    let all = [friction.shear_force, friction.shear_strength].into_iter().chain(of_rate);
    all.flatten().any(|shear| shear > 0.0)
}

fn why(scene: &Scene) -> String {
    let friction = scene.friction.as_ref();
    match (friction.is_some_and(has_shear), scene.material.is_some(), scene.fine.is_some()) {
        (true, false, _) => "is the shear force right, in N a mass in contact?".to_owned(),
        (true, true, false) => NO_FINE.to_owned(),
        (true, true, true) => {
            "is the shear strength right, in Pa, and are the shortest waves of surface.fine (surface.fine.shortest) those of the \
             surface?"
                .to_owned()
        }
        (false, ..) => match friction.and_then(|friction| friction.coulomb).filter(|mu| *mu > LARGEST_FRICTION) {
            Some(coulomb) => format!("friction.coulomb = {coulomb}"),
            None => format!(
                "the slopes of the profile, {} in the root mean square, lose too much: are its units right, and is it the \
                 surface's?",
                rounded(scene.surface.rms_slope(), 3)
            ),
        },
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn scene(surface: &str, friction: &str) -> Scene {
        let text = format!(
            "name = 's'\nlayer = {{ foundation = 'half_space', masses = 16, spacing = 6.25e-5, width = 1e-2 }}\n\
             material = {{ density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 1e6, prony = [] }}\n\
             surface = {{ {surface} }}\nfriction = {{ {friction} }}"
        );
        Scene::parse(&text, "s.toml".as_ref()).unwrap()
    }

    const SINE: &str = "kind = 'sinusoid', amplitude = 1e-6, wavelength = 1e-3";

    fn said(surface: &str, friction: &str, found: &[(f64, f64)]) -> Vec<String> {
        let found = found.iter().map(|&(friction, area)| FoundFriction {
            place: "at 1 m/s".into(),
            friction,
            area: Some(area),
            rise: None,
        });
        implausible(&scene(surface, friction), found)
    }

    #[test]
    fn the_missing_key_is_named() {
        let shear = "shear_strength = 5e6";
        let rough = said(SINE, shear, &[(8.0, 0.3), (9.0, 0.2), (1.0, 0.5)]);
        assert!(
            rough.len() == 1 && rough[0].starts_with("friction is 9 at 1 m/s and at one more point, more"),
            "{rough:?}"
        );
        assert!(rough[0].contains("give surface.fine the waves"), "{rough:?}");
        let pressed = said(SINE, shear, &[(1.0, 1.0)]);
        assert!(pressed.len() == 1 && pressed[0].contains("without surface.fine"), "{pressed:?}");
        let fine = format!("{SINE}, fine = {{ hurst = 0.8, rms_slope = 0.3, longest = 1e-4, shortest = 1e-6 }}");
        assert!(said(&fine, shear, &[(1.0, 0.999)])[0].contains("surface.fine.shortest"));
        assert!(said(SINE, "coulomb = 5", &[(5.0, 1.0)])[0].ends_with("friction.coulomb = 5"));
    }

    #[test]
    fn contacts_that_rubber_does_not_stand_are_said() {
        let found = |rise| FoundFriction { place: "at 3 m/s".into(), friction: 1.0, area: Some(0.1), rise: Some(rise) };
        let scene = scene(SINE, "coulomb = 0.5");
        assert_eq!(implausible(&scene, [found(149.0)]), [""; 0]);
        let said = implausible(&scene, [found(160.0), found(199.2), found(20.0)]);
        assert_eq!(said.len(), 1);
        assert!(
            said[0].starts_with("contacts are 199 K above the temperature of the scene at 3 m/s and at one more"),
            "{said:?}"
        );
    }

    #[test]
    fn friction_that_strains_a_layer_is_said_with_what_it_adds() {
        let found = |friction| FoundFriction { place: "at 1 m/s".into(), friction, area: None, rise: None };
        // The slope of 2π 5e-5/1e-3 has a mean square of 0.0493.
        let mut steep = scene("kind = 'sinusoid', amplitude = 5e-5, wavelength = 1e-3", "coulomb = 0.9");
        assert_eq!(strained(&steep, [found(0.9)]), None);
        steep.layer.kinematics = Some(Kinematics::Material);
        assert_eq!(strained(&steep, [found(0.6)]), None);
        let said = strained(&steep, [found(0.7), found(0.9), found(0.5)]).unwrap();
        let beginning = "friction of 0.9 on slopes of 0.222 in the root mean square strains the layer along them, at 1 m/s and at \
                         one more point: it comes out 2.2 to 4.4 % too large";
        assert!(said.starts_with(beginning), "{said}");
        assert_eq!(strained(&scene("kind = 'flat'", "coulomb = 5"), [found(5.0)]), None);
    }

    /// The links of a sine are stiffer than the surface against waves of an eighth of its length.
    #[test]
    fn contacts_that_the_links_do_not_fit_are_said_with_their_length() {
        let mut fine = scene(SINE, "coulomb = 0.5");
        (fine.layer.masses, fine.layer.spacing) = (256, 1e-3 / 256.0);
        assert_eq!(misfitted(&fine, [("at the end".into(), 0.3)]), None);
        let said = misfitted(&fine, [("at 1 m/s".into(), 0.0625), ("at 2 m/s".into(), 0.3)]).unwrap();
        assert!(said.starts_with("contacts of some 66 µm come out"), "{said}");
        assert!(said.contains("% too narrow at 1 m/s: the links"), "{said}");
    }

    /// Glass is smooth, and Coulomb's friction has no area.
    #[test]
    fn what_is_plausible_is_passed_over() {
        assert_eq!(said("kind = 'flat'", "shear_strength = 5e6", &[(1.0, 1.0)]), [""; 0]);
        assert_eq!(said(SINE, "coulomb = 0.5", &[(0.5, 1.0)]), [""; 0]);
        assert_eq!(said(SINE, "shear_strength = 5e6", &[(2.9, 0.9)]), [""; 0]);
    }
}
