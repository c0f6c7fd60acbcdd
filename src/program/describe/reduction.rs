//! The Maxwell elements that `solver.reduce` leaves out, in a description.

use asperity::model::{LinkKind, Reduction, Replaced, Replacement};
use asperity::scene::{Initial, Scene};

use super::{LEFT_OUT, Row, number, under};

/// What is replaced by what, why, and with which bound.
pub(super) fn rows(scene: &Scene) -> Vec<Row> {
    let Some(reduction) = Reduction::new(scene) else { return vec![("Reduce", LEFT_OUT.into())] };
    let meaning = format!(
        "{}: the most that the elements left out change their link's force, as a share of it",
        number(scene.solver.reduce)
    );
    let links = LinkKind::ALL.into_iter().flat_map(|kind| link(scene, &reduction, kind));
    under("Reduce", [meaning, run(&reduction), frequency(scene, &reduction)].into_iter().chain(links))
}

fn run(reduction: &Reduction) -> String {
    if reduction.run.is_finite() {
        format!("long against the run of {:.4e} s becomes a spring; beyond it the bound grows with time", reduction.run)
    } else {
        "no [[excitation]], so the length of the run is not known: nothing is long, no element becomes a spring".into()
    }
}

fn frequency(scene: &Scene, reduction: &Reduction) -> String {
    if scene.layer.initial == Initial::Undeformed {
        return "undeformed at the start, where no damper is like an element: none becomes one".into();
    }
    let of = if reduction.run.is_finite() {
        "the shortest period of carrier, profile and layer"
    } else {
        "the layer's own shortest period, the carrier's motion not being known,"
    };
    format!(
        "short against {of} 2π/ω, ω = {:.4e} rad/s, becomes a damper; a jump of ė adds d |Δė| for about τ",
        reduction.frequency
    )
}

fn link(scene: &Scene, reduction: &Reduction, kind: LinkKind) -> Vec<String> {
    let Some(link) = scene.link(kind).filter(|link| !link.maxwell.is_empty()) else { return Vec::new() };
    let stiffness = reduction.stiffness[kind as usize];
    let replaced: Vec<_> = reduction.replaced.iter().filter(|one| one.kind == kind).collect();
    let left = link.maxwell.len() - replaced.len();
    let head = format!("{:<12}{left} of {} elements stay, K' = {stiffness:.4e} N/m", kind.name(), link.maxwell.len());
    [head].into_iter().chain(replaced.iter().map(|one| element(one, stiffness))).collect()
}

fn element(one: &Replaced, stiffness: f64) -> String {
    let (place, why) = match one.by {
        Replacement::Spring => ("spring", "long"),
        Replacement::Damper => ("damper", "short"),
    };
    let share = if one.bound > 0.0 { one.bound / stiffness } else { 0.0 };
    format!(
        "{:<12}[{}] {} N/m at {} s is {why}: a {place}, bound {share:.2e}",
        "",
        one.index + 1,
        number(one.element.stiffness),
        number(one.element.relaxation_time)
    )
}
