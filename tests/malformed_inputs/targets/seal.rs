//! A seal file, its pressures and a motion: an error with a position and a reason, or a film that is finite and keeps its fluid.

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

use asperity::scene::CanonicalFiles;
use asperity::seal::{FilmError, Seal, SealMotion, SealOutput, SealRun, SealStart, SealVariable};

/// Cells that there is time for.
const MAX_CELLS: usize = 24;
/// Steps that there is time for.
const MAX_STEPS: usize = 6;
/// Length of a text, bytes; longer ones test nothing new.
const MAX_BYTES: usize = 4096;
/// The line between the seal file, the pressures and the motion.
const BREAK: &str = "\n%\n";

/// Gaps and friction over a few speeds and pressures; above 4 MPa contacts close.
const TABLE: &str = "# asperity sweep = 1\n# scene = gaps\n# nominal_area = 1e-4 m2\n# rest_separation = 1e-6 m\n\
    speed [m/s],pressure [Pa],temperature [K],status,friction [1],contact_ratio [1],separation [m],leak_gap [m],\
    drag_gap [m],tangential_stiffness [N/m]\n\
    1e-3,1e3,,steady,0.3,0.001,1e-6,9e-7,9.5e-7,1e4\n1e-3,1e5,,steady,0.3,0.08,5e-7,3e-7,4e-7,1e4\n\
    1e-3,1e6,,steady,0.3,0.5,1e-7,0,0,1e4\n1e-3,4e6,,steady,0.3,0.97,1e-9,0,0,1e4\n\
    1,1e3,,steady,0.1,0.001,1e-6,9e-7,9.5e-7,1e4\n1,1e5,,steady,0.1,0.08,5e-7,3e-7,4e-7,1e4\n\
    1,1e6,,steady,0.1,0.5,1e-7,0,0,1e4\n1,4e6,,steady,0.1,0.97,1e-9,0,0,1e4\n";

/// Pressures over a width, and steps, where a text has none.
const PRESSURES: &str =
    "sealed_pressure,x,pressure\n0,0,1e5\n0,5e-4,2e6\n0,1e-3,0\n5e6,0,5.1e6\n5e6,5e-4,6e6\n5e6,1e-3,0\n";
const STEPS: &str = "1e-2,1e-2,0,1e6\n1e-3,0.1,0,0\n1e-2,-1e-2,0,0\n1,0,0,-1e4\n";

fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("asperity-seal-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("gaps.csv"), TABLE).unwrap();
        folder
    })
}

/// Reads a seal and, after lines with a percent sign, its pressures and steps of duration, speed, rate of w and of the sealed
/// pressure, and does these.
pub fn run(bytes: &[u8]) {
    let Some(text) = std::str::from_utf8(bytes).ok().filter(|text| text.len() <= MAX_BYTES) else { return };
    let mut parts = text.splitn(3, BREAK);
    let [text, pressures, steps] = ["", PRESSURES, STEPS].map(|default| parts.next().unwrap_or(default));
    let path = folder().join("seal.toml");
    fs::write(folder().join("lip.csv"), pressures).unwrap();
    let seal = match Seal::parse_with(text, &path, &CanonicalFiles, &[]) {
        Ok(seal) => seal,
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with(folder().to_str().unwrap()) && !message.contains('\n'), "{message}");
            return;
        }
    };
    if seal.cells() > MAX_CELLS {
        return;
    }
    let (sealed_pressure, temperature) = (seal.sealed_pressure(), seal.temperature());
    let start = SealStart { sealed_pressure, temperature, ..SealStart::default() };
    let Ok(mut run) = SealRun::new(&seal, &start) else { return };
    let variables = seal.variables();
    let mut judged = Judged { begun: volume(&seal, &run), variables, values: Vec::new() };
    judged.check(&seal, &run);
    for line in steps.lines().take(MAX_STEPS) {
        let numbers: Vec<f64> = line.split(',').map_while(|number| number.trim().parse().ok()).collect();
        let &[duration, u_rate, w_rate, pressure_rate] = numbers.as_slice() else { continue };
        let motion = SealMotion { duration, u_rate, w_rate, pressure_rate, temperature };
        run.limit_work();
        if !judged.advance(&seal, &mut run, &motion) {
            break;
        }
    }
}

/// What is under the lip, m³.
fn volume(seal: &Seal, run: &SealRun) -> f64 {
    seal.width() / seal.cells() as f64 * seal.file().length * run.contents().iter().sum::<f64>()
}

/// The rules of every run.
struct Judged {
    begun: f64,
    variables: Vec<SealVariable>,
    values: Vec<f64>,
}

impl Judged {
    /// Follows a motion: what was refused changed nothing, a restored run does the same; whether there may be time for more.
    fn advance(&mut self, seal: &Seal, run: &mut SealRun, motion: &SealMotion) -> bool {
        let (saved, lost) = (run.save(), run.value(SealOutput::Energy));
        let result = run.advance(motion);
        if matches!(result, Err(FilmError::TooMuchWork { .. })) {
            assert_eq!(run.save(), saved, "changed though given up");
            return false;
        }
        let mut again = SealRun::restore(seal, &saved).unwrap_or_else(|error| panic!("{error}: {saved:?}"));
        again.limit_work();
        // As text, since a number refused may be none.
        assert_eq!(format!("{:?}", again.advance(motion)), format!("{result:?}"));
        assert_eq!(again.save(), run.save(), "a restored run differs");
        match result {
            Ok(()) => {
                self.check(seal, run);
                let after = run.value(SealOutput::Energy);
                assert!(after >= lost, "energy is won: {lost} {after}");
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert_eq!(run.save(), saved, "changed though refused: {error}");
            }
        }
        true
    }

    /// Numbers, no negative content, and the fluid that came in less what left.
    fn check(&mut self, seal: &Seal, run: &SealRun) {
        self.values.resize(self.variables.len(), 0.0);
        run.evaluate(&self.variables, &mut self.values);
        for (variable, value) in self.variables.iter().zip(&self.values) {
            assert!(value.is_finite(), "{} = {value}", variable.name);
        }
        assert!(run.contents().iter().all(|content| *content >= 0.0), "{:?}", run.contents());
        let (kept, moved) = (volume(seal, run) - self.begun, run.drawn() - run.leak());
        let scale = self.begun + run.drawn().abs() + run.leak().abs() + volume(seal, run);
        // film.md 4: to 1e-9.
        assert!((kept - moved).abs() <= 1e-9 * scale, "fluid: {kept} {moved} of {scale}");
    }
}
