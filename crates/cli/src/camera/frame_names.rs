//! Names of images in the order in which they were taken: [`FrameNames`].

use std::path::Path;

/// Images of a folder by their names. Numbers in names count by value, as whole numbers or as
/// decimal ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    /// The names in their order.
    pub names: Vec<String>,
    /// Question that the names leave open; `None` if their order is sure.
    pub question: Option<String>,
}

/// Meaning of `12.5` in a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reading {
    /// The number twelve and a half, as in times in seconds.
    Decimal,
    /// Twelve, then five, as in run 12, frame 5.
    Counters,
}

/// Part of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece<'n> {
    Number { whole: &'n str, fraction: &'n str },
    Text(&'n str),
}

/// Part of a name as it is compared. A whole number has its length first, without leading zeros.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Number {
        whole: (usize, String),
        fraction: (usize, String),
    },
    Text(String),
}

impl FrameNames {
    /// Brings names into their order.
    pub fn sort(mut names: Vec<String>) -> Self {
        let by = |names: &[String], reading: Reading| {
            let mut names = names.to_vec();
            names.sort_by_cached_key(|name| (keys(name, reading), name.clone()));
            names
        };
        let [decimal, counters] =
            [Reading::Decimal, Reading::Counters].map(|reading| by(&names, reading));
        let (reading, mut question) = match reading(&names) {
            _ if decimal == counters => (Reading::Decimal, None),
            Some(reading) => (reading, None),
            None => {
                let pair = decimal.iter().zip(&counters).find(|(a, b)| a != b);
                let question = pair.map(|(a, b)| {
                    format!(
                        "`{a}` comes before `{b}` if these are decimal numbers, and after it if they are counters: which are they?"
                    )
                });
                (Reading::Decimal, question)
            }
        };
        names = match reading {
            Reading::Decimal => decimal,
            Reading::Counters => counters,
        };
        let pairs = || names.array_windows();
        let equal = pairs().find(|[a, b]| keys(a, reading) == keys(b, reading));
        let other = pairs().find(|[a, b]| form(a) != form(b));
        if let Some([a, b]) = equal {
            question = Some(format!(
                "`{a}` and `{b}` have the same number: which comes first?"
            ));
        } else if let Some([a, b]) = other {
            question = Some(format!(
                "`{a}` and `{b}` are named in different ways: which comes first?"
            ));
        }
        Self { names, question }
    }
}

/// Meaning of fractions of different lengths; `None` if it cannot be known.
fn reading(names: &[String]) -> Option<Reading> {
    let pieces = names.iter().flat_map(|name| pieces(stem(name)));
    let fractions: Vec<&str> = pieces
        .filter_map(|piece| match piece {
            Piece::Number { fraction, .. } => Some(fraction).filter(|digits| digits.len() > 1),
            Piece::Text(_) => None,
        })
        .collect();
    // a counter has no zeros before it, and a time that is written in short has none at its end
    let padded = fractions.iter().any(|digits| digits.starts_with('0'));
    let ends_in_zero = fractions.iter().any(|digits| digits.ends_with('0'));
    match (padded, ends_in_zero) {
        (true, false) => Some(Reading::Decimal),
        (false, true) => Some(Reading::Counters),
        _ => None,
    }
}

fn stem(name: &str) -> &str {
    let stem = Path::new(name).file_stem();
    stem.and_then(|stem| stem.to_str()).unwrap_or(name)
}

/// A name without its ending, in pieces. Two numbers with a point between are one; three or more,
/// as in a date, are not.
fn pieces(stem: &str) -> Vec<Piece<'_>> {
    let is_digit = |c: &u8| c.is_ascii_digit();
    let mut runs = Vec::new();
    let mut rest = stem;
    while let Some(first) = rest.as_bytes().first() {
        let same = |c: &&u8| is_digit(c) == is_digit(first);
        let (run, other) = rest.split_at(rest.bytes().take_while(|c| same(&c)).count());
        runs.push(run);
        rest = other;
    }
    let point = |index: Option<usize>| index.and_then(|index| runs.get(index)) == Some(&".");
    let mut pieces = Vec::new();
    let mut at = 0;
    while let Some(&run) = runs.get(at) {
        let fraction = runs.get(at + 2).filter(|_| {
            let alone = !point(at.checked_sub(1)) && !point(Some(at + 3));
            point(Some(at + 1)) && alone
        });
        let is_number = run.as_bytes().first().is_some_and(is_digit);
        match (is_number, fraction) {
            (true, Some(fraction)) => {
                let whole = run;
                pieces.push(Piece::Number { whole, fraction });
                at += 2;
            }
            (true, None) => pieces.push(Piece::Number {
                whole: run,
                fraction: "",
            }),
            (false, _) => pieces.push(Piece::Text(run)),
        }
        at += 1;
    }
    pieces
}

fn keys(name: &str, reading: Reading) -> Vec<Key> {
    let counted = |digits: &str| {
        let digits = digits.trim_start_matches('0');
        (digits.len(), digits.to_owned())
    };
    let key = |piece: Piece<'_>| match piece {
        Piece::Number { whole, fraction } => Key::Number {
            whole: counted(whole),
            fraction: match reading {
                Reading::Decimal => (0, fraction.trim_end_matches('0').to_owned()),
                Reading::Counters => counted(fraction),
            },
        },
        Piece::Text(text) => Key::Text(text.to_owned()),
    };
    pieces(stem(name)).into_iter().map(key).collect()
}

/// The texts between the numbers of a name.
fn form(name: &str) -> Vec<Option<&str>> {
    let text = |piece| match piece {
        Piece::Number { .. } => None,
        Piece::Text(text) => Some(text),
    };
    pieces(stem(name)).into_iter().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts that names are brought into this order, and what they leave open.
    #[track_caller]
    fn assert_sorted(expected: &[&str], question: Option<&str>) {
        let mut names: Vec<String> = expected.iter().map(|name| (*name).to_owned()).collect();
        names.sort_by_key(|name| (name.len() % 3, name.clone()));
        let sorted = FrameNames::sort(names);
        assert_eq!(sorted.names, expected);
        let asked = sorted.question.unwrap_or_default();
        assert!(
            question.map_or(asked.is_empty(), |words| asked.contains(words)),
            "{asked}"
        );
    }

    #[test]
    fn frame_names_with_whole_numbers_sort_by_value() {
        assert_sorted(&["9.png", "10.jpg", "100.png"], None);
        assert_sorted(&["a9b2.png", "a10b1.png"], None);
        let long = "1700000000000000000000.png";
        assert_sorted(&["1.png", "999999999999999999999.png", long], None);
        assert_sorted(&["2026.9.1.png", "2026.10.1.png"], None);
    }

    #[test]
    fn frame_names_in_seconds_sort_as_decimal_numbers() {
        let names = [
            "12.0.png",
            "12.033.png",
            "12.067.png",
            "12.1.png",
            "12.133.png",
        ];
        assert_sorted(&names, None);
        assert_sorted(&["9.95.png", "10.00.png", "10.05.png"], None);
        assert_sorted(&["12.png", "12.05.png", "12.1.png"], None);
    }

    #[test]
    fn frame_names_of_two_counters_sort_by_both() {
        assert_sorted(&["cam1.2.png", "cam1.9.png", "cam1.10.png"], None);
    }

    #[test]
    fn frame_names_that_leave_their_order_open_ask() {
        let question = Some("decimal numbers, and after it if they are counters");
        assert_sorted(&["12.25.png", "12.5.png"], question);
        assert_sorted(&["12.05.png", "12.10.png", "12.2.png"], question);
        assert_sorted(&["009.png", "9.png"], Some("the same number"));
        assert_sorted(&["7.jpg", "7.png"], Some("the same number"));
        assert_sorted(
            &["1.05.png", "1.5.png", "1.50.png"],
            Some("the same number"),
        );
        assert_sorted(&["1.png", "flat.png"], Some("in different ways"));
    }
}
