//! The frame grabber, which now and then delivers a frame twice: [`FrameGrabber`].

use stickslip_filter::Streams;

use crate::draws::FIRST_DRAW;

/// A frame grabber that does not always keep up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameGrabber {
    /// Probability that a frame is the one before again, in [0, 1).
    pub repeat: f64,
    /// Seed of the repeats.
    pub seed: u64,
}

impl FrameGrabber {
    /// The frame that is delivered in the place of frame `index`: itself, or an earlier one again.
    ///
    /// ```
    /// # use stickslip_rendering::FrameGrabber;
    /// assert_eq!(FrameGrabber { repeat: 0.0, seed: 1 }.delivered(5), 5);
    /// ```
    pub fn delivered(&self, index: u64) -> u64 {
        let late = |index: u64| Streams::new(self.seed).uniform(index, FIRST_DRAW, 0) < self.repeat;
        (0..=index)
            .rev()
            .find(|index| *index == 0 || !late(*index))
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delivered_repeats_the_frame_before_as_often_as_asked() {
        let grabber = FrameGrabber {
            repeat: 0.2,
            seed: 4,
        };
        let delivered: Vec<u64> = (0..5000).map(|index| grabber.delivered(index)).collect();
        assert!(
            delivered
                .iter()
                .zip(0..)
                .all(|(frame, index)| *frame <= index)
        );
        let repeats = delivered
            .windows(2)
            .filter(|pair| pair[0] == pair[1])
            .count();
        // mean 1000, standard deviation 28
        assert!((860..1140).contains(&repeats), "{repeats}");
        assert!(
            delivered
                .windows(2)
                .zip(1..)
                .all(|(pair, index)| pair[1] == index || pair[1] == pair[0])
        );
    }
}
