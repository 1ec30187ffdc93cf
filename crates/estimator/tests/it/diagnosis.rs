//! Findings of `diagnose` on logs whose faults are known: a disc is pushed along x by a pusher that
//! starts away from it, and stops.

use stickslip::diagnosis::{Finding, Severity, Subject, diagnose, misread, refused};
use stickslip::dynamics::{Part, Pose, Shape};
use stickslip::{Log, PoseCovariance, Row, Setup, Tracker, TrackerOptions};

use crate::common::{disc, setup};

/// A data set may have the object's pose at the start and at the end of a push only.
#[test]
fn object_that_is_seen_before_and_after_a_push_alone_does_not_lead() {
    let at = |k: usize| 0.0007 * k as f64;
    let mut log = Log::default();
    for k in 0..60 {
        log.time.push(k as f64 / 30.0);
        log.pusher.push(Some(Pose::new(at(k) - 0.035, 0.0, 0.0)));
        let seen = Pose::new(at(k), 0.0, 0.0);
        log.object.push(Some(seen).filter(|_| k == 0 || k == 59));
    }
    assert_eq!(refused(&setup(&[]), &log), None);
}

/// Gap at the start (m).
const WAY: f64 = 0.012;

/// Standard deviations of the positions of object and pusher (m), and of their angles (rad), as
/// [`setup`] has them.
const NOISE: [f64; 2] = [3e-4, 1e-4];
const TURN_NOISE: [f64; 2] = [5e-3, 2e-3];

/// Draws that are the same on all machines: sums of twelve uniform numbers, of unit variance.
struct Draws(u64);

impl Draws {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn about(&mut self, [x, y]: [f64; 2], std: f64, turn_std: f64) -> Pose {
        let position = [x + std * self.normal(), y + std * self.normal()];
        Pose::new(position[0], position[1], turn_std * self.normal())
    }
}

/// A push: the pusher waits, moves on by `length`, and waits.
#[derive(Clone, Copy)]
struct Push {
    rate: f64,
    speed: f64,
    length: f64,
    /// Radius of the object (m).
    radius: f64,
    seed: u64,
}

const FAST: Push = Push {
    rate: 30.0,
    speed: 0.1,
    length: 0.05,
    radius: 0.03,
    seed: 1,
};

impl Push {
    fn times(&self) -> Vec<f64> {
        let duration = 2.0 + self.length / self.speed;
        (0..(duration * self.rate) as usize)
            .map(|row| row as f64 / self.rate)
            .collect()
    }

    fn pusher_way(&self, time: f64) -> f64 {
        (self.speed * (time - 1.0)).clamp(0.0, self.length)
    }

    fn setup(&self) -> Setup {
        let mut setup = setup(&[]);
        setup.scene.object.shape = disc(self.radius);
        setup.scene.object.inertia = 0.5 * setup.scene.object.mass * self.radius * self.radius;
        setup
    }

    /// The log of frames at `times`.
    fn log_at(&self, time: Vec<f64>) -> Log {
        let mut draws = Draws(self.seed);
        let object = |way: f64| [(way - WAY).max(0.0), 0.0];
        let pusher = |way: f64| [way - WAY - self.radius - 0.005, 0.0];
        let rows = time.iter().map(|time| {
            let way = self.pusher_way(*time);
            (
                Some(draws.about(object(way), NOISE[0], TURN_NOISE[0])),
                Some(draws.about(pusher(way), NOISE[1], TURN_NOISE[1])),
            )
        });
        let (object, pusher) = rows.unzip();
        Log {
            object,
            pusher,
            time,
            ..Log::default()
        }
    }

    fn log(&self) -> Log {
        self.log_at(self.times())
    }

    /// Returns the findings of a log that are worse than ok.
    fn faults(&self, log: &Log) -> Vec<Finding> {
        let mut findings = diagnose(&self.setup(), log);
        findings.retain(|finding| finding.severity > Severity::Ok);
        findings
    }
}

fn moved(pose: &mut Option<Pose>, x: f64) {
    if let Some(pose) = pose {
        pose.x += x;
    }
}

/// Checks that the only fault has this subject and severity, and these words.
#[track_caller]
fn assert_only(faults: &[Finding], severity: Severity, subject: Subject, words: &str) {
    let [fault] = faults else {
        panic!("not one fault: {faults:#?}");
    };
    assert_eq!(
        (fault.severity, fault.subject),
        (severity, subject),
        "{fault}"
    );
    assert!(fault.found.contains(words), "{words} in {fault}");
}

#[test]
fn an_object_that_waits_for_a_fast_pusher_does_not_move_yet() {
    for speed in [0.06, 0.1, 0.15] {
        let push = Push { speed, ..FAST };
        assert_eq!(push.faults(&push.log()), Vec::new(), "{speed} m/s");
    }
}

#[test]
fn a_pusher_hidden_while_the_object_moves_is_told_where_both_are_hidden() {
    let push = Push {
        rate: 120.0,
        length: 0.12,
        ..FAST
    };
    let mut log = push.log();
    log.pusher[160..210].fill(None);
    log.object[160..210].fill(None);
    let words = "the pusher has no pose in rows 160 to 209";
    let faults = push.faults(&log);
    assert_only(&faults, Severity::Warning, Subject::PusherPoses, words);
}

/// A pusher at 13 mm/s moves half a millimetre in 40 ms. A pose is off by 0.3 mm, and its turn has
/// as much effect where the pusher pushes a box off its middle.
#[test]
fn the_stop_of_a_slow_pusher_tells_no_latency_by_noise_alone() {
    let side = 0.08;
    for seed in 0..100 {
        let push = Push {
            speed: 0.013,
            length: 0.025,
            radius: side,
            seed,
            ..FAST
        };
        let mut setup = push.setup();
        let vertices = vec![[-side, -side], [side, -side], [side, side], [-side, side]];
        setup.scene.object.shape = Shape::new(vec![Part::Polygon { vertices }]).expect("a box");
        let mut log = push.log();
        for pose in log.pusher.iter_mut().flatten() {
            pose.y += 0.75 * side;
        }
        let findings = diagnose(&setup, &log);
        let of_latency = |finding: &&Finding| finding.subject == Subject::Latency;
        let finding = findings.iter().find(of_latency).expect("a finding");
        assert_eq!(finding.severity, Severity::Ok, "seed {seed}: {finding}");
    }
}

#[test]
fn a_latency_is_told_from_the_stop_of_a_fast_pusher() {
    let mut log = FAST.log();
    log.object[3..].rotate_right(3);
    log.object.copy_within(6..9, 3);
    let faults = FAST.faults(&log);
    assert_only(
        &faults,
        Severity::Problem,
        Subject::Latency,
        "camera latency 0.10",
    );
}

#[test]
fn uneven_steps_of_a_moving_pusher_are_no_noise() {
    let push = Push {
        rate: 10.0,
        speed: 0.05,
        length: 0.2,
        ..FAST
    };
    let mut draws = Draws(7);
    let uneven = |time: f64| time + 0.025 * (2.0 * draws.uniform() - 1.0);
    let times = push.times().into_iter().map(uneven).collect();
    assert_eq!(push.faults(&push.log_at(times)), Vec::new());
}

/// The errors have the nominal size, and are forgotten within 0.15 s.
#[test]
fn errors_that_last_are_named_and_taken_for_no_motion() {
    let push = Push {
        rate: 120.0,
        ..FAST
    };
    let mut told = 0;
    for seed in 0..8 {
        let mut log = Push { seed, ..push }.log();
        let mut draws = Draws(seed + 100);
        let kept = libm::exp(-1.0 / (0.15 * push.rate));
        let fresh = (1.0 - kept * kept).sqrt();
        let mut error = [draws.normal(), draws.normal(), draws.normal()];
        for (time, pose) in log.time.iter().zip(&mut log.object) {
            error = error.map(|error| kept * error + fresh * draws.normal());
            let x = (push.pusher_way(*time) - WAY).max(0.0) + NOISE[0] * error[0];
            *pose = Some(Pose::new(x, NOISE[0] * error[1], TURN_NOISE[0] * error[2]));
        }
        let faults = push.faults(&log);
        let lasts = |fault: &Finding| fault.found.contains("the camera's errors last over");
        told += usize::from(faults.iter().any(lasts));
        let others: Vec<&Finding> = faults.iter().filter(|fault| !lasts(fault)).collect();
        assert!(others.is_empty(), "seed {seed}: {others:#?}");
    }
    assert!(told >= 7, "{told} of 8");
}

#[test]
fn jumps_are_told_of_a_large_object_and_its_pusher() {
    let push = Push {
        radius: 0.1,
        speed: 0.05,
        ..FAST
    };
    let mut log = push.log();
    moved(&mut log.pusher[45], 0.02);
    let mut faults = push.faults(&log);
    let also = faults.pop().expect("a finding");
    let words = "the pusher jumps at row 45, 2";
    assert_only(&faults, Severity::Problem, Subject::PusherPoses, words);
    let words = "1 pusher pose that the pusher cannot have reached, first in row 45";
    assert_only(&[also], Severity::Warning, Subject::PusherPoses, words);
    let mut log = push.log();
    (20..25).for_each(|row| moved(&mut log.object[row], 0.025));
    let faults = push.faults(&log);
    let words = "the object jumps at row 20, 2";
    assert_only(&faults, Severity::Problem, Subject::ObjectPoses, words);
    let mut log = push.log();
    moved(&mut log.object[0], 0.025);
    let faults = push.faults(&log);
    let words = "the object jumps at row 1, 2";
    assert_only(&faults, Severity::Problem, Subject::ObjectPoses, words);
}

#[test]
fn a_run_tells_which_poses_of_the_pusher_it_leaves_out() {
    let mut log = FAST.log();
    assert_eq!(misread(&FAST.setup(), &log), Vec::new());
    for row in [20, 45, 60] {
        moved(&mut log.pusher[row], 0.03);
    }
    let told = misread(&FAST.setup(), &log);
    let told = told.last().expect("a finding");
    assert_eq!(told.severity, Severity::Warning);
    let words = "3 pusher poses that the pusher cannot have reached, first in row 20";
    assert!(told.found.contains(words), "{told}");
    // live, row by row, these are as many
    let options = TrackerOptions::default();
    let mut tracker = Tracker::new(&FAST.setup(), &options).expect("a tracker");
    for ((time, object), pusher) in log.time.iter().zip(&log.object).zip(&log.pusher) {
        let row = Row {
            time: *time,
            object: *object,
            pusher: *pusher,
            ..Row::default()
        };
        tracker.push(&row).expect("a row");
    }
    assert_eq!(tracker.pusher_poses_left_out(), 3);
}

#[test]
fn a_start_and_a_stop_within_three_frames_are_no_jumps() {
    let push = Push {
        rate: 10.0,
        length: 0.025,
        ..FAST
    };
    assert_eq!(push.faults(&push.log()), Vec::new());
}

#[test]
fn a_pusher_that_is_held_between_its_samples_is_told() {
    let push = Push {
        speed: 0.05,
        ..FAST
    };
    let mut log = push.log();
    for row in 0..log.len() {
        log.pusher[row] = log.pusher[row / 3 * 3];
    }
    // and, by the camera, it is late by a row
    let faults = push.faults(&log);
    let of_repeats = |fault: &&Finding| fault.subject == Subject::RepeatedFrames;
    let fault = faults.iter().find(of_repeats).expect("a finding");
    let words = "of pusher poses repeat the one before while it moves";
    assert!(fault.found.contains(words), "{fault}");
    let of_jumps = |fault: &&Finding| fault.subject == Subject::PusherPoses;
    assert_eq!(faults.iter().find(of_jumps), None);
    // an exact pusher repeats its pose where it rests
    let mut log = push.log();
    for (time, pose) in log.time.iter().zip(&mut log.pusher) {
        *pose = Some(Pose::new(push.pusher_way(*time) - WAY - 0.035, 0.0, 0.0));
    }
    assert_eq!(push.faults(&log), Vec::new());
}

#[test]
fn an_assumed_stall_force_without_fixels_asks_for_nothing() {
    let mut setup = FAST.setup();
    setup.stall_force_assumed = true;
    let findings = diagnose(&setup, &FAST.log());
    let of_force = |finding: &&Finding| finding.subject == Subject::StallForce;
    let finding = findings.iter().find(of_force).expect("a finding");
    assert_eq!((finding.severity, &finding.advice), (Severity::Ok, &None));
    assert!(
        finding.found.ends_with("without fixels nothing jams"),
        "{finding}"
    );
}

/// Covariances count as they are given: those of a driver that fills in numbers make poses
/// worthless.
#[test]
fn covariances_that_are_made_up_are_named() {
    let with = |position: f64| {
        let mut log = FAST.log();
        let covariance = PoseCovariance {
            x: position * position,
            y: position * position,
            theta: TURN_NOISE[0] * TURN_NOISE[0],
            ..PoseCovariance::default()
        };
        log.object_covariance = vec![Some(covariance); log.len()];
        log
    };
    let setup = FAST.setup();
    assert!(misread(&setup, &with(NOISE[0])).is_empty());
    let found = refused(&setup, &with(0.07)).expect("a problem");
    assert_eq!(found.subject, Subject::Noise, "{found}");
    assert!(
        found.found.contains("their covariances: 70.00 mm"),
        "{found}"
    );
    assert_only(
        &FAST.faults(&with(8.0 * NOISE[0])),
        Severity::Warning,
        Subject::Noise,
        "their covariances: 2.40 mm",
    );
}

/// Poses of another point of the tool: a gap that stays is no swap of axes.
#[test]
fn pusher_that_is_away_by_a_constant_is_doubted_and_not_refused() {
    let long = Push {
        length: 0.2,
        ..FAST
    };
    let mut log = long.log();
    log.pusher.iter_mut().for_each(|pose| moved(pose, -0.004));
    let setup = long.setup();
    assert_eq!(refused(&setup, &log), None);
    let doubts = misread(&setup, &log);
    let gap = doubts.iter().find(|f| f.subject == Subject::PushingGap);
    assert!(gap.is_some(), "{:#?}", diagnose(&setup, &log));
    assert!(misread(&setup, &long.log()).is_empty());
}
