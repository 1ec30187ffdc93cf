//! Centroid and moment of inertia of parts of even thickness: [`MassProperties`].

use stickslip_dynamics::Part;

use stickslip_testkit::cross;

/// Integrals over an area.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MassProperties {
    /// Area (m²); where parts overlap it counts twice.
    pub area: f64,
    /// Its first moments about the axes (m³).
    first: [f64; 2],
    /// Its polar second moment about the frame's origin (m⁴).
    second: f64,
}

impl MassProperties {
    /// Of all parts together.
    pub fn of(parts: &[Part]) -> Self {
        parts
            .iter()
            .map(Self::of_part)
            .fold(Self::default(), Self::plus)
    }

    /// Centre of the area (m).
    pub fn centroid(&self) -> [f64; 2] {
        self.first.map(|moment| moment / self.area)
    }

    /// Square of the radius of gyration about the centroid (m²).
    pub fn gyration_squared(&self) -> f64 {
        let [x, y] = self.centroid();
        self.second / self.area - x * x - y * y
    }

    fn plus(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            first: [
                self.first[0] + other.first[0],
                self.first[1] + other.first[1],
            ],
            second: self.second + other.second,
        }
    }

    fn of_part(part: &Part) -> Self {
        match part {
            Part::Polygon { vertices } => (0..vertices.len())
                .map(|k| Self::of_triangle(vertices[k], vertices[(k + 1) % vertices.len()]))
                .fold(Self::default(), Self::plus),
            Part::Disc { radius, centre } => Self::of_disc(*radius, *centre),
        }
    }

    /// Of the triangle (0, a, b), negative where it is clockwise.
    fn of_triangle(a: [f64; 2], b: [f64; 2]) -> Self {
        let area = 0.5 * cross(a, b);
        let squares = |k: usize| a[k] * a[k] + a[k] * b[k] + b[k] * b[k];
        Self {
            area,
            first: [0, 1].map(|k| area * (a[k] + b[k]) / 3.0),
            second: area * (squares(0) + squares(1)) / 6.0,
        }
    }

    fn of_disc(radius: f64, [x, y]: [f64; 2]) -> Self {
        let area = std::f64::consts::PI * radius * radius;
        Self {
            area,
            first: [area * x, area * y],
            second: area * (radius * radius / 2.0 + x * x + y * y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_shifted_rectangle_and_disc_is_the_textbook_one() {
        let vertices = vec![[1.0, 2.0], [5.0, 2.0], [5.0, 4.0], [1.0, 4.0]];
        let rectangle = MassProperties::of(&[Part::Polygon { vertices }]);
        assert!((rectangle.area - 8.0).abs() < 1e-14);
        assert_eq!(rectangle.centroid(), [3.0, 3.0]);
        assert!((rectangle.gyration_squared() - (16.0 + 4.0) / 12.0).abs() < 1e-13);
        let disc = MassProperties::of(&[Part::Disc {
            radius: 2.0,
            centre: [-3.0, 1.0],
        }]);
        assert!((disc.gyration_squared() - 2.0).abs() < 1e-14);
    }
}
