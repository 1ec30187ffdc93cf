//! What stands before the camera: [`Stage`].

use stickslip_dynamics::{Part, Pose, Scene, Shape};

use super::body::{Body, Carrier, Hit, Place, square};
use super::ray::Ray;
use super::sampler::View;
use super::tag::{Tag, TagCells};

/// Greys of top and side.
const OBJECT: [f32; 2] = [0.38, 0.22];
const PUSHER: [f32; 2] = [0.24, 0.15];
const FIXEL: [f32; 2] = [0.30, 0.18];
const HAND: [f32; 2] = [0.62, 0.40];
/// Grey of the plate, and of the room around it.
const PLATE: f32 = 0.52;
const ROOM: f32 = 0.10;

/// A tag fixed to a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TagMount {
    /// The tag.
    pub tag: Tag,
    /// Pose of the tag's frame (origin in its middle, x right and y up as printed) in the body's
    /// frame.
    pub pose: Pose,
    /// Height of the print above the table (m).
    pub height: f64,
}

/// The hand that gets between camera and object.
#[derive(Clone, Debug, PartialEq)]
pub struct Hand {
    /// Its outline from above, in its own frame.
    pub parts: Vec<Part>,
    /// Heights of its underside and back (m).
    pub heights: [f64; 2],
}

/// What the scene of the dynamics leaves open: heights, tags, the plate, the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Props {
    /// Two opposite corners of the plate, the lower left and the upper right (m).
    pub plate: [[f64; 2]; 2],
    /// Height of the object (m).
    pub object_height: f64,
    /// Height of the pusher (m).
    pub pusher_height: f64,
    /// Height of the fixels (m).
    pub fixel_height: f64,
    /// The object's tag.
    pub object_tag: Option<TagMount>,
    /// The pusher's tag.
    pub pusher_tag: Option<TagMount>,
    /// The hand.
    pub hand: Hand,
}

/// Everything before the camera, at rest and moving.
#[derive(Clone, Debug)]
pub struct Stage {
    plate: [[f64; 2]; 2],
    bodies: Vec<Body>,
}

/// A body during one exposure.
#[derive(Clone, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) body: &'a Body,
    /// Its place at each instant of the exposure, or the only one.
    pub(crate) places: Vec<Place>,
}

/// What may be seen in a part of the image during one exposure.
#[derive(Clone, Debug)]
pub(crate) struct Scenery<'a> {
    pub(crate) plate: [[f64; 2]; 2],
    pub(crate) bodies: Vec<&'a Placed<'a>>,
}

impl Hand {
    /// A fist with its forearm, the fist's middle at the origin, the knuckles along x.
    pub fn fist(heights: [f64; 2]) -> Self {
        let ellipse = |semi_axes: [f64; 2], centre: [f64; 2], angle: f64| Part::Ellipse {
            semi_axes,
            centre,
            angle,
        };
        let back = ellipse([0.042, 0.044], [0.0, 0.0], 0.0);
        let thumb = ellipse([0.034, 0.012], [0.008, 0.042], 0.35);
        let wrist = ellipse([0.050, 0.032], [-0.045, 0.0], 0.0);
        let arm = Part::Polygon {
            vertices: vec![
                [-0.50, -0.040],
                [-0.06, -0.029],
                [-0.06, 0.029],
                [-0.50, 0.040],
            ],
        };
        Self {
            parts: vec![back, thumb, wrist, arm],
            heights,
        }
    }
}

impl Props {
    /// Bodies 15 to 24 mm high on a plate of 0.5 m by 0.4 m; the object's tag in its middle and as
    /// large as fits a square of its reach; the pusher's 40 mm behind it against `push`, the
    /// direction of its way (rad) in its frame, and higher.
    pub fn of(scene: &Scene, object_cells: TagCells, pusher_cells: TagCells, push: f64) -> Self {
        let object_tag = Tag {
            cells: object_cells,
            size: 0.8 * scene.object.shape.bounding_radius(),
        };
        let pusher_tag = Tag {
            cells: pusher_cells,
            size: 0.024,
        };
        let [x, y] = Pose::new(0.0, 0.0, push).rotate([-0.04, 0.0]);
        Self {
            plate: [[-0.25, -0.2], [0.25, 0.2]],
            object_height: 0.020,
            pusher_height: 0.024,
            fixel_height: 0.015,
            object_tag: Some(TagMount {
                tag: object_tag,
                pose: Pose::default(),
                height: 0.0205,
            }),
            pusher_tag: Some(TagMount {
                tag: pusher_tag,
                pose: Pose::new(x, y, push),
                height: 0.0305,
            }),
            hand: Hand::fist([0.07, 0.10]),
        }
    }
}

impl Stage {
    /// The bodies of a scene with what the scene leaves open.
    pub fn new(scene: &Scene, props: &Props) -> Self {
        let upright = |carrier: Carrier, shape: &Shape, height: f64, greys: [f32; 2]| {
            shape
                .parts()
                .iter()
                .map(|part| Body::plain(carrier, part, [0.0, height], greys))
                .collect::<Vec<_>>()
        };
        let mut bodies = upright(
            Carrier::Object,
            &scene.object.shape,
            props.object_height,
            OBJECT,
        );
        bodies.extend(upright(
            Carrier::Pusher,
            &scene.pusher.shape,
            props.pusher_height,
            PUSHER,
        ));
        for fixel in &scene.fixels {
            let parts = upright(Carrier::Table, &fixel.shape, props.fixel_height, FIXEL);
            bodies.extend(parts.into_iter().map(|body| Body {
                mount: fixel.pose,
                ..body
            }));
        }
        for (carrier, mount) in [
            (Carrier::Object, &props.object_tag),
            (Carrier::Pusher, &props.pusher_tag),
        ] {
            bodies.extend(
                mount
                    .iter()
                    .map(|m| Body::tag(carrier, m.pose, m.height, m.tag)),
            );
        }
        bodies.extend(props.pusher_tag.iter().flat_map(tag_holder));
        bodies.extend(
            props
                .hand
                .parts
                .iter()
                .map(|part| Body::plain(Carrier::Hand, part, props.hand.heights, HAND)),
        );
        Self {
            plate: props.plate,
            bodies,
        }
    }

    pub(crate) fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The plate with nothing on it.
    pub(crate) fn bare(&self) -> Scenery<'_> {
        Scenery {
            plate: self.plate,
            bodies: Vec::new(),
        }
    }
}

impl Placed<'_> {
    /// Whether it moves during the exposure.
    pub(crate) fn moves(&self) -> bool {
        self.places.len() > 1
    }

    /// A box that holds its ground plan during the exposure: its lower left and upper right corner
    /// (m).
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        self.body
            .bounds([&self.places[0], &self.places[self.places.len() - 1]])
    }

    fn hit(&self, ray: &Ray, instant: usize) -> Option<Hit> {
        self.body
            .hit(&self.places[if self.moves() { instant } else { 0 }], ray)
    }
}

impl Scenery<'_> {
    /// What a ray meets first at an instant; the table where it meets no body.
    pub(crate) fn hit(&self, ray: &Ray, instant: usize) -> Hit {
        let [x, y] = ray.at(0.0);
        let [from, to] = self.plate;
        let on_plate = (from[0]..to[0]).contains(&x) && (from[1]..to[1]).contains(&y);
        let table = Hit {
            height: 0.0,
            grey: if on_plate { PLATE } else { ROOM },
        };
        let hits = self.bodies.iter().filter_map(|body| body.hit(ray, instant));
        hits.fold(table, |first, hit| {
            if hit.height > first.height {
                hit
            } else {
                first
            }
        })
    }
}

impl View for Scenery<'_> {
    fn grey(&self, ray: &Ray, instant: usize) -> f32 {
        self.hit(ray, instant).grey
    }

    fn is_still(&self) -> bool {
        !self.bodies.iter().any(|body| body.moves())
    }
}

/// What holds the pusher's tag up, and a rod from there to the pusher.
fn tag_holder(mount: &TagMount) -> [Body; 2] {
    let post = Body::plain(
        Carrier::Pusher,
        &square(0.9 * mount.tag.print_size()),
        [0.002, mount.height - 0.001],
        PUSHER,
    );
    let length = libm::hypot(mount.pose.x, mount.pose.y);
    let vertices = vec![
        [-length, -0.004],
        [0.0, -0.004],
        [0.0, 0.004],
        [-length, 0.004],
    ];
    let rod = Body::plain(
        Carrier::Pusher,
        &Part::Polygon { vertices },
        [0.006, 0.014],
        PUSHER,
    );
    let along = Pose::new(0.0, 0.0, libm::atan2(-mount.pose.y, -mount.pose.x));
    [
        Body {
            mount: mount.pose,
            ..post
        },
        Body {
            mount: along,
            ..rod
        },
    ]
}
