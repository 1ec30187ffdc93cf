//! Counts in words: [`counted`].

/// A count with its noun, "1 push" or "2 pushes".
///
/// ```
/// use stickslip::counted;
/// assert_eq!((counted(1, "push"), counted(0, "row")), ("1 push".to_owned(), "0 rows".to_owned()));
/// assert_eq!(counted(2, "push"), "2 pushes");
/// ```
pub fn counted(count: u64, noun: &str) -> String {
    let end = match noun.as_bytes() {
        _ if count == 1 => "",
        [.., b's' | b'x'] | [.., b's' | b'c', b'h'] => "es",
        _ => "s",
    };
    format!("{count} {noun}{end}")
}
