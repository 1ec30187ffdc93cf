//! The scene `bench-scene` against a trajectory that an independent block Gauss–Seidel program
//! computed to 1e-15.

use crate::common::{bench_input, bench_scene, step};
use stickslip_dynamics::{Body, Dynamics, Outcome, Particle, StepWork, TOLERANCE};
use stickslip_testkit::data_root;

/// A body pushes, as far as the comparison of contact masks goes, from this normal impulse on: a
/// millionth of the weight's [N s].
const PUSHES: f64 = 1e-6 * 0.5 * 9.81 / 30.0;

/// Bodies in the order of the mask's bits.
const BODIES: [Body; 4] = [
    Body::Finger(0),
    Body::Fixel(0),
    Body::Fixel(1),
    Body::Fixel(2),
];

struct Row {
    frame: u32,
    pose: [f64; 3],
    mask: u32,
}

fn reference() -> Vec<Row> {
    let path = data_root()
        .expect("recorded data")
        .join("bench-scene/ref_traj_h.txt");
    let text = std::fs::read_to_string(&path).expect("the reference trajectory");
    let row = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |k: usize| words[k].parse::<f64>().expect("a number");
        Row {
            frame: words[0].parse().expect("a frame"),
            pose: [1, 2, 3].map(number),
            mask: words[4].parse().expect("a mask"),
        }
    };
    text.lines().map(row).collect()
}

fn mask(work: &StepWork<1>) -> u32 {
    BODIES
        .iter()
        .enumerate()
        .map(|(bit, &body)| u32::from(work.normal_impulse(0, body) > PUSHES) << bit)
        .sum()
}

#[test]
#[ignore = "needs recorded experiments"]
fn step_follows_the_recorded_reference_over_600_frames_to_a_micrometre() {
    let rows = reference();
    assert_eq!(rows.len(), 600);
    let dynamics = Dynamics::new(bench_scene());
    let (mut particle, mut work) = (Particle::default(), StepWork::default());
    for Row {
        frame,
        pose: [x, y, theta],
        mask: touching,
    } in rows
    {
        let report = step(&dynamics, &bench_input(frame), &mut particle, &mut work);
        assert_eq!(report.outcome, Outcome::Solved, "frame {frame}");
        assert!(
            report.residual <= TOLERANCE,
            "frame {frame}: residual {:e}",
            report.residual
        );
        let error = [
            particle.pose.x - x,
            particle.pose.y - y,
            particle.pose.theta - theta,
        ];
        assert!(
            error.iter().all(|e| e.abs() <= 1e-6),
            "frame {frame}: {error:?}"
        );
        // At rest the impulses are not unique.
        assert!(
            frame >= 198 || mask(&work) == touching,
            "frame {frame}: {} touch, {touching} in the reference",
            mask(&work)
        );
    }
}
