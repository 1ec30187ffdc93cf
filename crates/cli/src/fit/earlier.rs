//! Fits that an earlier call made: [`earlier`]. A call that was interrupted goes on where it was.

use std::collections::BTreeMap;
use std::fs;
use std::hash::{DefaultHasher, Hasher};

use serde::{Deserialize, Serialize};

use super::object::Object;
use super::{FitResult, JSON, POSTERIOR, SCENE, Task};

/// Content of posterior.json: what a page shows, and fit.json leaves out.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Posterior {
    /// Digest of the pushes, the options and the program.
    pub digest: String,
    /// Posterior draws by name, in the unit of each.
    pub draws: BTreeMap<String, Vec<f64>>,
    /// Predicted poses, row by row of the log, of the push with the largest error, of those left
    /// out and of those of `--test`.
    pub worst: [Vec<Option<[f64; 3]>>; 2],
}

/// The fit in the folder of `object`, if it is one of this `digest`.
pub fn earlier(object: &Object, digest: &str) -> Option<FitResult> {
    let read = |name: &str| fs::read(object.out.join(name)).ok();
    let posterior: Posterior = serde_json::from_slice(&read(POSTERIOR)?).ok()?;
    let result: FitResult = serde_json::from_slice(&read(JSON)?).ok()?;
    let is_this = posterior.digest == digest && object.out.join(SCENE).is_file();
    is_this.then_some(FitResult {
        posterior,
        ..result
    })
}

/// Digest of all that fixes the result of a task: its pushes as they were read, the text of the
/// scene that is changed, the options, and the version of the program.
pub fn digest(task: &Task, object: &Object, scene: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let mut hasher = DefaultHasher::new();
    hasher.write(format!("{version} {task:?} {object:?} {scene}").as_bytes());
    format!("{:016x}", hasher.finish())
}
