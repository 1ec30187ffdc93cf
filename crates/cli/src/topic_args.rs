//! How an MCAP log is read, on the command line: [`TopicArgs`].

use clap::error::ErrorKind;
use clap::{Args, Command};
use stickslip_formats::{BagOptions, BagPart, LogTime, TopicMapping, Topics};

/// Which topic of an MCAP log is which, and which part of it is read.
#[derive(Debug, Args)]
pub struct TopicArgs {
    /// Topic of a KEY in an MCAP log: object=/vicon/box/pose, or object=/tf:table.tag_7 for frames.
    /// Keys: object, pusher, wrench (empty: no forces), fixel_1, ...; repeatable
    #[arg(long = "topic", value_name = "KEY=TOPIC")]
    mappings: Vec<TopicMapping>,
    /// Leave out messages of an MCAP log that were recorded before this log time, in s
    #[arg(long, value_name = "TIME")]
    from: Option<LogTime>,
    /// Leave out messages of an MCAP log that were recorded after this log time, in s
    #[arg(long, value_name = "TIME")]
    to: Option<LogTime>,
}

impl TopicArgs {
    /// How an MCAP log is read; options that contradict each other are bad arguments of `program`.
    pub fn options(&self, mut program: Command) -> anyhow::Result<BagOptions> {
        let mut conflict = |text| program.error(ErrorKind::ArgumentConflict, text);
        let topics = Topics::new(self.mappings.iter().cloned());
        let topics = topics.map_err(|error| conflict(format!("--topic: {error}")))?;
        let part = BagPart {
            from: self.from,
            to: self.to,
        };
        if let (Some(from), Some(to)) = (self.from, self.to)
            && to < from
        {
            return Err(conflict(format!("--to {to} comes before --from {from}")).into());
        }
        Ok(BagOptions {
            topics,
            part,
            ..BagOptions::default()
        })
    }
}
