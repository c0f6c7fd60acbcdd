//! Small patches to fuzz, and the rules of every run of a patch.

use std::path::{Path, PathBuf};
use std::{env, fs, process};

use asperity::patch::{MotionError, Patch, PatchMotion, PatchOutput, PatchRun, PatchVariable};

use super::fmu::table;

/// Parts of a step that there is time for; with more than [`DISCARDED`] a step is refused at once.
const MAX_PARTS: f64 = 40.0;
const DISCARDED: f64 = 1e5;

const ALL: &str =
    "fmu = { outputs = ['forces', 'dissipation', 'contact', 'friction', 'energy', 'tangent', 'elements'] }\n";

/// Points of uneven heights and areas; treads of a flat and a cylinder, one beyond whose table no step goes, at poses
/// around 0 and in tens of micrometres.
pub const PATCHES: [&str; 4] = [
    "name = 'points'\ntable = { path = 'table.csv' }\npatch = { shape = 'points', path = 'points.csv' }\n",
    "name = 'wheel'\ntable = { path = 'table.csv', temperature = 295.0 }\ninput = { extrapolation = 'hold' }\n\
     patch = { shape = 'cylinder', radius = 0.01, length = 4e-4, width = 1e-3, nx = 4, ny = 2, transport = true, \
     offset = [0.0, 0.0, 0.01] }\nsolver = { refine = 2 }\n",
    "name = 'belt'\ntable = { path = 'table.csv', extrapolation = 'refuse' }\n\
     patch = { shape = 'flat', length = 3e-4, width = 1e-3, nx = 3, ny = 1, transport = true }\n",
    "name = 'narrow'\ntable = { path = 'narrow.csv', nominal_area = 4e-5 }\n\
     patch = { shape = 'flat', length = 1e-3, width = 1e-3, nx = 1, ny = 1, transport = true }\n",
];

/// Elements beside, above and below each other, of areas from tiny to large.
pub const POINTS: &str = "x,y,z,area\n0,0,0,1e-6\n1e-3,0,1e-6,1e-12\n-1e-3,1e-3,-2e-6,1e-6\n0,-2e-3,5e-6,1e-3\n";

/// A table of forces at one speed and one load.
const NARROW: &str = "# asperity sweep = 1\n# scene = narrow\n# rest_separation = 2e-6 m\n\
    speed [m/s],force [N],temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]\n1e-3,4,,steady,0.8,1e-6,2e4\n\
    1e-3,8,,steady,0.8,-1e-6,3e4\n";

/// The text of a patch with all outputs.
pub fn text(number: usize) -> String {
    format!("{}{ALL}", PATCHES[number])
}

/// Writes what a patch file may name into its folder.
pub fn write_files(folder: &Path, points: &str) {
    let files = [("table.csv", table()), ("narrow.csv", NARROW.to_owned()), ("points.csv", points.to_owned())];
    files.into_iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
}

/// A folder of this process with those files.
pub fn folder(name: &str) -> PathBuf {
    let folder = env::temp_dir().join(format!("asperity-{name}-{}", process::id()));
    fs::create_dir_all(&folder).unwrap();
    write_files(&folder, POINTS);
    folder
}

/// A run with all that its rules need.
pub struct Judged {
    pub patch: Patch,
    pub run: PatchRun,
    variables: Vec<PatchVariable>,
    values: Vec<f64>,
}

impl Judged {
    pub fn new(patch: &Patch, run: PatchRun) -> Self {
        let variables = patch.variables();
        let values = vec![0.0; variables.len()];
        let mut judged = Self { patch: patch.clone(), run, variables, values };
        judged.check();
        judged
    }

    /// Whether there is time for a motion.
    pub fn has_time_for(&self, motion: &PatchMotion, cell: f64, refine: f64) -> bool {
        let turned: f64 = motion.rates[3..].iter().map(|rate| (rate * motion.duration).abs()).sum();
        let speed = self.run.transport_speed().abs().max(motion.transport_speed.abs());
        let parts = refine * (turned / 0.1 + speed * motion.duration.abs() / cell);
        parts.is_nan() || !(MAX_PARTS..8.0 * DISCARDED).contains(&parts)
    }

    /// Follows a motion: what was done has numbers and only loses energy, what was refused changed nothing, and a restored
    /// run does the same.
    pub fn advance(&mut self, motion: &PatchMotion) -> Result<(), MotionError> {
        let (saved, before) = (self.run.save(), self.values.clone());
        let lost = self.lost();
        let result = self.run.advance(motion);
        self.run.evaluate(&self.variables, &mut self.values);
        let mut again = PatchRun::restore(&self.patch, &saved).unwrap_or_else(|error| panic!("{error}: {saved:?}"));
        // As text, since a number refused may be none.
        assert_eq!(format!("{:?}", again.advance(motion)), format!("{result:?}"));
        assert_eq!(again.save(), self.run.save(), "a restored run differs");
        match &result {
            Ok(()) => {
                self.check();
                let after = self.lost();
                assert!(after[0] >= lost[0] && after[1] >= lost[1], "energy is won: {lost:?} {after:?}");
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert_eq!(self.run.save(), saved, "changed though refused: {error}");
                assert_eq!(bits(&self.values), bits(&before), "{error}");
            }
        }
        result
    }

    fn value(&self, output: PatchOutput) -> Option<f64> {
        let place = self.variables.iter().position(|variable| variable.output == output);
        place.map(|place| self.values[place])
    }

    fn lost(&self) -> [f64; 2] {
        [PatchOutput::SlipEnergy, PatchOutput::ReleaseEnergy].map(|output| self.value(output).unwrap_or_default())
    }

    fn check(&mut self) {
        self.run.evaluate(&self.variables, &mut self.values);
        for (variable, value) in self.variables.iter().zip(&self.values) {
            assert!(value.is_finite(), "{} = {value}", variable.name);
            let has_sign = matches!(
                variable.output,
                PatchOutput::ElementTraction(..)
                    | PatchOutput::Moment(_)
                    | PatchOutput::Tangent(..)
                    | PatchOutput::Force(0 | 1)
                    | PatchOutput::TransportForce
            );
            assert!(has_sign || *value >= 0.0, "{} = {value}", variable.name);
        }
        if let (Some(count), Some(sticking)) = (self.value(PatchOutput::Count), self.value(PatchOutput::Sticking)) {
            assert!(sticking <= count, "{sticking} of {count} stick");
        }
        self.check_derivatives();
        // Among other things that no spring is beyond its limit.
        let saved = self.run.save();
        let restored = PatchRun::restore(&self.patch, &saved).unwrap_or_else(|error| panic!("{error}: {saved:?}"));
        assert_eq!(restored.save(), saved);
    }

    fn check_derivatives(&mut self) {
        let mut slopes = vec![0.0; self.variables.len()];
        for direction in [[1.0, 1.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.1, -0.1, 0.0]] {
            self.run.directional_derivative(&self.variables, direction, &mut slopes);
            let found = slopes.iter().position(|slope| !slope.is_finite());
            assert!(found.is_none(), "slope of {}: {slopes:?}", self.variables[found.unwrap_or_default()].name);
        }
        for output in (0..3).flat_map(|axis| [PatchOutput::Force(axis), PatchOutput::Moment(axis)]) {
            let rate = self.run.rate(output);
            assert!(rate.is_some_and(f64::is_finite), "rate of {output:?}: {rate:?}");
        }
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
