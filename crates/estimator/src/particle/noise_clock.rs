//! For how long noise lasts: [`NoiseClock`], docs/method.md (19).

/// Time step to which the noise settings refer (s): so long a random force stays the same.
pub(crate) const NOISE_STEP: f64 = 1.0 / 30.0;

/// By how much a step's length may be off for its times being rounded.
pub(crate) const ROUNDED: f64 = 1e-4;

/// Steps of `h` seconds that share one draw of the noise: those that fit into [`NOISE_STEP`], or
/// one.
pub(crate) fn sharing(h: f64) -> u32 {
    let fitting = NOISE_STEP / h * (1.0 + ROUNDED);
    // a cast saturates
    (fitting as u32).max(1)
}

/// Which rows share their noise with the one before.
///
/// What disturbs an object lasts for about a frame of the camera. Noise drawn anew for every row
/// would be other physics where rows are shorter, as those of a faster pusher: friction holds an
/// object against a small force, and no longer against one that is larger for being short.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NoiseClock {
    /// How long the noise has lasted (s), and for how many rows.
    lasted: f64,
    rows: u64,
}

impl NoiseClock {
    /// A row `h` seconds after the one before: rows since the one that drew its noise.
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

    /// Ages of rows at `times` (s).
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
