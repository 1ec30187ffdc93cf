//! Result of one check: [`Finding`].

use std::fmt;

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// As it should be.
    Ok,
    /// Estimates may be worse than they could be.
    Warning,
    /// Estimates will be wrong.
    Problem,
}

/// Subject of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Subject {
    /// Units of lengths and masses.
    Units,
    /// Units and wrapping of angles.
    Angles,
    /// Nominal values within the filter's limits.
    Limits,
    /// The pusher's stall force.
    StallForce,
    /// Time steps.
    Timing,
    /// Missing object poses.
    ObjectPoses,
    /// The pusher off the plane.
    PusherPoses,
    /// Repeated poses: frames of the camera, samples of the pusher.
    RepeatedFrames,
    /// Noise of the camera.
    Noise,
    /// Frames of object and pusher.
    Frames,
    /// Contact between object and pusher.
    Contact,
    /// Overlap at the start.
    Overlap,
    /// Delay of the camera behind the pusher.
    Latency,
    /// The gap between object and pusher while it pushes.
    PushingGap,
    /// The pusher's force.
    Force,
    /// Rows at which the particle filter explained nothing.
    Collapses,
    /// One tactile sensor, counted from 1.
    Sensor(usize),
}

/// Result of one check, with advice.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Subject of the check.
    pub subject: Subject,
    /// Severity of the finding.
    pub severity: Severity,
    /// Description of what was found, with its number.
    pub found: String,
    /// Advice; `None` if there is nothing to do.
    pub advice: Option<String>,
}

impl Finding {
    /// A finding that all is well.
    pub(super) fn ok(subject: Subject, found: impl Into<String>) -> Self {
        Self {
            subject,
            severity: Severity::Ok,
            found: found.into(),
            advice: None,
        }
    }

    /// A finding that estimates may be worse than they could be.
    pub(super) fn warning(
        subject: Subject,
        found: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            subject,
            severity: Severity::Warning,
            found: found.into(),
            advice: Some(advice.into()),
        }
    }

    /// A finding that estimates will be wrong.
    pub(super) fn problem(
        subject: Subject,
        found: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            subject,
            severity: Severity::Problem,
            found: found.into(),
            advice: Some(advice.into()),
        }
    }
}

impl fmt::Display for Finding {
    /// Writes what was found and the advice, in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.found)?;
        match &self.advice {
            Some(advice) => write!(f, "; {advice}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ok => "ok",
            Self::Warning => "warning",
            Self::Problem => "problem",
        })
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Units => "units",
            Self::Angles => "angles",
            Self::Limits => "limits",
            Self::StallForce => "stall force",
            Self::Timing => "timing",
            Self::ObjectPoses => "object poses",
            Self::PusherPoses => "pusher poses",
            Self::RepeatedFrames => "repeated frames",
            Self::Noise => "noise",
            Self::Frames => "frames",
            Self::Contact => "contact",
            Self::Overlap => "overlap",
            Self::Latency => "latency",
            Self::PushingGap => "pushing gap",
            Self::Force => "force",
            Self::Collapses => "collapses",
            Self::Sensor(k) => return write!(f, "sensor {k}"),
        })
    }
}
