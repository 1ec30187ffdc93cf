//! Recorded case that several benchmarks measure: [`recorded_case`].

use std::error::Error;

use stickslip::Occlusion;
use stickslip_experiments::{RecordedCase, recorded_cases};
use stickslip_testkit::data_root;

/// The recorded experiment of this name with all of its camera.
pub fn recorded_case(name: &str) -> Result<RecordedCase, Box<dyn Error>> {
    let root = data_root().ok_or("no recorded experiments: point STICKSLIP_DATA at them")?;
    let case = recorded_cases(&root.join("mujoco").join(name))?
        .into_iter()
        .find(|case| case.occlusion == Occlusion::None);
    Ok(case.ok_or("no case without an occlusion")?)
}
