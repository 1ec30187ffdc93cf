//! Reason why a fit was refused: [`FitError`].

use stickslip::{RunError, counted};
use stickslip_dynamics::ShapeError;
use stickslip_formats::SceneError;

/// Reason why a fit was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Too few pushes for the request.
    #[error("{} given; at least {least} are needed. Give more folders", counted(*.pushes as u64, "push"))]
    TooFewPushes {
        /// Pushes given.
        pushes: usize,
        /// Fewest that would do.
        least: usize,
    },
    /// A name that is no parameter.
    #[error(
        "`{name}` is no parameter that can be learnt; did you mean `{nearest}`? Known are {known}"
    )]
    UnknownParameter {
        /// The name found.
        name: String,
        /// The nearest that is one.
        nearest: &'static str,
        /// All that are.
        known: String,
    },
    /// A hand of several fingers.
    #[error(
        "{push}: the scene has [[finger]] tables; a fit learns from one pusher. Leave it out of the fit"
    )]
    Hand {
        /// Its name.
        push: String,
    },
    /// A push in which nothing touches the object.
    #[error("{push}: {found}. It is no push")]
    Untouched {
        /// Its name.
        push: String,
        /// The finding.
        found: String,
    },
    /// Nothing is to be learnt.
    #[error("no parameter is free; name some of {known}")]
    NothingFree {
        /// All that could be.
        known: String,
    },
    /// The prior leaves nothing open.
    #[error(
        "{push}: {parameter} is {value} with the relative spread {spread}, which leaves nothing to be learnt; \
         both must be above 0. Give a nominal value, and {parameter} in [uncertainty], or take it from the free ones"
    )]
    ClosedPrior {
        /// The push whose scene says so.
        push: String,
        /// Name of the parameter.
        parameter: &'static str,
        /// First guess.
        value: f64,
        /// Spread of its logarithm.
        spread: f64,
    },
    /// The tripod is to be learnt where the feet are known.
    #[error(
        "{push}: the scene gives the feet, so there is no {parameter} to learn. \
         Take it from the free parameters, or give tripod_radius instead of feet"
    )]
    KnownFeet {
        /// The push whose scene does.
        push: String,
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// The pushes are of several objects.
    #[error(
        "{second} has another object than {first}: its scene has another outline, mass, inertia or feet. \
         Fit the pushes of one object at a time, or make the scenes agree"
    )]
    SeveralObjects {
        /// A push of the first object.
        first: String,
        /// A push of another.
        second: String,
    },
    /// Two scenes start from different guesses.
    #[error(
        "{parameter} is {a} (spread {a_spread}) in the scene of {first} and {b} (spread {b_spread}) in that of {second}; \
         pushes are fitted together where they share what is learnt. Fit one object and one table at a time, or make the scenes agree"
    )]
    Disagree {
        /// Name of the parameter.
        parameter: &'static str,
        /// First push.
        first: String,
        /// Its guess.
        a: f64,
        /// Spread of that.
        a_spread: f64,
        /// Second push.
        second: String,
        /// Its guess.
        b: f64,
        /// Spread of that.
        b_spread: f64,
    },
    /// A push that nothing can be learnt from.
    #[error(
        "{push}: after the first pose of the object no other was measured; give a log with at least two, or leave the folder out"
    )]
    NoPose {
        /// The push.
        push: String,
    },
    /// A latency is to be learnt where there is no camera.
    #[error(
        "{push}: the scene has no [camera], so no latency either; add the table, or take latency from the free parameters"
    )]
    NoCamera {
        /// The push whose scene has none.
        push: String,
    },
    /// The fitted outline is none.
    #[error(
        "the fitted outline is none: {0}; take outline_scale, outline_offset and pusher_offset from the free parameters"
    )]
    Outline(#[from] ShapeError),
    /// The scene to be written is none.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A push that cannot be simulated.
    #[error("{push}: {source}")]
    Run {
        /// The push.
        push: String,
        /// Its error.
        source: RunError,
    },
}
