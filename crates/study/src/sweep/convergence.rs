//! What a study of convergence says of a sweep's scene, for the header of the table.

use asperity::tables;

/// The verdict on `scene` and the point that it was found at, from the header of a study's table.
///
/// # Errors
/// What is wrong with the text.
pub fn verdict(text: &str, scene: &str) -> Result<String, String> {
    let value = |key: &str| {
        let found = tables::comments(text).find_map(|(_, comment)| {
            let (name, value) = comment.split_once('=')?;
            (name.trim() == key).then(|| value.trim().to_owned())
        });
        found.ok_or_else(|| format!("expected a line `# {key} = ...`"))
    };
    value("asperity converge")?;
    let studied = value("scene")?;
    if studied != scene {
        return Err(format!("it is of the scene {studied}, the sweep of {scene}"));
    }
    let verdict = value("verdict").map_err(|missing| format!("{missing}: the study is not finished"))?;
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
        assert_eq!(found.as_deref(), Ok("converged: spacing leaves most open (at 100000 Pa, 0.1 m/s)"));
        let found = verdict(&STUDY.replace("# speed", "# method = layer: as asked for\n# speed"), "block");
        assert!(found.is_ok_and(|verdict| verdict.ends_with("0.1 m/s, by layer: as asked for)")));
    }

    #[test]
    fn another_scene_or_an_unfinished_study_is_refused() {
        assert!(verdict(STUDY, "seal").is_err_and(|problem| problem.contains("of the scene block")));
        let unfinished = STUDY.replace("# verdict", "# other");
        assert!(verdict(&unfinished, "block").is_err_and(|problem| problem.contains("not finished")));
        assert!(verdict("speed,friction\n", "block").is_err());
    }
}
