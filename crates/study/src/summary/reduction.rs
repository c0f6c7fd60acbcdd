//! The Maxwell elements that `solver.reduce` replaces, in the summary of a scene.

use asperity::model::{Reduction, Replaced, Replacement};
use asperity::scene::{Initial, LinkKind, Scene};

use super::words::{LEFT_OUT, each_once, number};
use crate::labelled::{LabelledLine, labelled};

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
