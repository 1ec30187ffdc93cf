//! Which topic of an MCAP log is which, on the command line: [`TopicArgs`].

use clap::error::ErrorKind;
use clap::{Args, Command};
use stickslip_formats::{TopicMapping, Topics};

/// Which topic of an MCAP log is which.
#[derive(Debug, Args)]
pub struct TopicArgs {
    /// Topic of a KEY in an MCAP log: object=/vicon/box/pose, or object=/tf:table.tag_7 for frames.
    /// Keys: object, pusher, wrench (empty: no forces), fixel_1, ...; repeatable
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
