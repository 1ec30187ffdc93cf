//! A pose on the table from the corners of a tag: [`Measurement`].
//!
//! The print of a tag lies in a plane of known height, at a known place on its body. So its four
//! corners are functions of the body's planar pose and of the black square's size: x ↦
//! lens(camera(pose ∘ place(corner))). The size is left free: ink that spreads, exposure and blur
//! move all four edges alike, and no pose must follow them.
//!
//! Gauss–Newton on the corners' ideal pixels, weighted by their covariance C, gives the pose, its
//! covariance (JᵀC⁻¹J)⁻¹, and χ² with 4 degrees of freedom: 8 coordinates less 4 unknowns. Where
//! χ² / 4 is above 1 the corners are off by more than their noise, and the covariance is scaled by
//! it (Birge 1932).

use nalgebra::{Matrix3, SMatrix, SVector, Vector2};
use stickslip_dynamics::Pose;

use crate::camera::Camera;
use crate::outline::Square;

/// Error of a fitted corner besides its noise: the blur is not exactly that of the model (px).
const MODEL_STD: f64 = 0.005;
/// Corners off by more than this, and by more than their noise explains, are not those of a square
/// on the plane (px).
const WORST_MISFIT: f64 = 0.2;
/// Ratio to the standard deviation of their noise above which corners are off by more than noise
/// explains.
const NOISE: f64 = 5.0;
/// Degrees of freedom: coordinates of four corners less the numbers of a pose and a size.
const FREEDOM: f64 = 4.0;
/// The iteration ends with a step below this (m, rad).
const NEGLIGIBLE: f64 = 1e-12;
const ITERATIONS: usize = 20;

/// Place of a tag's print on its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TagPlace {
    /// Edge of the black square (m).
    pub size: f64,
    /// Height of the print above the table (m).
    pub height: f64,
    /// Pose of the tag's frame (origin in its middle, x right and y up as printed) in the body's
    /// frame.
    pub pose: Pose,
}

/// A measured pose of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The pose in the world; its angle in (-π, π].
    pub pose: Pose,
    /// Covariance of (x, y, θ) (m², m rad, rad²).
    pub covariance: Matrix3<f64>,
    /// Edge of the black square as measured (m); where it is far from the given one, the given size
    /// or height is wrong.
    pub size: f64,
    /// Squared misfit of the corners in units of their noise, 4 degrees of freedom.
    pub chi2: f64,
}

/// Corners compared with those that a pose predicts.
struct Fit {
    residual: SVector<f64, 8>,
    /// By x, y, θ and size.
    jacobian: SMatrix<f64, 8, 4>,
}

impl Measurement {
    /// The body's pose from the corners of its tag; `None` where they are not those of a square on
    /// its plane.
    pub(crate) fn of(square: &Square, place: &TagPlace, camera: &Camera) -> Option<Self> {
        let weight =
            (square.covariance + SMatrix::identity() * (MODEL_STD * MODEL_STD)).try_inverse()?;
        let (mut pose, mut size) = (first_pose(square, place, camera)?, place.size);
        for _ in 0..ITERATIONS {
            let Fit { residual, jacobian } =
                Fit::new(&pose, square, &TagPlace { size, ..*place }, camera)?;
            let information = jacobian.transpose() * weight * jacobian;
            let step = information
                .cholesky()?
                .solve(&(jacobian.transpose() * weight * residual));
            pose = Pose::new(pose.x + step[0], pose.y + step[1], pose.theta + step[2]);
            size += step[3];
            if step.amax() < NEGLIGIBLE {
                let chi2 = (residual.transpose() * weight * residual).x;
                let tolerance = WORST_MISFIT.max(NOISE * square.covariance.diagonal().max().sqrt());
                let covariance =
                    information.try_inverse()?.fixed_view::<3, 3>(0, 0) * (chi2 / FREEDOM).max(1.0);
                return (residual.amax() <= tolerance).then(|| Self {
                    pose: wrapped(pose),
                    covariance,
                    size,
                    chi2,
                });
            }
        }
        None
    }

    /// Standard deviations of x, y (m) and θ (rad).
    pub fn std(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.covariance[(k, k)].sqrt())
    }
}

impl Fit {
    fn new(pose: &Pose, square: &Square, place: &TagPlace, camera: &Camera) -> Option<Self> {
        let mut fit = Self {
            residual: SVector::zeros(),
            jacobian: SMatrix::zeros(),
        };
        for (k, (local, seen)) in place.corners().into_iter().zip(square.corners).enumerate() {
            let on_body = place.pose.transform(local);
            let arm = pose.rotate(on_body);
            let (ideal, by_plane) =
                camera.ideal([pose.x + arm[0], pose.y + arm[1], place.height])?;
            fit.residual
                .fixed_rows_mut::<2>(2 * k)
                .copy_from(&(seen - ideal));
            fit.jacobian
                .fixed_view_mut::<2, 2>(2 * k, 0)
                .copy_from(&by_plane);
            fit.jacobian
                .fixed_view_mut::<2, 1>(2 * k, 2)
                .copy_from(&(by_plane * Vector2::new(-arm[1], arm[0])));
            let by_size = Pose::new(0.0, 0.0, pose.theta + place.pose.theta)
                .rotate(local.map(|x| x / place.size));
            fit.jacobian
                .fixed_view_mut::<2, 1>(2 * k, 3)
                .copy_from(&(by_plane * Vector2::from(by_size)));
        }
        Some(fit)
    }
}

impl TagPlace {
    /// Corners of the black square in the tag's frame (m), anti-clockwise from the lower left.
    fn corners(&self) -> [[f64; 2]; 4] {
        let half = self.size / 2.0;
        [[-half, -half], [half, -half], [half, half], [-half, half]]
    }
}

/// The pose that puts the tag where its corners are seen on its plane.
fn first_pose(square: &Square, place: &TagPlace, camera: &Camera) -> Option<Pose> {
    let mut on_plane = [Vector2::zeros(); 4];
    for (point, seen) in on_plane.iter_mut().zip(square.corners) {
        *point = camera.on_plane(seen, place.height)?;
    }
    let middle = on_plane.iter().fold(Vector2::zeros(), |sum, p| sum + p) / 4.0;
    let right = on_plane[1] - on_plane[0] + on_plane[2] - on_plane[3];
    let theta = libm::atan2(right.y, right.x) - place.pose.theta;
    let arm = Pose::new(0.0, 0.0, theta).rotate([place.pose.x, place.pose.y]);
    Some(Pose::new(middle.x - arm[0], middle.y - arm[1], theta))
}

/// Wraps the pose's angle to (-π, π].
fn wrapped(pose: Pose) -> Pose {
    use std::f64::consts::{PI, TAU};
    Pose {
        theta: PI - libm::fmod(libm::fmod(PI - pose.theta, TAU) + TAU, TAU),
        ..pose
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use stickslip_filter::Streams;

    use super::*;
    use crate::camera::tests::camera;

    const PLACE: TagPlace = TagPlace {
        size: 0.028,
        height: 0.02,
        pose: Pose {
            x: 0.004,
            y: -0.007,
            theta: 0.6,
        },
    };

    /// The squared error in units of the predicted covariance.
    fn whitened(measurement: &Measurement, truth: Pose) -> f64 {
        let error = Vector3::new(
            measurement.pose.x - truth.x,
            measurement.pose.y - truth.y,
            measurement.pose.theta - truth.theta,
        );
        (error.transpose() * measurement.covariance.try_inverse().unwrap() * error).x
    }

    fn square(pose: Pose, std: f64, noise: &[f64; 8]) -> Square {
        let seen = |k: usize| {
            let [x, y] = pose.transform(PLACE.pose.transform(PLACE.corners()[k]));
            camera().ideal([x, y, PLACE.height]).unwrap().0
                + Vector2::new(noise[2 * k], noise[2 * k + 1]) * std
        };
        Square {
            corners: [0, 1, 2, 3].map(seen),
            covariance: SMatrix::identity() * (std * std - MODEL_STD * MODEL_STD),
        }
    }

    #[test]
    fn measurement_of_exact_corners_is_exact() {
        for pose in [
            Pose::new(0.05, -0.03, 0.4),
            Pose::new(-0.06, 0.02, -2.9),
            Pose::new(0.0, 0.0, std::f64::consts::PI),
        ] {
            let found = Measurement::of(&square(pose, 0.05, &[0.0; 8]), &PLACE, &camera()).unwrap();
            assert!(
                (found.pose.x - pose.x).abs() < 1e-12 && (found.pose.y - pose.y).abs() < 1e-12,
                "{found:?}"
            );
            assert!(
                (found.pose.theta - pose.theta).abs() < 1e-11 && found.chi2 < 1e-9,
                "{found:?}"
            );
        }
    }

    /// Over many draws, misfits have mean 4, and squared errors in units of the predicted
    /// covariance 3 times the mean of 1 / max(1, misfit / 4), which for χ² with 4 degrees of
    /// freedom is 1 - e⁻².
    #[test]
    fn measurement_has_the_covariance_of_its_errors() {
        const DRAWS: u64 = 4000;
        let truth = Pose::new(0.05, -0.03, 0.4);
        let (mut errors, mut misfits) = (0.0, 0.0);
        for draw in 0..DRAWS {
            let found = Measurement::of(
                &square(truth, 0.1, &Streams::new(5).at(draw).normals(0, 0)),
                &PLACE,
                &camera(),
            )
            .unwrap();
            errors += whitened(&found, truth) / DRAWS as f64;
            misfits += found.chi2 / DRAWS as f64;
        }
        // five standard errors: sqrt(2 k / draws) of a chi-squared variable
        let expected = 3.0 * (1.0 - libm::exp(-2.0));
        assert!(
            (errors - expected).abs() < 5.0 * (6.0 / DRAWS as f64).sqrt(),
            "{errors}"
        );
        assert!(
            (misfits - 4.0).abs() < 5.0 * (8.0 / DRAWS as f64).sqrt(),
            "{misfits}"
        );
    }

    #[test]
    fn wrapped_angles_are_the_same_direction() {
        use std::f64::consts::PI;
        for (theta, expected) in [
            (0.3, 0.3),
            (PI, PI),
            (-PI, PI),
            (4.0, 4.0 - 2.0 * PI),
            (-9.0, -9.0 + 2.0 * PI),
            (20.0, 20.0 - 6.0 * PI),
        ] {
            assert!(
                (wrapped(Pose::new(0.0, 0.0, theta)).theta - expected).abs() < 1e-12,
                "{theta}"
            );
        }
    }
}
