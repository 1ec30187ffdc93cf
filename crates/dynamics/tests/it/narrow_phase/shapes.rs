//! Shapes, random numbers and shorthands for the tests.

use stickslip_dynamics::{Gap, Part, Placed, Pose, Shape, narrow_phase};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// A pose in the square of half side `size` (m).
    pub fn pose(&mut self, size: f64) -> Pose {
        Pose::new(
            self.range(-size, size),
            self.range(-size, size),
            self.range(-7.0, 7.0),
        )
    }
}

pub fn shape(parts: Vec<Part>) -> Shape {
    Shape::new(parts).expect("a valid shape")
}

pub fn polygon(vertices: &[[f64; 2]]) -> Part {
    Part::Polygon {
        vertices: vertices.to_vec(),
    }
}

pub fn rectangle(x: [f64; 2], y: [f64; 2]) -> Part {
    polygon(&[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
}

pub fn disc(radius: f64, centre: [f64; 2]) -> Part {
    Part::Disc { radius, centre }
}

/// A convex polygon of 3 to 8 corners on an ellipse of random axes.
pub fn random_polygon(random: &mut Random) -> Part {
    let count = 3 + random.below(6);
    polygon_of(count, random)
}

/// A convex polygon of 16 to 79 corners on an ellipse of random axes.
pub fn random_polygon_of_many(random: &mut Random) -> Part {
    let count = 16 + random.below(64);
    polygon_of(count, random)
}

fn polygon_of(count: usize, random: &mut Random) -> Part {
    let axes = [random.range(0.01, 0.05), random.range(0.01, 0.05)];
    let centre = [random.range(-0.01, 0.01), random.range(-0.01, 0.01)];
    let start = random.range(0.0, 6.0);
    let vertex = |k: usize, jitter: f64| {
        let (sin, cos) =
            libm::sincos(start + std::f64::consts::TAU * (k as f64 + jitter) / count as f64);
        [centre[0] + axes[0] * cos, centre[1] + axes[1] * sin]
    };
    polygon(
        &(0..count)
            .map(|k| vertex(k, random.range(-0.4, 0.4)))
            .collect::<Vec<_>>(),
    )
}

/// A polygon whose corners are rounded over `reach` (m) along both their edges, in so many steps.
pub fn filleted(part: &Part, reach: f64, steps: usize) -> Part {
    let Part::Polygon { vertices } = part else {
        panic!("no polygon: {part:?}")
    };
    let n = vertices.len();
    let fillet = |k: usize| {
        let corner = vertices[k];
        let towards = |other: [f64; 2]| {
            let d = [other[0] - corner[0], other[1] - corner[1]];
            let share = reach / d[0].hypot(d[1]);
            [corner[0] + share * d[0], corner[1] + share * d[1]]
        };
        let (from, to) = (
            towards(vertices[(k + n - 1) % n]),
            towards(vertices[(k + 1) % n]),
        );
        // a parabola that leaves along one edge and arrives along the other
        (0..=steps).map(move |i| {
            let b = i as f64 / steps as f64;
            let a = 1.0 - b;
            [0, 1].map(|j| a * a * from[j] + 2.0 * a * b * corner[j] + b * b * to[j])
        })
    };
    polygon(&(0..n).flat_map(fillet).collect::<Vec<_>>())
}

/// All contacts whose gap is below `search_distance` (m).
pub fn contacts(object: (&Shape, Pose), other: (&Shape, Pose), search_distance: f64) -> Vec<Gap> {
    let mut gaps = Vec::new();
    narrow_phase(
        &Placed::new(object.0, object.1),
        &Placed::new(other.0, other.1),
        search_distance,
        &mut gaps,
    );
    gaps
}

pub fn smallest(gaps: &[Gap]) -> f64 {
    gaps.iter().map(|gap| gap.gap).fold(f64::INFINITY, f64::min)
}

/// Returns true if both are equal in any order, to `tolerance` (m, and in the normals).
pub fn same(a: &[Gap], b: &[Gap], tolerance: f64) -> bool {
    let near = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]) <= tolerance;
    let equal = |p: &Gap, q: &Gap| {
        (p.gap - q.gap).abs() <= tolerance && near(p.normal, q.normal) && near(p.arm, q.arm)
    };
    a.len() == b.len() && a.iter().all(|p| b.iter().any(|q| equal(p, q)))
}
