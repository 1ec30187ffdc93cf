//! The six scenes of the paper's evaluation tell the stories that
//! docs/decisions/002-paper-scenes.md asks for.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::fs;
use std::path::Path;

use common::{empty_folder, stickslip};

/// The truth of one simulated scene.
struct Truth {
    /// Object pose per row: x, y (mm), theta (rad).
    pose: Vec<[f64; 3]>,
    /// Normal force per row and fixel (N).
    force: Vec<Vec<f64>>,
    thumb: usize,
    fixels: Vec<Option<usize>>,
    dark: usize,
}

impl Truth {
    fn of(name: &str, seed: u64) -> Self {
        let out = empty_folder(&format!("paper_scenes/{name}-{seed}"));
        let run = stickslip()
            .args([
                "simulate",
                "--paper",
                name,
                "--seed",
                &seed.to_string(),
                "--out",
            ])
            .arg(&out)
            .output()
            .unwrap();
        assert_eq!(
            run.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&run.stderr)
        );
        Self::read(&out)
    }

    fn read(folder: &Path) -> Self {
        let text = fs::read_to_string(folder.join("truth.csv")).unwrap();
        let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let place = |name: &str| names.iter().position(|n| *n == name).unwrap();
        let row = |line: &str| {
            line.split(',')
                .map(|cell| cell.parse::<f64>().unwrap())
                .collect::<Vec<f64>>()
        };
        let rows: Vec<Vec<f64>> = text.lines().skip(1).map(row).collect();
        let facts: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
        let index = |value: &serde_json::Value| value.as_u64().map(|row| row as usize);
        Self {
            pose: rows
                .iter()
                .map(|r| [1e3 * r[place("x")], 1e3 * r[place("y")], r[place("theta")]])
                .collect(),
            force: rows
                .iter()
                .map(|r| (1..=3).map(|k| r[place(&format!("force_{k}"))]).collect())
                .collect(),
            thumb: index(&facts["first_pusher_contact"]).unwrap(),
            fixels: facts["first_fixel_contacts"]
                .as_array()
                .unwrap()
                .iter()
                .map(index)
                .collect(),
            dark: index(&facts["occlude_from"]).unwrap(),
        }
    }

    /// Distance of the object between two rows (mm).
    fn way(&self, from: usize, to: usize) -> f64 {
        (self.pose[to][0] - self.pose[from][0]).hypot(self.pose[to][1] - self.pose[from][1])
    }

    /// Only the first fixel is met, and the object stops there.
    fn stops(&self) {
        let [Some(first), None, None] = self.fixels[..] else {
            panic!("one fixel: {:?}", self.fixels)
        };
        assert!(
            (first + 15..300).all(|row| self.way(row, row + 1) < 0.1)
                && self.way(first + 15, 300) < 0.5
        );
        assert!((first + 1..=300).all(|row| self.force[row][0] > 1.0));
    }

    /// Only the first fixel is met, and the object moves while it touches.
    fn slides(&self) {
        let [Some(first), None, None] = self.fixels[..] else {
            panic!("one fixel: {:?}", self.fixels)
        };
        let touching =
            (first..300).filter(|row| self.force[*row][0] > 0.0 && self.force[row + 1][0] > 0.0);
        let way: f64 = touching.map(|row| self.way(row, row + 1)).sum();
        assert!(way > 5.0, "{way}");
        assert_eq!(self.dark, first - 5);
    }
}

#[track_caller]
fn assert_near(row: usize, expected: usize, within: usize) {
    assert!(
        row.abs_diff(expected) <= within,
        "row {row} is not {expected}"
    );
}

/// Seed 0 to the row; other seeds are other rigs.
fn check(name: &str, seed: u64) {
    let truth = Truth::of(name, seed);
    let within = if seed == 0 { 1 } else { 5 };
    match name {
        "A" => {
            assert_near(truth.thumb, 130, within);
            assert_near(truth.fixels[0].unwrap(), 270, within);
            assert_eq!(truth.dark, 200);
            truth.stops();
        }
        "B" => {
            assert_near(truth.thumb, 130, within);
            let [Some(first), Some(second), Some(third)] = truth.fixels[..] else {
                panic!("three fixels: {:?}", truth.fixels)
            };
            assert_near(first, 257, within);
            assert_near(second.max(third), 270, within);
            assert!(truth.way(first, second.max(third)) > 5.0 && truth.way(285, 300) < 0.5);
            assert!(truth.force[300].iter().all(|force| *force > 1.0));
            assert_eq!(truth.dark, 240);
        }
        "1" | "2" => truth.slides(),
        _ => truth.stops(),
    }
    assert_eq!(truth.pose.len(), 301);
}

#[test]
fn scenes_tell_the_paper_s_stories() {
    for name in ["A", "B", "1", "2", "3", "4"] {
        for seed in 0..2 {
            check(name, seed);
        }
    }
}

#[test]
#[ignore = "120 simulations"]
fn scenes_tell_the_paper_s_stories_on_twenty_rigs() {
    for name in ["A", "B", "1", "2", "3", "4"] {
        for seed in 0..20 {
            check(name, seed);
        }
    }
}
