//! The laws of contact, mass by mass.

use asperity::outputs::Output;
use asperity::scene::Method;
use proptest::prelude::*;

use crate::physics::invariants::case::{Case, Record};
use crate::physics::invariants::check::check;
use crate::physics::invariants::random::cases;
use crate::physics::invariants::trust::Units;

/// One row of a run, and the scene's numbers.
struct Row<'a> {
    case: &'a Case,
    record: &'a Record,
    row: usize,
}

impl Row<'_> {
    fn get(&self, output: Output) -> f64 {
        let index = self.record.variables.iter().position(|variable| variable.output == output).unwrap();
        self.record.rows[self.row][index]
    }

    /// T(0) = μ F_N + A τ_0 + A τ_f(v_c) of a mass that sticks; the largest T(v) of another, or of one that remembers a
    /// speed, N.
    fn limit(&self, normal: f64, mode: f64) -> f64 {
        let friction = self.case.scene.friction.clone().unwrap_or_default();
        let at_rest = mode == 2.0 && friction.memory.is_none_or(|way| way == 0.0);
        let rate_shear = self.case.scene.rate_shear().map_or(0.0, |law| {
            let decades = (law.creep_speed() / law.reference_speed).log10();
            law.force.unwrap_or(0.0) * if at_rest { (-law.sharpness * decades * decades).exp() } else { 1.0 }
        });
        friction.coulomb.unwrap_or(0.0) * normal + friction.shear_force.unwrap_or(0.0) + rate_shear
    }
}

/// F_N ≥ 0, |F_T| ≤ T, no mass under the profile, contacts on it; and the masses' forces add up to the layer's.
#[test]
fn every_mass_obeys_the_laws_of_contact() {
    check("the laws of contact", 150, cases(), |case| {
        // Within a time step modes are held, whatever comes; its end is in order.
        let rows = if case.scene.solver.method == Method::Event { 5 } else { 1 };
        let record = case.run(rows).map_err(|error| TestCaseError::fail(format!("{error}")))?;
        for row in 0..record.rows.len() {
            obeys(&Row { case: &case, record: &record, row })?;
        }
        Ok(())
    });
}

fn obeys(row: &Row<'_>) -> Result<(), TestCaseError> {
    let (case, units) = (row.case, Units::of(row.case));
    let spline = case.scene.surface.spline();
    // An event is located where its limit is passed by a tenth of the tolerance at most; the dense output within a step
    // is as good as the tolerance.
    let (gap_allowed, force_allowed) = (units.length(0.0), units.force(row.record.largest(Output::ForceZ)));
    let (mut sum_x, mut sum_z, mut allowed) = (0.0, 0.0, 0.0);
    // A mass that was located where it came to stick stays where its elongation has it, off the profile that it is held
    // to by less than the absolute tolerance. So its slope is known no better.
    for i in 0..case.scene.layer.masses {
        let [x, z, normal, friction] =
            [Output::ElementX(i), Output::ElementZ(i), Output::ElementNormalForce(i), Output::ElementFrictionForce(i)]
                .map(|output| row.get(output));
        let (height, slope, curvature, _) = spline.evaluate(x);
        let rounding = 4.0 * f64::EPSILON * (x.abs() + z.abs()) * (1.0 + slope.abs());
        let gap = z - height;
        let mode = row.get(Output::ElementMode(i));
        let state = format!("row {}, mass {i}, mode {mode}: g {gap:e}, F_N {normal:e}, F_T {friction:e}", row.row);
        prop_assert!(gap >= -gap_allowed - rounding, "under the profile: {}", state);
        let limit = row.limit(normal, mode);
        prop_assert!(mode == 0.0 || gap <= gap_allowed + rounding, "above the profile: {}", state);
        prop_assert!(mode != 0.0 || (normal == 0.0 && friction == 0.0), "{}", state);
        prop_assert!(normal >= -force_allowed, "pulled: {}", state);
        prop_assert!(friction.abs() <= limit.abs() + force_allowed, "T {limit:e}: {}", state);
        let q = slope.hypot(1.0);
        sum_x += (-normal * slope - friction) / q;
        sum_z += (normal - friction * slope) / q;
        allowed += (1e-6 + curvature.abs() * gap_allowed) * (normal.abs() + friction.abs());
    }
    let (found_x, found_z) = (row.get(Output::ContactForceX), row.get(Output::ContactForceZ));
    prop_assert!((sum_x - found_x).abs() <= allowed, "row {}: contact.F_x {found_x:e}, not {sum_x:e}", row.row);
    prop_assert!((sum_z - found_z).abs() <= allowed, "row {}: contact.F_z {found_z:e}, not {sum_z:e}", row.row);
    Ok(())
}
