//! Messages of a topic that its series lacks, or that came late: [`Losses`].

use crate::left_out::{LeftOut, Reason};
use crate::log_mcap::arrival::Late;
use crate::log_mcap::rows::seconds;
use crate::log_warning::LogWarning;

/// Numbers of measurements that a series lacks, and of those that came late.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Losses {
    /// Messages without a measurement.
    pub unmeasured: usize,
    /// Messages whose stamp is 0, where others have one.
    pub unstamped: usize,
    /// Messages that are equal to an earlier one.
    pub repeated: usize,
    /// Stamps at which another transform on the way is not known.
    pub unlinked: usize,
    /// Messages that came after later ones.
    pub late: Late,
}

impl Losses {
    /// The warnings about a place where `kept` measurements were kept; `file` names the bag.
    pub(crate) fn warnings(&self, place: &str, file: &str, kept: usize) -> Vec<LogWarning> {
        let counts = [
            (self.unmeasured, Reason::NotMeasured),
            (self.unstamped, Reason::Unstamped),
            (self.repeated, Reason::Repeated),
            (self.unlinked, Reason::Unlinked),
        ];
        let of = kept + self.unmeasured + self.unstamped + self.repeated + self.unlinked;
        let left_out = counts.into_iter().filter(|(count, _)| *count > 0);
        let left_out = left_out.map(|(count, reason)| LogWarning::LeftOut {
            file: file.to_owned(),
            left_out: LeftOut {
                place: place.to_owned(),
                count,
                of,
                reason,
            },
        });
        let late = (self.late.count > 0).then(|| LogWarning::Late {
            file: file.to_owned(),
            place: place.to_owned(),
            count: self.late.count,
            longest: seconds(self.late.longest),
        });
        left_out.chain(late).collect()
    }
}
