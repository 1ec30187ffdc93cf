//! Solutions that stand while others of their chunk are sought again: [`KeptLanes`].

use stickslip_lanes::Mask;

use crate::ncp::report::Report;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;

/// The answers of a chunk, on the contacts that they were found on.
#[derive(Clone, Debug, Default)]
pub struct KeptLanes<const W: usize> {
    ncp: Ncp<W>,
    unknowns: Unknowns<W>,
    reports: Vec<Report>,
    alone: Unknowns<1>,
}

impl<const W: usize> KeptLanes<W> {
    /// Copies a chunk's answers; memory is reused.
    #[inline(always)]
    pub fn keep(&mut self, ncp: &Ncp<W>, unknowns: &Unknowns<W>, reports: &[Report; W]) {
        self.ncp.copy_from(ncp);
        self.unknowns.copy_from(unknowns);
        self.reports.clear();
        self.reports.extend(reports);
    }

    /// Puts those of some lanes back, on the rows that their contacts have now.
    #[inline(always)]
    pub fn restore(
        &mut self,
        lanes: Mask<W>,
        ncp: &Ncp<W>,
        unknowns: &mut Unknowns<W>,
        reports: &mut [Report; W],
    ) {
        let rows = self.ncp.contacts.len();
        for lane in (0..W).filter(|lane| lanes.lane(*lane)) {
            self.alone.clear(rows);
            self.unknowns.pack_lane(&self.ncp, lane, &mut self.alone, 0);
            unknowns.unpack_lane(ncp, lane, &self.alone, 0);
            reports[lane] = self.reports[lane];
        }
    }
}
