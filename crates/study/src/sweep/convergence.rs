//! What a study of convergence says of a sweep's scene, for the header of the table.

use asperity::tables;

/// A text is not the table of a study of the convergence of a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotAStudy {
    /// The line of this key is missing.
    #[error("expected a line `# {0} = ...`")]
    NoLine(&'static str),
    /// It is of another scene.
    #[error("it is of the scene {studied}, the sweep of {scene}")]
    OtherScene {
        /// The name of the scene that was studied.
        studied: String,
        /// The name of the scene that is swept.
        scene: String,
    },
    /// It has no verdict yet.
    #[error("expected a line `# verdict = ...`: the study is not finished")]
    NotFinished,
}

/// The verdict on `scene` and the point that it was found at, from the header of a study's table.
///
/// # Errors
/// What is wrong with the text.
pub fn verdict(text: &str, scene: &str) -> Result<String, NotAStudy> {
    let value = |key: &'static str| {
        let found = tables::comments(text).find_map(|(_, comment)| {
            let (name, value) = comment.split_once('=')?;
            (name.trim() == key).then(|| value.trim().to_owned())
        });
        found.ok_or(NotAStudy::NoLine(key))
    };
    value("asperity converge")?;
    let studied = value("scene")?;
    if studied != scene {
        return Err(NotAStudy::OtherScene { studied, scene: scene.to_owned() });
    }
    let verdict = value("verdict").map_err(|_| NotAStudy::NotFinished)?;
    // The studies of a layer and of the surface solved for are of different errors.
    let by = value("method").map_or_else(|_| String::new(), |method| format!(", by {method}"));
    Ok(format!("{verdict} (at {}, {}{by})", value("pressure")?, value("speed")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "# asperity converge = 3\n# scene = block\n# pressure = 100000 Pa\n# speed = 0.1 m/s\n\
                         # verdict = converged: spacing leaves most open\nmasses\n";

    #[test]
    fn a_verdict_says_where_it_was_found() {
        let found = verdict(STUDY, "block");
        assert_eq!(found, Ok("converged: spacing leaves most open (at 100000 Pa, 0.1 m/s)".to_owned()));
        let found = verdict(&STUDY.replace("# speed", "# method = layer: as asked for\n# speed"), "block");
        assert!(found.is_ok_and(|verdict| verdict.ends_with("0.1 m/s, by layer: as asked for)")));
    }

    #[test]
    fn another_scene_or_an_unfinished_study_is_refused() {
        assert!(verdict(STUDY, "seal").is_err_and(|problem| problem.to_string().contains("of the scene block")));
        let unfinished = STUDY.replace("# verdict", "# other");
        assert!(verdict(&unfinished, "block").is_err_and(|problem| problem == NotAStudy::NotFinished));
        assert!(verdict("speed,friction\n", "block").is_err());
    }
}
