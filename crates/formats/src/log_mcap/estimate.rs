//! An estimate as a recording that viewers of ROS 2 draw: [`write_estimate_mcap`]; and as a
//! trajectory for evo: [`write_estimate_tum`].

use std::io::{Seek, Write};

use mcap::Compression;
use stickslip::{Estimate, EstimateRow, Log, Setup};
use stickslip_dynamics::Pose;

use crate::estimate_columns::estimate_columns;
use crate::log_mcap::drawing::{Body, bodies, markers, outline_points};
use crate::log_mcap::output_message::{Float64, MarkerArray, PointCloud, PoseArray};
use crate::log_mcap::pose_message::{PoseWithCovarianceStamped, TfMessage, TransformStamped};
use crate::log_mcap::write::{McapWriteError, Recorder, header, pose_parts, stamps};
use crate::number;

/// Writes an estimate as an MCAP recording of ROS 2 messages in the frame `world`, one of each per
/// row that has a pose:
///
/// - `/stickslip/pose`, `geometry_msgs/msg/PoseWithCovarianceStamped`: the pose with its covariance
///   of x, y and the angle about z; the rest is 0, and so are values that the method does not have,
/// - `/tf`, `tf2_msgs/msg/TFMessage`: the frame `stickslip_object` in `world`,
/// - `/stickslip/markers`, `visualization_msgs/msg/MarkerArray`: outlines of the object, of the
///   pusher's fingers at their poses in `log` and of the fixels, red where contact is likelier than
///   not,
/// - `/stickslip/particles`, `geometry_msgs/msg/PoseArray`: row by row the poses of `cloud`,
///   particles that count the same; none where the slice is shorter or the row has none,
/// - `/stickslip/points/...`, `sensor_msgs/msg/PointCloud2`, for viewers without markers: points
///   along the outlines of the `object`, and of `pusher` and `fixels` where they are not `touched`;
///   `particles`,
/// - `/stickslip/NAME`, `std_msgs/msg/Float64`, for each column of `estimate.csv` that is not
///   empty: its number, NaN for an empty cell.
///
/// Equal estimates give equal bytes.
///
/// # Errors
/// A time that a stamp cannot hold, two rows within a nanosecond, or what `writer` says.
pub fn write_estimate_mcap(
    writer: impl Write + Seek,
    estimate: &Estimate,
    cloud: &[Vec<Pose>],
    log: &Log,
    setup: &Setup,
) -> Result<(), McapWriteError> {
    let has_particles = cloud.iter().any(|poses| !poses.is_empty());
    let mut columns = estimate_columns(estimate).split_off(1);
    columns.retain(|(_, column)| column.iter().any(|number| number.is_finite()));
    let mut messages = Messages::new(writer, has_particles)?;
    let plots = columns.iter();
    let plots = plots.map(|(name, _)| {
        messages
            .recorder
            .topic::<Float64>(&format!("/stickslip/{name}"))
    });
    let plots: Vec<u16> = plots.collect::<Result<_, _>>()?;
    let stamps = stamps(&estimate.time)?;
    for (k, (stamp, row)) in stamps.into_iter().zip(&estimate.rows).enumerate() {
        let Some(pose) = row.pose else { continue };
        messages.write_pose(stamp, pose, row)?;
        messages.write_bodies(stamp, &bodies(setup, row, pose, &log.fingers_at(k)))?;
        messages.write_particles(stamp, cloud.get(k).map_or(&[], Vec::as_slice))?;
        for (topic, (_, column)) in plots.iter().zip(&columns) {
            let number = Float64 { data: column[k] };
            messages.recorder.write(Some(*topic), stamp, Some(number))?;
        }
    }
    messages.recorder.finish()
}

/// Clouds of points, by the last part of their topic.
const CLOUDS: [&str; 4] = ["object", "pusher", "fixels", "touched"];

/// The messages of an estimate while they are written.
struct Messages<W: Write + Seek> {
    recorder: Recorder<W>,
    pose: u16,
    tf: u16,
    markers: u16,
    /// Topics of the particles, as poses and as points.
    particles: Option<[u16; 2]>,
    clouds: [u16; 4],
}

impl<W: Write + Seek> Messages<W> {
    fn new(writer: W, has_particles: bool) -> Result<Self, McapWriteError> {
        // outlines and transforms repeat themselves from row to row
        let mut recorder = Recorder::new(writer, Some(Compression::Zstd))?;
        let pose = recorder.topic::<PoseWithCovarianceStamped>("/stickslip/pose")?;
        let tf = recorder.topic::<TfMessage>("/tf")?;
        let markers = recorder.topic::<MarkerArray>("/stickslip/markers")?;
        let mut clouds = [0; 4];
        for (cloud, name) in clouds.iter_mut().zip(CLOUDS) {
            *cloud = recorder.topic::<PointCloud>(&format!("/stickslip/points/{name}"))?;
        }
        let particles = match has_particles {
            false => None,
            true => Some([
                recorder.topic::<PoseArray>("/stickslip/particles")?,
                recorder.topic::<PointCloud>("/stickslip/points/particles")?,
            ]),
        };
        Ok(Self {
            recorder,
            pose,
            tf,
            markers,
            particles,
            clouds,
        })
    }

    fn write_pose(
        &mut self,
        stamp: i64,
        pose: Pose,
        row: &EstimateRow,
    ) -> Result<(), McapWriteError> {
        let header = header(stamp);
        let (position, orientation) = pose_parts(pose);
        let transform = TransformStamped {
            header: header.clone(),
            child_frame_id: "stickslip_object".to_owned(),
            translation: position.clone(),
            rotation: orientation.clone(),
        };
        let transforms = vec![transform];
        self.recorder
            .write(Some(self.tf), stamp, Some(TfMessage { transforms }))?;
        let covariance = covariance(row);
        let message = PoseWithCovarianceStamped {
            header,
            position,
            orientation,
            covariance,
        };
        self.recorder.write(Some(self.pose), stamp, Some(message))
    }

    fn write_bodies(&mut self, stamp: i64, bodies: &[Body<'_>]) -> Result<(), McapWriteError> {
        let header = header(stamp);
        let markers = markers(&header, bodies);
        self.recorder
            .write(Some(self.markers), stamp, Some(MarkerArray { markers }))?;
        for (topic, name) in self.clouds.into_iter().zip(CLOUDS) {
            let shown = bodies.iter().filter(|body| body.cloud() == name);
            let message = PointCloud::new(header.clone(), shown.flat_map(outline_points));
            self.recorder.write(Some(topic), stamp, Some(message))?;
        }
        Ok(())
    }

    fn write_particles(&mut self, stamp: i64, cloud: &[Pose]) -> Result<(), McapWriteError> {
        let Some([poses, points]) = self.particles.filter(|_| !cloud.is_empty()) else {
            return Ok(());
        };
        let header = header(stamp);
        let places = cloud.iter().map(|pose| [pose.x, pose.y]);
        let message = PointCloud::new(header.clone(), places);
        self.recorder.write(Some(points), stamp, Some(message))?;
        let all = cloud.iter().map(|pose| pose_parts(*pose)).collect();
        self.recorder
            .write(Some(poses), stamp, Some(PoseArray { header, poses: all }))
    }
}

/// Writes an estimate's poses as lines `time x y z q_x q_y q_z q_w`, as evo and the benchmarks of
/// the TU Munich have them; rows without a pose are left out.
///
/// # Errors
/// Those of `writer`.
pub fn write_estimate_tum(mut writer: impl Write, estimate: &Estimate) -> std::io::Result<()> {
    for (time, row) in estimate.time.iter().zip(&estimate.rows) {
        let Some(pose) = row.pose else { continue };
        let (z, w) = libm::sincos(pose.theta / 2.0);
        let [time, x, y, z, w] = [*time, pose.x, pose.y, z, w].map(number::text);
        writeln!(writer, "{time} {x} {y} 0 0 0 {z} {w}")?;
    }
    Ok(())
}

/// Variances and covariances of x, y and the angle about z at their places; 0 where nothing is
/// known.
fn covariance(row: &EstimateRow) -> [[f64; 6]; 6] {
    let mut covariance = [[0.0; 6]; 6];
    if let Some(spread) = &row.spread {
        let of = spread.covariance();
        (covariance[0][0], covariance[1][1], covariance[5][5]) = (of.x, of.y, of.theta);
        for (row, column, value) in [(0, 1, of.x_y), (0, 5, of.x_theta), (1, 5, of.y_theta)] {
            covariance[row][column] = value;
            covariance[column][row] = value;
        }
    }
    covariance
}
