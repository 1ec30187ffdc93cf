//! Outlines of bodies: [`Outline`], the drawn lines of a union of parts.

use stickslip_dynamics::{Part, Pose, Shape};

/// Corners by which a full circle is drawn.
const TURN: usize = 48;

/// Distance outside a part's edge at which another part is sought, as a share of the shape's
/// bounding radius: an edge with a part beyond it is a seam.
const BESIDE: f64 = 1e-4;

/// A body in the plane (m): areas to fill and lines to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Closed polygons, counter-clockwise; together they cover the body.
    pub areas: Vec<Vec<[f64; 2]>>,
    /// Its boundary, without the seams between areas.
    pub lines: Vec<Vec<[f64; 2]>>,
}

impl Outline {
    /// The outline of a shape in its own frame.
    #[must_use]
    pub fn new(shape: &Shape) -> Self {
        let seamless = shape.parts().len() == 1;
        let longest = if seamless {
            f64::INFINITY
        } else {
            0.02 * shape.bounding_radius()
        };
        let areas: Vec<Vec<[f64; 2]>> = shape
            .parts()
            .iter()
            .map(|part| split(&corners(part), longest))
            .collect();
        let lines = areas.iter().enumerate().flat_map(|(own, area)| {
            if seamless {
                vec![closed(area)]
            } else {
                visible(shape, own, area)
            }
        });
        Self {
            lines: lines.collect(),
            areas: areas.clone(),
        }
    }

    /// The outline of a body at a pose.
    #[must_use]
    pub fn at(&self, pose: &Pose) -> Self {
        self.mapped(&|point| pose.transform(point))
    }

    /// Every point mapped.
    #[must_use]
    pub fn mapped(&self, map: &dyn Fn([f64; 2]) -> [f64; 2]) -> Self {
        let each = |lines: &[Vec<[f64; 2]>]| {
            lines
                .iter()
                .map(|line| line.iter().map(|point| map(*point)).collect())
                .collect()
        };
        Self {
            areas: each(&self.areas),
            lines: each(&self.lines),
        }
    }

    /// Corners of a box that holds it; `None` of nothing.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        bounds(self.areas.iter().flatten().copied())
    }
}

/// Corners of the box that holds all points whose numbers are finite.
pub(crate) fn bounds(points: impl Iterator<Item = [f64; 2]>) -> Option<[[f64; 2]; 2]> {
    let finite = points.filter(|point| point.iter().all(|value| value.is_finite()));
    finite.fold(None, |bounds: Option<[[f64; 2]; 2]>, [x, y]| {
        let [[left, low], [right, high]] = bounds.unwrap_or([[x, y], [x, y]]);
        Some([[left.min(x), low.min(y)], [right.max(x), high.max(y)]])
    })
}

fn corners(part: &Part) -> Vec<[f64; 2]> {
    match part {
        Part::Polygon { vertices } => vertices.clone(),
        Part::Disc { radius, centre } => circle(*radius, *centre),
    }
}

fn circle(radius: f64, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / TURN as f64);
        [x + radius * cos, y + radius * sin]
    };
    (0..TURN).map(corner).collect()
}

/// A closed polygon's edges cut into pieces of at most this length.
fn split(corners: &[[f64; 2]], longest: f64) -> Vec<[f64; 2]> {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let points = edges.flat_map(|([x0, y0], [x1, y1])| {
        let pieces = ((x1 - x0).hypot(y1 - y0) / longest)
            .ceil()
            .clamp(1.0, 1000.0);
        (0..pieces as u32).map(move |k| {
            let share = f64::from(k) / pieces;
            [x0 + share * (x1 - x0), y0 + share * (y1 - y0)]
        })
    });
    points.collect()
}

fn closed(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    corners.iter().chain(corners.first()).copied().collect()
}

/// The pieces of part `own`'s boundary that lie on the boundary of the union, joined to lines.
fn visible(shape: &Shape, own: usize, area: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let beside = BESIDE * shape.bounding_radius();
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    for (start, end) in area.iter().zip(area.iter().cycle().skip(1)) {
        let (dx, dy) = (end[0] - start[0], end[1] - start[1]);
        let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
        let outside = [
            0.5 * (start[0] + end[0]) + beside * dy / length,
            0.5 * (start[1] + end[1]) - beside * dx / length,
        ];
        // a seam between parts is not drawn
        if shape
            .parts()
            .iter()
            .enumerate()
            .any(|(part, other)| part != own && holds(other, outside))
        {
            continue;
        }
        match lines.last_mut() {
            Some(line) if line.last() == Some(start) => line.push(*end),
            _ => lines.push(vec![*start, *end]),
        }
    }
    lines
}

/// Returns true if a point lies in a part.
fn holds(part: &Part, [x, y]: [f64; 2]) -> bool {
    match part {
        Part::Polygon { vertices } => {
            let edges = vertices.iter().zip(vertices.iter().cycle().skip(1));
            edges
                .into_iter()
                .all(|([x0, y0], [x1, y1])| (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0) >= 0.0)
        }
        Part::Disc { radius, centre } => (x - centre[0]).hypot(y - centre[1]) <= *radius,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(lines: &[Vec<[f64; 2]>]) -> f64 {
        lines
            .iter()
            .flat_map(|line| line.windows(2))
            .map(|ends| (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]))
            .sum()
    }

    fn box_at(left: f64, width: f64) -> Part {
        Part::Polygon {
            vertices: vec![
                [left, 0.0],
                [left + width, 0.0],
                [left + width, 1.0],
                [left, 1.0],
            ],
        }
    }

    #[test]
    fn outline_of_one_part_is_its_boundary() {
        let square = Outline::new(&Shape::new(vec![box_at(0.0, 1.0)]).unwrap());
        assert_eq!(
            square.lines,
            [vec![
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, 1.0],
                [0.0, 1.0],
                [0.0, 0.0]
            ]]
        );
        let disc = Part::Disc {
            radius: 2.0,
            centre: [1.0, 0.0],
        };
        let disc = Outline::new(&Shape::new(vec![disc]).unwrap());
        assert_eq!(disc.bounds().unwrap()[1][0], 3.0);
        assert!((length(&disc.lines) / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn outline_leaves_seams_out() {
        // two squares side by side: the circumference of a 2 x 1 box, without the edge that they
        // share
        let boxes = Shape::new(vec![box_at(0.0, 1.0), box_at(1.0, 1.0)]).unwrap();
        assert!((length(&Outline::new(&boxes).lines) - 6.0).abs() < 1e-9);
        // a disc half sunk into a square: the square less its diameter, and half of the disc
        let sunk = Shape::new(vec![
            box_at(0.0, 1.0),
            Part::Disc {
                radius: 0.25,
                centre: [1.0, 0.5],
            },
        ])
        .unwrap();
        let expected = 4.0 - 0.5 + 0.25 * std::f64::consts::PI;
        assert!((length(&Outline::new(&sunk).lines) - expected).abs() < 0.03);
    }

    #[test]
    fn outline_is_moved_point_by_point() {
        let square = Outline::new(&Shape::new(vec![box_at(0.0, 1.0)]).unwrap());
        let turned = square.at(&Pose::new(10.0, 0.0, std::f64::consts::FRAC_PI_2));
        let [[left, low], [right, high]] = turned.bounds().unwrap();
        assert!(
            (left - 9.0).abs() < 1e-12
                && low.abs() < 1e-12
                && (right - 10.0).abs() < 1e-12
                && (high - 1.0).abs() < 1e-12
        );
    }
}
