//! Which topic of an MCAP log is which, on the command line: [`TopicArgs`].

use clap::error::ErrorKind;
use clap::{Args, Command};
use stickslip_formats::{TopicMapping, Topics};

/// Which topic of an MCAP log is which.
#[derive(Debug, Args)]
pub struct TopicArgs {
    /// Read KEY from TOPIC of an MCAP log, as object=/vicon/box/pose, or from frames of its
    /// transforms, as object=/tf:table.tag_7; keys are object, pusher, wrench (without TOPIC: no
    /// forces) and fixel_1, fixel_2, ...; may be repeated
    #[arg(long = "topic", value_name = "KEY=TOPIC")]
    mappings: Vec<TopicMapping>,
}

impl TopicArgs {
    /// All topics; mappings that contradict each other are bad arguments of `program`.
    pub fn topics(&self, mut program: Command) -> anyhow::Result<Topics> {
        let contradicting =
            |error| program.error(ErrorKind::ArgumentConflict, format!("--topic: {error}"));
        Ok(Topics::new(self.mappings.iter().cloned()).map_err(contradicting)?)
    }
}
