//! Object poses that go back and forth between two places: two cameras whose frames differ, or a
//! tag with two likely poses.

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, mm};
use super::finding::{Finding, Subject};
use super::pose_noise::PoseNoise;

/// Least share of steps from pose to pose that lead from one place to the other. Wrong poses are
/// rarer, and lie anywhere.
const MANY: f64 = 0.1;

/// Stated standard deviations of a pose by which two places are farther apart.
const APART: f64 = 4.0;

/// Share of its length by which a step back may miss, and by which steps may differ from their
/// mean.
const ALIKE: f64 = 0.5;

/// Two places between which the object seems to go back and forth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TwoPlaces {
    /// Distance of their positions (m) and of their angles (rad).
    apart: PoseNoise,
    /// Share of steps that lead from one to the other.
    share: f64,
}

/// A displacement along x and y, and a turn at the radius of gyration (m).
type Step = [f64; 3];

impl TwoPlaces {
    /// Finds them, if the steps from pose to pose do so that are longer than the noise that the
    /// scene states.
    pub fn of(evidence: &Evidence<'_>) -> Option<Self> {
        let gyration = evidence.setup.scene.object.gyration_radius();
        let noise = evidence.stated();
        let least = APART * noise.position.hypot(gyration * noise.angle);
        let poses = evidence
            .seen
            .iter()
            .filter_map(|row| evidence.log.object[*row]);
        let poses: Vec<Pose> = poses.collect();
        let steps = poses.array_windows().map(|[a, b]| {
            let turn = crate::angle::wrapped(b.theta - a.theta);
            [b.x - a.x, b.y - a.y, gyration * turn]
        });
        let long: Vec<Step> = steps.filter(|step| length(*step) > least).collect();
        let first = *long.first()?;

        // from one place to the other: a step that the next long one takes back
        let there: Vec<Step> = long
            .array_windows()
            .filter(|[step, back]| length(sum(*step, *back)) < ALIKE * length(*step))
            .map(|[step, _]| match dot(*step, first) < 0.0 {
                true => step.map(|d| -d),
                false => *step,
            })
            .collect();
        let mean = there.iter().copied().fold([0.0; 3], sum);
        let mean = mean.map(|d| d / there.len() as f64);
        let off = mean.map(|d| -d);
        let alike = there
            .iter()
            .filter(|step| length(sum(**step, off)) < ALIKE * length(mean));
        let share = alike.count() as f64 / poses.len() as f64;
        let [x, y, turn] = mean;
        (share > MANY).then_some(Self {
            apart: PoseNoise {
                position: x.hypot(y),
                angle: turn.abs() / gyration,
            },
            share,
        })
    }
}

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let found = evidence.two_places.as_ref().map(|TwoPlaces { apart, share }| {
        let found = format!(
            "object poses alternate between two places {} and {:.3} rad apart, in {:.0} % of rows",
            mm(apart.position),
            apart.angle,
            1e2 * share
        );
        let advice = "calibrate the cameras to each other, or log the poses of one only";
        Finding::problem(Subject::ObjectPoses, found, advice)
    });
    found.into_iter().collect()
}

fn sum(a: Step, b: Step) -> Step {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn dot(a: Step, b: Step) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(step: Step) -> f64 {
    dot(step, step).sqrt()
}
