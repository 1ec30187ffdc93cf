//! Frictional form closure of contacts: [`Cones`].

use stickslip_dynamics::ContactPoint;

/// Least component of a unit wrench against a plane.
const CLEAR: f64 = 1e-6;

/// Friction cones of an object's contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cones {
    /// Unit wrenches along their edges.
    edges: Vec<[f64; 3]>,
}

impl Cones {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.edges.clear();
    }

    /// Adds a contact of an object with the radius of gyration `rho` (m).
    pub fn add(&mut self, contact: &ContactPoint, rho: f64) {
        let edges = [1.0, -1.0].map(|side| edge(contact, side, rho));
        self.edges.extend(edges);
    }

    /// Returns true if forces within the cones can balance any load: their wrenches span all of
    /// force and torque with coefficients from 0 up.
    pub fn close(&self) -> bool {
        // a half-space that holds all of them has two of them in its boundary
        let mut planes = 0;
        for (k, a) in self.edges.iter().enumerate() {
            for b in &self.edges[k + 1..] {
                let normal = cross(a, b);
                let length = dot(&normal, &normal).sqrt();
                if length < CLEAR {
                    continue;
                }
                planes += 1;
                let heights = self.edges.iter().map(|edge| dot(&normal, edge) / length);
                let (low, high) = heights.fold((0.0, 0.0), |(low, high), height| {
                    (f64::min(low, height), f64::max(high, height))
                });
                if low > -CLEAR || high < CLEAR {
                    return false;
                }
            }
        }
        planes > 0
    }
}

/// Unit wrench, torque over ρ, of a force along an edge of a friction cone.
fn edge(contact: &ContactPoint, side: f64, rho: f64) -> [f64; 3] {
    let ([nx, ny], [rx, ry]) = (contact.normal, contact.arm);
    let slope = side * contact.mu;
    let force = [nx - slope * ny, ny + slope * nx];
    let wrench = [force[0], force[1], (rx * force[1] - ry * force[0]) / rho];
    let length = dot(&wrench, &wrench).sqrt();
    wrench.map(|x| x / length)
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contacts at these angles (rad) on a disc of 30 mm, each `aside` (m) of its radius.
    fn on_disc(angles: &[f64], mu: f64, aside: f64) -> bool {
        let contact = |angle: &f64| {
            let (sin, cos) = libm::sincos(*angle);
            ContactPoint {
                normal: [-cos, -sin],
                arm: [0.03 * cos - aside * sin, 0.03 * sin + aside * cos],
                gap: 0.0,
                mu,
                surface_velocity: [0.0; 2],
                yields: None,
            }
        };
        let mut cones = Cones::default();
        for angle in angles {
            cones.add(&contact(angle), 0.02);
        }
        cones.close()
    }

    #[test]
    fn two_contacts_close_where_the_line_between_them_is_within_both_cones() {
        let opposite = [0.0, std::f64::consts::PI];
        assert!(on_disc(&opposite, 0.3, 0.0));
        assert!(!on_disc(&opposite, 0.0, 0.0), "nothing stops a turn");
        // the line between them leans by aside / 0.03
        assert!(on_disc(&opposite, 0.3, 0.0089) && !on_disc(&opposite, 0.3, 0.0091));
        assert!(!on_disc(&[0.0], 0.9, 0.0) && !on_disc(&[], 0.3, 0.0));
        // each leans by half of what they are off the diameter
        assert!(on_disc(&[0.0, std::f64::consts::PI - 0.58], 0.3, 0.0));
        assert!(!on_disc(&[0.0, std::f64::consts::PI - 0.60], 0.3, 0.0));
    }

    #[test]
    fn three_contacts_about_a_disc_close_with_friction() {
        let third = std::f64::consts::TAU / 3.0;
        assert!(on_disc(&[0.0, third, 2.0 * third], 0.1, 0.0));
        assert!(!on_disc(&[0.0, third, 2.0 * third], 0.0, 0.0));
        assert!(!on_disc(&[0.0, 0.5, 1.0], 0.3, 0.0));
    }
}
