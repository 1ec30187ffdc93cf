//! The shapes of all recorded scenes.

use std::path::{Path, PathBuf};

use stickslip_dynamics::{Part, Pose, Shape};
use stickslip_testkit::data_root;

use super::shapes::{Random, contacts, disc, polygon, shape, smallest};

fn scene_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            scene_files(&path, found);
        } else if path.file_name().is_some_and(|name| name == "scene.toml") {
            found.push(path);
        }
    }
}

/// The text between the brackets of every `shape = [ ... ]`.
fn shape_lists(text: &str) -> Vec<&str> {
    let list = |rest: &'_ str| {
        let mut depth = 0;
        rest.char_indices().find_map(|(k, c)| {
            depth += i32::from(c == '[') - i32::from(c == ']');
            (c == ']' && depth == 0).then_some(k)
        })
    };
    text.split("shape =")
        .skip(1)
        .filter_map(|rest| list(rest).map(|end| &rest[..end]))
        .collect()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !"+-.eE0123456789".contains(c))
        .filter_map(|word| word.parse().ok())
        .collect()
}

fn parts(list: &str) -> Vec<Part> {
    let part = |text: &str| {
        let (kind, rest) = text.split_once('=')?;
        let key = |name: &str| {
            rest.split_once(name)
                .map(|(_, after)| numbers(after))
                .unwrap_or_default()
        };
        let centre = key("centre").get(..2).map_or([0.0; 2], |c| [c[0], c[1]]);
        match kind.trim() {
            "polygon" => Some(polygon(numbers(rest).as_chunks().0)),
            "disc" => Some(disc(key("radius")[0], centre)),
            _ => None,
        }
    };
    // a part opens with one of its two keys; discs open an inner table that belongs to them
    let mut starts: Vec<usize> = ["polygon", "disc"]
        .iter()
        .flat_map(|key| list.match_indices(key))
        .map(|(k, _)| k)
        .collect();
    starts.sort_unstable();
    let ends = starts.iter().skip(1).copied().chain([list.len()]);
    starts
        .iter()
        .zip(ends)
        .filter_map(|(a, b)| part(&list[*a..b]))
        .collect()
}

/// All different shapes of the data folder.
fn recorded() -> Vec<Vec<Part>> {
    let mut files = Vec::new();
    scene_files(&data_root().expect("recorded data"), &mut files);
    let mut found: Vec<Vec<Part>> = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(file).expect("a readable scene");
        for list in shape_lists(&text).into_iter().map(parts) {
            if !found.contains(&list) {
                found.push(list);
            }
        }
    }
    assert!(!found.is_empty());
    found
}

#[test]
#[ignore = "needs recorded experiments"]
fn recorded_shapes_are_as_far_as_their_nearest_part() {
    let mut random = Random(1);
    for list in recorded() {
        assert!(!list.is_empty());
        let whole = shape(list.clone());
        let singles: Vec<Shape> = list.iter().map(|part| shape(vec![part.clone()])).collect();
        let size = whole.bounding_radius();
        for radius in [0.05 * size, 0.3 * size] {
            let tip = shape(vec![disc(radius, [0.0; 2])]);
            for _ in 0..4000 {
                let pose = random.pose(1.2 * size + radius);
                let body = |object: &Shape| {
                    smallest(&contacts((object, Pose::default()), (&tip, pose), size))
                };
                let (found, expected) = (
                    body(&whole),
                    singles.iter().map(body).fold(f64::INFINITY, f64::min),
                );
                // inputs are rounded to a micrometre, and so are the seams of their parts
                let wrong = (found - expected).abs() > 2e-6
                    && (found > 0.0 || expected > 0.0 || found.is_infinite());
                assert!(
                    !wrong,
                    "{list:?} {pose:?}, radius {radius}: {found} is not {expected}"
                );
            }
        }
    }
}

#[test]
#[ignore = "needs recorded experiments"]
fn a_point_round_a_recorded_shape_touches_no_seam() {
    let mut random = Random(2);
    for list in recorded() {
        let whole = shape(list.clone());
        let size = whole.bounding_radius();
        let tip = shape(vec![disc(1e-3 * size, [0.0; 2])]);
        for _ in 0..4000 {
            let pose = random.pose(1.1 * size);
            let found = contacts((&whole, Pose::default()), (&tip, pose), 2e-3 * size);
            // on the surface a small tip has one contact, or two in a reentrant corner
            if smallest(&found) > -1e-3 * size {
                assert!(found.len() <= 2, "{list:?} {pose:?}: {found:?}");
            }
        }
    }
}
