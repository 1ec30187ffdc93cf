//! Processor and date of a benchmark: [`processor`], [`date`].

use std::time::{SystemTime, UNIX_EPOCH};

/// The processor's model in lower-case letters, digits and hyphens, `unknown` where the system does
/// not say.
#[must_use]
pub fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |key: &str| {
        let line = text
            .lines()
            .find(|line| line.split(':').next().is_some_and(|k| k.trim() == key))?;
        Some(line.split(':').nth(1)?.trim().to_owned())
    };
    let Some(name) = field("model name") else {
        return "unknown".to_owned();
    };
    slug(&field("model").map_or(name.clone(), |model| format!("{name} model {model}")))
}

fn slug(name: &str) -> String {
    let plain = name.replace("(R)", "").replace("(TM)", "").to_lowercase();
    let words = plain
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-")
}

/// Today as `YYYY-MM-DD` (UTC).
#[must_use]
pub fn date() -> String {
    let seconds = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    civil(seconds / 86_400)
}

/// The Gregorian date of a day after 1970-01-01 (H. Hinnant, "chrono-compatible low-level date
/// algorithms").
fn civil(days: u64) -> String {
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153; // from March
    let day = of_year - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 {
        (year, month + 3)
    } else {
        (year + 1, month - 9)
    };
    format!("{:04}-{month:02}-{day:02}", year + era * 400)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From `date -u -d @SECONDS +%F`.
    #[test]
    fn civil_gives_the_dates_of_the_calendar() {
        for (seconds, date) in [
            (0, "1970-01-01"),
            (951_782_400, "2000-02-29"),
            (1_709_251_199, "2024-02-29"),
            (4_107_542_400, "2100-03-01"),
        ] {
            assert_eq!(civil(seconds / 86_400), date);
        }
    }

    #[test]
    fn slug_keeps_letters_and_digits() {
        assert_eq!(
            slug("Intel(R) Xeon(R) Gold 6230 CPU @ 2.10GHz"),
            "intel-xeon-gold-6230-cpu-2-10ghz"
        );
    }
}
