//! Order in which the messages of a topic arrived, against that of their times: [`check`].

use std::collections::BTreeMap;

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::message::SECOND;
use crate::log_mcap::part::LogTime;
use crate::log_mcap::recording::RawMessage;
use crate::log_mcap::series::seconds_text;

/// A step back by more than this is that of a clock (ns). No message is late by so much.
const FAR: i64 = SECOND / 2;
/// A step back by more than this is that of a clock if messages go on from there (ns).
const NEAR: i64 = SECOND / 50;
/// Number of messages that then go on behind a later one.
const GO_ON: usize = 4;
/// A day (ns).
const DAY: i64 = 86_400 * SECOND;

/// Clock by which messages are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    /// `header.stamp`.
    Stamp,
    /// Time at which the recorder wrote the message.
    LogTime,
}

/// Messages that arrived after later ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Late {
    /// Their number.
    pub count: usize,
    /// Longest delay (ns).
    pub longest: i64,
}

/// Leaves out what has a stamp of 0, if all others are more than a day later: its sender had no
/// clock yet. A simulation begins at 0, and goes on from there.
pub(crate) fn drop_unstamped<T>(messages: &mut Vec<T>, time: impl Fn(&T) -> i64) {
    let others = messages.iter().map(&time).filter(|time| *time != 0);
    if others.min().is_some_and(|first| first > DAY) {
        messages.retain(|message| time(message) != 0);
    }
}

/// Counts the messages that arrived late, each with its time (ns).
///
/// # Errors
/// The clock jumps back: the message after the jump, and the problem.
pub(crate) fn check<'a>(
    messages: impl IntoIterator<Item = (&'a RawMessage, i64)>,
    clock: Clock,
) -> Result<Late, (&'a RawMessage, McapProblem)> {
    let mut messages: Vec<(&RawMessage, i64)> = messages.into_iter().collect();
    by_arrival(&mut messages);
    let mut late = Late::default();
    let Some((mut before, mut latest)) = messages.first().copied() else {
        return Ok(late);
    };
    // the message after the step back, the latest before it, and the number that went on from there
    let mut back: Option<Back<'_>> = None;
    let mut last = latest;
    for (raw, time) in messages {
        if time >= latest {
            (latest, back) = (time, None);
        } else {
            late.count += 1;
            late.longest = late.longest.max(latest.saturating_sub(time));
            let here = back.take().filter(|_| time > last);
            let mut here = here.unwrap_or(Back {
                raw,
                before,
                from: latest,
                to: time,
                count: 0,
            });
            here.count += 1;
            if here.is_jump() {
                return Err((here.raw, here.problem(clock)));
            }
            back = Some(here);
        }
        (last, before) = (time, raw);
    }
    Ok(late)
}

/// A step back.
struct Back<'a> {
    /// Message after it.
    raw: &'a RawMessage,
    /// Message before it.
    before: &'a RawMessage,
    /// Latest time before it (ns).
    from: i64,
    /// Time after it (ns).
    to: i64,
    /// Messages that went on from there.
    count: usize,
}

impl Back<'_> {
    fn is_jump(&self) -> bool {
        let step = self.from.saturating_sub(self.to);
        step > FAR || (step > NEAR && self.count >= GO_ON)
    }

    fn problem(&self, clock: Clock) -> McapProblem {
        let log_went_on = self.raw.log_time >= self.before.log_time;
        McapProblem::JumpsBack {
            clock: match (clock, log_went_on) {
                (Clock::Stamp, true) => "header.stamp",
                (Clock::Stamp, false) => "header.stamp, as the log time,",
                (Clock::LogTime, _) => "the log time",
            },
            from: seconds_text(self.from),
            to: seconds_text(self.to),
            log_times: (clock == Clock::Stamp && log_went_on)
                .then(|| [self.before, self.raw].map(|raw| LogTime(raw.log_time))),
        }
    }
}

/// Sorts messages by the order of their files in time, and in these as they are recorded.
///
/// A program may write them in an order of its own: more than a quarter then follow later ones, and
/// their log times say how they arrived.
fn by_arrival(messages: &mut [(&RawMessage, i64)]) {
    let mut begins: BTreeMap<u32, u64> = BTreeMap::new();
    for (raw, _) in messages.iter() {
        let begin = begins.entry(raw.file).or_insert(raw.log_time);
        *begin = raw.log_time.min(*begin);
    }
    messages.sort_by_key(|(raw, _)| (begins[&raw.file], raw.file));
    let pairs = messages.array_windows();
    let back = pairs.filter(|[(a, _), (b, _)]| b.log_time < a.log_time);
    if 4 * back.count() > messages.len() {
        messages.sort_by_key(|(raw, _)| raw.log_time);
    }
}
