//! Binary touch sensors on fixels, and on the fingers of a hand: [`TouchSensors`].

use stickslip_filter::{Purpose, Streams};

use crate::trace::Frame;
use crate::trial::Trial;

/// Sensors that compare a body's mean force over a frame's interval with a threshold; they chatter
/// and drop out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchSensors {
    /// Force at which a sensor reads 1 (N).
    pub threshold: f64,
    /// Standard deviation of the sensed force (N); readings chatter where the force is near the
    /// threshold.
    pub noise: f64,
    /// A further standard deviation, as a share of the force.
    pub relative_noise: f64,
    /// Dropouts per second; during one a sensor reads 0.
    pub dropouts: f64,
    /// Mean length of a dropout (s).
    pub dropout_time: f64,
    /// Seed of chatter and dropouts; `None`: the trial's.
    pub seed: Option<u64>,
}

impl Default for TouchSensors {
    fn default() -> Self {
        Self {
            threshold: 0.05,
            noise: 0.02,
            relative_noise: 0.1,
            dropouts: 0.3,
            dropout_time: 0.1,
            seed: None,
        }
    }
}

impl TouchSensors {
    /// Writes every frame's readings.
    pub(crate) fn write_readings(&self, frames: &mut [Frame], trial: &Trial<'_>) {
        let streams = Streams::new(self.seed.unwrap_or(trial.seed)).of(Purpose::Measure);
        let dropout_probability = 1.0 - libm::exp(-self.dropouts / trial.rate);
        let mut silent_until = vec![0.0; trial.scene.sensors()];
        for (k, frame) in frames.iter_mut().enumerate() {
            let draw = streams.at(k as u64);
            let forces = frame.fixel_forces.iter().chain(&frame.finger_forces);
            let reading = |(sensor, force): (usize, &f64)| {
                let number = sensor as u32;
                if frame.time >= silent_until[sensor]
                    && draw.uniform(number, 0) < dropout_probability
                {
                    silent_until[sensor] =
                        frame.time - self.dropout_time * libm::log(draw.uniform(number, 1));
                }
                let sensed =
                    force + (self.noise + self.relative_noise * force) * draw.normal(number, 0);
                sensed > self.threshold && frame.time >= silent_until[sensor]
            };
            let sensors = forces.take(trial.scene.sensors());
            frame.tactile = sensors.enumerate().map(reading).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use stickslip_dynamics::{Pose, SpeedProfile, Start, Twist};
    use stickslip_testkit::{disc, fixels, pushed_scene};

    use super::*;

    const FRAMES: usize = 20_000;

    /// Readings of one sensor under a force that stays the same.
    fn readings(sensors: &TouchSensors, force: f64, seed: u64) -> Vec<bool> {
        let pin = disc(0.01);
        let scene = pushed_scene(pin.clone(), pin.clone(), fixels(&pin, &[[0.0; 2]]));
        let (object, pusher) = (Pose::default(), Pose::default());
        let start = Start {
            object,
            pusher,
            direction: 0.0,
            other_fingers: vec![],
            speed: SpeedProfile::constant(0.0),
            duration: 1.0,
        };
        let trial = Trial {
            scene: &scene,
            start: &start,
            rate: 30.0,
            seed,
        };
        let frame = |k: usize| Frame {
            time: trial.time(k),
            object,
            twist: Twist::default(),
            pusher,
            other_fingers: vec![],
            contacts: vec![],
            pusher_force: [0.0; 2],
            hand_force: [0.0; 2],
            fixel_forces: vec![force],
            finger_forces: vec![0.0],
            tactile: vec![],
        };
        let mut frames: Vec<Frame> = (0..FRAMES).map(frame).collect();
        sensors.write_readings(&mut frames, &trial);
        frames.iter().map(|frame| frame.tactile[0]).collect()
    }

    fn share(readings: &[bool]) -> f64 {
        readings.iter().filter(|touched| **touched).count() as f64 / readings.len() as f64
    }

    #[test]
    fn untouched_sensor_seldom_reads_1() {
        // 0.05 N are 2.5 standard deviations of the noise: 0.62 %, with 3 standard errors of 20 000
        // readings
        let share = share(&readings(&TouchSensors::default(), 0.0, 1));
        assert!((share - 0.0062).abs() < 3.0 * 6e-4, "{share}");
    }

    #[test]
    fn sensor_at_its_threshold_chatters() {
        let readings = readings(
            &TouchSensors {
                dropouts: 0.0,
                ..TouchSensors::default()
            },
            0.05,
            1,
        );
        let changes = readings
            .windows(2)
            .filter(|pair| pair[0] != pair[1])
            .count() as f64
            / FRAMES as f64;
        assert!(
            (share(&readings) - 0.5).abs() < 0.02 && (changes - 0.5).abs() < 0.02,
            "{changes}"
        );
    }

    #[test]
    fn touched_sensor_drops_out_for_a_while_now_and_then() {
        let sensors = TouchSensors {
            dropouts: 0.5,
            dropout_time: 0.2,
            ..TouchSensors::default()
        };
        let readings = readings(&sensors, 5.0, 1);
        // with a share a of the time dropped out, a / (1 - a) = 0.5 Hz times the mean length, which
        // frames round up
        let silent = 1.0 - share(&readings);
        assert!((0.085..0.13).contains(&silent), "{silent}");
        let begins = readings
            .windows(2)
            .filter(|pair| pair[0] && !pair[1])
            .count() as f64;
        let rate = begins * 30.0 / FRAMES as f64;
        assert!((0.4..0.5).contains(&rate), "{rate}");
    }
}
