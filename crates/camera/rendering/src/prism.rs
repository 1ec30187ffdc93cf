//! Things that stand upright on the table: [`Prism`], a convex footprint between two heights.

use stickslip_dynamics::{Part, Pose};

use crate::footprint::Footprint;
use crate::ray::Ray;
use crate::tag::{PAPER, Tag};

/// Body that a prism moves with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parent {
    Table,
    Object,
    Pusher,
    /// Of a hand's fingers besides the pusher, from 0.
    Finger(usize),
    Hand,
}

/// Texture of a prism's top.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Texture {
    Plain(f32),
    Tag(Tag),
}

/// An upright prism with a convex footprint; a body of several parts is several prisms.
#[derive(Clone, Debug)]
pub(crate) struct Prism {
    pub(crate) parent: Parent,
    /// Its pose in the parent's frame.
    pub(crate) mount: Pose,
    /// Heights above the table (m).
    pub(crate) bottom: f64,
    pub(crate) top: f64,
    /// A disc that holds its footprint: middle and radius (m).
    pub(crate) middle: [f64; 2],
    pub(crate) radius: f64,
    /// Grey of its sides.
    pub(crate) side: f32,
    pub(crate) texture: Texture,
    pub(crate) footprint: Footprint,
}

/// Place of a prism at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// The middle of its disc (m).
    pub(crate) middle: [f64; 2],
    sin: f64,
    cos: f64,
}

/// Intersection of a ray with a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// Height (m); of two hits a descending ray meets the higher first.
    pub(crate) height: f64,
    pub(crate) grey: f32,
}

impl Prism {
    /// A prism with a plain top.
    pub(crate) fn plain(
        parent: Parent,
        part: &Part,
        [bottom, top]: [f64; 2],
        [top_grey, side]: [f32; 2],
    ) -> Self {
        let (middle, radius) = disc_about(part);
        Self {
            parent,
            mount: Pose::default(),
            bottom,
            top,
            middle,
            radius,
            side,
            texture: Texture::Plain(top_grey),
            footprint: Footprint::new(part),
        }
    }

    /// A sheet with a tag on it, its print at height `top` (m).
    pub(crate) fn tag(parent: Parent, mount: Pose, top: f64, tag: Tag) -> Self {
        let sheet = Self::plain(
            parent,
            &square(tag.print_size()),
            [(top - 1e-3).max(0.0), top],
            [PAPER; 2],
        );
        Self {
            mount,
            texture: Texture::Tag(tag),
            ..sheet
        }
    }

    /// Place of the prism with its parent at `parent`.
    pub(crate) fn place(&self, parent: Pose) -> Placement {
        let [x, y] = parent.transform([self.mount.x, self.mount.y]);
        let pose = Pose::new(x, y, parent.theta + self.mount.theta);
        let (sin, cos) = libm::sincos(pose.theta);
        Placement {
            middle: pose.transform(self.middle),
            sin,
            cos,
        }
    }

    /// A box that holds the footprint at two placements: its lower left and upper right corner (m).
    pub(crate) fn bounds(&self, placements: [&Placement; 2]) -> [[f64; 2]; 2] {
        let along = |k: usize| placements.map(|placement| placement.middle[k]);
        [
            [0, 1].map(|k| along(k)[0].min(along(k)[1]) - self.radius),
            [0, 1].map(|k| along(k)[0].max(along(k)[1]) + self.radius),
        ]
    }

    /// First intersection of `ray` with the prism.
    pub(crate) fn hit(&self, placement: &Placement, ray: &Ray) -> Option<Hit> {
        // the ray between the top's and the bottom's height, seen from above
        let (top, thickness) = (ray.at(self.top), self.top - self.bottom);
        let from = [top[0] - placement.middle[0], top[1] - placement.middle[1]];
        let run = ray.slope.map(|slope| slope * thickness);

        // far rays: those that stay clear of the disc
        let reach = self.radius + run[0].abs() + run[1].abs();
        if from[0] * from[0] + from[1] * from[1] > reach * reach {
            return None;
        }

        // the first point over the footprint: on the top, or on a side
        let [x, y] = placement.inv_rotate(from);
        let start = [x + self.middle[0], y + self.middle[1]];
        let entry = self.footprint.entry(start, placement.inv_rotate(run))?;
        let grey = if entry == 0.0 {
            self.texture.grey(start)
        } else {
            self.side
        };
        Some(Hit {
            height: self.top - entry * thickness,
            grey,
        })
    }
}

/// A square about the origin.
pub(crate) fn square(edge: f64) -> Part {
    let half = edge / 2.0;
    Part::Polygon {
        vertices: vec![[-half, -half], [half, -half], [half, half], [-half, half]],
    }
}

/// A disc that holds a part: middle and radius.
fn disc_about(part: &Part) -> ([f64; 2], f64) {
    match part {
        Part::Disc { radius, centre } => (*centre, *radius),
        Part::Polygon { vertices } => {
            let count = vertices.len() as f64;
            let middle = vertices.iter().fold([0.0; 2], |sum, v| {
                [sum[0] + v[0] / count, sum[1] + v[1] / count]
            });
            (
                middle,
                vertices
                    .iter()
                    .map(|v| libm::hypot(v[0] - middle[0], v[1] - middle[1]))
                    .fold(0.0, f64::max),
            )
        }
    }
}

impl Placement {
    fn inv_rotate(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x + self.sin * y, self.cos * y - self.sin * x]
    }
}

impl Texture {
    fn grey(&self, point: [f64; 2]) -> f32 {
        match self {
            Self::Plain(grey) => *grey,
            Self::Tag(tag) => tag.grey(point),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hit_meets_the_top_or_a_side_at_its_height() {
        let disc = Part::Disc {
            radius: 0.01,
            centre: [0.0, 0.04],
        };
        let prism = Prism::plain(Parent::Table, &disc, [0.0, 0.02], [0.5, 0.25]);
        // a quarter turn brings the disc's middle to (0.1, 0)
        let placement = prism.place(Pose::new(0.14, 0.0, std::f64::consts::FRAC_PI_2));
        let toward = |x: f64, slope: f64| Ray {
            origin: [x - (1.0 - 0.02) * slope, 0.0, 1.0],
            slope: [slope, 0.0],
        };
        let top = prism.hit(&placement, &toward(0.1, 0.3)).unwrap();
        assert_eq!((top.height, top.grey), (0.02, 0.5));
        // 3 mm before the disc at its top, one metre per metre: meets it 3 mm lower
        let side = prism.hit(&placement, &toward(0.1 - 0.013, 1.0)).unwrap();
        assert!((side.height - 0.017).abs() < 1e-12 && side.grey == 0.25);
        assert!(prism.hit(&placement, &toward(0.1 - 0.013, 0.1)).is_none());
    }
}
