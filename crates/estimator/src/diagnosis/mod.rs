//! Problems of a scene and a log, found from the data alone: [`diagnose`].
//!
//! Each finding measures one thing (a gap, a delay, a share of rows). It compares it with what the
//! scene says or with what is possible on a table top, and gives advice. Nothing is repaired.
//! Findings that need the geometry are left out if units or angles are wrong: they would only
//! repeat that.

mod angles;
mod collapses;
mod evidence;
mod finding;
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
mod units;

pub use collapses::collapsed;
pub use finding::{Finding, Severity, Subject};
pub(crate) use left_out::left_out_poses;
pub use stall_force::assumed_stall_force;

use evidence::Evidence;

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
/// # let pusher = Pusher { shape: finger, stall_force: None };
/// # let scene = Scene { gravity: 9.81, object, feet: Feet::Tripod { angle: 0.0 }, pusher, fixels: vec![], nominal };
/// # let setup = Setup { scene, stall_force_assumed: false, camera: None, tactile: Default::default(), filter: Default::default(), uncertainty: Default::default(), start: None };
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
    let evidence = Evidence::new(setup, log);
    let mut findings = plain(&evidence);
    let geometric = [
        frame::check,
        overlap::check,
        latency::check,
        pushing::check,
        sensors::check,
    ];
    if !findings.iter().any(is_misread) {
        findings.extend(geometric.iter().flat_map(|check| check(&evidence)));
    }
    findings
}

/// Finds the problems that are cheap enough to check before every run: numbers in other units or by
/// other clocks, bodies that overlap at the start. An estimate and its scores mean nothing with
/// them.
///
/// Also finds where a run departs from the log and the scene. It leaves out pusher poses that are
/// impossible. It tracks pusher poses that scatter by more than the scene states by the noise that
/// they have.
pub fn misread(setup: &Setup, log: &Log) -> Vec<Finding> {
    let evidence = Evidence::new(setup, log);
    let mut findings = plain(&evidence);
    if !findings.iter().any(is_misread) {
        findings.extend(overlap::check(&evidence));
    }
    findings.retain(|finding| finding.severity == Severity::Problem);
    if !findings.iter().any(is_misread) {
        findings.extend(left_out::check(&evidence));
        findings.extend(noise::pusher(&evidence));
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

/// Returns the findings that need no geometry.
fn plain(evidence: &Evidence<'_>) -> Vec<Finding> {
    let checks = [
        units::check,
        angles::check,
        limits::check,
        stall_force::check,
        timing::check,
        lost_poses::check,
        jumps::check,
        left_out::check,
        repeats::check,
        noise::check,
    ];
    checks.iter().flat_map(|check| check(evidence)).collect()
}

/// Returns true if units or angles are wrong. Findings that need the geometry would only repeat
/// that.
fn is_misread(finding: &Finding) -> bool {
    finding.severity == Severity::Problem
        && matches!(finding.subject, Subject::Units | Subject::Angles)
}
