//! What is compared: [`Variant`], a method with what it may use.

use stickslip::{Log, Method, Occlusion, TactileUse};

/// A method with what it may use: tactile readings or not, the camera during an occlusion or not.
///
/// How the pusher is tracked (smoothed or causal) is no variant: it is the same for all that are
/// compared, see [`crate::RunConditions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Simulation with the nominal friction, which sees the first pose only.
    Nominal,
    /// Constant-velocity Kalman filter, which knows nothing of contact.
    Kalman,
    /// The Kalman filter with nothing hidden from it.
    KalmanCameraOn,
    /// The Kalman filter that comes to rest at the first tactile contact in the dark.
    KalmanStops,
    /// The Kalman filter that in the dark moves with the pusher as if glued to it.
    WithPusher,
    /// Extended Kalman filter over contact dynamics, which does not feel touch.
    ExtendedKalman,
    /// The same with nothing hidden from it.
    ExtendedKalmanCameraOn,
    /// Particle filter without tactile readings.
    ParticleNoTouch,
    /// The same with nothing hidden from it.
    ParticleNoTouchCameraOn,
    /// Particle filter with all that the log has.
    Particle,
    /// The same with nothing hidden from it.
    ParticleCameraOn,
}

impl Variant {
    /// Those that `compare` runs, in the order of its tables.
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

    /// Those that are drawn, in the order of tables.
    pub const DRAWN: [Self; 5] = [
        Self::Nominal,
        Self::Kalman,
        Self::ParticleNoTouch,
        Self::Particle,
        Self::ParticleCameraOn,
    ];

    /// The variant of a method from which an occlusion hides the object.
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

    /// Those of [`Variant::COMPARED`] that differ on a log of which `occlusion` hides rows.
    pub fn compared_on(log: &Log, occlusion: Occlusion) -> impl Iterator<Item = Self> {
        Self::different_on(&Self::COMPARED, log, occlusion)
    }

    /// Those of [`Variant::DRAWN`] that differ on a log of which `occlusion` hides rows.
    pub fn drawn_on(log: &Log, occlusion: Occlusion) -> impl Iterator<Item = Self> {
        Self::different_on(&Self::DRAWN, log, occlusion)
    }

    fn different_on<'a>(
        all: &'a [Self],
        log: &Log,
        occlusion: Occlusion,
    ) -> impl Iterator<Item = Self> + use<'a> {
        let (touch, hides) = (
            !log.tactile.is_empty(),
            occlusion.hidden(log).contains(&true),
        );
        all.iter().copied().filter(move |variant| match variant {
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

    /// Whether it weighs by tactile readings.
    #[must_use]
    pub fn tactile(self) -> TactileUse {
        match self {
            Self::ParticleNoTouch | Self::ParticleNoTouchCameraOn => TactileUse::Ignored,
            _ => TactileUse::Used,
        }
    }

    /// Whether its camera stays on during an occlusion.
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

    /// Whether a run depends on its seed.
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

    /// Name in the JSON of `reproduce`, which says of every particle filter whether it feels.
    #[must_use]
    pub fn paper_key(self) -> &'static str {
        match self {
            Self::Particle => "particle_tactile",
            Self::ParticleCameraOn => "particle_tactile_camera_on",
            _ => self.key(),
        }
    }

    /// Name in the tables and figures of `reproduce`, as the paper's columns.
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
            Self::WithPusher => ["with_pusher", "with the pusher", "moved with the pusher"],
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
                "particle, no tactile",
                "particle filter without touch",
            ],
            Self::ParticleNoTouchCameraOn => [
                "particle_no_tactile_camera_on",
                "particle, no tactile, camera on",
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
