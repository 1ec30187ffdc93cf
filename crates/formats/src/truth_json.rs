//! `truth.json`, the true friction values and the times of events: [`TruthFacts`],
//! [`read_truth_json`], [`write_truth_json`]. For scoring only.

use std::io::Write;

use serde::{Deserialize, Serialize};
use stickslip::Occlusion;
use stickslip_dynamics::Pose;

/// Facts that are known of an experiment after it; `None` where the file does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TruthFacts {
    /// Source of the truth, in words.
    pub source: Option<String>,
    /// True μ_s.
    pub mu_s: Option<f64>,
    /// True μ_p.
    pub mu_p: Option<f64>,
    /// True μ_f.
    pub mu_f: Option<f64>,
    /// True radius of the support tripod (m).
    pub d_tri: Option<f64>,
    /// Log row of the first contact with the pusher, from 0.
    pub first_pusher_contact: Option<usize>,
    /// Log row of the first contact with each fixel, then with each other finger of a hand; empty
    /// where the file does not say.
    pub first_fixel_contacts: Vec<Option<usize>>,
    /// First log row without the camera.
    pub occlude_from: Option<usize>,
    /// The object's pose after the last row.
    pub final_pose: Option<Pose>,
}

impl TruthFacts {
    /// Rows that the camera does not see: everything from `occlude_from` on.
    #[must_use]
    pub fn occlusion(&self) -> Occlusion {
        self.occlude_from
            .map_or(Occlusion::None, |from| Occlusion::Rows { from, to: None })
    }
}

/// Reason why a `truth.json` was refused, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {}{problem}. Write one JSON object with numbers, row indices from 0 and null where nothing is known", if .key.is_empty() { String::new() } else { format!("`{key}`: ") })]
pub struct TruthFactsError {
    /// Display name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// The key, empty where the text is no JSON object.
    pub key: String,
    /// The value found and the one expected.
    pub problem: String,
}

/// The file as it stands; keys that are not here are ignored.
#[derive(Deserialize, Serialize)]
struct Document {
    source: Option<String>,
    mu_s: Option<f64>,
    mu_p: Option<f64>,
    mu_f: Option<f64>,
    d_tri: Option<f64>,
    first_pusher_contact: Option<usize>,
    first_fixel_contacts: Option<Vec<Option<usize>>>,
    occlude_from: Option<usize>,
    final_pose: Option<[f64; 3]>,
}

/// Reads the known keys; others are ignored, missing ones and `null` are `None`. `name` is shown in
/// errors.
///
/// # Errors
/// The text is no JSON object, or a known key has a value of another type.
///
/// ```
/// let facts = stickslip_formats::read_truth_json(r#"{ "mu_s": 0.2, "source": "a table" }"#, "truth.json")?;
/// assert_eq!((facts.mu_s, facts.mu_p), (Some(0.2), None));
/// # Ok::<(), stickslip_formats::TruthFactsError>(())
/// ```
pub fn read_truth_json(text: &str, name: &str) -> Result<TruthFacts, TruthFactsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    check_object(text, name)?;
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let document: Document = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|error| error_at(name, error.path().to_string(), error.inner()))?;
    deserializer
        .end()
        .map_err(|error| error_at(name, String::new(), &error))?;
    Ok(document.into())
}

/// The text begins as an object: serde would also take the values as a list, in the order of the
/// fields.
fn check_object(text: &str, file: &str) -> Result<(), TruthFactsError> {
    let blank = text.len() - text.trim_start().len();
    let problem = match text[blank..].chars().next() {
        Some('{') => return Ok(()),
        Some(found) => format!("the text begins with `{found}`, an object with `{{`"),
        None => "the file is empty".to_owned(),
    };
    let (line, column) = (
        1 + text[..blank].matches('\n').count(),
        1 + text[..blank]
            .chars()
            .rev()
            .take_while(|c| *c != '\n')
            .count(),
    );
    Err(TruthFactsError {
        file: file.to_owned(),
        line,
        column,
        key: String::new(),
        problem,
    })
}

fn error_at(file: &str, path: String, error: &serde_json::Error) -> TruthFactsError {
    let text = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let problem = text.strip_suffix(&place).unwrap_or(&text).to_owned();
    let key = if path == "." || path == "?" {
        String::new()
    } else {
        path
    };
    TruthFactsError {
        file: file.to_owned(),
        line: error.line().max(1),
        column: error.column().max(1),
        key,
        problem,
    }
}

/// Writes all keys, `null` where nothing is known; reads back to the same facts.
///
/// # Errors
/// Those of `writer`.
pub fn write_truth_json(mut writer: impl Write, facts: &TruthFacts) -> std::io::Result<()> {
    serde_json::to_writer_pretty(&mut writer, &Document::from(facts))?;
    writeln!(writer)
}

impl From<&TruthFacts> for Document {
    fn from(facts: &TruthFacts) -> Self {
        Self {
            source: facts.source.clone(),
            mu_s: facts.mu_s,
            mu_p: facts.mu_p,
            mu_f: facts.mu_f,
            d_tri: facts.d_tri,
            first_pusher_contact: facts.first_pusher_contact,
            first_fixel_contacts: Some(facts.first_fixel_contacts.clone()),
            occlude_from: facts.occlude_from,
            final_pose: facts.final_pose.map(|pose| [pose.x, pose.y, pose.theta]),
        }
    }
}

impl From<Document> for TruthFacts {
    fn from(document: Document) -> Self {
        Self {
            source: document.source,
            mu_s: document.mu_s,
            mu_p: document.mu_p,
            mu_f: document.mu_f,
            d_tri: document.d_tri,
            first_pusher_contact: document.first_pusher_contact,
            first_fixel_contacts: document.first_fixel_contacts.unwrap_or_default(),
            occlude_from: document.occlude_from,
            final_pose: document
                .final_pose
                .map(|[x, y, theta]| Pose::new(x, y, theta)),
        }
    }
}
