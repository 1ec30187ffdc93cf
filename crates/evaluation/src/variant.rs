//! Methods that are compared: [`Variant`], a method with the measurements that it may use.

use stickslip::{Log, Method, Occlusion, TactileUse};

/// A method with the measurements that it may use: touch or not, the camera during an occlusion or
/// not.
///
/// All variants of a comparison track the pusher in one way, smoothed or causal
/// ([`crate::RunConditions`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Simulation with the nominal friction from the first pose on.
    Nominal,
    /// Constant-velocity Kalman filter without contacts.
    Kalman,
    /// Kalman filter, camera on.
    KalmanCameraOn,
    /// Kalman filter that stops at the first touch while the camera is off.
    KalmanStops,
    /// Kalman filter; while the camera is off, the object is glued to the pusher.
    WithPusher,
    /// Extended Kalman filter over contact dynamics, without touch.
    ExtendedKalman,
    /// Extended Kalman filter, camera on.
    ExtendedKalmanCameraOn,
    /// Particle filter without touch.
    ParticleNoTouch,
    /// Particle filter without touch, camera on.
    ParticleNoTouchCameraOn,
    /// Particle filter with touch.
    Particle,
    /// Particle filter with touch, camera on.
    ParticleCameraOn,
}

impl Variant {
    /// Variants that `compare` and `demo` run, in the order of their tables.
    pub const COMPARED: [Self; 10] = [
        Self::Nominal,
        Self::Kalman,
        Self::KalmanStops,
        Self::WithPusher,
        Self::ExtendedKalman,
        Self::ParticleNoTouch,
        Self::Particle,
        Self::KalmanCameraOn,
        Self::ExtendedKalmanCameraOn,
        Self::ParticleCameraOn,
    ];

    /// Variants that figures show, in the order of tables.
    pub const DRAWN: [Self; 6] = [
        Self::Nominal,
        Self::Kalman,
        Self::WithPusher,
        Self::ExtendedKalman,
        Self::ParticleNoTouch,
        Self::Particle,
    ];

    /// Variant of a method whose camera is off during an occlusion.
    #[must_use]
    pub fn of(method: Method, tactile: TactileUse) -> Self {
        match (method, tactile) {
            (Method::Nominal, _) => Self::Nominal,
            (Method::Kalman, _) => Self::Kalman,
            (Method::KalmanStops, _) => Self::KalmanStops,
            (Method::WithPusher, _) => Self::WithPusher,
            (Method::ExtendedKalman, _) => Self::ExtendedKalman,
            (Method::Particle, TactileUse::Ignored) => Self::ParticleNoTouch,
            (Method::Particle, TactileUse::Used) => Self::Particle,
        }
    }

    /// Variants of [`Variant::COMPARED`] that differ on a log of which `occlusion` hides rows.
    pub fn compared_on(log: &Log, occlusion: Occlusion) -> impl Iterator<Item = Self> + use<> {
        let (touch, hides) = (
            !log.tactile.is_empty(),
            occlusion.hidden(log).contains(&true),
        );
        Self::COMPARED
            .into_iter()
            .filter(move |variant| match variant {
                Self::ParticleNoTouch => touch,
                Self::ParticleCameraOn
                | Self::KalmanCameraOn
                | Self::ExtendedKalmanCameraOn
                | Self::WithPusher => hides,
                Self::KalmanStops => touch && hides,
                _ => true,
            })
    }

    /// Its method.
    #[must_use]
    pub fn method(self) -> Method {
        match self {
            Self::Nominal => Method::Nominal,
            Self::Kalman | Self::KalmanCameraOn => Method::Kalman,
            Self::KalmanStops => Method::KalmanStops,
            Self::WithPusher => Method::WithPusher,
            Self::ExtendedKalman | Self::ExtendedKalmanCameraOn => Method::ExtendedKalman,
            _ => Method::Particle,
        }
    }

    /// Use of touch.
    #[must_use]
    pub fn tactile(self) -> TactileUse {
        match self {
            Self::ParticleNoTouch | Self::ParticleNoTouchCameraOn => TactileUse::Ignored,
            _ => TactileUse::Used,
        }
    }

    /// Returns true if its camera stays on during an occlusion.
    #[must_use]
    pub fn camera_on(self) -> bool {
        matches!(
            self,
            Self::KalmanCameraOn
                | Self::ExtendedKalmanCameraOn
                | Self::ParticleNoTouchCameraOn
                | Self::ParticleCameraOn
        )
    }

    /// Returns true if a run depends on its seed.
    #[must_use]
    pub fn is_random(self) -> bool {
        self.method() == Method::Particle
    }

    /// Name in JSON.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.words()[0]
    }

    /// Short name, in tables on a terminal.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.words()[1]
    }

    /// Name in reports and figures.
    #[must_use]
    pub fn title(self) -> &'static str {
        self.words()[2]
    }

    /// Name in the JSON of `reproduce`, which names the use of touch for every particle filter.
    #[must_use]
    pub fn paper_key(self) -> &'static str {
        match self {
            Self::Particle => "particle_tactile",
            Self::ParticleCameraOn => "particle_tactile_camera_on",
            _ => self.key(),
        }
    }

    /// Name in the tables and figures of `reproduce`, as in the paper's columns.
    #[must_use]
    pub fn paper_title(self) -> &'static str {
        match self {
            Self::ParticleNoTouch => "particle filter, no tactile",
            Self::ParticleNoTouchCameraOn => "particle filter, no tactile, camera on",
            Self::Particle => "particle filter, tactile",
            Self::ParticleCameraOn => "particle filter, tactile, camera on",
            _ => self.title(),
        }
    }

    /// Key, name and title.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::Nominal => ["nominal", "nominal", "nominal simulation"],
            Self::Kalman => ["kalman", "kalman", "Kalman filter"],
            Self::KalmanCameraOn => [
                "kalman_camera_on",
                "kalman, camera on",
                "Kalman filter, camera on",
            ],
            Self::KalmanStops => [
                "kalman_stops",
                "kalman, stops at touch",
                "Kalman filter that stops at touch",
            ],
            Self::WithPusher => ["with_pusher", "glued to pusher", "glued to the pusher"],
            Self::ExtendedKalman => [
                "extended_kalman",
                "extended kalman",
                "extended Kalman filter",
            ],
            Self::ExtendedKalmanCameraOn => [
                "extended_kalman_camera_on",
                "extended kalman, camera on",
                "extended Kalman filter, camera on",
            ],
            Self::ParticleNoTouch => [
                "particle_no_tactile",
                "particle, no touch",
                "particle filter without touch",
            ],
            Self::ParticleNoTouchCameraOn => [
                "particle_no_tactile_camera_on",
                "particle, no touch, camera on",
                "particle filter without touch, camera on",
            ],
            Self::Particle => ["particle", "particle", "particle filter"],
            Self::ParticleCameraOn => [
                "particle_always_on",
                "particle, camera on",
                "particle filter, camera on",
            ],
        }
    }
}
