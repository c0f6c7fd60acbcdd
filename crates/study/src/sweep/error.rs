//! Why a scene is not swept.

use asperity::math::NotEnoughMemory;
use asperity::scene::ParameterError;

use super::method::MethodError;
use super::never_steady::NeverSteady;
use super::not_possible::NotPossible;
use crate::error::of_kind;
use crate::uncertainty::UncertaintyError;

of_kind! { SweepError => Scene, MethodError => Scene, NeverSteady => Scene }

/// The scene does not go with what is asked of a sweep.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum SweepError {
    #[error("the scene has [carrier.x]; expected none, since a sweep prescribes the speed")]
    BodyAlongX,
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error(
        "`pressures`: the scene is in the direct form, which has no width and so no area: give `forces`, F_z of the whole \
         layer in N"
    )]
    NoArea,
    #[error("`temperatures`: the scene has no material.wlf, so nothing in it depends on the temperature")]
    NoWlf,
    #[error("`temperatures`: {0}")]
    Temperature(ParameterError),
    #[error(transparent)]
    NeverSteady(#[from] NeverSteady),
    #[error(transparent)]
    Memory(#[from] NotEnoughMemory),
    #[error(transparent)]
    Range(#[from] NotPossible),
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error(transparent)]
    Uncertainty(#[from] UncertaintyError),
    #[error(
        "the table is of another sweep: its fingerprint is {found}, that of this scene with its samples and speeds {expected}"
    )]
    OtherTable { found: String, expected: String },
    #[error("`quantile`: expected the whole table of a sweep with samples, which ranks them")]
    NoRanking,
}
