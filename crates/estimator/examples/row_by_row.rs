//! Tracks a log as if its rows came live, and prints the likeliest particle between them:
//! `cargo run --release -p stickslip --example row_by_row`.

use std::error::Error;
use std::fs;

use stickslip::{Tracker, TrackerOptions};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../testkit/experiments/slide-ell-disc-110"
    );
    let scene = fs::read_to_string(format!("{folder}/scene.toml"))?;
    let setup = stickslip_formats::read_scene(&scene, "scene.toml")?;
    let file = fs::File::open(format!("{folder}/log.csv"))?;
    let (log, _) = stickslip_formats::read_log(file, "log.csv")?;

    let mut tracker = Tracker::new(&setup, &TrackerOptions::default())?;
    for mut row in (0..log.len()).map(|row| log.row(row)) {
        // the hand hides the object after five seconds
        if row.time > 5.0 {
            row.object = None;
        }
        let estimate = tracker.push(&row)?;
        let Some((pose, spread)) = estimate.pose.zip(estimate.spread) else {
            continue;
        };
        let spread_mm = 1e3 * spread.pose.x.hypot(spread.pose.y);
        let likeliest = tracker.particles().and_then(|particles| {
            let weights = particles.weights().iter().enumerate();
            let (best, _) = weights.max_by(|a, b| a.1.total_cmp(b.1))?;
            Some(particles.pose(best))
        });
        if (row.time * 30.0).round() % 30.0 == 0.0 {
            println!(
                "{:5.1} s: {pose:.4?} ± {spread_mm:.2} mm, likeliest {likeliest:.4?}",
                row.time
            );
        }
    }
    Ok(())
}
