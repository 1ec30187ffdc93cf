//! `log.csv` there and back to the same bits, covariances of poses among them.

use proptest::prelude::*;
use stickslip::{Log, PoseCovariance};
use stickslip_dynamics::Pose;
use stickslip_formats::{read_log, write_log};

fn written(log: &Log) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_log(&mut bytes, log).expect("memory takes everything");
    bytes
}

/// Every bit, the sign of zero included.
fn bits(log: &Log) -> Vec<Option<Vec<u64>>> {
    let poses = log
        .object
        .iter()
        .chain(&log.pusher)
        .map(|pose| pose.map(|p| vec![p.x.to_bits(), p.y.to_bits(), p.theta.to_bits()]));
    let force = log
        .force
        .iter()
        .map(|force| force.map(|f| f.map(f64::to_bits).to_vec()));
    let time = log.time.iter().map(|time| Some(vec![time.to_bits()]));
    let own = log.object_covariance.iter().map(|own| {
        own.map(|c| {
            [c.x, c.y, c.theta, c.x_y, c.x_theta, c.y_theta]
                .map(f64::to_bits)
                .to_vec()
        })
    });
    poses.chain(force).chain(time).chain(own).collect()
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("finite", |value| value.is_finite()),
        -1.0..1.0_f64
    ]
}

/// A coordinate that can be, with any last bits.
fn coordinate() -> impl Strategy<Value = f64> {
    number().prop_map(|value| value % 1e6)
}

fn any_pose() -> impl Strategy<Value = Option<Pose>> {
    let numbers = (coordinate(), coordinate(), coordinate());
    prop::option::of(numbers.prop_map(|(x, y, theta)| Pose::new(x, y, theta)))
}

/// A covariance that can be: variances, and correlations that are small enough.
fn any_covariance() -> impl Strategy<Value = PoseCovariance> {
    let (variance, correlation) = (1e-12..1e3_f64, -0.45..0.45_f64);
    let numbers = prop::array::uniform3((variance, correlation));
    numbers.prop_map(|[(x, a), (y, b), (theta, c)]| PoseCovariance {
        x,
        y,
        theta,
        x_y: a * (x * y).sqrt(),
        x_theta: b * (x * theta).sqrt(),
        y_theta: c * (y * theta).sqrt(),
    })
}

fn any_log() -> impl Strategy<Value = Log> {
    (1..20_usize, 0..4_usize, any::<bool>()).prop_flat_map(|(rows, sensors, has_force)| {
        let time = prop::collection::btree_set(-1_000_000..1_000_000_i64, rows)
            .prop_map(|set| set.iter().map(|t| *t as f64 / 30.0).collect());
        let force = prop::option::of((number(), number()).prop_map(|(x, y)| [x, y]));
        (
            time,
            prop::collection::vec(any_pose(), rows),
            prop::collection::vec(any_pose(), rows),
            prop::collection::vec(prop::collection::vec(any::<Option<bool>>(), rows), sensors),
            prop::collection::vec(force, if has_force { rows } else { 0 }),
            prop::collection::vec(prop::option::of(any_covariance()), rows),
        )
            .prop_map(|(time, object, pusher, tactile, force, own)| Log {
                time,
                object,
                // a column without any is none
                object_covariance: if own.iter().any(Option::is_some) {
                    own
                } else {
                    Vec::new()
                },
                pusher,
                other_fingers: Vec::new(),
                tactile,
                force,
            })
    })
}

proptest! {
    #[test]
    fn written_log_reads_back_to_the_same_bits(log in any_log()) {
        let (back, warnings) = read_log(&written(&log)[..], "log.csv").map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!(warnings, []);
        prop_assert_eq!(bits(&back), bits(&log));
        prop_assert_eq!(back, log);
    }
}

#[test]
fn covariances_are_read_where_they_are_told_and_refused_where_they_are_none() {
    let header = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta,object_cov_x_y,object_cov_x_theta,object_cov_y_theta,object_var_x,object_var_y,object_var_theta";
    let told =
        format!("{header}\n0,0,0,0,0,0,0,1e-9,0,-1e-8,4e-8,9e-8,1e-6\n1,0,0,0,0,0,0,,,,,,\n");
    let (log, warnings) = read_log(told.as_bytes(), "log.csv").unwrap();
    let own = PoseCovariance {
        x: 4e-8,
        y: 9e-8,
        theta: 1e-6,
        x_y: 1e-9,
        x_theta: 0.0,
        y_theta: -1e-8,
    };
    assert_eq!(
        (log.object_covariance, warnings),
        (vec![Some(own), None], vec![])
    );
    for (row, words) in [
        (
            "0,0,0,0,0,0,0,1e-9,0,-1e-8,4e-8,9e-8,0",
            "the covariance 4e-8, 9e-8, 0, 1e-9, 0, -1e-8",
        ),
        ("0,0,0,0,0,0,0,0,0,0,0,0,0", "Leave all six cells empty"),
        ("0,0,0,0,0,0,0,0,0,0,1,1,", "object_var_theta"),
        ("0,0,0,0,0,0,0,0,0,0,1,nan,1", "object_var_y"),
    ] {
        let text = read_log(format!("{header}\n{row}\n").as_bytes(), "log.csv");
        let text = text.unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
    let part = told.replace(",object_var_theta", ",other");
    let text = read_log(part.as_bytes(), "log.csv")
        .unwrap_err()
        .to_string();
    assert!(text.contains("object_var_theta"), "{text}");
}
