//! Rule by which a loop asks other threads for help: [`Pace`].
//!
//! If other processes are busy, the system may run a helping thread late, or in turn with the
//! thread that it should help. Such help costs more than it brings. Waking a thread takes as long
//! as a block of particles. A piece of the loop in the hands of a thread that the system does not
//! run holds the whole loop up for a time slice.
//!
//! So after loops that got no help, a thread goes on alone for a while before it asks again. Loops
//! of one place in the program take about as long. A short loop is over before another thread is
//! awake, and teaches nothing about a long one. No result depends on it.

use std::cell::RefCell;
use std::panic::Location;

/// Pieces of loops after which a thread asks again at the latest. As many blocks of particles take
/// one to two milliseconds, up to 10 where they jam: about a time slice of the system. A longer
/// loop always asks.
const LONGEST_REST: usize = 64;

/// Help that the other threads brought to a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Help {
    /// One of them worked while the calling thread did.
    Useful,
    /// None did: they were asleep, or ran in turn with the calling thread.
    None,
    /// The calling thread had to wait for one that the system did not run.
    Late,
}

/// Rule of one thread for the loops of one place.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    /// Pieces that the thread still does alone.
    rest: usize,
    /// The rest before the last loop that asked (pieces); doubles while there is no help.
    last_rest: usize,
}

/// Place in the program at which a loop is called.
type Place = &'static Location<'static>;

thread_local! {
    static PACES: RefCell<Vec<(Place, Pace)>> = const { RefCell::new(Vec::new()) };
}

/// Returns true if the calling thread should ask for help with a loop at `place` of so many
/// `pieces`.
pub(crate) fn asks_for_help(place: Place, pieces: usize) -> bool {
    with_pace(place, |pace| pace.asks_for_help(pieces))
}

/// Takes into account the help that asking brought to a loop at `place` of so many `pieces`.
pub(crate) fn learn(place: Place, pieces: usize, help: Help) {
    with_pace(place, |pace| pace.learn(pieces, help));
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
    fn asks_for_help(&mut self, pieces: usize) -> bool {
        let asks = self.rest < pieces;
        self.rest = self.rest.saturating_sub(pieces);
        asks
    }

    fn learn(&mut self, pieces: usize, help: Help) {
        self.rest = match help {
            Help::Useful => 0,
            Help::None => (2 * self.last_rest).clamp(pieces.min(LONGEST_REST), LONGEST_REST),
            Help::Late => LONGEST_REST,
        };
        self.last_rest = self.rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Loops of `pieces` that a thread does alone before it asks again.
    fn loops_alone(pace: &mut Pace, pieces: usize) -> usize {
        (0..).take_while(|_| !pace.asks_for_help(pieces)).count()
    }

    #[test]
    fn asks_rarely_where_there_is_no_help_and_always_where_there_is() {
        let mut pace = Pace::default();
        let mut alone = Vec::new();
        for _ in 0..9 {
            alone.push(loops_alone(&mut pace, 8));
            pace.learn(8, Help::None);
        }
        assert_eq!(alone, [0, 1, 2, 4, 8, 8, 8, 8, 8]);
        let _ = loops_alone(&mut pace, 8);
        pace.learn(8, Help::Useful);
        assert!(pace.asks_for_help(8));
    }

    #[test]
    fn late_help_is_not_asked_for_again_at_once_except_by_a_long_loop() {
        let mut pace = Pace::default();
        pace.learn(8, Help::Late);
        assert_eq!(loops_alone(&mut pace, 8), LONGEST_REST / 8);
        pace.learn(8, Help::Late);
        assert!(pace.asks_for_help(LONGEST_REST + 1));
    }

    #[test]
    fn every_place_has_a_pace_of_its_own() {
        let places = [Location::caller(), other_place()];
        learn(places[0], 8, Help::Late);
        assert_eq!(places.map(|place| asks_for_help(place, 8)), [false, true]);
    }

    fn other_place() -> Place {
        #[track_caller]
        fn place() -> Place {
            Location::caller()
        }
        place()
    }
}
