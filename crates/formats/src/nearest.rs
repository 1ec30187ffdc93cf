//! The known name closest to a mistyped one, by edit distance.

/// The candidate with the fewest edits to `name`, and that number; the first of equals; `None`
/// without candidates.
pub fn nearest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<(&'a str, usize)> {
    candidates
        .into_iter()
        .map(|candidate| (candidate, edit_distance(name, candidate)))
        .min_by_key(|(_, distance)| *distance)
}

/// Levenshtein distance in characters, capital letters equal to small ones.
fn edit_distance(a: &str, b: &str) -> usize {
    strsim::levenshtein(&a.to_lowercase(), &b.to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_of_textbook_pairs() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "mass"), 4);
        assert_eq!(edit_distance("Mass", "mass"), 0);
        assert_eq!(edit_distance("fricton", "friction"), 1);
    }

    #[test]
    fn nearest_is_the_closest_and_none_of_none() {
        assert_eq!(
            nearest("mas", ["inertia", "mass", "shape"]),
            Some(("mass", 1))
        );
        assert_eq!(nearest("mas", []), None);
    }
}
