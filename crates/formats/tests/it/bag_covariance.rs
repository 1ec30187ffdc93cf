//! Poses in messages that say how noisy they are.

use crate::bag::{Line, MS, file, longer, pusher, told, xs};
use stickslip::{Log, PoseCovariance};
use stickslip_formats::{BagOptions, LogWarning, McapError, read_bag};

fn read(lines: &[Line], options: &BagOptions) -> Result<(Log, Vec<LogWarning>), McapError> {
    let bytes = file(lines);
    read_bag([("bag.mcap".to_owned(), &bytes[..])], options)
}

#[test]
fn poses_are_read_from_four_messages() {
    for (kind, child, extra) in [
        ("geometry_msgs/msg/PoseWithCovarianceStamped", None, 36),
        ("geometry_msgs/msg/TransformStamped", Some("box"), 0),
        ("nav_msgs/msg/Odometry", Some("box"), 36 + 6 + 36),
    ] {
        let lines: Vec<Line> = (0..5)
            .map(|k| longer(kind, 40 * MS * k, k as f64, child, extra))
            .chain([pusher(0, 0.0)])
            .collect();
        let (log, warnings) = read(&lines, &BagOptions::default()).unwrap();
        assert_eq!(warnings, []);
        assert_eq!(
            xs(&log.object),
            [0.0, 1.0, 2.0, 3.0, 4.0].map(Some),
            "{kind}"
        );
        let own = PoseCovariance {
            x: told(0, 0),
            y: told(1, 1),
            theta: told(5, 5),
            x_y: told(0, 1),
            x_theta: told(0, 5),
            y_theta: told(1, 5),
        };
        let expected = if extra > 0 {
            vec![Some(own); 5]
        } else {
            Vec::new()
        };
        assert_eq!(log.object_covariance, expected, "{kind}");
    }
}

/// Zeros mean that nothing is known. Numbers that are no covariance give a warning, and count as
/// not known.
#[test]
fn covariances_that_are_none_are_not_used() {
    let kind = "geometry_msgs/msg/PoseWithCovarianceStamped";
    let with = |stamp: i64, change: fn(&mut [[f64; 6]; 6])| {
        let mut covariance = std::array::from_fn(|i| std::array::from_fn(|j| told(i, j)));
        change(&mut covariance);
        let mut line = longer(kind, stamp, 0.5, None, 36);
        let start = line.data.len() - 36 * 8;
        for (at, number) in line.data[start..]
            .chunks_mut(8)
            .zip(covariance.as_flattened())
        {
            at.copy_from_slice(&number.to_le_bytes());
        }
        line
    };
    let zeros: fn(&mut [[f64; 6]; 6]) = |c| *c = [[0.0; 6]; 6];
    let lines = [
        with(0, |_| {}),
        with(40 * MS, zeros),
        with(80 * MS, |c| c[5][5] = 0.0),
        with(120 * MS, |c| c[0][1] = 0.5),
        with(160 * MS, |c| c[1][1] = f64::NAN),
        // heights and tilts do not matter
        with(200 * MS, |c| c[2] = [f64::INFINITY; 6]),
        pusher(0, 0.0),
    ];
    let (log, warnings) = read(&lines, &BagOptions::default()).unwrap();
    let known: Vec<bool> = log.object_covariance.iter().map(Option::is_some).collect();
    assert_eq!(known, [true, false, false, false, false, true]);
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}")
    };
    let text = warning.to_string();
    assert!(text.contains("/object/pose: 3 of 6 covariances"), "{text}");
    assert!(text.contains("Publish zeros where"), "{text}");

    let (log, warnings) = read(&[with(0, zeros), pusher(0, 0.0)], &BagOptions::default()).unwrap();
    assert_eq!((log.object_covariance.len(), warnings.len()), (0, 0));
}
