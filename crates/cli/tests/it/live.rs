//! `stickslip live`: rows as JSON lines, one answer each, whatever the source does.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::common::{Experiment, SLIDE, stickslip, succeeds};
use serde_json::Value;

/// The rows of a log as lines of JSON, cells as they stand.
fn rows(case: &Experiment, count: usize) -> Vec<String> {
    let text = fs::read_to_string(case.log()).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells = names.iter().zip(line.split(','));
        let filled = cells.filter(|(_, cell)| !cell.is_empty());
        let entries: Vec<String> = filled
            .map(|(name, cell)| format!("\"{name}\": {cell}"))
            .collect();
        format!("{{{}}}", entries.join(", "))
    };
    lines.take(count).map(row).collect()
}

/// The program while it runs.
struct Live {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Live {
    fn start(case: &Experiment, args: &[&str]) -> Self {
        let mut command: Command = stickslip();
        command.args(["live", &case.scene()]).args(args);
        if !args.contains(&"--particles") {
            command.args(["--particles", "64"]);
        }
        let pipes = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = pipes.spawn().unwrap();
        let (input, output) = (
            child.stdin.take(),
            BufReader::new(child.stdout.take().unwrap()),
        );
        Self {
            child,
            input,
            output,
        }
    }

    /// Sends a line and waits for its answer.
    fn ask(&mut self, line: &[u8]) -> Value {
        let input = self.input.as_mut().unwrap();
        input.write_all(line).unwrap();
        input.write_all(b"\n").unwrap();
        input.flush().unwrap();
        let mut answer = String::new();
        self.output.read_line(&mut answer).unwrap();
        serde_json::from_str(&answer).unwrap_or_else(|error| panic!("{error}: {answer}"))
    }

    /// Ends the source: exit code and messages.
    fn end(mut self) -> (Option<i32>, String) {
        drop(self.input.take());
        let run = self.child.wait_with_output().unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    }
}

/// A cell of an answer as `estimate.csv` has it.
fn cell(answer: &Value, key: &str) -> String {
    match &answer[key] {
        Value::Null => String::new(),
        Value::Number(number) => number.to_string(),
        other => panic!("{key}: {other}"),
    }
}

#[test]
fn answers_are_the_bits_of_filter_causal() {
    let case = Experiment::copy(SLIDE, "live/bits");
    case.edit_rows(|rows| rows.truncate(200));
    let out = case.folder.join("out").display().to_string();
    let (log, scene) = (case.log(), case.scene());
    let filter = [
        "filter",
        &log,
        "--scene",
        &scene,
        "--causal",
        "--particles",
        "64",
        "--out",
        &out,
    ];
    succeeds(stickslip().args(filter));
    let csv = fs::read_to_string(case.folder.join("out/estimate.csv")).unwrap();
    let mut expected = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = expected.next().unwrap();

    // a deadline that leaves time changes no bit
    let mut live = Live::start(&case, &["--deadline-ms", "1e6"]);
    let mut compared = 0;
    for (row, expected) in rows(&case, 200).iter().zip(expected) {
        let answer = live.ask(row.as_bytes());
        assert_eq!(answer.as_object().unwrap().len(), names.len() + 2);
        assert_eq!(
            (&answer["particles"], &answer["missed"]),
            (&64.into(), &0.into())
        );
        for (name, expected) in names.iter().zip(expected) {
            let found = cell(&answer, name);
            // as numbers, to the bit: whole ones are written in two ways
            let bits = |text: &str| text.parse::<f64>().map(f64::to_bits);
            assert_eq!(bits(&found), bits(expected), "row {compared}, {name}");
        }
        compared += 1;
    }
    assert_eq!(compared, 200);
    let (code, told) = live.end();
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("200 rows, 0 late; 0 lines refused"), "{told}");
    assert!(
        told.contains("0 after the deadline of 1000000 ms"),
        "{told}"
    );
}

#[test]
fn garbage_repeats_and_late_rows_are_answered_and_the_session_goes_on() {
    let case = Experiment::copy(SLIDE, "live/garbage");
    let rows = rows(&case, 60);
    let mut live = Live::start(&case, &[]);
    for row in &rows[..20] {
        live.ask(row.as_bytes());
    }
    let mut error = |line: &[u8], number: u64, words: &str| {
        let answer = live.ask(line);
        let told = answer["error"]
            .as_str()
            .unwrap_or_else(|| panic!("{answer}"));
        assert!(answer["line"] == number && told.contains(words), "{answer}");
    };
    error(b"GET / HTTP/1.1", 21, "the line is no JSON object");
    error(b"\xff\xfe", 22, "no UTF-8");
    error(&vec![b'['; 100_000], 23, "the line has 100001 bytes");
    error(
        b"{\"time\": 0.7, \"objekt_x\": 1}",
        24,
        "the nearest is `object_x`",
    );
    error(b"{\"time\": 1e30}", 25, "time is 1e30 s");
    error(rows[19].as_bytes(), 26, "was taken already");
    error(b"{\"time\": -3}", 27, "leave such rows out");
    // one wrong time is no pause
    error(b"{\"time\": 1000}", 28, "at most 5 s apart");

    // a row that was overtaken counts late, and changes what is thought of the latest one
    live.ask(rows[21].as_bytes());
    let late = live.ask(rows[20].as_bytes());
    assert!(late["time"].as_f64() > Some(0.6), "{late}");
    let next = live.ask(rows[22].as_bytes());
    assert!(next["x"].is_f64() && next["time"].as_f64() > late["time"].as_f64());

    // a source that comes back after a pause starts over, from the second row on
    let later = |time: f64| {
        format!("{{\"time\": {time}, \"object_x\": 0.01, \"object_y\": 0, \"object_theta\": 0}}")
    };
    assert!(live.ask(later(100.0).as_bytes())["error"].is_string());
    assert_eq!(live.ask(later(100.03).as_bytes())["time"], 100.03);
    let (code, told) = live.end();
    assert_eq!(code, Some(3), "{told}");
    assert!(
        told.contains("24 rows, 1 late; 9 lines refused; 1 restart"),
        "{told}"
    );
}

#[test]
fn recordings_are_logs() {
    let case = Experiment::copy(SLIDE, "live/recorded");
    let rows = rows(&case, 120);
    for name in ["kept.mcap", "kept.csv"] {
        let path = case.folder.join(name).display().to_string();
        let mut live = Live::start(&case, &["--record", &path]);
        for row in &rows {
            live.ask(row.as_bytes());
        }
        let (code, told) = live.end();
        assert!(
            code == Some(0) && told.contains(&format!("wrote {path}")),
            "{told}"
        );
        let score = |log: &str| {
            let run = stickslip()
                .args(["filter", log, "--method", "kalman", "--json"])
                .output()
                .unwrap();
            assert_eq!(
                run.status.code(),
                Some(0),
                "{}",
                String::from_utf8_lossy(&run.stderr)
            );
            serde_json::from_slice::<Value>(&run.stdout).unwrap()
        };
        let kept = score(&path);
        case.edit_rows(|rows| rows.truncate(120));
        let (wmse, expected) = (
            kept["wmse_mm"].as_f64().unwrap(),
            score(&case.log())["wmse_mm"].as_f64().unwrap(),
        );
        assert!(
            (wmse - expected).abs() < 1e-6 * expected,
            "{wmse} {expected}"
        );
        assert_eq!(kept["frames"], 120);
        let again = stickslip()
            .args(["live", &case.scene(), "--record", &path])
            .output()
            .unwrap();
        assert_eq!(
            again.status.code(),
            Some(1),
            "a recording is not written over"
        );
    }
}

#[test]
fn recording_of_a_killed_program_lacks_the_last_second_at_most() {
    let case = Experiment::copy(SLIDE, "live/killed");
    let rows = rows(&case, 150);
    let path = case.folder.join("kept.mcap");
    let mut live = Live::start(&case, &["--record", &path.display().to_string()]);
    for row in &rows {
        live.ask(row.as_bytes());
    }
    live.child.kill().unwrap();
    live.child.wait().unwrap();
    let path = path.display().to_string();
    let run = stickslip()
        .args(["filter", &path, "--method", "kalman", "--json"])
        .output()
        .unwrap();
    assert_eq!(
        run.status.code(),
        Some(3),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    let kept = report["frames"].as_u64().unwrap();
    // 30 rows a second
    assert!((119..150).contains(&kept), "{kept}");
}

#[test]
fn deadline_that_cannot_be_met_leaves_few_particles_and_is_counted() {
    let case = Experiment::copy(SLIDE, "live/deadline");
    let args = ["--deadline-ms", "0.001", "--particles", "300"];
    let mut live = Live::start(&case, &args);
    let answers: Vec<Value> = rows(&case, 60)
        .iter()
        .map(|row| live.ask(row.as_bytes()))
        .collect();
    let last = answers.last().unwrap();
    assert_eq!(
        (&answers[0]["particles"], &answers[0]["missed"]),
        (&300.into(), &0.into())
    );
    assert_eq!(
        (&last["particles"], &last["missed"]),
        (&64.into(), &59.into())
    );
    assert!(last["x"].is_f64(), "{last}");
    let (code, told) = live.end();
    assert_eq!(code, Some(0), "{told}");
    assert!(
        told.contains("60 after the deadline of 0.001 ms") && told.contains("64 to 300 particles"),
        "{told}"
    );
}
