//! Every way of giving a log and a scene that a user would try is taken, or answered with the words
//! to type.

use std::fs;
use std::process::{Command, Output};

use crate::common::{Experiment, SLIDE, STOP, stickslip, succeeds};

/// A copy of an experiment, whose program runs in the folder above it.
struct Case(Experiment);

impl Case {
    /// The copy is called `a`; there is a copy of its log alone, `alone/other.csv`.
    fn new(test: &str) -> Self {
        let case = Experiment::copy(SLIDE, &format!("given/{test}/a"));
        let alone = case.folder.with_file_name("alone");
        fs::create_dir_all(&alone).unwrap();
        fs::copy(case.log(), alone.join("other.csv")).unwrap();
        Self(case)
    }

    /// The program with `words` for arguments.
    fn command(&self, words: &str) -> Command {
        let mut command = stickslip();
        command
            .current_dir(self.0.folder.parent().unwrap())
            .args(words.split_whitespace());
        command
    }

    fn run(&self, words: &str) -> Output {
        self.command(words).output().unwrap()
    }

    /// Printed table of a run that succeeds, without the first line: it names the log as given.
    fn table(&self, words: &str) -> String {
        let text = String::from_utf8(succeeds(&mut self.command(words)).stdout).unwrap();
        text.split_once('\n').unwrap().1.to_owned()
    }
}

#[test]
fn a_log_and_a_scene_come_in_any_order_and_either_finds_the_other() {
    let case = Case::new("orders");
    let ways = [
        "a",
        "a/log.csv",
        "a/scene.toml",
        "a/log.csv a/scene.toml",
        "a/scene.toml a/log.csv",
        "a/scene.toml a",
        "a/log.csv --scene a/scene.toml",
        "--scene a/scene.toml a/log.csv",
        "a/log.csv --scene a",
        "alone/other.csv a/scene.toml",
        "alone/other.csv --scene a",
    ];
    let checked = case.run("check a");
    assert!(!checked.stdout.is_empty());
    // the copy alone has no truth next to it, so its scores are others
    let filtered = case.table("filter a --method nominal --truth a/truth.csv");
    for way in ways {
        let run = case.run(&format!("check {way}"));
        assert_eq!(
            (run.status.code(), run.stdout),
            (checked.status.code(), checked.stdout.clone()),
            "{way}"
        );
        let table = case.table(&format!(
            "filter {way} --method nominal --truth a/truth.csv"
        ));
        assert_eq!(without_speed(&table), without_speed(&filtered), "{way}");
    }
}

/// The words of a table, line by line, without the row that no two runs share.
fn without_speed(table: &str) -> Vec<Vec<&str>> {
    let lines: Vec<Vec<&str>> = table
        .lines()
        .filter(|line| !line.contains("real-time factor"))
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert!(lines.len() > 5 && lines.len() < table.lines().count());
    lines
}

#[test]
fn what_cannot_be_meant_is_answered_with_what_to_type() {
    let case = Case::new("refused");
    fs::copy(case.0.scene(), case.0.folder.with_file_name("only.toml")).unwrap();
    for (words, told, next) in [
        (
            "check a/scene.toml only.toml",
            "a/scene.toml and only.toml: these are two scenes",
            "`stickslip check LOG --scene only.toml`",
        ),
        (
            "filter a/scene.toml --scene only.toml",
            "a/scene.toml and only.toml: these are two scenes",
            "`stickslip filter LOG --scene only.toml`",
        ),
        (
            "filter a/log.csv a/scene.toml --scene only.toml",
            "a/scene.toml and only.toml: these are two scenes",
            "`stickslip filter LOG --scene only.toml`",
        ),
        (
            "filter a/log.csv alone/other.csv",
            "a/log.csv and alone/other.csv: neither is a scene",
            "`stickslip filter a/log.csv`",
        ),
        (
            "filter a/log.csv alone/other.csv --scene only.toml",
            "a/log.csv and alone/other.csv: neither is a scene",
            "`stickslip filter a/log.csv`",
        ),
        (
            "check only.toml",
            "only.toml: this is a scene, and there is no log next to it",
            "`stickslip check LOG --scene only.toml`",
        ),
        (
            "compare alone/other.csv",
            "alone/other.csv: a file; experiments are given as folders",
            "its scene, too: alone/other.csv --scene SCENE",
        ),
        (
            "compare only.toml a",
            "only.toml: a file; experiments are given as folders",
            "this scene for all: DIR --scene only.toml",
        ),
        (
            "compare a/scene.toml --scene only.toml",
            "a/scene.toml and only.toml: these are two scenes",
            "leave one out",
        ),
        (
            "fit only.toml --out out",
            "only.toml: a file; experiments are given as folders",
            "give such a folder",
        ),
    ] {
        let run = case.run(words);
        let talk = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(1), "{words}: {talk}");
        assert!(
            talk.contains(told) && talk.contains(next),
            "{words}: {talk}"
        );
    }
}

#[test]
fn compare_takes_a_scene_or_a_log_for_its_folder() {
    let case = Case::new("compare");
    let compared = |folders: &str| {
        let words = format!("compare {folders} --particles 8 --threads 1");
        succeeds(&mut case.command(&words)).stdout
    };
    let folder = compared("a");
    for way in [
        "a/log.csv",
        "a/scene.toml",
        "a/scene.toml a/log.csv",
        "a --scene a/scene.toml",
        "--scene a a/log.csv",
    ] {
        assert_eq!(compared(way), folder, "{way}");
    }
}

#[test]
fn compare_takes_one_scene_for_all_logs() {
    let case = Case::new("one_scene");
    let above = case.0.folder.parent().unwrap();
    fs::rename(case.0.scene(), above.join("only.toml")).unwrap();
    fs::rename(above.join("alone/other.csv"), above.join("alone/log.csv")).unwrap();
    fs::copy(above.join("alone/log.csv"), above.join("alone/third.csv")).unwrap();
    let compared = |words: &str| {
        let options = "--occlude 300: --particles 8 --threads 1 --json";
        let run = succeeds(&mut case.command(&format!("compare {words} {options}")));
        serde_json::from_slice::<serde_json::Value>(&run.stdout).unwrap()["folders"].clone()
    };
    let found = compared("a alone alone/third.csv --scene only.toml");
    let names: Vec<&str> = found
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["folder"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["a", "alone", "alone/third.csv"]);
    assert_eq!(compared(". --scene only.toml").as_array().unwrap().len(), 2);
    // the scene that is given counts, although the folder has its own
    let text = fs::read_to_string(above.join("only.toml")).unwrap();
    fs::write(
        case.0.scene(),
        text.replace("friction = 0.2", "friction = 0.9"),
    )
    .unwrap();
    assert_eq!(compared("a --scene only.toml")[0], found[0]);
    assert_ne!(compared("a")[0], found[0]);
}

#[test]
fn one_problem_is_one() {
    let case = Experiment::copy(STOP, "given/one_problem");
    let last = |case: &Experiment| {
        let folder = case.folder.display().to_string();
        let run = stickslip().args(["check", &folder]).output().unwrap();
        let text = String::from_utf8(run.stdout).unwrap();
        text.lines().last().unwrap().to_owned()
    };
    assert_eq!(last(&case), "0 problems, 0 warnings");
    case.forget_stall_force();
    assert_eq!(last(&case), "0 problems, 1 warning");
    case.edit_rows(|rows| {
        for row in rows {
            row[3] *= 180.0 / std::f64::consts::PI;
        }
    });
    assert!(last(&case).starts_with("1 problem, "), "{}", last(&case));
}
