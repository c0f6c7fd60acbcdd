//! How well the links of a scene stand for the surface of its material, and which of their elements `solver.reduce`
//! replaces: rows of the summary.

use asperity::model::{Reduction, Replaced, Replacement};
use asperity::scene::{Foundation, FoundationKind, Initial, LinkKind, Material, PronyTerm, Quality, Scene};

use super::words::{LEFT_OUT, LabelledLine, each_once, labelled, number, six_digits};

/// What the links stand for, in a line each; nothing in the direct form.
pub(super) fn foundation(scene: &Scene) -> Vec<String> {
    let (Some(material), Some(quality)) = (&scene.material, scene.quality(LinkKind::Vertical)) else {
        return Vec::new();
    };
    let mut rows = vec![title(scene)];
    if let Some(foundation) = &scene.foundation {
        rows.extend(constants(scene, foundation));
        rows.push(mean_stiffness(material, foundation));
    }
    rows.extend(quality_rows("vertical", &quality));
    if scene.layer.foundation != Some(FoundationKind::HalfSpace) {
        rows.extend(scene.quality(LinkKind::Horizontal).iter().flat_map(|quality| quality_rows("horizontal", quality)));
    }
    rows
}

/// What the links stand for, and how far their stiffness is from that.
pub(super) fn foundation_in_brief(scene: &Scene) -> Vec<String> {
    if scene.material.is_none() {
        return Vec::new();
    }
    let of = |kind: LinkKind| {
        let Quality { least, largest, rms, .. } = scene.quality(kind)?;
        Some(format!(
            "r {:<11} {least:.3} to {largest:.3} over the waves of the slopes; rms of r - 1 is {rms:.3}",
            kind.name()
        ))
    };
    let kinds: &[LinkKind] = match scene.layer.foundation {
        Some(FoundationKind::HalfSpace) => &[LinkKind::Vertical],
        _ => &[LinkKind::Vertical, LinkKind::Horizontal],
    };
    std::iter::once(title(scene)).chain(kinds.iter().filter_map(|kind| of(*kind))).collect()
}

fn title(scene: &Scene) -> String {
    match scene.layer.foundation.unwrap_or_default() {
        FoundationKind::Springs => {
            "springs: links by thickness and spacing; r, their stiffness against a wave over that \
                                    of a bonded layer of this thickness:"
                .into()
        }
        FoundationKind::HalfSpace => "half_space: links fitted to a half-space".into(),
        FoundationKind::Layer => "layer: links fitted to a layer of this thickness, bonded to a rigid base".into(),
    }
}

fn constants(scene: &Scene, foundation: &Foundation) -> Vec<String> {
    let Foundation { normal, tangential, depth, .. } = foundation;
    let mut rows = vec![format!(
        "α = {} 1/m, β = {} m, ℓ = {} m, the depth whose mass the masses have",
        six_digits(normal.alpha),
        six_digits(normal.beta),
        six_digits(*depth)
    )];
    if scene.layer.foundation == Some(FoundationKind::Layer) {
        rows.push(format!(
            "α_t = {} 1/m, β_t = {} m, along x",
            six_digits(tangential.alpha),
            six_digits(tangential.beta)
        ));
    }
    rows
}

/// The stiffness against a displacement of the whole carrier.
fn mean_stiffness(material: &Material, foundation: &Foundation) -> String {
    let prony: f64 = material.prony.iter().map(|term: &PronyTerm| term.modulus).sum();
    let stiffness = |modulus: f64| six_digits(material.plane_modulus(modulus) * foundation.normal.alpha);
    let rest = material.equilibrium_modulus;
    format!("Mα = {} Pa/m at rest, {} Pa/m glassy, against w", stiffness(rest), stiffness(rest + prony))
}

fn quality_rows(direction: &str, quality: &Quality) -> [String; 2] {
    let ratios = quality.ratios.map(|(wavelength, ratio)| format!("{ratio:.3} at {wavelength:.3e} m"));
    [
        format!("r {direction:<10}  {}", ratios.join(", ")),
        format!(
            "{:<12}  {:.3} to {:.3} over the waves with 5 to 95 % of the slopes' power; rms of r - 1 is {:.3}",
            "", quality.least, quality.largest, quality.rms
        ),
    ]
}

/// The Maxwell elements that `solver.reduce` replaces, why, and the bounds on the error.
pub(super) fn reduction(scene: &Scene) -> Vec<LabelledLine> {
    let Some(reduction) = Reduction::new(scene) else { return vec![("Reduce", LEFT_OUT.into())] };
    let meaning = format!(
        "{}: the largest relative change of a link's force by the elements left out",
        number(scene.solver.reduce)
    );
    let links = each_once(LinkKind::ALL.map(|kind| (kind.name(), reduced_link(scene, &reduction, kind))));
    labelled("Reduce", [meaning, long_times(&reduction), short_times(scene, &reduction)].into_iter().chain(links))
}

fn long_times(reduction: &Reduction) -> String {
    if reduction.run.is_finite() {
        format!(
            "elements with relaxation times much longer than the run of {:.4e} s become springs; for a longer run the bound grows in proportion",
            reduction.run
        )
    } else {
        "no [[excitation]], so the duration of the run is not known: no element becomes a spring".into()
    }
}

fn short_times(scene: &Scene, reduction: &Reduction) -> String {
    if scene.layer.initial == Initial::Undeformed {
        return "undeformed at the start, where no damper is equivalent to an element: no element becomes a damper"
            .into();
    }
    let period = if reduction.run.is_finite() {
        "the shortest period of carrier, profile and layer"
    } else {
        "the layer's own shortest period (the carrier's motion is not known),"
    };
    format!(
        "elements with relaxation times much shorter than {period} 2π/ω, ω = {:.4e} rad/s, become dampers; a jump of the elongation rate ė adds an error of d |Δė| for about τ",
        reduction.frequency
    )
}

fn reduced_link(scene: &Scene, reduction: &Reduction, kind: LinkKind) -> Vec<String> {
    let Some(link) = scene.link(kind).filter(|link| !link.maxwell.is_empty()) else { return Vec::new() };
    let stiffness = reduction.stiffness[kind];
    let replaced: Vec<_> = reduction.replaced.iter().filter(|one| one.kind == kind).collect();
    let left = link.maxwell.len() - replaced.len();
    let head = format!("{left} of {} elements stay, K' = {stiffness:.4e} N/m", link.maxwell.len());
    [head].into_iter().chain(replaced.iter().map(|one| replaced_element(one, stiffness))).collect()
}

fn replaced_element(one: &Replaced, stiffness: f64) -> String {
    let (replacement, why) = match one.by {
        Replacement::Spring => ("spring", "long"),
        Replacement::Damper => ("damper", "short"),
    };
    let share = if one.bound > 0.0 { one.bound / stiffness } else { 0.0 };
    format!(
        "[{}] {} N/m at {} s is {why}: a {replacement}, bound {share:.2e}",
        one.index + 1,
        number(one.element.stiffness),
        number(one.element.relaxation_time)
    )
}
