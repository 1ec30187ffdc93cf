//! Problems of a scene and a log, found from the data alone: [`diagnose`].
//!
//! Each finding measures one thing (a gap, a delay, a share of rows). It compares it with what the
//! scene says or with what is possible on a table top, and gives advice. Nothing is repaired.
//! A cause is reported without its consequences. Wrong units or angles leave out all that is
//! measured on poses, wrong frames all that is measured on gaps.

mod angles;
mod collapses;
mod contact;
mod evidence;
mod finding;
mod force;
mod frame;
mod jumps;
mod lasting;
mod latency;
mod left_out;
mod limits;
mod lost_poses;
mod noise;
mod overlap;
mod pose_noise;
mod pushing;
mod repeats;
mod sensors;
mod stall_force;
mod timing;
mod two_places;
mod units;

pub use collapses::collapsed;
pub use finding::{Finding, Severity, Subject};
pub(crate) use left_out::left_out_poses;
pub use stall_force::assumed_stall_force;

use evidence::{Evidence, unwrapped};

use crate::log::Log;
use crate::run::Run;
use crate::setup::Setup;

/// Checks a log against its scene.
///
/// The findings come in a fixed order, at least one for every subject that the data can speak of.
///
/// ```
/// # use stickslip::diagnosis::{diagnose, Severity};
/// # use stickslip::dynamics::{Feet, Friction, Object, Part, Pose, Pusher, Scene, Shape};
/// # use stickslip::{Log, Setup};
/// # let disc = |radius| Shape::new(vec![Part::Disc { radius, centre: [0.0, 0.0] }]);
/// # let (object, finger) = (disc(0.03)?, disc(0.005)?);
/// # let nominal = Friction { mu_s: 0.3, mu_p: 0.3, mu_f: 0.3, d_tri: 0.02 };
/// # let object = Object { mass: 0.5, inertia: 2e-4, shape: object };
/// # let pusher = Pusher { fingers: vec![finger], stall_force: None };
/// # let scene = Scene { gravity: 9.81, object, feet: Feet::Tripod { angle: 0.0 }, pusher, fixels: vec![], nominal };
/// # let setup = Setup { scene, stall_force_assumed: false, camera: None, tactile: Default::default(), wrench: None, filter: Default::default(), uncertainty: Default::default(), start: None };
/// let in_millimetres = Log {
///     time: vec![0.0, 0.1],
///     object: vec![Some(Pose::new(40.0, 0.0, 0.0)); 2],
///     pusher: vec![Some(Pose::new(0.0, 0.0, 0.0)), Some(Pose::new(3.0, 0.0, 0.0))],
///     ..Log::default()
/// };
/// let findings = diagnose(&setup, &in_millimetres);
/// assert!(findings.iter().any(|finding| finding.severity == Severity::Problem && finding.found.contains("millimetres")));
/// # Ok::<(), stickslip::dynamics::ShapeError>(())
/// ```
pub fn diagnose(setup: &Setup, log: &Log) -> Vec<Finding> {
    let whole = unwrapped(log);
    let evidence = Evidence::new(setup, &whole);
    let mut findings = plain(&evidence, log);
    if !findings.iter().any(is_misread) {
        findings.extend(frame::check(&evidence));
    }
    let of_gaps = [
        contact::check,
        overlap::check,
        latency::check,
        pushing::check,
        force::check,
        sensors::check,
    ];
    if findings.iter().any(is_misread) {
        findings.retain(is_misread);
    } else {
        findings.extend(of_gaps.iter().flat_map(|check| check(&evidence)));
    }
    findings
}

/// Finds what makes an estimate meaningless: wrong units, angles or frames, noise in other units,
/// swapped columns. Only the first cause is returned.
pub fn refused(setup: &Setup, log: &Log) -> Option<Finding> {
    let whole = unwrapped(log);
    let evidence = Evidence::new(setup, &whole);
    let mut findings = units::check(&evidence);
    findings.extend(angles::check(&evidence, log));
    findings.extend(noise::check(&evidence));
    findings.extend(frame::check(&evidence));
    findings
        .into_iter()
        .find(|finding| finding.severity == Severity::Problem)
}

/// Finds a log in which nothing touches the object: it shows neither contact nor friction.
pub fn untouched(setup: &Setup, log: &Log) -> Option<Finding> {
    contact::none(&Evidence::new(setup, &unwrapped(log)))
}

/// Finds the problems that are cheap enough to check before every run: numbers in other units or by
/// other clocks, bodies that overlap at the start. An estimate and its scores mean nothing with
/// them.
///
/// Also finds where a run departs from the log and the scene. It leaves out pusher poses that are
/// impossible. It tracks pusher poses that scatter by more than the scene states by the noise that
/// they have.
pub fn misread(setup: &Setup, log: &Log) -> Vec<Finding> {
    let whole = unwrapped(log);
    let evidence = Evidence::new(setup, &whole);
    let mut findings = plain(&evidence, log);
    if !findings.iter().any(is_misread) {
        findings.extend(overlap::check(&evidence));
    }
    findings.retain(|finding| finding.severity == Severity::Problem);
    if !findings.iter().any(is_misread) {
        findings.extend(left_out::check(&evidence));
        findings.extend(noise::pusher(&evidence));
        findings.extend(contact::none(&evidence));
        let gap = pushing::check(&evidence).into_iter();
        findings.extend(gap.filter(|finding| finding.severity != Severity::Ok));
    }
    findings
}

/// Finds reasons to doubt the estimate of a run: those of [`misread`] and of [`collapsed`].
pub fn doubts(setup: &Setup, log: &Log, run: &Run) -> Vec<Finding> {
    let seen = run.estimate.rows.iter().filter(|row| row.visual).count();
    let mut findings = misread(setup, log);
    findings.extend(collapsed(run.collapses, seen));
    findings
}

/// Returns the findings that need no geometry; the causes alone if units or angles are wrong.
/// Angles are judged as `given`.
fn plain(evidence: &Evidence<'_>, given: &Log) -> Vec<Finding> {
    let others = [
        limits::check,
        stall_force::check,
        lost_poses::check,
        jumps::check,
        two_places::check,
        left_out::check,
        repeats::check,
        noise::check,
    ];
    let mut findings = units::check(evidence);
    findings.extend(angles::check(evidence, given));
    findings.extend(timing::check(evidence));
    if !findings.iter().any(is_misread) {
        findings.extend(others.iter().flat_map(|check| check(evidence)));
    }
    findings
}

/// Returns true for a cause that other findings would only repeat.
fn is_misread(finding: &Finding) -> bool {
    finding.severity == Severity::Problem
        && matches!(
            finding.subject,
            Subject::Units | Subject::Angles | Subject::Timing | Subject::Noise | Subject::Frames
        )
}
