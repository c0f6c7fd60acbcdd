//! The table of a ranking: a row for each point and scene.

use asperity::element::Load;

use super::ranking::{QUANTILES, Ranking};
use crate::csv;
use crate::decimals::real;

/// The table; fields of what there is no result of are empty.
pub fn table(ranking: &Ranking) -> String {
    let load = match ranking.load {
        Load::Pressure { .. } => "pressure [Pa]",
        Load::Force => "force [N]",
    };
    let quantiles = QUANTILES.map(|quantile| format!("friction_{quantile}"));
    let head = ["scene", "speed [m/s]", load, "temperature [K]", "weight", "friction"];
    let head = head.into_iter().chain(quantiles.iter().map(String::as_str)).chain(["largest"]);
    let text = |value: Option<f64>| value.map_or_else(String::new, real);
    let rows = ranking.points.iter().flat_map(|ranked| {
        ranking.scenes.iter().enumerate().map(move |(i, scene)| {
            let at = &ranked.point;
            let own = [Some(at.speed), Some(at.load), at.temperature, Some(ranked.weight), ranked.friction[i]];
            let band = (0..QUANTILES.len()).map(|quantile| ranked.bands[i].map(|band| band[quantile]));
            let numbers = own.into_iter().chain(band).chain([Some(ranked.largest[i])]).map(text);
            std::iter::once(scene.label.clone()).chain(numbers).collect()
        })
    });
    csv::text(head, rows)
}
