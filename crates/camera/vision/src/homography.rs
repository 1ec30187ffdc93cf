//! The projective map from a plane to an image: [`homography`], and a lens from several:
//! [`focal_length`] (Zhang 2000).

use nalgebra::{Matrix3, SMatrix, Vector2, Vector3};

use crate::motion::{Motion, nearest_rotation};

/// A point of the plane and where it is seen.
pub(crate) type Match = (Vector2<f64>, Vector2<f64>);

/// The map H with (image, 1) ~ H (plane, 1), from four or more matches: the direct linear transform
/// on normalised points (Hartley & Zisserman 2004, algorithm 4.2). `None` where the points do not
/// fix it.
pub(crate) fn homography(matches: &[Match]) -> Option<Matrix3<f64>> {
    let plane = normaliser(matches.iter().map(|m| m.0))?;
    let image = normaliser(matches.iter().map(|m| m.1))?;
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (on_plane, in_image) in matches {
        let p = plane * on_plane.push(1.0);
        let [u, v] = (image * in_image.push(1.0)).xy().into();
        for row in [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -u * p.x, -u * p.y, -u],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -v * p.x, -v * p.y, -v],
        ] {
            let row = SMatrix::<f64, 9, 1>::from(row);
            normal += row * row.transpose();
        }
    }
    let eigen = normal.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    // one vector without image, no more
    let free = eigen
        .eigenvalues
        .iter()
        .filter(|value| **value < 1e-9 * eigen.eigenvalues.amax())
        .count();
    if free > 1 {
        return None;
    }
    let h = eigen.eigenvectors.column(least);
    let normalised = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8]);
    Some(image.try_inverse()? * normalised * plane)
}

/// The similarity that brings points about the origin, their mean distance from it √2; `None` where
/// all are one point.
fn normaliser(points: impl Iterator<Item = Vector2<f64>> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let middle = points.clone().fold(Vector2::zeros(), |sum, p| sum + p) / count;
    let spread = points.fold(0.0, |sum, p| sum + (p - middle).norm()) / count;
    let scale = std::f64::consts::SQRT_2 / spread;
    scale.is_finite().then(|| {
        Matrix3::new(
            scale,
            0.0,
            -scale * middle.x,
            0.0,
            scale,
            -scale * middle.y,
            0.0,
            0.0,
            1.0,
        )
    })
}

/// The focal length f (px) of a camera without distortion whose axis is at `centre`, from
/// homographies of planes with right angles and equal scales; `None` where they do not show it: no
/// plane is tilted.
///
/// With ω = diag(1, 1, f²) and the centre moved to the origin, every H has h₁ᵀ ω h₂ = 0 and h₁ᵀ ω
/// h₁ = h₂ᵀ ω h₂: least squares in 1/f².
pub(crate) fn focal_length(maps: &[Matrix3<f64>], centre: Vector2<f64>) -> Option<f64> {
    let to_origin = Matrix3::new(1.0, 0.0, -centre.x, 0.0, 1.0, -centre.y, 0.0, 0.0, 1.0);
    let (mut products, mut squares) = (0.0, 0.0);
    for map in maps {
        let map = to_origin * map / map.norm();
        let (a, b) = (map.column(0), map.column(1));
        let equations = [
            (a.x * b.x + a.y * b.y, a.z * b.z),
            (
                a.x * a.x + a.y * a.y - b.x * b.x - b.y * b.y,
                a.z * a.z - b.z * b.z,
            ),
        ];
        for (of_inverse_square, constant) in equations {
            products -= of_inverse_square * constant;
            squares += of_inverse_square * of_inverse_square;
        }
    }
    let inverse_square = products / squares;
    (inverse_square > 0.0 && inverse_square.is_finite()).then(|| 1.0 / inverse_square.sqrt())
}

/// The motion from a plane's frame to the camera's, from its homography to directions (x, y, 1),
/// the plane before the camera.
pub(crate) fn plane_motion(map: Matrix3<f64>) -> Option<Motion> {
    let scale = (map.column(0).norm() + map.column(1).norm()) / 2.0 * map[(2, 2)].signum();
    let [a, b, translation]: [Vector3<f64>; 3] = [0, 1, 2].map(|k| map.column(k) / scale);
    let rotation = nearest_rotation(Matrix3::from_columns(&[a, b, a.cross(&b)]))?;
    Some(Motion {
        rotation,
        translation,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::rotation;

    const FOCAL: f64 = 800.0;
    const CENTRE: Vector2<f64> = Vector2::new(320.0, 240.0);

    fn motion(tilt: Vector3<f64>) -> Motion {
        let down = rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        Motion {
            rotation: rotation(tilt) * down,
            translation: Vector3::new(-0.05, 0.03, 0.5),
        }
    }

    fn map(tilt: Vector3<f64>) -> Matrix3<f64> {
        let matches: Vec<Match> = (0..30)
            .map(|k| {
                let on_plane = Vector2::new(0.03 * f64::from(k % 6), 0.03 * f64::from(k / 6));
                let at = motion(tilt).apply(on_plane.push(0.0));
                (on_plane, at.xy() / at.z * FOCAL + CENTRE)
            })
            .collect();
        homography(&matches).unwrap()
    }

    #[test]
    fn focal_length_and_motion_come_back_from_exact_points() {
        let tilts = [
            Vector3::new(0.4, 0.1, 0.2),
            Vector3::new(-0.2, 0.5, 0.0),
            Vector3::new(0.1, -0.4, -0.3),
        ];
        let focal = focal_length(&tilts.map(map), CENTRE).unwrap();
        assert!((focal - FOCAL).abs() < 1e-6, "{focal}");
        let to_direction =
            Matrix3::new(1.0, 0.0, -CENTRE.x, 0.0, 1.0, -CENTRE.y, 0.0, 0.0, FOCAL) / FOCAL;
        for tilt in tilts {
            let found = plane_motion(to_direction * map(tilt)).unwrap();
            assert!(
                (found.rotation - motion(tilt).rotation).amax() < 1e-9
                    && (found.translation - motion(tilt).translation).amax() < 1e-9
            );
        }
    }

    #[test]
    fn homography_of_points_on_a_line_is_none() {
        let line: Vec<Match> = (0..8)
            .map(|k| {
                (
                    Vector2::new(f64::from(k), 1.0),
                    Vector2::new(f64::from(2 * k), 3.0),
                )
            })
            .collect();
        assert_eq!(homography(&line), None);
        assert_eq!(homography(&[(Vector2::zeros(), Vector2::zeros()); 4]), None);
    }
}
