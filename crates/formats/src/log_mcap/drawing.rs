//! Bodies as viewers draw them: lines around their parts, and points along those.

use stickslip::{EstimateRow, Setup};
use stickslip_dynamics::{Part, Pose, Shape};

use crate::log_mcap::message::{Header, Vector3};
use crate::log_mcap::output_message::{ADD, Colour, DELETE, LINE_STRIP, Marker};
use crate::log_mcap::write::pose_parts;

/// Sides of a circle as it is drawn.
const SIDES: usize = 48;
/// Width of the lines that outlines are drawn with (m).
const LINE: f64 = 0.001;
/// Points along a part at least, where points are drawn.
const POINTS: f64 = 60.0;

const OBJECT: Colour = colour(0.12, 0.47, 0.71);
const PUSHER: Colour = colour(0.9, 0.6, 0.1);
const FIXEL: Colour = colour(0.4, 0.4, 0.4);
const TOUCHED: Colour = colour(0.84, 0.15, 0.16);

const fn colour(r: f32, g: f32, b: f32) -> Colour {
    Colour { r, g, b, a: 1.0 }
}

/// A body at a row.
pub(crate) struct Body<'a> {
    namespace: &'static str,
    colour: Colour,
    shape: &'a Shape,
    /// `None` where it is not known.
    pose: Option<Pose>,
    /// True if contact with the object is likelier than not.
    touched: bool,
}

impl Body<'_> {
    /// Of which cloud its points are.
    pub(crate) fn cloud(&self) -> &'static str {
        if self.touched {
            "touched"
        } else {
            self.namespace
        }
    }
}

/// All bodies: the object at its estimated pose, the pusher, the fixels, a hand's other fingers.
pub(crate) fn bodies<'a>(
    setup: &'a Setup,
    row: &EstimateRow,
    object: Pose,
    fingers: &[Option<Pose>],
) -> Vec<Body<'a>> {
    let scene = &setup.scene;
    let touched = |contact: Option<f64>| contact.is_some_and(|contact| contact > 0.5);
    let mut bodies = vec![
        Body {
            namespace: "object",
            colour: OBJECT,
            shape: &scene.object.shape,
            pose: Some(object),
            touched: false,
        },
        Body {
            namespace: "pusher",
            colour: PUSHER,
            shape: &scene.pusher.fingers[0],
            pose: fingers.first().copied().flatten(),
            touched: touched(row.contact_pusher),
        },
    ];
    let contacts = row.contact_others.as_deref().unwrap_or_default();
    bodies.extend(scene.fixels.iter().enumerate().map(|(k, fixel)| Body {
        namespace: "fixels",
        colour: FIXEL,
        shape: &fixel.shape,
        pose: Some(fixel.pose),
        touched: touched(contacts.get(k).copied()),
    }));
    let others = scene.pusher.fingers.iter().zip(fingers).skip(1);
    bodies.extend(
        others
            .zip(scene.fixels.len()..)
            .map(|((shape, pose), k)| Body {
                namespace: "pusher",
                colour: PUSHER,
                shape,
                pose: *pose,
                touched: touched(contacts.get(k).copied()),
            }),
    );
    bodies
}

/// A closed line for each part of each body, or the word to take it away where its pose is not
/// known.
pub(crate) fn markers(header: &Header, bodies: &[Body<'_>]) -> Vec<Marker> {
    let mut markers: Vec<Marker> = Vec::new();
    for body in bodies {
        for part in body.shape.parts() {
            let before = markers.last().filter(|last| last.ns == body.namespace);
            let id = before.map_or(0, |last| last.id + 1);
            markers.push(marker(header, body, part, id));
        }
    }
    markers
}

fn marker(header: &Header, body: &Body<'_>, part: &Part, id: i32) -> Marker {
    let (position, orientation) = pose_parts(body.pose.unwrap_or_default());
    let point = |[x, y]: [f64; 2]| Vector3 { x, y, z: 0.0 };
    let (action, points) = match body.pose {
        Some(_) => (ADD, closed_line(part).into_iter().map(point).collect()),
        None => (DELETE, Vec::new()),
    };
    Marker {
        header: header.clone(),
        ns: body.namespace.to_owned(),
        id,
        kind: LINE_STRIP,
        action,
        position,
        orientation,
        scale: Vector3 {
            x: LINE,
            y: 0.0,
            z: 0.0,
        },
        colour: if body.touched { TOUCHED } else { body.colour },
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
}

/// Points along the boundaries of a body's parts, in the world; none where its pose is not known.
pub(crate) fn outline_points(body: &Body<'_>) -> Vec<[f64; 2]> {
    let Some(pose) = body.pose else {
        return Vec::new();
    };
    let parts = body.shape.parts().iter();
    let points = parts.flat_map(|part| points_along(&closed_line(part)));
    points.map(|point| pose.transform(point)).collect()
}

/// A line's points and others between them, from one to the next at most a share 1 / [`POINTS`] of
/// the way.
fn points_along(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let sides = || line.iter().zip(&line[1..]);
    let length = |(a, b): (&[f64; 2], &[f64; 2])| libm::hypot(b[0] - a[0], b[1] - a[1]);
    let spacing = sides().map(length).fold(0.0, |sum, side| sum + side) / POINTS;
    let mut points = Vec::new();
    for (a, b) in sides() {
        let count = (length((a, b)) / spacing).ceil().max(1.0);
        for k in 0..count as usize {
            let share = k as f64 / count;
            points.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
        }
    }
    points
}

/// A part's boundary in the body's frame, from a point back to it.
fn closed_line(part: &Part) -> Vec<[f64; 2]> {
    match part {
        Part::Polygon { vertices } => vertices.iter().chain(vertices.first()).copied().collect(),
        Part::Disc { radius, centre } => {
            let side = |k: usize| {
                let turn = std::f64::consts::TAU * (k % SIDES) as f64 / SIDES as f64;
                let (sin, cos) = libm::sincos(turn);
                [centre[0] + radius * cos, centre[1] + radius * sin]
            };
            (0..=SIDES).map(side).collect()
        }
    }
}
