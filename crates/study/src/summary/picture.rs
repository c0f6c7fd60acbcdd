//! The picture of a scene: the stiffness of its links, and the friction below its profile.

use asperity::scene::{FoundationKind, LinkKind, Scene};

use super::fine::{FineFrictionCurve, MIDDLE};
use crate::decimals::rounded;
use crate::picture::{Mark, Picture, Stroke};

/// The stiffness of the links over that of the body that they stand for, over wavelength, and μ_h of a mass over speed
/// where bands rub; `None` in the direct form.
pub fn picture(scene: &Scene) -> Option<Picture> {
    let curve = |(look, (name, kind)): (usize, (&str, LinkKind))| {
        let points = scene.quality(kind)?.curve.iter().map(|&(length, share)| [length, share]).collect();
        Some(Mark::line(name, look, points))
    };
    let kinds: &[(&str, LinkKind)] = match scene.layer.foundation {
        Some(FoundationKind::HalfSpace) => &[("along z and along x", LinkKind::Vertical)],
        _ => &[("along z", LinkKind::Vertical), ("along x", LinkKind::Horizontal)],
    };
    let mut curves: Vec<Mark> = kinds.iter().copied().enumerate().filter_map(curve).collect();
    let exact = curves.first()?.points().map(|[length, _]| [length, 1.0]).collect();
    curves.push(Mark::broken("the body", 6, exact, Stroke::Dashed));
    let panels = vec![(("stiffness of the links over the body's", ""), curves)];
    let mut picture = Picture::stacked(("wavelength", "m"), panels).titled(&scene.name);
    picture.rows.extend(friction(scene).into_iter().flat_map(|friction| friction.rows));
    Some(picture)
}

fn friction(scene: &Scene) -> Option<Picture> {
    let curve = |(look, FineFrictionCurve { temperature, points }): (usize, FineFrictionCurve)| {
        let name = temperature.map_or_else(|| "mu_h".into(), |kelvin| format!("{} K", rounded(kelvin, 6)));
        Mark::line(name, look, points.into_iter().map(|(speed, friction)| [speed, friction]).collect())
    };
    let curves: Vec<Mark> = FineFrictionCurve::around(scene).into_iter().enumerate().map(curve).collect();
    let title = format!("friction below the profile, mu_h, under {} MPa", MIDDLE / 1e6);
    let rows = vec![("friction coefficient", vec![(title, curves.clone())])];
    (!curves.is_empty()).then(|| Picture::side_by_side(("speed", "m/s"), rows))
}
