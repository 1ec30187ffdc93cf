//! `poses.csv`, the poses in every frame, with their noise: [`write_poses`].

use std::io::{Result, Write};

use crate::planar_pose::Measurement;
use crate::track::{Sighting, Track};

/// Cells of a measurement.
const NUMBERS: [&str; 11] = [
    "x",
    "y",
    "theta",
    "var_x",
    "var_y",
    "var_theta",
    "cov_x_y",
    "cov_x_theta",
    "cov_y_theta",
    "tag_size",
    "chi2",
];

/// Writes one row for each frame: its time, whether it repeats the one before, and the columns of
/// object and pusher. For each these are: whether it is seen (measured, missing, distorted or
/// twice), the pose in the world (m, rad), its covariance, the size of the tag as seen (m) and the
/// misfit.
///
/// # Errors
/// Those of `writer`.
///
/// # Panics
/// If there are not as many times as frames.
pub fn write_poses(mut writer: impl Write, time: &[f64], track: &Track) -> Result<()> {
    assert_eq!(time.len(), track.frames.len(), "a time for every frame");
    let columns = |body: &str| {
        [format!("{body}_seen")]
            .into_iter()
            .chain(NUMBERS.map(|name| format!("{body}_{name}")))
            .collect::<Vec<_>>()
    };
    writeln!(
        writer,
        "time,repeated,{},{}",
        columns("object").join(","),
        columns("pusher").join(",")
    )?;
    time.iter()
        .zip(&track.frames)
        .try_for_each(|(time, frame)| {
            writeln!(
                writer,
                "{time},{},{},{}",
                u8::from(frame.repeated),
                cells(&frame.object),
                cells(&frame.pusher)
            )
        })
}

fn cells(sighting: &Sighting) -> String {
    let (seen, numbers) = match sighting {
        Sighting::Measured(measurement) => (
            "measured",
            numbers(measurement).map(|number| format!("{number:e}")),
        ),
        Sighting::Missing => ("missing", Default::default()),
        Sighting::Distorted => ("distorted", Default::default()),
        Sighting::Twice => ("twice", Default::default()),
    };
    format!("{seen},{}", numbers.join(","))
}

fn numbers(measurement: &Measurement) -> [f64; NUMBERS.len()] {
    let Measurement {
        pose,
        covariance,
        size,
        chi2,
    } = measurement;
    let c = |row: usize, column: usize| covariance[(row, column)];
    [
        pose.x,
        pose.y,
        pose.theta,
        c(0, 0),
        c(1, 1),
        c(2, 2),
        c(0, 1),
        c(0, 2),
        c(1, 2),
        *size,
        *chi2,
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;
    use stickslip_dynamics::Pose;

    use super::*;
    use crate::track::FrameSighting;

    #[test]
    fn write_poses_has_a_cell_for_every_column() {
        let covariance = Matrix3::new(1.0, 4.0, 5.0, 4.0, 2.0, 6.0, 5.0, 6.0, 3.0);
        let seen = Sighting::Measured(Measurement {
            pose: Pose::new(0.25, -0.5, 1.0),
            covariance,
            size: 0.03,
            chi2: 7.0,
        });
        let frame = FrameSighting {
            repeated: true,
            object: seen,
            pusher: Sighting::Missing,
            tags: vec![1],
        };
        let mut text = Vec::new();
        write_poses(
            &mut text,
            &[0.5],
            &Track {
                frames: vec![frame],
            },
        )
        .unwrap();
        let text = String::from_utf8(text).unwrap();
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(lines[0].len(), lines[1].len());
        let cell =
            |name: &str| lines[1][lines[0].iter().position(|column| *column == name).unwrap()];
        assert_eq!(
            [
                "repeated",
                "object_seen",
                "object_y",
                "object_var_theta",
                "object_cov_y_theta"
            ]
            .map(cell),
            ["1", "measured", "-5e-1", "3e0", "6e0"]
        );
        assert_eq!(
            ["pusher_seen", "pusher_x", "pusher_chi2"].map(cell),
            ["missing", "", ""]
        );
    }
}
