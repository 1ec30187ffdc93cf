//! Looks of a scene that its planar shapes leave open: heights, tags, the plate and the hand,
//! [`Appearance`].

use stickslip_dynamics::{Part, Pose, Scene};

use crate::tag::{Tag, TagCells};

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

/// Looks of a scene besides its planar shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
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

impl Hand {
    /// A fist with its forearm: the fist's middle at the origin, the knuckles along x.
    pub fn fist(heights: [f64; 2]) -> Self {
        let disc = |radius: f64, x: f64| Part::Disc {
            radius,
            centre: [x, 0.0],
        };
        let thumb = Part::Polygon {
            vertices: vec![
                [0.040, 0.054],
                [0.028, 0.058],
                [0.004, 0.053],
                [-0.017, 0.042],
                [-0.024, 0.030],
                [-0.012, 0.026],
                [0.012, 0.031],
                [0.033, 0.042],
            ],
        };
        let arm = Part::Polygon {
            vertices: vec![
                [-0.50, -0.040],
                [-0.06, -0.029],
                [-0.06, 0.029],
                [-0.50, 0.040],
            ],
        };
        Self {
            parts: vec![disc(0.043, 0.0), thumb, disc(0.034, -0.045), arm],
            heights,
        }
    }
}

impl Appearance {
    /// Bodies 15 to 24 mm high on a plate of 0.5 m by 0.4 m.
    ///
    /// The object's tag is in its middle, as large as fits a square of the object's bounding
    /// radius. The pusher's tag is higher, and 40 mm behind the pusher against `push`, the
    /// direction of its motion (rad) in its own frame.
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
