//! Bundle adjustment: a lens and the poses of a plane from where its points are seen, [`Bundle`].
//!
//! The normal equations have the shape of an arrow: a block of the lens's 8 numbers, one of 6 for
//! every view, nothing between views. The views are eliminated (Schur complement), which leaves 8
//! equations; their inverse is the lens's covariance.

use nalgebra::{Matrix2x3, Matrix3, SMatrix, SVector, Vector2, Vector3};

use crate::homography::Match;
use crate::lens::{Lens, PARAMETERS};
use crate::levenberg_marquardt::{LeastSquares, Minimum, Rules, Step, minimise};
use crate::motion::{Motion, rotation};

type LensBlock = SMatrix<f64, PARAMETERS, PARAMETERS>;

pub(crate) const RULES: Rules = Rules {
    damping: 1e-4,
    most_damping: 1e8,
    least_decrease: 1e-12,
    iterations: 100,
};

/// A plane seen once.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// From the plane's frame to the camera's.
    pub(crate) motion: Motion,
    /// Points of the plane (m) and where they are seen (px).
    pub(crate) matches: Vec<Match>,
}

/// A lens with views through it.
#[derive(Clone, Debug)]
pub(crate) struct Bundle {
    pub(crate) lens: Lens,
    pub(crate) views: Vec<View>,
}

/// Best fit of a bundle.
#[derive(Clone, Debug)]
pub(crate) struct Adjusted {
    pub(crate) bundle: Bundle,
    /// Root mean square residual of a coordinate (px), by the degrees of freedom.
    pub(crate) rms: f64,
    /// Standard deviations of the lens's numbers fx, fy, cx, cy, k1, k2, p1, p2.
    pub(crate) lens_std: [f64; PARAMETERS],
}

/// The equations of one view.
#[derive(Clone, Debug)]
pub(crate) struct ViewEquations {
    lens: LensBlock,
    mixed: SMatrix<f64, PARAMETERS, 6>,
    pub(crate) view: SMatrix<f64, 6, 6>,
    lens_gradient: SVector<f64, PARAMETERS>,
    pub(crate) view_gradient: SVector<f64, 6>,
    pub(crate) squares: f64,
}

impl Bundle {
    /// The nearest best fit; `None` where the views leave a number open.
    pub(crate) fn adjust(self) -> Option<Adjusted> {
        let Minimum {
            at: bundle,
            equations,
            ..
        } = minimise(self, &RULES)?;
        let coordinates = 2 * bundle
            .views
            .iter()
            .map(|view| view.matches.len())
            .sum::<usize>();
        let free = coordinates
            .checked_sub(PARAMETERS + 6 * bundle.views.len())
            .filter(|free| *free > 0)?;
        let variance = Self::squares(&equations) / free as f64;
        let (reduced, _) = reduce(&equations, 0.0)?;
        let covariance = scaled_inverse(reduced)? * variance;
        Some(Adjusted {
            bundle,
            rms: variance.sqrt(),
            lens_std: std::array::from_fn(|k| covariance[(k, k)].sqrt()),
        })
    }
}

impl LeastSquares for Bundle {
    type Equations = Vec<ViewEquations>;

    /// `None` where a point is behind the camera.
    fn equations(&self) -> Option<Vec<ViewEquations>> {
        self.views
            .iter()
            .map(|view| view.equations(&self.lens))
            .collect()
    }

    fn squares(equations: &Vec<ViewEquations>) -> f64 {
        equations.iter().fold(0.0, |sum, e| sum + e.squares)
    }

    fn step(&self, equations: &Vec<ViewEquations>, damping: f64) -> Option<Step<Self>> {
        let (reduced, gradient) = reduce(equations, damping)?;
        let by_lens = scaled_inverse(reduced)? * gradient;
        let moved = |(view, equations): (&View, &ViewEquations)| {
            let rest = equations.view_gradient - equations.mixed.transpose() * by_lens;
            let by = damped(equations.view, damping).cholesky()?.solve(&rest);
            Some(view.moved(&by))
        };
        let views = self
            .views
            .iter()
            .zip(equations)
            .map(moved)
            .collect::<Option<_>>()?;
        Some(Step::To(Self {
            lens: self.lens.moved(by_lens.as_slice()),
            views,
        }))
    }
}

impl View {
    /// Turns and moves the view's motion by six numbers.
    pub(crate) fn moved(&self, by: &SVector<f64, 6>) -> Self {
        let turn = rotation(Vector3::new(by[0], by[1], by[2]));
        let translation = self.motion.translation + Vector3::new(by[3], by[4], by[5]);
        Self {
            motion: Motion {
                rotation: turn * self.motion.rotation,
                translation,
            },
            matches: self.matches.clone(),
        }
    }

    /// Misfits (px): seen less predicted; `None` where a point is behind the camera.
    pub(crate) fn misfits(&self, lens: &Lens) -> Option<Vec<Vector2<f64>>> {
        let misfit = |(point, seen): &Match| {
            let at = self.motion.apply(point.push(0.0));
            (at.z > 0.0).then(|| seen - lens.project(at.xy() / at.z).0)
        };
        self.matches.iter().map(misfit).collect()
    }

    /// Its equations by the lens and by its motion; `None` where a point is behind the camera.
    pub(crate) fn equations(&self, lens: &Lens) -> Option<ViewEquations> {
        let mut sum = ViewEquations {
            lens: SMatrix::zeros(),
            mixed: SMatrix::zeros(),
            view: SMatrix::zeros(),
            lens_gradient: SVector::zeros(),
            view_gradient: SVector::zeros(),
            squares: 0.0,
        };
        for ((point, _), misfit) in self.matches.iter().zip(self.misfits(lens)?) {
            let turned = self.motion.rotation * point.push(0.0);
            let at = turned + self.motion.translation;
            let (_, by_direction, by_lens) = lens.project(at.xy() / at.z);
            let by_point = by_direction
                * Matrix2x3::new(1.0, 0.0, -at.x / at.z, 0.0, 1.0, -at.y / at.z)
                / at.z;
            let mut by_view = SMatrix::<f64, 2, 6>::zeros();
            by_view
                .fixed_view_mut::<2, 3>(0, 0)
                .copy_from(&(by_point * -Matrix3::from(turned.cross_matrix())));
            by_view.fixed_view_mut::<2, 3>(0, 3).copy_from(&by_point);
            sum.lens += by_lens.transpose() * by_lens;
            sum.mixed += by_lens.transpose() * by_view;
            sum.view += by_view.transpose() * by_view;
            sum.lens_gradient += by_lens.transpose() * misfit;
            sum.view_gradient += by_view.transpose() * misfit;
            sum.squares += misfit.norm_squared();
        }
        Some(sum)
    }
}

/// The equations of the lens with all views eliminated.
fn reduce(
    equations: &[ViewEquations],
    damping: f64,
) -> Option<(LensBlock, SVector<f64, PARAMETERS>)> {
    let whole = equations
        .iter()
        .fold(LensBlock::zeros(), |sum, e| sum + e.lens);
    let mut reduced = damped(whole, damping);
    let mut gradient = equations
        .iter()
        .fold(SVector::zeros(), |sum, e| sum + e.lens_gradient);
    for e in equations {
        let inverse = damped(e.view, damping).cholesky()?.inverse();
        reduced -= e.mixed * inverse * e.mixed.transpose();
        gradient -= e.mixed * inverse * e.view_gradient;
    }
    Some((reduced, gradient))
}

/// Diagonal raised by a share of itself (Marquardt).
pub(crate) fn damped<const N: usize>(
    matrix: SMatrix<f64, N, N>,
    damping: f64,
) -> SMatrix<f64, N, N> {
    matrix + SMatrix::from_diagonal(&(matrix.diagonal() * damping))
}

/// The inverse, found with a diagonal of ones, since pixels and distortions differ by many powers
/// of ten; `None` where there is none.
fn scaled_inverse(matrix: LensBlock) -> Option<LensBlock> {
    let scale = LensBlock::from_diagonal(&matrix.diagonal().map(|d| 1.0 / d.sqrt()));
    Some(scale * (scale * matrix * scale).cholesky()?.inverse() * scale)
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;

    const STD: f64 = 0.05;

    fn truth() -> Lens {
        Lens {
            size: [640, 480],
            focal: [810.0, 805.0],
            centre: [330.0, 236.0],
            radial: [-0.25, 0.1, 0.0],
            tangential: [1e-3, -1e-3],
        }
    }

    /// Twelve views of 8 × 6 points, seen with noise.
    fn views(std: f64, seed: u64) -> Vec<View> {
        let down = rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        let view = |k: u32| {
            let angle = 2.4 * f64::from(k);
            let tilt = Vector3::new(
                0.5 * libm::cos(angle),
                0.5 * libm::sin(angle),
                0.3 * libm::sin(3.0 * angle),
            );
            let motion = Motion {
                rotation: rotation(tilt) * down,
                translation: Vector3::new(-0.12, 0.09, 0.5),
            };
            let seen = |i: u32| {
                let point = Vector2::new(0.035 * f64::from(i % 8), 0.035 * f64::from(i / 8));
                let at = motion.apply(point.push(0.0));
                let noise: [f64; 2] = Streams::new(seed).at(k.into()).normals(i, 0);
                (
                    point,
                    truth().project(at.xy() / at.z).0 + Vector2::from(noise) * std,
                )
            };
            View {
                motion,
                matches: (0..48).map(seen).collect(),
            }
        };
        (0..12).map(view).collect()
    }

    /// Starts from a lens without distortion and poses that are off.
    fn adjusted(std: f64, seed: u64) -> Adjusted {
        let mut views = views(std, seed);
        for view in &mut views {
            view.motion.rotation = rotation(Vector3::new(0.02, -0.03, 0.01)) * view.motion.rotation;
            view.motion.translation += Vector3::new(0.003, 0.002, -0.01);
        }
        Bundle {
            lens: Lens::pinhole([640, 480], 780.0),
            views,
        }
        .adjust()
        .unwrap()
    }

    #[test]
    fn adjust_finds_the_lens_of_exact_points() {
        let found = adjusted(0.0, 0);
        let truth = truth().calibrated();
        for (k, (number, expected)) in found.bundle.lens.calibrated().iter().zip(truth).enumerate()
        {
            assert!(
                (number - expected).abs() < 1e-6 * expected.abs().max(1.0),
                "{k}: {number} {expected}"
            );
        }
        assert!(found.rms < 1e-7, "{}", found.rms);
    }

    /// Errors in units of the predicted standard deviation, over many draws, have mean square 1.
    #[test]
    fn adjust_has_the_standard_deviations_of_its_errors() {
        const DRAWS: u64 = 60;
        let mut mean_square = 0.0;
        for seed in 0..DRAWS {
            let found = adjusted(STD, seed);
            assert!((found.rms / STD - 1.0).abs() < 0.12, "{}", found.rms);
            let errors = found
                .bundle
                .lens
                .calibrated()
                .into_iter()
                .zip(truth().calibrated())
                .zip(found.lens_std);
            mean_square += errors.fold(0.0, |sum, ((n, t), std)| sum + ((n - t) / std).powi(2))
                / (DRAWS as f64 * PARAMETERS as f64);
        }
        // five standard errors of 60 mean squares of 8 correlated normals, had they but one degree
        // of freedom
        assert!(
            (mean_square - 1.0).abs() < 5.0 * (2.0 / DRAWS as f64).sqrt(),
            "{mean_square}"
        );
    }

    #[test]
    fn adjust_of_too_few_points_is_none() {
        let few = views(0.0, 0)
            .into_iter()
            .take(1)
            .map(|v| View {
                matches: v.matches[..5].to_vec(),
                ..v
            })
            .collect();
        assert!(
            Bundle {
                lens: truth(),
                views: few
            }
            .adjust()
            .is_none()
        );
    }
}
