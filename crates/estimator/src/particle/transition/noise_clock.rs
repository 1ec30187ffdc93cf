//! Duration of the noise: [`NoiseClock`], docs/method.md (19).

/// Time step to which the noise settings refer (s). A random force stays constant for as long.
pub(crate) const NOISE_STEP: f64 = 1.0 / 30.0;

/// Relative error of a step's length by rounding of its times.
pub(crate) const ROUNDED: f64 = 1e-4;

/// Returns the number of steps of `h` seconds that share one draw of the noise: those that fit into
/// [`NOISE_STEP`], at least one.
pub(crate) fn sharing(h: f64) -> u32 {
    let fitting = NOISE_STEP / h * (1.0 + ROUNDED);
    // a cast saturates
    (fitting as u32).max(1)
}

/// Clock of the rows that share their noise with the one before.
///
/// A disturbance of the object lasts for about a frame of the camera. Noise drawn in every row
/// would be other physics for shorter rows, as those of a faster pusher. Friction holds an object
/// against a small force, but not against one that is larger because it is shorter.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NoiseClock {
    /// Time for which the noise has lasted (s), and number of its rows.
    lasted: f64,
    rows: u64,
}

impl NoiseClock {
    /// Takes a row `h` seconds after the one before; returns the number of rows since the one that
    /// drew its noise.
    pub fn age(&mut self, h: f64) -> u64 {
        let lasted = self.lasted + h;
        let shares = self.rows > 0 && sharing(h) > 1 && lasted <= NOISE_STEP * (1.0 + ROUNDED);
        (self.lasted, self.rows) = match shares {
            true => (lasted, self.rows + 1),
            false => (h, 1),
        };
        self.rows - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the ages of rows at `times` (s).
    fn ages(times: impl Iterator<Item = f64>) -> Vec<u64> {
        let mut clock = NoiseClock::default();
        let times: Vec<f64> = times.collect();
        let lengths = times.windows(2).map(|pair| pair[1] - pair[0]);
        lengths.map(|h| clock.age(h)).collect()
    }

    #[test]
    fn rows_at_the_rate_of_a_camera_draw_their_own() {
        for rate in [5.0, 25.0, 30.0, 50.0] {
            // as a log has them, to the microsecond
            let times = (0..40).map(|row| (f64::from(row) / rate * 1e6).round() / 1e6);
            assert_eq!(ages(times), [0; 39], "{rate} Hz");
        }
    }

    #[test]
    fn faster_rows_share_it_for_a_thirtieth_of_a_second() {
        for (rate, shared) in [(60.0, 2), (120.0, 4), (1000.0, 33)] {
            let times = (0..200).map(|row| (f64::from(row) / rate * 1e6).round() / 1e6);
            let expected: Vec<u64> = (0..199).map(|row| row % shared).collect();
            assert_eq!(ages(times), expected, "{rate} Hz");
            assert_eq!(u64::from(sharing(1.0 / rate)), shared);
        }
    }

    #[test]
    fn a_row_longer_than_half_of_it_draws_its_own_among_shorter_ones() {
        let times = [0.0, 0.001, 0.002, 0.022, 0.023, 0.024, 0.060, 0.061];
        assert_eq!(ages(times.into_iter()), [0, 1, 0, 1, 2, 0, 0]);
    }
}
