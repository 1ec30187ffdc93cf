//! An estimate as a recording that viewers of ROS 2 draw: [`write_estimate_mcap`]; and as a
//! trajectory for evo: [`write_estimate_tum`].

use std::io::{Seek, Write};
use std::iter::repeat;

use stickslip::{Estimate, EstimateRow, Setup};
use stickslip_dynamics::{Part, Pose, Shape};

use crate::log_mcap::message::{Header, Vector3};
use crate::log_mcap::output_message::{Colour, LINE_STRIP, Marker, MarkerArray, PoseArray};
use crate::log_mcap::pose_message::{PoseWithCovarianceStamped, TfMessage, TransformStamped};
use crate::log_mcap::write::{McapWriteError, Recorder, header, pose_parts, stamps};
use crate::number;

/// Sides of a circle as it is drawn.
const SIDES: usize = 48;
/// Width of the lines that outlines are drawn with (m).
const LINE: f64 = 0.001;

const OBJECT: Colour = colour(0.12, 0.47, 0.71);
const FIXEL: Colour = colour(0.4, 0.4, 0.4);
const TOUCHED: Colour = colour(0.84, 0.15, 0.16);

const fn colour(r: f32, g: f32, b: f32) -> Colour {
    Colour { r, g, b, a: 1.0 }
}

/// Writes an estimate as an MCAP recording of ROS 2 messages in the frame `world`, one of each per row
/// that has a pose:
///
/// - `/stickslip/pose`, `geometry_msgs/msg/PoseWithCovarianceStamped`: the pose with its variances;
///   covariances between its numbers are not known and 0, as all about z and the other two angles,
/// - `/tf`, `tf2_msgs/msg/TFMessage`: the frame `stickslip_object` in `world`,
/// - `/stickslip/markers`, `visualization_msgs/msg/MarkerArray`: outlines of the object, and of the
///   fixels, red where contact is likelier than not,
/// - `/stickslip/particles`, `geometry_msgs/msg/PoseArray`: row by row the poses of `cloud`, particles that
///   count the same; none where the slice is shorter or the row has none.
///
/// The same estimate gives the same bytes.
///
/// # Errors
/// A time that a stamp cannot hold, two rows within a nanosecond, or what `writer` says.
pub fn write_estimate_mcap(
    writer: impl Write + Seek,
    estimate: &Estimate,
    cloud: &[Vec<Pose>],
    setup: &Setup,
) -> Result<(), McapWriteError> {
    let mut recorder = Recorder::new(writer)?;
    let pose_channel = recorder.topic::<PoseWithCovarianceStamped>("/stickslip/pose")?;
    let tf_channel = recorder.topic::<TfMessage>("/tf")?;
    let marker_channel = recorder.topic::<MarkerArray>("/stickslip/markers")?;
    let particle_channel = match cloud.iter().all(Vec::is_empty) {
        true => None,
        false => Some(recorder.topic::<PoseArray>("/stickslip/particles")?),
    };
    let clouds = cloud.iter().map(Vec::as_slice).chain(repeat(&[][..]));
    let stamps = stamps(&estimate.time)?;
    for ((stamp, row), cloud) in stamps.into_iter().zip(&estimate.rows).zip(clouds) {
        let Some(pose) = row.pose else { continue };
        let header = header(stamp);
        let (position, orientation) = pose_parts(pose);
        let transform = TransformStamped {
            header: header.clone(),
            child_frame_id: "stickslip_object".to_owned(),
            translation: position.clone(),
            rotation: orientation.clone(),
        };
        let transforms = vec![transform];
        recorder.write(Some(tf_channel), stamp, Some(TfMessage { transforms }))?;
        let message = PoseWithCovarianceStamped {
            header: header.clone(),
            position,
            orientation,
            covariance: covariance(row),
        };
        recorder.write(Some(pose_channel), stamp, Some(message))?;
        let markers = markers(&header, pose, row, setup);
        recorder.write(Some(marker_channel), stamp, Some(MarkerArray { markers }))?;
        let poses: Vec<_> = cloud.iter().map(|pose| pose_parts(*pose)).collect();
        let particles = (!poses.is_empty()).then_some(PoseArray { header, poses });
        recorder.write(particle_channel, stamp, particles)?;
    }
    recorder.finish()
}

/// Writes an estimate's poses as lines `time x y z q_x q_y q_z q_w`, as evo and the benchmarks of the
/// TU Munich have them; rows without a pose are left out.
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

/// Variances and covariances of x, y and the angle about z at their places; 0 where nothing is known.
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

fn markers(header: &Header, pose: Pose, row: &EstimateRow, setup: &Setup) -> Vec<Marker> {
    let mut markers = outlines(
        header,
        "object",
        0,
        (pose, &setup.scene.object.shape),
        OBJECT,
    );
    let contacts = row.contact_fixels.as_deref().unwrap_or_default();
    let mut id = 0;
    for (k, fixel) in setup.scene.fixels.iter().enumerate() {
        let touched = contacts.get(k).is_some_and(|contact| *contact > 0.5);
        let colour = if touched { TOUCHED } else { FIXEL };
        let drawn = outlines(header, "fixels", id, (fixel.pose, &fixel.shape), colour);
        id += drawn.len() as i32;
        markers.extend(drawn);
    }
    markers
}

/// A closed line for each part of a shape.
fn outlines(
    header: &Header,
    ns: &str,
    first_id: i32,
    (pose, shape): (Pose, &Shape),
    colour: Colour,
) -> Vec<Marker> {
    let (position, orientation) = pose_parts(pose);
    let marker = |(id, part): (i32, &Part)| {
        let mut points = part_points(part);
        points.extend(points.first().cloned());
        Marker {
            header: header.clone(),
            ns: ns.to_owned(),
            id,
            kind: LINE_STRIP,
            action: 0,
            position: position.clone(),
            orientation: orientation.clone(),
            scale: Vector3 {
                x: LINE,
                y: 0.0,
                z: 0.0,
            },
            colour,
            lifetime: (0, 0),
            frame_locked: false,
            points,
            colours: Vec::new(),
            texture_resource: String::new(),
            texture: (header.clone(), String::new(), Vec::new()),
            uv_coordinates: Vec::new(),
            text: String::new(),
            mesh_resource: String::new(),
            mesh_file: (String::new(), Vec::new()),
            mesh_use_embedded_materials: false,
        }
    };
    (first_id..).zip(shape.parts()).map(marker).collect()
}

/// Points along a part's boundary, in the body's frame.
fn part_points(part: &Part) -> Vec<Vector3> {
    let point = |[x, y]: [f64; 2]| Vector3 { x, y, z: 0.0 };
    let (semi_axes, centre, angle) = match part {
        Part::Polygon { vertices } => return vertices.iter().copied().map(point).collect(),
        Part::Disc { radius, centre } => ([*radius, *radius], *centre, 0.0),
        Part::Ellipse {
            semi_axes,
            centre,
            angle,
        } => (*semi_axes, *centre, *angle),
    };
    let frame = Pose::new(centre[0], centre[1], angle);
    let side = |k: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / SIDES as f64);
        point(frame.transform([semi_axes[0] * cos, semi_axes[1] * sin]))
    };
    (0..SIDES).map(side).collect()
}
