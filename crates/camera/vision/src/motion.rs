//! Rigid motions of space: [`Motion`].

use nalgebra::{Matrix3, Vector3};

/// x ↦ R x + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) translation: Vector3<f64>,
}

impl Motion {
    /// Turns about the z axis by `angle` (rad), then moves.
    pub(crate) fn planar(angle: f64, translation: Vector3<f64>) -> Self {
        Self {
            rotation: rotation(Vector3::new(0.0, 0.0, angle)),
            translation,
        }
    }

    pub(crate) fn apply(&self, point: Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }

    /// This motion after `first`.
    pub(crate) fn after(&self, first: &Motion) -> Self {
        Self {
            rotation: self.rotation * first.rotation,
            translation: self.apply(first.translation),
        }
    }

    pub(crate) fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self {
            rotation,
            translation: -(rotation * self.translation),
        }
    }
}

/// The rotation about `vector` by its length (rad) (Rodrigues).
pub(crate) fn rotation(vector: Vector3<f64>) -> Matrix3<f64> {
    let angle = vector.norm();
    let cross = vector.cross_matrix();
    // sin a / a and (1 - cos a) / a² near zero
    let (first, second) = if angle < 1e-4 {
        (1.0 - angle * angle / 6.0, 0.5 - angle * angle / 24.0)
    } else {
        (
            libm::sin(angle) / angle,
            (1.0 - libm::cos(angle)) / (angle * angle),
        )
    };
    Matrix3::identity() + cross * first + cross * cross * second
}

/// The rotation nearest to a matrix (in the Frobenius norm); `None` for a singular one.
pub(crate) fn nearest_rotation(matrix: Matrix3<f64>) -> Option<Matrix3<f64>> {
    let svd = matrix.svd(true, true);
    let (u, v) = (svd.u?, svd.v_t?);
    if svd.singular_values[2] <= 1e-9 * svd.singular_values[0] {
        return None;
    }
    let turn = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant()));
    Some(u * turn * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand small turns make a large one.
    #[test]
    fn rotation_is_many_small_ones() {
        let vector = Vector3::new(0.4, -1.1, 0.7);
        let small = Matrix3::identity() + vector.cross_matrix() * 1e-6;
        let many = (0..20).fold(small, |power, _| power * power); // 2^20 turns
        let expected = rotation(vector * (1e-6 * f64::from(1 << 20)));
        assert!((many - expected).amax() < 1e-5);
        assert!(
            (rotation(vector * 1e-5) - (Matrix3::identity() + vector.cross_matrix() * 1e-5)).amax()
                < 1e-9
        );
    }

    #[test]
    fn nearest_rotation_undoes_scale_and_noise() {
        let turn = rotation(Vector3::new(0.3, 0.2, -0.9));
        assert!((nearest_rotation(turn * 2.0).unwrap() - turn).amax() < 1e-12);
        assert!(
            (nearest_rotation(turn.add_scalar(1e-3))
                .unwrap()
                .determinant()
                - 1.0)
                .abs()
                < 1e-12
        );
        assert_eq!(nearest_rotation(Matrix3::zeros()), None);
    }

    #[test]
    fn inverse_undoes_the_motion() {
        let motion = Motion {
            rotation: rotation(Vector3::new(0.3, 0.2, -0.9)),
            translation: Vector3::new(1.0, 2.0, 3.0),
        };
        let round = motion.inverse().after(&motion);
        assert!(
            (round.rotation - Matrix3::identity()).amax() < 1e-14
                && round.translation.amax() < 1e-14
        );
    }
}
