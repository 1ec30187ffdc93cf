//! Things that stand upright on the table: [`Body`], a convex ground plan between two heights.

use stickslip_dynamics::{Part, Pose};

use super::footprint::Footprint;
use super::ray::Ray;
use super::tag::{PAPER, Tag};

/// What carries a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Carrier {
    Table,
    Object,
    Pusher,
    Hand,
}

/// What is on a body's top.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Paint {
    Plain(f32),
    Tag(Tag),
}

/// An upright body with a convex ground plan, from `bottom` to `top`; of a union of parts, each is
/// one.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) carrier: Carrier,
    /// Its pose in the carrier's frame.
    pub(crate) mount: Pose,
    /// Heights above the table (m).
    pub(crate) bottom: f64,
    pub(crate) top: f64,
    /// A disc that holds its ground plan: middle and radius (m).
    pub(crate) middle: [f64; 2],
    pub(crate) radius: f64,
    /// Light that its sides return.
    pub(crate) side: f32,
    pub(crate) paint: Paint,
    pub(crate) footprint: Footprint,
}

/// Where a body is at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The middle of its disc (m).
    pub(crate) middle: [f64; 2],
    sin: f64,
    cos: f64,
}

/// What a ray meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// Height (m); of two bodies the ray meets the higher first.
    pub(crate) height: f64,
    pub(crate) grey: f32,
}

impl Body {
    /// A body with a plain top.
    pub(crate) fn plain(
        carrier: Carrier,
        part: &Part,
        [bottom, top]: [f64; 2],
        [paint, side]: [f32; 2],
    ) -> Self {
        let (middle, radius) = disc_about(part);
        let footprint = Footprint::new(part);
        Self {
            carrier,
            mount: Pose::default(),
            bottom,
            top,
            middle,
            radius,
            side,
            paint: Paint::Plain(paint),
            footprint,
        }
    }

    /// A sheet with a tag on it, its print at height `top` (m).
    pub(crate) fn tag(carrier: Carrier, mount: Pose, top: f64, tag: Tag) -> Self {
        let sheet = Self::plain(
            carrier,
            &square(tag.print_size()),
            [(top - 1e-3).max(0.0), top],
            [PAPER; 2],
        );
        Self {
            mount,
            paint: Paint::Tag(tag),
            ..sheet
        }
    }

    /// Where the body is with its carrier at `carrier`.
    pub(crate) fn place(&self, carrier: Pose) -> Place {
        let [x, y] = carrier.transform([self.mount.x, self.mount.y]);
        let pose = Pose::new(x, y, carrier.theta + self.mount.theta);
        let (sin, cos) = libm::sincos(pose.theta);
        Place {
            middle: pose.transform(self.middle),
            sin,
            cos,
        }
    }

    /// A box that holds the body's ground plan at two places: its lower left and upper right corner
    /// (m).
    pub(crate) fn bounds(&self, places: [&Place; 2]) -> [[f64; 2]; 2] {
        let along = |k: usize| places.map(|place| place.middle[k]);
        [
            [0, 1].map(|k| along(k)[0].min(along(k)[1]) - self.radius),
            [0, 1].map(|k| along(k)[0].max(along(k)[1]) + self.radius),
        ]
    }

    /// What `ray` meets of the body.
    pub(crate) fn hit(&self, place: &Place, ray: &Ray) -> Option<Hit> {
        let (top, thickness) = (ray.at(self.top), self.top - self.bottom);
        let from = [top[0] - place.middle[0], top[1] - place.middle[1]];
        let way = ray.slope.map(|slope| slope * thickness);
        let reach = self.radius + way[0].abs() + way[1].abs();
        if from[0] * from[0] + from[1] * from[1] > reach * reach {
            return None;
        }
        let [x, y] = place.unrotate(from);
        let start = [x + self.middle[0], y + self.middle[1]];
        let entry = self.footprint.entry(start, place.unrotate(way))?;
        let grey = if entry == 0.0 {
            self.paint.grey(start)
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
        Part::Ellipse {
            semi_axes, centre, ..
        } => (*centre, semi_axes[0].max(semi_axes[1])),
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

impl Place {
    fn unrotate(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x + self.sin * y, self.cos * y - self.sin * x]
    }
}

impl Paint {
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
        let body = Body::plain(Carrier::Table, &disc, [0.0, 0.02], [0.5, 0.25]);
        // a quarter turn brings the disc's middle to (0.1, 0)
        let place = body.place(Pose::new(0.14, 0.0, std::f64::consts::FRAC_PI_2));
        let toward = |x: f64, slope: f64| Ray {
            origin: [x - (1.0 - 0.02) * slope, 0.0, 1.0],
            slope: [slope, 0.0],
        };
        let top = body.hit(&place, &toward(0.1, 0.3)).unwrap();
        assert_eq!((top.height, top.grey), (0.02, 0.5));
        // 3 mm before the disc at its top, one metre per metre: meets it 3 mm lower
        let side = body.hit(&place, &toward(0.1 - 0.013, 1.0)).unwrap();
        assert!((side.height - 0.017).abs() < 1e-12 && side.grey == 0.25);
        assert!(body.hit(&place, &toward(0.1 - 0.013, 0.1)).is_none());
    }
}
