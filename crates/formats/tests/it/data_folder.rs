//! Every file of the data folder reads without an error: `STICKSLIP_DATA`, by default
//! `../shared/data` next to the workspace.

use std::path::{Path, PathBuf};

use stickslip_formats::{check_bodies, read_log, read_scene, read_truth_csv, read_truth_json};

pub fn data_folder() -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    std::env::var_os("STICKSLIP_DATA").map_or_else(beside, PathBuf::from)
}

/// Files below `folder` whose name passes, sorted.
fn files(folder: &Path, wanted: &dyn Fn(&str) -> bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).expect("a readable folder") {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() {
                open.push(path);
            } else if path
                .file_name()
                .and_then(|name| name.to_str())
                .is_some_and(wanted)
            {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a readable file")
}

fn bytes(path: &Path) -> std::fs::File {
    std::fs::File::open(path).expect("a readable file")
}

#[test]
#[ignore = "needs recorded experiments"]
fn every_recorded_scene_reads() {
    let folder = data_folder();
    let scenes = files(&folder, &|name| {
        name.starts_with("scene") && name.ends_with(".toml")
    });
    assert!(!scenes.is_empty());
    for path in scenes {
        read_scene(&text(&path), &path.display().to_string())
            .unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
#[ignore = "needs recorded experiments"]
fn every_recorded_log_reads_and_fits_its_scene() {
    let folder = data_folder();
    let logs = files(&folder, &|name| name == "log.csv");
    assert!(!logs.is_empty());
    for path in logs {
        let (log, warnings) = read_log(bytes(&path), &path.display().to_string())
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(warnings, []);
        let setup = read_scene(&text(&path.with_file_name("scene.toml")), "scene.toml").unwrap();
        check_bodies(&log, &setup).unwrap();
        assert_eq!(log.len() + 1, text(&path).lines().count());
    }
}

#[test]
#[ignore = "needs recorded experiments"]
fn every_recorded_truth_reads() {
    let folder = data_folder();
    let truths = files(&folder, &|name| name == "truth.csv");
    assert!(!truths.is_empty());
    for path in truths {
        let truth = read_truth_csv(bytes(&path), &path.display().to_string())
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(truth.time.len(), truth.pose.len());
    }
    for path in files(&folder, &|name| name == "truth.json") {
        read_truth_json(&text(&path), &path.display().to_string())
            .unwrap_or_else(|error| panic!("{error}"));
    }
}
