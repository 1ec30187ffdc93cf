//! The pusher's track: causally a function of the past alone, and near the motion that its
//! measurements were made from.

use stickslip::dynamics::Pose;
use stickslip::{Camera, Log, PusherTrack, Schedule, Tracking};
use stickslip_filter::{Purpose, Streams};

const CAMERA: Camera = Camera {
    position_std: 3e-4,
    orientation_std: 5e-3,
    latency: 0.0,
    pusher_position_std: 1e-4,
    pusher_orientation_std: 2e-3,
};

/// Pose of a pusher that rests for 2 s, moves at 30 mm/s for 2 s, stops for 4 s.
fn moved(time: f64) -> Pose {
    Pose::new(0.03 * (time.clamp(2.0, 4.0) - 2.0), 0.01, 0.0)
}

/// That motion as a camera at 30 Hz sees it.
fn log(seed: u64) -> Log {
    let time: Vec<f64> = (0..240).map(|row| f64::from(row) / 30.0).collect();
    let draws = Streams::new(seed).of(Purpose::Measure);
    let seen = |row: usize| {
        let [x, y, theta] = draws.at(row as u64).normals(0, 0);
        let Pose {
            x: x0,
            y: y0,
            theta: theta0,
        } = moved(time[row]);
        Some(Pose::new(
            x0 + 1e-4 * x,
            y0 + 1e-4 * y,
            theta0 + 2e-3 * theta,
        ))
    };
    Log {
        pusher: (0..time.len()).map(seen).collect(),
        object: vec![None; time.len()],
        time,
        ..Log::default()
    }
}

/// That log with a row missing now and then, a gap that is bridged and one that is not.
fn holey(seed: u64) -> Log {
    let mut log = log(seed);
    for row in [20, 21, 70]
        .into_iter()
        .chain(90..95)
        .chain(120..133)
        .chain([200])
    {
        log.pusher[row] = None;
    }
    log
}

fn causal(log: &Log, camera: Option<&Camera>) -> PusherTrack {
    PusherTrack::new(log, camera, Tracking::Causal).expect("a track")
}

/// The log with everything after row `k` changed: elsewhere, never seen again, seen without a
/// break, in slow motion, not there at all.
fn other_futures(log: &Log, k: usize) -> [Log; 5] {
    let change = |change: &dyn Fn(&mut Log, usize)| {
        let mut other = log.clone();
        (k + 1..log.len()).for_each(|row| change(&mut other, row));
        other
    };
    let elsewhere = |log: &mut Log, row: usize| {
        log.pusher[row] = Some(Pose::new(-0.3 * log.time[row], 1.0, log.time[row].powi(2)))
    };
    let seen = |log: &mut Log, row: usize| {
        log.pusher[row] = log.pusher[row].or(Some(moved(log.time[row])))
    };
    let slow = |log: &mut Log, row: usize| log.time[row] = log.time[row - 1] + 0.15;
    let mut cut = log.clone();
    cut.time.truncate(k + 1);
    cut.pusher.truncate(k + 1);
    cut.object.truncate(k + 1);
    [
        change(&elsewhere),
        change(&|log, row| log.pusher[row] = None),
        change(&seen),
        change(&slow),
        cut,
    ]
}

#[test]
fn causal_track_up_to_a_row_does_not_depend_on_later_rows_in_any_bit() {
    let log = holey(1);
    for camera in [Some(&CAMERA), None] {
        let track = causal(&log, camera);
        let schedule = Schedule::new(&log.time, &track, None);
        for k in (0..log.len() - 1)
            .step_by(7)
            .chain([0, 1, 2, 20, 94, 95, 120, 125, 126, 127, 133, 134])
        {
            for (future, other) in other_futures(&log, k).iter().enumerate() {
                let other_track = causal(other, camera);
                let other_schedule = Schedule::new(&other.time, &other_track, None);
                for row in 0..=k {
                    assert_eq!(
                        track.pose(row),
                        other_track.pose(row),
                        "row {row}, future {future} from {k} on"
                    );
                }
                for row in 0..k {
                    assert_eq!(
                        schedule.step(row),
                        other_schedule.step(row),
                        "step from row {row}, future {future} from {k} on"
                    );
                }
            }
        }
    }
}

/// A track that looks ahead fails the comparison.
#[test]
fn smoothed_track_depends_on_later_rows() {
    let log = log(1);
    let smoothed =
        |log: &Log| PusherTrack::new(log, Some(&CAMERA), Tracking::Smoothed).expect("a track");
    let [elsewhere, ..] = other_futures(&log, 100);
    assert_ne!(smoothed(&log).pose(50), smoothed(&elsewhere).pose(50));
}

/// Tag poses scatter by 0.5 mm, while the nominal noise is 0.1 mm, as of an encoder.
#[test]
fn recorded_poses_noisier_than_told_are_tracked_as_if_it_were_told() {
    let told = Camera {
        pusher_position_std: 5e-4,
        ..CAMERA
    };
    for seed in 0..10 {
        let mut noisy = log(seed);
        for (pose, time) in noisy.pusher.iter_mut().zip(&noisy.time) {
            let (pose, exact) = (pose.as_mut().expect("a pose"), moved(*time));
            pose.x = exact.x + 5.0 * (pose.x - exact.x);
            pose.y = exact.y + 5.0 * (pose.y - exact.y);
        }
        let error = |camera: &Camera| {
            let track = PusherTrack::new(&noisy, Some(camera), Tracking::Smoothed);
            errors(&track.expect("a track"), &noisy, 1..240)
        };
        let ([all, step], [known, known_step]) = (error(&CAMERA), error(&told));
        assert!(
            all < 1.1 * known && step < 1.3 * known_step,
            "seed {seed}: {all}, {step}, {known}, {known_step}"
        );
        assert!(step < 1e-4, "seed {seed}: {step}");
        // poses of the nominal noise are tracked by the nominal noise
        let right = PusherTrack::new(&noisy, Some(&told), Tracking::Smoothed).expect("a track");
        let less = Camera {
            pusher_position_std: 1.1 * told.pusher_position_std,
            ..CAMERA
        };
        let other = PusherTrack::new(&noisy, Some(&less), Tracking::Smoothed).expect("a track");
        assert_ne!(right.pose(100), other.pose(100), "seed {seed}");
    }
}

/// Root mean square of (position error, error of its change from row to row) (m), along the motion,
/// over some rows.
fn errors(track: &PusherTrack, log: &Log, rows: std::ops::Range<usize>) -> [f64; 2] {
    let error = |row: usize| track.pose(row).expect("on the plane").x - moved(log.time[row]).x;
    let count = rows.len() as f64;
    let position: f64 = rows.clone().map(|row| error(row).powi(2)).sum();
    let change: f64 = rows.map(|row| (error(row) - error(row - 1)).powi(2)).sum();
    [(position / count).sqrt(), (change / count).sqrt()]
}

#[test]
fn causal_track_follows_a_start_and_a_stop_and_rests_with_the_pusher() {
    let mut sums = [0.0; 4];
    for seed in 0..20 {
        let log = log(seed);
        let track = causal(&log, Some(&CAMERA));
        let [all, _] = errors(&track, &log, 1..240);
        let [moving, _] = errors(&track, &log, 75..120);
        let [resting, creeping] = errors(&track, &log, 150..240);
        [all, moving, resting, creeping]
            .iter()
            .zip(&mut sums)
            .for_each(|(error, sum)| *sum += error);
    }
    let [all, moving, resting, creeping] = sums.map(|sum| 1e3 * sum / 20.0);
    // one measurement has 0.1 mm, and from one to the next 0.141 mm
    assert!(
        all < 0.09 && moving < 0.07,
        "{all} mm, {moving} mm in motion"
    );
    assert!(
        resting < 0.04 && creeping < 0.03,
        "{resting} mm at rest, {creeping} mm from row to row"
    );
}

/// A track's corrections after a stop point backwards; the drive does not.
#[test]
fn causal_direction_stays_that_of_the_motion_after_it_stops() {
    for seed in 0..20 {
        let log = log(seed);
        let schedule = Schedule::new(&log.time, &causal(&log, Some(&CAMERA)), None);
        for row in 70..239 {
            let [x, y] = schedule.step(row)[0].pusher.expect("on the plane")[0].direction;
            assert!(x > 0.98, "seed {seed}, row {row}: ({x}, {y})");
        }
    }
}

#[test]
fn causal_pusher_leaves_the_plane_when_a_gap_has_become_too_long() {
    let log = holey(3);
    let track = causal(&log, Some(&CAMERA));
    let off: Vec<usize> = (0..log.len())
        .filter(|&row| track.pose(row).is_none())
        .collect();
    // last seen at row 119; 0.2 s are six rows
    assert_eq!(off, (126..133).collect::<Vec<_>>());
    assert_eq!(track.pose(125), track.pose(119), "held, not extrapolated");
    let smoothed = PusherTrack::new(&log, Some(&CAMERA), Tracking::Smoothed).expect("a track");
    assert!(
        (120..133).all(|row| smoothed.pose(row).is_none()),
        "off-line the gap is known from its first row on"
    );
}

/// A stalled drive springs back by nanometres: with exact poses that is all that is left of its
/// motion.
#[test]
fn recoil_of_an_exactly_known_pusher_tells_no_direction() {
    let recoil = |row: usize| if row.is_multiple_of(2) { 1e-8 } else { -1e-8 };
    let mut log = log(1);
    log.pusher = log
        .time
        .iter()
        .enumerate()
        .map(|(row, time)| {
            Some(Pose {
                x: moved(*time).x + recoil(row),
                ..moved(*time)
            })
        })
        .collect();
    let track = PusherTrack::new(&log, None, Tracking::Smoothed).expect("a track");
    let schedule = Schedule::new(&log.time, &track, None);
    for row in 65..log.len() - 1 {
        let directions = schedule
            .step(row)
            .iter()
            .map(|input| input.pusher.expect("a pusher")[0].direction);
        assert!(
            directions
                .into_iter()
                .all(|[x, y]| x > 0.999 && y.abs() < 1e-3),
            "row {row}"
        );
        assert_eq!(schedule.driven(row), row < 120, "row {row}");
    }
}
