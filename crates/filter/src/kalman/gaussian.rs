//! The Kalman filter and the Rauch–Tung–Striebel smoother on small fixed-size matrices.
//!
//! With x' = F x + w, w ~ N(0, Q) and z = H x + r, r ~ N(0, R) (Kalman 1960; Rauch, Tung & Striebel
//! 1965):
//!
//! | | mean | covariance |
//! | --- | --- | --- |
//! | predict | F m | F P Fᵀ + Q |
//! | update | m + K (z - H m) | (I - K H) P (I - K H)ᵀ + K R Kᵀ (Joseph), K = P Hᵀ S⁻¹, S = H P Hᵀ + R |
//! | smooth | m + G (m_s' - m') | P + G (P_s' - P') Gᵀ, G = P Fᵀ P'⁻¹; ' is one row later |

use nalgebra::{SMatrix, SVector};

/// ln 2π.
pub(crate) const LN_TAU: f64 = 1.837_877_066_409_345_3;

/// A normal distribution over N numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian<const N: usize> {
    /// Mean m, (N).
    pub mean: SVector<f64, N>,
    /// Covariance P, (N, N), symmetric.
    pub covariance: SMatrix<f64, N, N>,
}

/// A measurement update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementUpdate<const N: usize, const M: usize> {
    /// The state given the measurement as well.
    pub posterior: Gaussian<N>,
    /// z - H m and its covariance S.
    pub innovation: Gaussian<M>,
    /// ln N(z; H m, S).
    pub log_likelihood: f64,
}

impl<const N: usize> Gaussian<N> {
    /// The normal distribution with the mean and the covariance of a mixture of parts (weight,
    /// distribution), whose weights sum to `total`.
    #[must_use]
    pub fn mixture(parts: &[(f64, Self)], total: f64) -> Self {
        let mean: SVector<f64, N> = parts
            .iter()
            .map(|(weight, state)| state.mean * (weight / total))
            .sum();
        let about =
            |state: &Self| state.covariance + (state.mean - mean) * (state.mean - mean).transpose();
        Self {
            mean,
            covariance: parts
                .iter()
                .map(|(weight, state)| about(state) * (weight / total))
                .sum(),
        }
    }

    /// The state one step later: `transition` is F, `noise` is Q.
    #[must_use]
    pub fn predict(&self, transition: &SMatrix<f64, N, N>, noise: &SMatrix<f64, N, N>) -> Self {
        Gaussian {
            mean: transition * self.mean,
            covariance: symmetric(transition * self.covariance * transition.transpose() + noise),
        }
    }

    /// The state given a measurement z: `sensor` is H, `noise` is R.
    ///
    /// `None` if S = H P Hᵀ + R is not positive definite.
    #[must_use]
    pub fn update<const M: usize>(
        &self,
        measurement: &SVector<f64, M>,
        sensor: &SMatrix<f64, M, N>,
        noise: &SMatrix<f64, M, M>,
    ) -> Option<MeasurementUpdate<N, M>> {
        let innovation = Gaussian {
            mean: measurement - sensor * self.mean,
            covariance: symmetric(sensor * self.covariance * sensor.transpose() + noise),
        };
        let s = innovation.covariance.cholesky()?;

        // K = P Hᵀ S⁻¹, by way of its transpose
        let gain = s.solve(&(sensor * self.covariance)).transpose();
        let keep = SMatrix::<f64, N, N>::identity() - gain * sensor;
        let posterior = Gaussian {
            mean: self.mean + gain * innovation.mean,
            covariance: symmetric(
                keep * self.covariance * keep.transpose() + gain * noise * gain.transpose(),
            ),
        };

        let log_determinant: f64 = s
            .l_dirty()
            .diagonal()
            .iter()
            .map(|l| 2.0 * libm::log(*l))
            .sum();
        let mahalanobis = innovation.mean.dot(&s.solve(&innovation.mean));
        let log_likelihood = -0.5 * (mahalanobis + log_determinant + M as f64 * LN_TAU);
        Some(MeasurementUpdate {
            posterior,
            innovation,
            log_likelihood,
        })
    }

    /// The state given all rows, those after it included: `self` is the filtered state,
    /// `transition` is F to the next row, `predicted` the state there before its measurement,
    /// `next` the smoothed state there.
    ///
    /// `None` if the predicted covariance is not positive definite.
    #[must_use]
    pub fn smooth(
        &self,
        transition: &SMatrix<f64, N, N>,
        predicted: &Self,
        next: &Self,
    ) -> Option<Self> {
        let p = predicted.covariance.cholesky()?;
        let gain = p.solve(&(transition * self.covariance)).transpose();
        Some(Gaussian {
            mean: self.mean + gain * (next.mean - predicted.mean),
            covariance: symmetric(
                self.covariance
                    + gain * (next.covariance - predicted.covariance) * gain.transpose(),
            ),
        })
    }
}

/// Rounding makes products of matrices slightly unsymmetric; this takes the symmetric part.
fn symmetric<const N: usize>(p: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (p + p.transpose()) * 0.5
}
