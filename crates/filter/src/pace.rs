//! When a loop asks other threads for help: [`Pace`].
//!
//! Beside other busy processes the system may run a helping thread late, or in turn with the thread
//! that it should help. Such help costs more than it brings: waking a thread takes as long as a block
//! of particles, and a piece of the loop in the hands of a thread that the system does not run holds
//! the whole loop up for a time slice. So a thread whose loops got no help goes on alone for a while
//! before it asks again. No result depends on it.

use std::cell::Cell;

/// Pieces of loops after which a thread asks again at the latest. As many blocks of particles take
/// about as long as a time slice of the system, 5 to 10 ms. A longer loop always asks.
const LONGEST_REST: usize = 256;

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

/// How one thread goes about its loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pace {
    /// Pieces that the thread still does alone.
    rest: usize,
    /// The rest before the last loop that asked (pieces); doubles while there is no help.
    last_rest: usize,
}

thread_local! {
    static PACE: Cell<Pace> = const { Cell::new(Pace { rest: 0, last_rest: 0 }) };
}

/// Whether the calling thread should ask for help with a loop of so many `pieces`.
pub(crate) fn asks_for_help(pieces: usize) -> bool {
    let mut pace = PACE.get();
    let asks = pace.asks_for_help(pieces);
    PACE.set(pace);
    asks
}

/// Takes into account what asking brought to a loop of so many `pieces`.
pub(crate) fn learn(pieces: usize, help: Help) {
    let mut pace = PACE.get();
    pace.learn(pieces, help);
    PACE.set(pace);
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
        let mut pace = Pace {
            rest: 0,
            last_rest: 0,
        };
        let mut alone = Vec::new();
        for _ in 0..9 {
            alone.push(loops_alone(&mut pace, 8));
            pace.learn(8, Help::None);
        }
        assert_eq!(alone, [0, 1, 2, 4, 8, 16, 32, 32, 32]);
        let _ = loops_alone(&mut pace, 8);
        pace.learn(8, Help::Useful);
        assert!(pace.asks_for_help(8));
    }

    #[test]
    fn late_help_is_not_asked_for_again_at_once_except_by_a_long_loop() {
        let mut pace = Pace {
            rest: 0,
            last_rest: 0,
        };
        pace.learn(8, Help::Late);
        assert_eq!(loops_alone(&mut pace, 8), LONGEST_REST / 8);
        pace.learn(8, Help::Late);
        assert!(pace.asks_for_help(LONGEST_REST + 1));
    }
}
