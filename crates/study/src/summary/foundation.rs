//! How well the links of a scene stand for the surface of its material: rows of the summary.

use asperity::scene::{Foundation, FoundationKind, LinkKind, Material, PronyTerm, Quality, Scene};

use crate::decimals::{decimal, rounded};

/// What the links stand for, in a line each; nothing in the direct form.
pub(super) fn rows(scene: &Scene) -> Vec<String> {
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
pub(super) fn short_rows(scene: &Scene) -> Vec<String> {
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

fn number(value: f64) -> String {
    decimal(rounded(value, 6), 1e-3..1e6)
}

fn constants(scene: &Scene, foundation: &Foundation) -> Vec<String> {
    let Foundation { normal, tangential, depth, .. } = foundation;
    let mut rows = vec![format!(
        "α = {} 1/m, β = {} m, ℓ = {} m, the depth whose mass the masses have",
        number(normal.alpha),
        number(normal.beta),
        number(*depth)
    )];
    if scene.layer.foundation == Some(FoundationKind::Layer) {
        rows.push(format!("α_t = {} 1/m, β_t = {} m, along x", number(tangential.alpha), number(tangential.beta)));
    }
    rows
}

/// The stiffness against a displacement of the whole carrier.
fn mean_stiffness(material: &Material, foundation: &Foundation) -> String {
    let prony: f64 = material.prony.iter().map(|term: &PronyTerm| term.modulus).sum();
    let stiffness = |modulus: f64| number(material.plane_modulus(modulus) * foundation.normal.alpha);
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
