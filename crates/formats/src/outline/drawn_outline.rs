//! An object's outline, cut into convex parts: [`Outline`].

use std::fmt;

use stickslip_dynamics::{Part, Shape};

use crate::number;
use crate::outline::contours::{closed_contours, contains, crossing, edges, twice_area};
use crate::outline::decompose::convex_parts;
use crate::outline::error::OutlineProblem;
use crate::outline::{OutlineOptions, Point};
use crate::scene::NEW_SCENE;

/// Coordinates are rounded to this (m), a hundredth of the resolution of a camera.
const ROUNDED: f64 = 1e-7;
/// Most vertices of an outline that has to be cut, and most parts of a scene's shape.
const MOST_VERTICES: usize = 1000;
const MOST_PARTS: usize = 200;

/// Lines that enclose less than half of this (m²) enclose nothing.
const LEAST_AREA: f64 = 1e-9;

/// The unit of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawnUnit {
    /// The drawing's own, as `mm`.
    Said(&'static str),
    /// SVG's own, a 96th of an inch, in a drawing that says no other.
    Pixel,
    /// The given one, in metres.
    Given(f64),
}

/// The outline of an object, in its frame: the origin in the middle of its area.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Convex polygons, counter-clockwise, that share edges (m).
    pub parts: Vec<Vec<[f64; 2]>>,
    /// Vertices of the outline.
    pub vertices: usize,
    /// Width and height (m).
    pub size: [f64; 2],
    /// Its area without its holes (m²).
    pub area: f64,
    /// Its holes, which are not among the parts.
    pub holes: usize,
    /// Place of the origin in the drawing, y up (m).
    pub centre: [f64; 2],
    /// The drawing's unit.
    pub unit: DrawnUnit,
}

impl Outline {
    /// The outline that lines of a drawing (m, y up) enclose.
    pub(super) fn of(
        lines: Vec<Vec<Point>>,
        unit: DrawnUnit,
        options: &OutlineOptions,
    ) -> Result<Self, OutlineProblem> {
        let mut contours = closed_contours(lines, options.tolerance / 4.0)?;
        contours.retain(|contour| twice_area(contour).abs() > LEAST_AREA);
        let size_of = |contour: &Vec<Point>| twice_area(contour).abs();
        let outer = contours
            .iter()
            .max_by(|a, b| size_of(a).total_cmp(&size_of(b)));
        let outer = outer.ok_or(OutlineProblem::Nothing)?;
        let others: Vec<&Vec<Point>> = contours.iter().filter(|other| *other != outer).collect();
        let beside = others
            .iter()
            .filter(|other| !contains(outer, other[0]))
            .count();
        if beside > 0 {
            return Err(OutlineProblem::Several { count: beside + 1 });
        }
        let size = extent(outer);
        if size.iter().any(|side| !(1e-4..10.0).contains(side)) {
            return Err(OutlineProblem::Size { size });
        }
        let whole = Moments::of(outer);
        let solid = others
            .iter()
            .fold(whole, |solid, hole| solid.without(Moments::of(hole)));
        let centre = solid.centre();
        let polygon = rounded(outer, centre);
        Ok(Self {
            parts: cut(&polygon)?,
            vertices: polygon.len(),
            size,
            area: solid.area,
            holes: others.len(),
            centre,
            unit,
        })
    }

    /// The value of `shape` in `scene.toml`.
    #[must_use]
    pub fn toml(&self) -> String {
        let vertex = |[x, y]: &Point| format!("[{}, {}]", number::text(*x), number::text(*y));
        let part = |part: &Vec<Point>| {
            let vertices: Vec<String> = part.iter().map(vertex).collect();
            format!("  {{ polygon = [{}] }},\n", vertices.join(", "))
        };
        format!("[\n{}]", self.parts.iter().map(part).collect::<String>())
    }

    /// [`NEW_SCENE`] with this shape for the object.
    #[must_use]
    pub fn scene(&self) -> String {
        let shape = |line: &&str| line.starts_with("shape = ");
        let Some(example) = NEW_SCENE.lines().find(shape) else {
            panic!("the scene to begin with has a shape")
        };
        NEW_SCENE.replacen(example, &format!("shape = {}", self.toml()), 1)
    }
}

impl fmt::Display for DrawnUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Said(unit) => write!(f, "{unit}, as it says"),
            Self::Pixel => f.write_str("pixels of 1/96 inch, since it says no other"),
            Self::Given(metres) => write!(f, "units of {metres} m, as given"),
        }
    }
}

/// Area and its first moments.
#[derive(Clone, Copy)]
struct Moments {
    area: f64,
    first: Point,
}

impl Moments {
    /// Of the area that a contour encloses, whichever way it runs.
    fn of(contour: &[Point]) -> Self {
        // about its first point, so that nothing cancels far from the drawing's origin
        let [x0, y0] = contour[0];
        let (mut twice, mut sum) = (0.0, [0.0; 2]);
        for [p, q] in edges(contour) {
            let ([px, py], [qx, qy]) = ([p[0] - x0, p[1] - y0], [q[0] - x0, q[1] - y0]);
            let cross = px * qy - qx * py;
            twice += cross;
            sum = [sum[0] + cross * (px + qx), sum[1] + cross * (py + qy)];
        }
        let area = 0.5 * twice.abs();
        let centre = [x0 + sum[0] / (3.0 * twice), y0 + sum[1] / (3.0 * twice)];
        Self {
            area,
            first: centre.map(|x| area * x),
        }
    }

    fn without(self, hole: Self) -> Self {
        Self {
            area: self.area - hole.area,
            first: [self.first[0] - hole.first[0], self.first[1] - hole.first[1]],
        }
    }

    fn centre(&self) -> Point {
        self.first.map(|first| first / self.area)
    }
}

/// Width and height.
fn extent(contour: &[Point]) -> Point {
    [0, 1].map(|k| {
        let low = contour.iter().map(|p| p[k]).fold(f64::MAX, f64::min);
        contour.iter().map(|p| p[k]).fold(f64::MIN, f64::max) - low
    })
}

/// The contour about `centre`, counter-clockwise, its coordinates rounded, without points that lie
/// on the line of their neighbours.
fn rounded(contour: &[Point], centre: Point) -> Vec<Point> {
    let near = |x: f64| (x / ROUNDED).round() * ROUNDED;
    let mut points: Vec<Point> = contour
        .iter()
        .map(|p| [near(p[0] - centre[0]), near(p[1] - centre[1])])
        .collect();
    if twice_area(&points) < 0.0 {
        points.reverse();
    }
    points.dedup();
    let mut k = 0;
    let mut kept = 0;
    while points.len() > 3 && kept < points.len() {
        let n = points.len();
        let [a, b, c] = [points[(k + n - 1) % n], points[k % n], points[(k + 1) % n]];
        let chord = libm::hypot(c[0] - a[0], c[1] - a[1]);
        let off = (c[0] - a[0]) * (b[1] - a[1]) - (c[1] - a[1]) * (b[0] - a[0]);
        // rounding alone bends a straight line by this much
        if off.abs() <= 2.0 * ROUNDED * chord {
            points.remove(k % n);
            kept = 0;
            k = k.min(points.len()) + points.len() - 1;
        } else {
            kept += 1;
            k += 1;
        }
        k %= points.len();
    }
    points
}

/// The convex parts of a polygon, which a scene takes.
fn cut(polygon: &[Point]) -> Result<Vec<Vec<Point>>, OutlineProblem> {
    let fine = |parts: usize, most: &'static str| OutlineProblem::Fine {
        vertices: polygon.len(),
        parts,
        most,
    };
    if polygon.len() > MOST_VERTICES {
        return Err(fine(0, "1000"));
    }
    if let Some(at) = crossing(polygon) {
        return Err(OutlineProblem::Crossing { at });
    }
    let is_shape = |parts: &[Vec<Point>]| {
        let part = |vertices: &Vec<Point>| Part::Polygon {
            vertices: vertices.clone(),
        };
        Shape::new(parts.iter().map(part).collect()).is_ok()
    };
    let whole = vec![polygon.to_vec()];
    if is_shape(&whole) {
        return Ok(whole);
    }
    let parts = convex_parts(polygon)?;
    match parts.len() {
        count if count > MOST_PARTS => Err(fine(count, "200 parts")),
        _ if !is_shape(&parts) => Err(OutlineProblem::Crossing { at: polygon[0] }),
        _ => Ok(parts),
    }
}
