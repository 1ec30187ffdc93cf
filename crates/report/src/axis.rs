//! One axis of a chart: [`Axis`], from values to pixels, with its ticks.

/// Spacing of values along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithm; smaller values are drawn at `floor`, which must be positive.
    Log {
        /// Smallest value shown.
        floor: f64,
    },
}

/// Values from `low` to `high` laid from pixel `start` to pixel `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    pub scale: Scale,
    pub limits: [f64; 2],
    pub pixels: [f64; 2],
}

/// A place on an axis that is marked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    /// Its number; empty for a faint line between numbers.
    pub label: String,
}

impl Scale {
    /// Limits that hold all finite `values`, with some room.
    pub(crate) fn limits(self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        let range = values.filter(|value| value.is_finite()).fold(
            None,
            |range: Option<[f64; 2]>, value| {
                let [low, high] = range.unwrap_or([value, value]);
                Some([low.min(value), high.max(value)])
            },
        );
        match (self, range) {
            (Self::Linear, None) => [0.0, 1.0],
            (Self::Linear, Some([low, high])) => {
                let room = if high > low {
                    0.06 * (high - low)
                } else {
                    0.5 * low.abs().max(1e-9)
                };
                [low - room, high + room]
            }
            (Self::Log { floor }, None) => [floor, 10.0 * floor],
            (Self::Log { floor }, Some([low, high])) => {
                let decade = libm::exp10(libm::log10(low.max(floor)).floor());
                [decade.max(floor), 1.3 * high.max(5.0 * floor)]
            }
        }
    }
}

impl Axis {
    /// The pixel of a value; outside the limits it lies outside the pixels.
    pub fn at(&self, value: f64) -> f64 {
        let [low, high] = self.limits.map(|limit| self.spread(limit));
        let share = (self.spread(value) - low) / (high - low);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    fn spread(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            // a missing value stays one: `max` would make the floor of it
            Scale::Log { floor } if value < floor => libm::log10(floor),
            Scale::Log { .. } => libm::log10(value),
        }
    }

    /// Round values among the limits, about one for every `spacing` pixels.
    pub fn ticks(&self, spacing: f64) -> Vec<Tick> {
        let count = ((self.pixels[1] - self.pixels[0]).abs() / spacing).max(1.0);
        match self.scale {
            Scale::Linear => self.even_ticks(count),
            Scale::Log { .. } => self.decade_ticks(count),
        }
    }

    fn even_ticks(&self, count: f64) -> Vec<Tick> {
        let [low, high] = self.limits;
        let step = round_step((high - low) / count);
        if !(step.is_finite() && step > 0.0) {
            return Vec::new();
        }
        let decimals = (-libm::log10(step).floor()).clamp(0.0, 9.0) as usize;
        let (first, last) = ((low / step).ceil(), (high / step).floor());
        let values =
            (0..=(last - first).clamp(0.0, 200.0) as u32).map(|k| (first + f64::from(k)) * step);
        values
            .map(|value| Tick {
                value,
                label: number(value, decimals),
            })
            .collect()
    }

    /// 1, 10, 100 with numbers, at least half as far apart as `count` even ones; where those are
    /// few, 2 and 5 as well; the rest between them without.
    fn decade_ticks(&self, count: f64) -> Vec<Tick> {
        let [low, high] = self.limits;
        let (first, last) = (
            libm::log10(low).floor() as i32,
            libm::log10(high).floor() as i32,
        );
        let few = last - first < 2;
        let every = (libm::log10(high / low) / (2.0 * count)).ceil().max(1.0) as i32;
        let all = (first..=last.min(first + 30))
            .flat_map(|decade| (1..10).map(move |digit| (decade, digit)));
        let ticks = all.map(|(decade, digit)| {
            let value = f64::from(digit) * libm::exp10(f64::from(decade));
            let named =
                digit == 1 && decade.rem_euclid(every) == 0 || few && (digit == 2 || digit == 5);
            Tick {
                value,
                label: if named {
                    number(value, (-decade).max(0) as usize)
                } else {
                    String::new()
                },
            }
        });
        let within = (1.0 - 1e-9) * low..=(1.0 + 1e-9) * high;
        ticks.filter(|tick| within.contains(&tick.value)).collect()
    }
}

/// The number 1, 2 or 5 times a power of ten that comes next.
fn round_step(step: f64) -> f64 {
    let power = libm::exp10(libm::log10(step).floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|factor| factor * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// A number as figures write it: with a true minus sign, and none before zero.
fn number(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let zero = text.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    if value < 0.0 && !zero {
        format!("\u{2212}{text}")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, spacing: f64) -> Vec<String> {
        axis.ticks(spacing)
            .into_iter()
            .map(|tick| tick.label)
            .filter(|label| !label.is_empty())
            .collect()
    }

    #[test]
    fn decades_that_are_too_close_have_a_number_at_every_other() {
        let axis = |width: f64| Axis {
            scale: Scale::Log { floor: 0.01 },
            limits: [0.01, 1e5],
            pixels: [0.0, width],
        };
        assert_eq!(labels(&axis(600.0), 80.0).len(), 8);
        assert_eq!(labels(&axis(270.0), 80.0), ["0.01", "1", "100", "10000"]);
    }

    #[test]
    fn at_maps_limits_to_pixels_and_decades_evenly() {
        let axis = Axis {
            scale: Scale::Log { floor: 0.01 },
            limits: [0.01, 100.0],
            pixels: [400.0, 0.0],
        };
        assert_eq!(
            [0.01, 1.0, 100.0, 0.0].map(|value| axis.at(value)),
            [400.0, 200.0, 0.0, 400.0]
        );
        assert!(axis.at(f64::NAN).is_nan(), "a missing value is a gap");
        let axis = Axis {
            scale: Scale::Linear,
            limits: [-1.0, 1.0],
            pixels: [0.0, 100.0],
        };
        assert_eq!(axis.at(0.5), 75.0);
    }

    #[test]
    fn ticks_are_round_numbers_within_the_limits() {
        let axis = Axis {
            scale: Scale::Linear,
            limits: [-0.31, 0.28],
            pixels: [0.0, 300.0],
        };
        assert_eq!(
            labels(&axis, 50.0),
            [
                "\u{2212}0.3",
                "\u{2212}0.2",
                "\u{2212}0.1",
                "0.0",
                "0.1",
                "0.2"
            ]
        );
        let axis = Axis {
            limits: [2.1, 11.0],
            ..axis
        };
        assert_eq!(labels(&axis, 60.0), ["4", "6", "8", "10"]);
        assert_eq!(labels(&axis, 75.0), ["5", "10"]);
        let axis = Axis {
            scale: Scale::Log { floor: 0.01 },
            limits: [0.01, 130.0],
            ..axis
        };
        assert_eq!(labels(&axis, 75.0), ["0.01", "0.1", "1", "10", "100"]);
    }

    #[test]
    fn limits_hold_all_values_and_never_fail() {
        let log = Scale::Log { floor: 0.01 };
        assert_eq!(log.limits([0.3, 7.0, 0.0].into_iter()), [0.01, 9.1]);
        assert_eq!(log.limits([f64::NAN].into_iter()), [0.01, 0.1]);
        let [low, high] = Scale::Linear.limits([5.0].into_iter());
        assert!(low < 5.0 && high > 5.0);
        assert_eq!(Scale::Linear.limits([].into_iter()), [0.0, 1.0]);
        let broken = Axis {
            scale: Scale::Linear,
            limits: [f64::NAN, 1.0],
            pixels: [0.0, 100.0],
        };
        assert!(broken.ticks(10.0).is_empty());
    }
}
