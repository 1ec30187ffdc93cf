//! The pusher's drive: [`DriveSettings`], a motor that lags and ripples, and a compliant
//! [`Spindle`] that slips at the stall force.

use std::f64::consts::TAU;

use stickslip_dynamics::SpeedProfile;

use super::random_stream::RandomStream;

/// Wavelengths of the two ripples (m) and their shares of the whole.
const RIPPLES: [(f64, f64); 2] = [(2e-3, 0.7), (0.31e-3, 0.3)];

/// Settings of the pusher's drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveSettings {
    /// Time constant of the motor's response to its command (s); 0 follows at once.
    pub lag: f64,
    /// Largest deviation of the motor's speed, as a share of it.
    pub ripple: f64,
    /// Transmission between motor and pusher; `None` is rigid, whatever resists.
    pub spindle: Option<Spindle>,
}

/// A spindle between motor and pusher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spindle {
    /// Mass of the slide with the pusher (kg).
    pub mass: f64,
    /// Force per length (N/m).
    pub stiffness: f64,
    /// Damping ratio of the slide on it.
    pub damping_ratio: f64,
    /// Largest force; beyond it the motor slips (N).
    pub stall_force: f64,
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            lag: 0.03,
            ripple: 0.03,
            spindle: Some(Spindle::default()),
        }
    }
}

impl Default for Spindle {
    fn default() -> Self {
        Self {
            mass: 1.0,
            stiffness: 3e5,
            damping_ratio: 0.5,
            stall_force: 40.0,
        }
    }
}

/// A drive's state.
#[derive(Clone, Debug)]
pub(super) struct Drive<'a> {
    settings: DriveSettings,
    command: &'a SpeedProfile,
    /// Phases of the ripples (rad).
    phases: [f64; 2],
    /// Travel that the motor asks for (m).
    motor: f64,
    motor_speed: f64,
    /// Travel of the pusher along its direction (m).
    pub travel: f64,
    /// Speed of the pusher (m/s).
    pub speed: f64,
}

impl<'a> Drive<'a> {
    /// A drive at rest.
    pub(super) fn new(settings: DriveSettings, command: &'a SpeedProfile, seed: u64) -> Self {
        let draw = RandomStream::Drive.draw(seed);
        let phases = [0, 1].map(|k| TAU * draw.uniform(k, 0));
        Self {
            settings,
            command,
            phases,
            motor: 0.0,
            motor_speed: 0.0,
            travel: 0.0,
            speed: 0.0,
        }
    }

    /// Advances by `h` seconds from `time` under the force of the object on the pusher along its
    /// direction (N).
    pub(super) fn advance(&mut self, time: f64, h: f64, force: f64) {
        let target = self.command.at(time) * (1.0 + self.ripple());
        self.motor_speed = if self.settings.lag > 0.0 {
            self.motor_speed
                + (target - self.motor_speed) * (1.0 - libm::exp(-h / self.settings.lag))
        } else {
            target
        };
        self.motor += h * self.motor_speed;
        match self.settings.spindle {
            None => (self.travel, self.speed) = (self.motor, self.motor_speed),
            Some(spindle) => self.move_slide(&spindle, h, force),
        }
    }

    /// Moves the slide under the spindle's and the object's force.
    fn move_slide(&mut self, spindle: &Spindle, h: f64, force: f64) {
        let Spindle {
            mass,
            stiffness,
            damping_ratio,
            stall_force,
        } = *spindle;
        let damping = 2.0 * damping_ratio * (stiffness * mass).sqrt();
        // a motor that is held back farther than the stall force winds the spindle slips
        let wound = (stiffness * (self.motor - self.travel)).clamp(-stall_force, stall_force);
        self.motor = self.travel + wound / stiffness;
        let drive =
            (wound + damping * (self.motor_speed - self.speed)).clamp(-stall_force, stall_force);
        self.speed += h / mass * (drive + force);
        self.travel += h * self.speed;
    }

    /// Relative deviation of the motor's speed.
    fn ripple(&self) -> f64 {
        if self.settings.ripple == 0.0 {
            return 0.0;
        }
        let waves = RIPPLES
            .iter()
            .zip(self.phases)
            .map(|((length, share), phase)| share * libm::sin(TAU * self.motor / length + phase));
        self.settings.ripple * waves.fold(0.0, |sum, wave| sum + wave)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 2e-5;

    fn run(settings: DriveSettings, seconds: f64, force: impl Fn(&Drive<'_>) -> f64) -> (f64, f64) {
        let command = SpeedProfile::constant(0.02);
        let mut drive = Drive::new(settings, &command, 1);
        for k in 0..(seconds / H).round() as u32 {
            let resistance = force(&drive);
            drive.advance(f64::from(k) * H, H, resistance);
        }
        (drive.travel, drive.speed)
    }

    #[test]
    fn rigid_drive_without_lag_follows_its_command() {
        let (travel, speed) = run(
            DriveSettings {
                lag: 0.0,
                ripple: 0.0,
                spindle: None,
            },
            3.0,
            |_| -1e9,
        );
        assert!(
            (travel - 0.06).abs() < 1e-12 && speed == 0.02,
            "{travel} {speed}"
        );
    }

    #[test]
    fn lag_costs_the_travel_of_its_time_constant() {
        let (travel, _) = run(
            DriveSettings {
                lag: 0.1,
                ripple: 0.0,
                spindle: None,
            },
            3.0,
            |_| 0.0,
        );
        assert!((travel - 0.02 * (3.0 - 0.1)).abs() < 1e-6, "{travel}");
    }

    #[test]
    fn ripple_changes_the_speed_by_its_share_and_not_the_mean() {
        let settings = DriveSettings {
            lag: 0.0,
            spindle: None,
            ..DriveSettings::default()
        };
        let (travel, _) = run(settings, 5.0, |_| 0.0);
        assert!((travel / 0.1 - 1.0).abs() < 2e-3, "{travel}");
        let speeds: Vec<f64> = (1..200)
            .map(|k| run(settings, 0.001 * f64::from(k), |_| 0.0).1 / 0.02)
            .collect();
        let most = speeds
            .iter()
            .fold(0.0, |most: f64, speed| most.max((speed - 1.0).abs()));
        assert!((0.02..=0.03).contains(&most), "{most}");
    }

    #[test]
    fn spindle_winds_by_the_force_over_its_stiffness() {
        let settings = DriveSettings {
            lag: 0.0,
            ripple: 0.0,
            spindle: Some(Spindle::default()),
        };
        let (free, _) = run(settings, 1.0, |_| 0.0);
        let (loaded, speed) = run(settings, 1.0, |_| -30.0);
        assert!(
            (free - loaded - 30.0 / 3e5).abs() < 1e-9 && (speed - 0.02).abs() < 1e-9,
            "{free} {loaded} {speed}"
        );
    }

    #[test]
    fn motor_slips_at_the_stall_force_and_leaves_nothing_wound_up() {
        // a stiff wall at 10 mm that is taken away after 2 s
        let settings = DriveSettings {
            lag: 0.0,
            ripple: 0.0,
            spindle: Some(Spindle::default()),
        };
        let wall = |drive: &Drive<'_>| -(1e6 * (drive.travel - 0.01) + 1e3 * drive.speed).max(0.0);
        let (travel, speed) = run(settings, 2.0, wall);
        assert!(
            (1e6 * (travel - 0.01) - 40.0).abs() < 0.01 && speed.abs() < 1e-6,
            "{travel} {speed}"
        );
    }
}
