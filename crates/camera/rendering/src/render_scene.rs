//! Bodies in front of the camera: [`RenderScene`].

use stickslip_dynamics::{Part, Pose, Scene, Shape};

use crate::appearance::{Appearance, TagMount};
use crate::exposure::Exposure;
use crate::prism::{Hit, Parent, Placement, Prism, square};
use crate::ray::Ray;
use crate::sampler::{INSTANTS, View};

/// Greys of top and side.
const OBJECT: [f32; 2] = [0.38, 0.22];
const PUSHER: [f32; 2] = [0.24, 0.15];
const FIXEL: [f32; 2] = [0.30, 0.18];
const HAND: [f32; 2] = [0.62, 0.40];
/// Grey of the plate, and of the room around it.
const PLATE: f32 = 0.52;
const ROOM: f32 = 0.10;

/// Everything before the camera, at rest and moving.
#[derive(Clone, Debug)]
pub struct RenderScene {
    plate: [[f64; 2]; 2],
    prisms: Vec<Prism>,
}

/// A prism during one exposure.
#[derive(Clone, Debug)]
pub(crate) struct PlacedPrism<'a> {
    pub(crate) prism: &'a Prism,
    /// Its placement at each instant of the exposure, or the only one.
    placements: Vec<Placement>,
}

/// Prisms that may be seen in a part of the image during one exposure.
#[derive(Clone, Debug)]
pub(crate) struct VisiblePart<'a> {
    pub(crate) plate: [[f64; 2]; 2],
    pub(crate) prisms: Vec<&'a PlacedPrism<'a>>,
}

impl RenderScene {
    /// The bodies of a scene with their appearance.
    pub fn new(scene: &Scene, appearance: &Appearance) -> Self {
        let upright = |parent: Parent, shape: &Shape, height: f64, greys: [f32; 2]| {
            shape
                .parts()
                .iter()
                .map(|part| Prism::plain(parent, part, [0.0, height], greys))
                .collect::<Vec<_>>()
        };
        let (object, pusher) = (&scene.object.shape, &scene.pusher.fingers[0]);
        let mut prisms = upright(Parent::Object, object, appearance.object_height, OBJECT);
        prisms.extend(upright(
            Parent::Pusher,
            pusher,
            appearance.pusher_height,
            PUSHER,
        ));
        for (k, finger) in scene.pusher.fingers[1..].iter().enumerate() {
            let height = appearance.pusher_height;
            prisms.extend(upright(Parent::Finger(k), finger, height, PUSHER));
        }
        for fixel in &scene.fixels {
            let parts = upright(Parent::Table, &fixel.shape, appearance.fixel_height, FIXEL);
            prisms.extend(parts.into_iter().map(|prism| Prism {
                mount: fixel.pose,
                ..prism
            }));
        }
        for (parent, mount) in [
            (Parent::Object, &appearance.object_tag),
            (Parent::Pusher, &appearance.pusher_tag),
        ] {
            let sheet = |m: &TagMount| Prism::tag(parent, m.pose, m.height, m.tag);
            prisms.extend(mount.iter().map(sheet));
        }
        prisms.extend(appearance.pusher_tag.iter().flat_map(tag_holder));
        let hand = &appearance.hand;
        let hand_part = |part: &Part| Prism::plain(Parent::Hand, part, hand.heights, HAND);
        prisms.extend(hand.parts.iter().map(hand_part));
        Self {
            plate: appearance.plate,
            prisms,
        }
    }

    /// The prisms that are there during an exposure.
    pub(crate) fn during(&self, exposure: &Exposure) -> Vec<PlacedPrism<'_>> {
        self.prisms
            .iter()
            .filter_map(|prism| PlacedPrism::new(prism, exposure))
            .collect()
    }

    /// The plate with nothing on it.
    pub(crate) fn bare(&self) -> VisiblePart<'_> {
        VisiblePart {
            plate: self.plate,
            prisms: Vec::new(),
        }
    }
}

impl<'a> PlacedPrism<'a> {
    /// The prism at every instant of an exposure; `None` where its parent is not in the picture.
    fn new(prism: &'a Prism, exposure: &Exposure) -> Option<Self> {
        let [start, end] = exposure.poses(prism.parent)?;
        let at = |instant: usize| {
            prism.place(start.interpolate(end, (instant as f64 + 0.5) / INSTANTS as f64))
        };
        let placements = if start == end {
            vec![prism.place(start)]
        } else {
            (0..INSTANTS).map(at).collect()
        };
        Some(Self { prism, placements })
    }

    /// Returns true if it moves during the exposure.
    pub(crate) fn moves(&self) -> bool {
        self.placements.len() > 1
    }

    /// A box that holds its footprint during the exposure: its lower left and upper right corner
    /// (m).
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        let last = self.placements.len() - 1;
        self.prism
            .bounds([&self.placements[0], &self.placements[last]])
    }

    fn hit(&self, ray: &Ray, instant: usize) -> Option<Hit> {
        let index = if self.moves() { instant } else { 0 };
        self.prism.hit(&self.placements[index], ray)
    }
}

impl VisiblePart<'_> {
    /// First surface that a ray meets at an instant; the table where it meets no prism.
    pub(crate) fn hit(&self, ray: &Ray, instant: usize) -> Hit {
        let [x, y] = ray.at(0.0);
        let [from, to] = self.plate;
        let on_plate = (from[0]..to[0]).contains(&x) && (from[1]..to[1]).contains(&y);
        let table = Hit {
            height: 0.0,
            grey: if on_plate { PLATE } else { ROOM },
        };
        let hits = self
            .prisms
            .iter()
            .filter_map(|prism| prism.hit(ray, instant));
        hits.fold(table, |first, hit| {
            if hit.height > first.height {
                hit
            } else {
                first
            }
        })
    }
}

impl View for VisiblePart<'_> {
    fn grey(&self, ray: &Ray, instant: usize) -> f32 {
        self.hit(ray, instant).grey
    }

    fn is_static(&self) -> bool {
        !self.prisms.iter().any(|prism| prism.moves())
    }
}

/// The post that carries the pusher's tag, and a rod from there to the pusher.
fn tag_holder(mount: &TagMount) -> [Prism; 2] {
    let post = Prism::plain(
        Parent::Pusher,
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
    let rod = Prism::plain(
        Parent::Pusher,
        &Part::Polygon { vertices },
        [0.006, 0.014],
        PUSHER,
    );
    let along = Pose::new(0.0, 0.0, libm::atan2(-mount.pose.y, -mount.pose.x));
    [
        Prism {
            mount: mount.pose,
            ..post
        },
        Prism {
            mount: along,
            ..rod
        },
    ]
}
