//! Terms of the field, explained where they stand: [`explained`].

use maud::{Markup, html};

/// Terms and what they mean.
const TERMS: [(&str, &str); 11] = [
    (
        "RMSE",
        "root mean square error of the pose; angles are multiplied by the radius of gyration",
    ),
    (
        "CRPS",
        "continuous ranked probability score, the error of the whole belief; lower is better",
    ),
    (
        "covers %",
        "share of the 90 % intervals of x, y and θ that contain the reference; 90 is right, less is overconfident",
    ),
    ("expected error", "the error that the method itself expects"),
    (
        "moving",
        "from the pusher's first contact to the object's last motion",
    ),
    ("final", "at the last row"),
    (
        "unsolved",
        "steps of particles without a certified solution",
    ),
    ("collapses", "rows that no particle explains"),
    (
        "minus filter",
        "median over the logs of the error minus the particle filter's, ± its standard error",
    ),
    ("fixel", "a fixed body that the object is pushed against"),
    (
        "effective sample size",
        "number of equally weighted particles that would be worth as much",
    ),
];

/// The text with the first use of each term as `abbr`.
pub(crate) fn explained(text: &str) -> Markup {
    let found = TERMS.iter().filter_map(|(term, meaning)| {
        let at = text.find(term)?;
        Some((at, at + term.len(), *meaning))
    });
    let mut found: Vec<(usize, usize, &str)> = found.collect();
    found.sort_unstable();
    let mut rest = 0;
    html! {
        @for (from, to, meaning) in found {
            @if from >= rest {
                (text[rest..from])
                abbr title=(meaning) tabindex="0" { (text[from..to]) }
                ({ rest = to; "" })
            }
        }
        (text[rest..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_use_of_a_term_is_explained_and_text_stays() {
        let html = explained("CRPS < RMSE, final RMSE").into_string();
        assert_eq!(html.matches("<abbr").count(), 3);
        let (mut text, mut inside) = (String::new(), false);
        for letter in html.chars() {
            match letter {
                '<' => inside = true,
                '>' => inside = false,
                _ if !inside => text.push(letter),
                _ => {}
            }
        }
        assert_eq!(text, "CRPS &lt; RMSE, final RMSE");
    }
}
