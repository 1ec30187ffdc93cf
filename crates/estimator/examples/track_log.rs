//! Tracks a recorded log and prints where the object ended:
//! `cargo run --release -p stickslip --example track_log [FOLDER]`.

use std::error::Error;
use std::fs;

use stickslip::{RunOptions, run};

fn main() -> Result<(), Box<dyn Error>> {
    // what is known before, and what was measured
    let embedded = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../testkit/experiments/slide-ell-disc-110"
    );
    let folder = std::env::args().nth(1).unwrap_or(embedded.to_owned());
    let scene = fs::read_to_string(format!("{folder}/scene.toml"))?;
    let setup = stickslip_formats::read_scene(&scene, "scene.toml")?;
    let file = fs::File::open(format!("{folder}/log.csv"))?;
    let (log, warnings) = stickslip_formats::read_log(file, "log.csv")?;
    warnings.iter().for_each(|warning| eprintln!("{warning}"));

    // the particle filter over the whole log
    let result = run(&setup, &log, &RunOptions::default(), &mut |_| ())?;

    // the estimate at the last row
    let last = result.estimate.rows.last().ok_or("the log has no rows")?;
    println!("pose     {:?}", last.pose.ok_or("no pose was seen")?);
    println!("friction {:?}", last.friction.ok_or("no pose was seen")?);
    println!(
        "unsolved {}, collapses {}",
        result.unsolved, result.collapses
    );
    Ok(())
}
