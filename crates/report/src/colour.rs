//! Colours that colour-blind people can tell apart (Okabe and Ito 2008): [`Colour`].

use stickslip_evaluation::Variant;

/// An sRGB colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Text, axes and what is true.
    pub const INK: Self = Self(51, 51, 51);
    /// Bodies that stand still, and what needs no name.
    pub const GREY: Self = Self(153, 153, 153);
    /// Orange.
    pub const ORANGE: Self = Self(230, 159, 0);
    /// Sky blue.
    pub const SKY: Self = Self(86, 180, 233);
    /// Bluish green.
    pub const GREEN: Self = Self(0, 158, 115);
    /// Yellow; too light for lines on white.
    pub const YELLOW: Self = Self(240, 228, 66);
    /// Blue.
    pub const BLUE: Self = Self(0, 114, 178);
    /// Vermillion.
    pub const VERMILLION: Self = Self(213, 94, 0);
    /// Reddish purple.
    pub const PURPLE: Self = Self(204, 121, 167);

    /// Of a variant, in every figure, table and playback.
    #[must_use]
    pub fn of(variant: Variant) -> Self {
        match variant {
            Variant::Nominal => Self::GREY,
            Variant::Kalman | Variant::KalmanStops => Self::ORANGE,
            Variant::WithPusher => Self::YELLOW,
            Variant::KalmanCameraOn => Self::PURPLE,
            Variant::ParticleNoTouch => Self::SKY,
            Variant::ExtendedKalman
            | Variant::ExtendedKalmanCameraOn
            | Variant::ParticleNoTouchCameraOn => Self::BLUE,
            Variant::Particle => Self::VERMILLION,
            Variant::ParticleCameraOn => Self::GREEN,
        }
    }

    /// As in CSS: `#d55e00`.
    ///
    /// ```
    /// assert_eq!(stickslip_report::Colour::VERMILLION.hex(), "#d55e00");
    /// ```
    #[must_use]
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Line {
    /// Through.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

impl Line {
    /// Of a variant, in every figure and playback: what uses less is broken, so that it covers
    /// nothing.
    #[must_use]
    pub fn of(variant: Variant) -> Self {
        match variant {
            Variant::Nominal | Variant::Kalman | Variant::ExtendedKalman | Variant::Particle => {
                Self::Solid
            }
            Variant::KalmanStops
            | Variant::WithPusher
            | Variant::ParticleNoTouch
            | Variant::ParticleNoTouchCameraOn => Self::Dashed,
            Variant::KalmanCameraOn
            | Variant::ExtendedKalmanCameraOn
            | Variant::ParticleCameraOn => Self::Dotted,
        }
    }

    /// SVG's `stroke-dasharray`; `None` for a solid line.
    pub(crate) fn dashes(self) -> Option<&'static str> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some("7 4"),
            Self::Dotted => Some("1.5 3"),
        }
    }
}
