//! `stickslip check`: faults of a scene and a log.

use std::fmt;

use anyhow::Result;
use clap::CommandFactory;
use serde::Serialize;
use stickslip::diagnosis::{Finding, Severity, diagnose};

use crate::args::{CheckArgs, Program};
use crate::experiment::read_scene_and_log;
use crate::log_files::LogFiles;
use crate::output::{counted, show_result};
use crate::verdict::Verdict;

/// A finding in JSON.
#[derive(Debug, Serialize)]
pub struct JsonFinding {
    subject: String,
    severity: String,
    found: String,
    advice: Option<String>,
}

/// All findings with their counts.
#[derive(Debug, Serialize)]
pub struct Report {
    problems: usize,
    warnings: usize,
    /// The findings, in their order.
    pub findings: Vec<JsonFinding>,
}

/// Runs the command.
pub fn check(args: &CheckArgs) -> Result<Verdict> {
    let given = args.given.resolve("check")?;
    let topics = args.topics.options(Program::command())?;
    let files = LogFiles::find(&given.log)?;
    let (setup, log, warnings) = read_scene_and_log(&given.scene, &files, &topics)?;
    let verdict = files.told(&warnings);
    let findings = diagnose(&setup, &log);
    let report = Report::new(&findings);
    show_result(args.json, &report, || report.to_string())?;
    Ok(if report.problems == 0 {
        verdict
    } else {
        Verdict::Failed
    })
}

impl Report {
    /// Of findings, in their order.
    pub fn new(findings: &[Finding]) -> Self {
        let count = |severity: Severity| {
            findings
                .iter()
                .filter(|finding| finding.severity == severity)
                .count()
        };
        let (problems, warnings) = (count(Severity::Problem), count(Severity::Warning));
        Self {
            problems,
            warnings,
            findings: findings.iter().map(JsonFinding::new).collect(),
        }
    }

    /// With warnings about reading the log in front.
    pub fn after_reading(mut self, warnings: &[String]) -> Self {
        self.warnings += warnings.len();
        let findings = warnings.iter().map(|warning| JsonFinding {
            subject: "reading".to_owned(),
            severity: Severity::Warning.to_string(),
            found: warning.clone(),
            advice: None,
        });
        self.findings.splice(0..0, findings);
        self
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for finding in &self.findings {
            writeln!(
                f,
                "{:<8} {:<16} {}",
                finding.severity, finding.subject, finding.found
            )?;
            if let Some(advice) = &finding.advice {
                writeln!(f, "{:<8} {:<16} help: {advice}", "", "")?;
            }
        }
        writeln!(
            f,
            "\n{}, {}",
            counted(self.problems as u64, "problem"),
            counted(self.warnings as u64, "warning")
        )
    }
}

impl JsonFinding {
    fn new(finding: &Finding) -> Self {
        Self {
            subject: finding.subject.to_string(),
            severity: finding.severity.to_string(),
            found: finding.found.clone(),
            advice: finding.advice.clone(),
        }
    }
}
