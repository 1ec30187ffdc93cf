//! Colours that colour-blind people can tell apart (Okabe and Ito 2008, and two more): [`Colour`].

use stickslip_evaluation::Variant;

/// An sRGB colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Text, axes and the truth.
    pub const INK: Self = Self(51, 51, 51);
    /// Bodies that stand still, and parts that need no name.
    pub const GREY: Self = Self(153, 153, 153);
    /// Orange.
    pub const ORANGE: Self = Self(230, 159, 0);
    /// Sky blue.
    pub const SKY: Self = Self(86, 180, 233);
    /// Bluish green.
    pub const GREEN: Self = Self(0, 158, 115);
    /// Blue.
    pub const BLUE: Self = Self(0, 114, 178);
    /// Vermillion.
    pub const VERMILLION: Self = Self(213, 94, 0);
    /// Reddish purple.
    pub const PURPLE: Self = Self(204, 121, 167);
    /// Brown.
    pub const BROWN: Self = Self(153, 85, 68);
    /// Violet.
    pub const VIOLET: Self = Self(136, 119, 255);
    /// Olive.
    pub const OLIVE: Self = Self(128, 128, 0);
    /// Wine.
    pub const WINE: Self = Self(170, 51, 85);

    /// Of a variant, in every figure, table and playback.
    #[must_use]
    pub fn of(variant: Variant) -> Self {
        match variant {
            Variant::Nominal => Self::GREY,
            Variant::Kalman => Self::ORANGE,
            Variant::KalmanStops => Self::BROWN,
            Variant::WithPusher => Self::VIOLET,
            Variant::KalmanCameraOn => Self::PURPLE,
            Variant::ParticleNoTouch => Self::SKY,
            Variant::ExtendedKalman => Self::OLIVE,
            Variant::ExtendedKalmanCameraOn => Self::WINE,
            Variant::ParticleNoTouchCameraOn => Self::BLUE,
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

/// Style of a line. The later ones lie on the earlier ones, which one sees through their gaps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
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
    /// Of a variant, in every figure and playback: the line of a variant that uses less is broken,
    /// so that it covers nothing.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two colours (WCAG 2.2), 1 to 21.
    fn contrast(a: Colour, b: Colour) -> f64 {
        let light = |Colour(r, g, b): Colour| {
            let [r, g, b] = [r, g, b].map(|part| {
                let part = f64::from(part) / 255.0;
                if part <= 0.04045 {
                    part / 12.92
                } else {
                    libm::pow((part + 0.055) / 1.055, 2.4)
                }
            });
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let [a, b] = [a, b].map(light);
        (a / b).max(b / a)
    }

    #[test]
    fn no_two_variants_share_a_colour_and_all_are_seen_on_light_and_dark_pages() {
        let others = [Variant::ParticleNoTouchCameraOn];
        let all: Vec<Variant> = Variant::COMPARED.into_iter().chain(others).collect();
        let [light, dark] = [Colour(251, 250, 247), Colour(23, 23, 27)];
        for (k, variant) in all.iter().enumerate() {
            let colour = Colour::of(*variant);
            assert!(
                all[..k].iter().all(|other| Colour::of(*other) != colour),
                "{}",
                variant.name()
            );
            let seen = contrast(colour, light).min(contrast(colour, dark));
            assert!(seen > 2.0, "{}: {seen}", variant.name());
        }
    }
}
