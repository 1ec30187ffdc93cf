//! `stickslip info`: the content of a bag, and how to read a log from it.

use std::path::{Path, PathBuf};

use anyhow::Result;
use serde::Serialize;
use stickslip_formats::{BagInfo, PosesInfo, TopicInfo};
use stickslip_report::Table;

use crate::args::InfoArgs;
use crate::experiment::scene_beside;
use crate::log_files::LogFiles;
use crate::output::show_result;
use crate::verdict::Verdict;

/// Printed description of a bag.
#[derive(Serialize)]
pub struct Shown {
    #[serde(flatten)]
    info: BagInfo,
    /// Commands to go on with, in their order.
    commands: Vec<String>,
    /// Those that find the poses in the bag's images; none without images.
    image_commands: Vec<String>,
}

/// Runs the command.
pub fn info(args: &InfoArgs) -> Result<Verdict> {
    let files = LogFiles::find(&args.bag)?;
    let (info, warnings) = files.info()?;
    let verdict = files.told(&warnings);
    let shown = Shown::new(&args.bag, info);
    show_result(args.json, &shown, || text(&shown))?;
    Ok(verdict)
}

impl Shown {
    /// The description of a bag at a path.
    pub fn new(bag: &Path, info: BagInfo) -> Self {
        Self {
            commands: commands(bag, &info.suggestion),
            image_commands: image_commands(bag, &info.image_suggestion),
            info,
        }
    }
}

/// Commands that find object and pusher in the bag's images.
fn image_commands(bag: &Path, suggestion: &[String]) -> Vec<String> {
    if suggestion.is_empty() {
        return Vec::new();
    }
    let (scene, begin) = scene_of(bag);
    let (topics, bag) = (topic_options(suggestion), word(bag));
    let track = format!(
        "stickslip track {bag}{topics} --calibration calibration.toml --tags tags.toml --out tracked"
    );
    let filter = format!(
        "stickslip filter tracked/log.csv --scene {} --out out --report report.html",
        word(&scene)
    );
    [track].into_iter().chain(begin).chain([filter]).collect()
}

/// A path as a shell takes it.
fn word(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// The scene next to a bag, and the command that writes one, if there is none.
fn scene_of(bag: &Path) -> (PathBuf, Option<String>) {
    let folder = bag.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    match scene_beside(bag) {
        Ok(scene) => (scene, None),
        Err(_) => (
            folder.join("scene.toml"),
            Some(format!("stickslip new {}", word(folder))),
        ),
    }
}

/// Mappings as options of a command.
fn topic_options(mappings: &[String]) -> String {
    let option = |topic: &String| format!(" --topic {}", quoted(topic));
    mappings.iter().map(option).collect()
}

/// Commands that check and filter the bag, and before them the one that writes a scene next to it,
/// if there is none.
fn commands(bag: &Path, suggestion: &[String]) -> Vec<String> {
    let topics = topic_options(suggestion);
    let (_, begin) = scene_of(bag);
    let bag = word(bag);
    let use_it = [
        format!("stickslip check {bag}{topics}"),
        format!("stickslip filter {bag}{topics} --out out --report report.html"),
    ];
    begin.into_iter().chain(use_it).collect()
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-=:+@%,".contains(c);
    match word.chars().all(plain) && !word.is_empty() {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

fn text(shown: &Shown) -> String {
    let BagInfo { topics, poses, .. } = &shown.info;
    if topics.is_empty() {
        return "No message can be read: the bag is empty or truncated within its first chunk"
            .to_owned();
    }
    let mut parts = vec![topic_table(topics).to_string()];
    if !poses.is_empty() {
        parts.push(poses_table(poses).to_string());
    }
    parts.extend(problems(poses));
    let missing = missing(&shown.info);
    if missing.is_empty() {
        parts.push(format!("Next steps:\n  {}", shown.commands.join("\n  ")));
    } else {
        parts.push(format!(
            "No moving frame is left for {}: record its poses, or publish the transform from a table frame to the camera on /tf_static",
            missing.join(" and ")
        ));
    }
    if !shown.image_commands.is_empty() {
        parts.push(format!(
            "Or track tags in the images, with tags.toml and the calibration.toml of `stickslip calibrate` (docs/guide/camera.md):\n  {}",
            shown.image_commands.join("\n  ")
        ));
    }
    parts.join("\n")
}

/// Bodies that nothing was found for.
fn missing(info: &BagInfo) -> Vec<&'static str> {
    let found = |body: &&str| {
        let mapped = info
            .suggestion
            .iter()
            .any(|text| text.starts_with(&format!("{body}=")));
        mapped
            || info
                .topics
                .iter()
                .any(|topic| topic.name == format!("/{body}/pose"))
    };
    ["object", "pusher"]
        .into_iter()
        .filter(|body| !found(body))
        .collect()
}

fn topic_table(topics: &[TopicInfo]) -> Table {
    let mut table = Table::new([
        "topic",
        "type",
        "messages",
        "rate, Hz",
        "longest gap, s",
        "usable as",
    ]);
    for topic in topics {
        table.push([
            topic.name.clone(),
            topic.message_type.clone(),
            topic.messages.to_string(),
            topic
                .rate
                .map_or(String::new(), |rate| format!("{rate:.1}")),
            format!("{:.3}", topic.longest_gap),
            topic.keys.join(", "),
        ]);
    }
    table
}

fn poses_table(poses: &[PosesInfo]) -> Table {
    let mut table = Table::new([
        "poses of",
        "count",
        "rate, Hz",
        "longest gap, s",
        "moves, mm",
        "from, s",
        "tilt, deg",
    ]);
    for info in poses.iter().filter(|info| info.problem.is_none()) {
        table.push([
            info.place.clone(),
            info.poses.to_string(),
            info.rate.map_or(String::new(), |rate| format!("{rate:.1}")),
            format!("{:.3}", info.longest_gap),
            format!("{:.1}", 1e3 * info.moves),
            format!("{:.2}", info.moves_at),
            format!("{:.1}", info.tilt_deg),
        ]);
    }
    table
}

/// Reason why some poses cannot be read.
fn problems(poses: &[PosesInfo]) -> Vec<String> {
    let told = poses.iter().filter_map(|info| {
        let problem = info.problem.as_ref()?;
        Some(format!("{}: {problem}\n", info.place))
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_is_what_a_shell_takes_apart_into_the_word() {
        for word in ["a b", "it's", "/tf:table.tag_7", "$HOME", "", "a*"] {
            let run = std::process::Command::new("sh")
                .args(["-c", &format!("printf %s {}", quoted(word))])
                .output()
                .unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(String::from_utf8_lossy(&run.stdout), word);
        }
        assert_eq!(quoted("/tf:table.tag_7"), "/tf:table.tag_7");
    }
}
