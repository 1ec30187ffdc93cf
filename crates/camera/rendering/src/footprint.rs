//! Area of the table that a prism covers: [`Footprint`], one convex part.

use stickslip_dynamics::Part;

/// A convex region of the plane that line segments can be tested against.
#[derive(Clone, Debug)]
pub(crate) enum Footprint {
    /// Points p with n · p <= offset for every (n, offset).
    Polygon(Vec<([f64; 2], f64)>),
    /// Points p with |p - centre| <= radius.
    Disc { centre: [f64; 2], radius: f64 },
}

impl Footprint {
    /// The region of a part.
    pub(crate) fn new(part: &Part) -> Self {
        match part {
            Part::Polygon { vertices } => Self::polygon(vertices),
            Part::Disc { radius, centre } => Self::Disc {
                centre: *centre,
                radius: *radius,
            },
        }
    }

    /// A convex polygon, vertices counter-clockwise.
    fn polygon(vertices: &[[f64; 2]]) -> Self {
        let next = vertices.iter().cycle().skip(1);
        let side = |(a, b): (&[f64; 2], &[f64; 2])| {
            let normal = [b[1] - a[1], a[0] - b[0]];
            (normal, dot(normal, *a))
        };
        Self::Polygon(vertices.iter().zip(next).map(side).collect())
    }

    /// Entry of the segment from `start` to `start + run` into the region, as a share of it in [0,
    /// 1]; `None` where it does not enter.
    pub(crate) fn entry(&self, start: [f64; 2], run: [f64; 2]) -> Option<f64> {
        match self {
            Self::Polygon(sides) => entry_of_polygon(sides, start, run),
            Self::Disc { centre, radius } => {
                let scaled = |v: [f64; 2]| v.map(|x| x / radius);
                entry_of_circle(
                    scaled([start[0] - centre[0], start[1] - centre[1]]),
                    scaled(run),
                )
            }
        }
    }
}

/// Clips the segment at every side (Cyrus & Beck 1978).
fn entry_of_polygon(sides: &[([f64; 2], f64)], start: [f64; 2], run: [f64; 2]) -> Option<f64> {
    if sides
        .iter()
        .all(|(normal, offset)| dot(*normal, start) <= *offset)
    {
        return Some(0.0);
    }
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (normal, offset) in sides {
        let (outside, speed) = (dot(*normal, start) - offset, dot(*normal, run));
        if speed < 0.0 {
            from = from.max(-outside / speed);
        } else if speed > 0.0 {
            to = to.min(-outside / speed);
        } else if outside > 0.0 {
            return None;
        }
    }
    (from <= to).then_some(from)
}

/// Entry into the unit circle: the smaller root of |start + s run| = 1.
fn entry_of_circle(start: [f64; 2], run: [f64; 2]) -> Option<f64> {
    let c = dot(start, start) - 1.0;
    if c <= 0.0 {
        return Some(0.0);
    }
    let (a, b) = (dot(run, run), dot(start, run));
    let root = b * b - a * c;
    let s = -(b + root.max(0.0).sqrt()) / a;
    (root >= 0.0 && (0.0..=1.0).contains(&s)).then_some(s)
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Footprint {
        Footprint::polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    }

    #[test]
    fn entry_of_a_square_is_where_the_segment_meets_it() {
        assert_eq!(square().entry([1.0, 1.0], [9.0, 0.0]), Some(0.0));
        assert_eq!(square().entry([-1.0, 1.0], [2.0, 0.0]), Some(0.5));
        assert_eq!(square().entry([-1.0, 1.0], [0.5, 0.0]), None);
        assert_eq!(square().entry([-1.0, 3.0], [4.0, 0.0]), None);
        assert_eq!(square().entry([3.0, 1.0], [0.0, 0.0]), None);
    }

    #[test]
    fn entry_of_a_disc_is_where_the_segment_meets_it() {
        let disc = Footprint::new(&Part::Disc {
            radius: 2.0,
            centre: [1.0, 2.0],
        });
        assert_eq!(disc.entry([1.0, 3.9], [0.0, 1.0]), Some(0.0));
        let along = disc.entry([1.0, 8.0], [0.0, -8.0]).unwrap();
        assert!((along - 0.5).abs() < 1e-15);
        assert_eq!(disc.entry([1.0, 5.0], [0.0, 4.0]), None);
        assert_eq!(disc.entry([3.1, 5.0], [0.0, -4.0]), None);
    }
}
