//! What a master does that the scene does not foresee: nothing in the forces shows it, so it is told, once.

use super::plant::Plant;
use super::subject::Subject;
use crate::model::{Reduction, Replacement};
use crate::scene::Scene;

/// What has been told of an instance.
#[derive(Clone, Debug, Default)]
pub(super) struct Beyond {
    /// The time at which the run began, s; `None` where that is not known.
    pub(super) start: Option<f64>,
    left_profile: bool,
    outlasted_reduction: bool,
}

impl Beyond {
    /// What is worth telling of a run of `subject` that has come to `time` (s).
    pub(super) fn news(&mut self, subject: &Subject, plant: &Plant, time: f64) -> Vec<String> {
        let Subject::Layer(scene) = subject else { return Vec::new() };
        let news = [self.profile(scene, plant.carrier().0), self.reduction(scene, time)];
        news.into_iter().flatten().map(|text| format!("t = {time} s: {text}")).collect()
    }

    fn profile(&mut self, scene: &Scene, u: f64) -> Option<String> {
        let text = if self.left_profile { None } else { scene.off_profile(u) };
        self.left_profile |= text.is_some();
        text
    }

    /// `solver.reduce` takes elements to be springs by how long the excitation is.
    fn reduction(&mut self, scene: &Scene, time: f64) -> Option<String> {
        /// Times differ by so much of themselves by rounding.
        const ROUNDING: f64 = 1e-9;
        if self.outlasted_reduction || scene.solver.reduce == 0.0 {
            return None;
        }
        let foreseen = scene.duration();
        if time - self.start? <= foreseen * (1.0 + ROUNDING) {
            return None;
        }
        self.outlasted_reduction = true;
        let springs = Reduction::new(scene)?.replaced.into_iter().any(|one| one.by == Replacement::Spring);
        springs.then(|| {
            let bound = scene.solver.reduce;
            format!(
                "longer than the scene's excitation of {foreseen} s: solver.reduce = {bound} takes elements for springs that \
                 relax in longer runs, and its bound grows with time"
            )
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::fmi::instance::Instance;
    use crate::fmi::instance::tests::instance_of;

    /// One mass, moved at 1 m/s in steps of 0.25 s: what is told.
    fn told(surface: &str, rest: &str) -> Vec<String> {
        let text = format!(
            "name = 'a'\nlayer = {{ masses = 1, spacing = 1.0, mass = 1.0, clearance = 9.0, vertical = {{ stiffness = 1.0, \
             maxwell = [{{ stiffness = 1.0, relaxation_time = 1e6 }}] }} }}\nsurface = {{ {surface} }}\n{rest}"
        );
        let mut instance = instance_of(&text);
        instance.take_messages();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        (0..8).for_each(|i| step(&mut instance, 0.25 * f64::from(i)));
        instance.take_messages().into_iter().map(|message| message.text).collect()
    }

    fn step(instance: &mut Instance, time: f64) {
        instance.run.carrier.set_input(crate::fmi::Input::U, time);
        instance.do_step(time, 0.25).unwrap();
    }

    #[test]
    fn a_layer_that_leaves_its_profile_is_told_once() {
        // Values without rates run on as they came, from the second step on: at 1.25 s the carrier has come beyond 1 m.
        let text = "t = 1.25 s: the profile reaches from -1.0 m to 1.0 m, but the layer has come to 1.25 m: \
                    beyond its ends the profile goes on straight, along its end tangents";
        assert_eq!(told("kind = 'points', x = [-1, 1], z = [0, 1]", ""), [text]);
        assert!(told("kind = 'flat'", "").is_empty());
    }

    #[test]
    fn a_run_that_outlasts_its_reduction_is_told_once() {
        let solver = |reduce: f64, duration: f64| {
            format!("solver = {{ reduce = {reduce} }}\nexcitation = [{{ duration = {duration} }}]")
        };
        let told = |reduce, duration| told("kind = 'flat'", &solver(reduce, duration));
        let text = told(1e-3, 1.0);
        assert!(
            text.len() == 1 && text[0].starts_with("t = 1.25 s: longer than the scene's excitation of 1 s"),
            "{text:?}"
        );
        assert!(told(1e-3, 2.0).is_empty());
        assert!(told(0.0, 1.0).is_empty());
        // Nothing is replaced: the bound is too tight.
        assert!(told(1e-9, 1.0).is_empty());
    }
}
