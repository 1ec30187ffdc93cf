//! When a loop asks other threads for help: [`Pace`].
//!
//! Beside other busy processes the system may run a helping thread late, or in turn with the thread
//! that it should help. Such help costs more than it brings: waking a thread takes as long as a block
//! of particles, and a piece of the loop in the hands of a thread that the system does not run holds
//! the whole loop up for a time slice. So where loops got no help, a thread goes on alone for a while
//! before it asks again. Loops of one place in the program take about as long; what a short one teaches,
//! which is over before another thread is awake, does not hold for a long one. No result depends on it.

use std::cell::RefCell;
use std::panic::Location;
use std::time::{Duration, Instant};

/// Time after which a thread asks again at the latest, about a time slice of the system. A longer loop
/// always asks.
const LONGEST_REST: Duration = Duration::from_millis(8);

/// What the other threads brought to a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Help {
    /// One of them worked while the calling thread did.
    Useful,
    /// None did: they were asleep, or ran in turn with the calling thread.
    None,
    /// The calling thread had to wait for one that the system did not run.
    Late,
}

/// How one thread goes about the loops of one place.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    /// How long the thread goes on alone; doubles while there is no help.
    rest: Duration,
    /// When it asks again; at once if never set.
    asks_again: Option<Instant>,
}

type Place = &'static Location<'static>;

thread_local! {
    static PACES: RefCell<Vec<(Place, Pace)>> = const { RefCell::new(Vec::new()) };
}

/// Whether the calling thread should ask for help with a loop that begins `now` at `place`.
pub(crate) fn asks_for_help(place: Place, now: Instant) -> bool {
    with_pace(place, |pace| pace.asks_for_help(now))
}

/// Takes into account what asking brought to a loop that has lasted from `start` until `now`.
pub(crate) fn learn(place: Place, [start, now]: [Instant; 2], help: Help) {
    with_pace(place, |pace| pace.learn([start, now], help));
}

fn with_pace<T>(place: Place, body: impl FnOnce(&mut Pace) -> T) -> T {
    PACES.with_borrow_mut(|paces| {
        let known = paces.iter().position(|(other, _)| *other == place);
        let index = known.unwrap_or_else(|| {
            paces.push((place, Pace::default()));
            paces.len() - 1
        });
        body(&mut paces[index].1)
    })
}

impl Pace {
    fn asks_for_help(&self, now: Instant) -> bool {
        self.asks_again.is_none_or(|time| now >= time)
    }

    fn learn(&mut self, [start, now]: [Instant; 2], help: Help) {
        let lasted = now - start;
        self.rest = match help {
            _ if lasted >= LONGEST_REST => Duration::ZERO,
            Help::Useful => Duration::ZERO,
            Help::None => (2 * self.rest).clamp(lasted, LONGEST_REST),
            Help::Late => LONGEST_REST,
        };
        self.asks_again = Some(now + self.rest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOOP: Duration = Duration::from_micros(250);

    /// Loops of 250 µs that a thread does alone before it asks again.
    fn loops_alone(pace: &Pace, now: &mut Instant) -> usize {
        let mut loops = 0;
        while !pace.asks_for_help(*now) {
            *now += LOOP;
            loops += 1;
        }
        loops
    }

    fn ask(pace: &mut Pace, now: &mut Instant, lasts: Duration, help: Help) {
        let start = *now;
        *now += lasts;
        pace.learn([start, *now], help);
    }

    #[test]
    fn asks_rarely_where_there_is_no_help_and_always_where_there_is() {
        let (mut pace, mut now) = (Pace::default(), Instant::now());
        let mut alone = Vec::new();
        for _ in 0..9 {
            alone.push(loops_alone(&pace, &mut now));
            ask(&mut pace, &mut now, LOOP, Help::None);
        }
        assert_eq!(alone, [0, 1, 2, 4, 8, 16, 32, 32, 32]);
        loops_alone(&pace, &mut now);
        ask(&mut pace, &mut now, LOOP, Help::Useful);
        assert!(pace.asks_for_help(now));
    }

    #[test]
    fn late_help_is_not_asked_for_again_at_once_except_by_a_long_loop() {
        let (mut pace, mut now) = (Pace::default(), Instant::now());
        ask(&mut pace, &mut now, LOOP, Help::Late);
        assert_eq!(loops_alone(&pace, &mut now), 32);
        ask(&mut pace, &mut now, LONGEST_REST, Help::Late);
        assert!(pace.asks_for_help(now));
    }

    #[test]
    fn every_place_has_a_pace_of_its_own() {
        let [here, there] = [Location::caller(), other_place()];
        let now = Instant::now();
        learn(here, [now, now + LOOP], Help::Late);
        assert!(!asks_for_help(here, now + 2 * LOOP) && asks_for_help(there, now + 2 * LOOP));
    }

    fn other_place() -> Place {
        #[track_caller]
        fn place() -> Place {
            Location::caller()
        }
        place()
    }
}
