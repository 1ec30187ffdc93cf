//! `stickslip live` when something goes wrong around it: wrong times, a full disk, signals, two
//! sessions with one file.

use std::fs;
use std::io::Write;
use std::process::{Output, Stdio};

use crate::common::{Experiment, SLIDE, empty_folder, json, stickslip};
use serde_json::Value;

/// Rows of an object at rest at these times (s), as lines.
fn rows(times: impl IntoIterator<Item = f64>) -> String {
    let row = |time: f64| {
        format!(
            "{{\"time\": {time}, \"object_x\": 0.01, \"object_y\": 0, \"object_theta\": 0, \"pusher_x\": -0.1, \"pusher_y\": 0, \"pusher_theta\": 0}}\n"
        )
    };
    times.into_iter().map(row).collect()
}

/// Every 0.03 s.
fn steady(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(|row| 0.03 * f64::from(row))
}

/// Runs a session over a source.
fn session(case: &Experiment, args: &[&str], source: &str) -> Output {
    let mut command = stickslip();
    command
        .args(["live", &case.scene(), "--particles", "20"])
        .args(args);
    let pipes = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let source = source.to_owned();
    let feeder = std::thread::spawn(move || input.write_all(source.as_bytes()));
    let run = child.wait_with_output().unwrap();
    let _ = feeder.join().unwrap();
    run
}

/// Answers, each the time of its estimate (s) or `None` for an error.
fn answers(run: &Output) -> Vec<Option<f64>> {
    let text = String::from_utf8_lossy(&run.stdout);
    let answer = |line: &str| {
        let answer: Value = serde_json::from_str(line).unwrap();
        answer["time"].as_f64()
    };
    text.lines().map(answer).collect()
}

#[test]
fn session_recovers_from_one_wrong_time() {
    let case = Experiment::copy(SLIDE, "live_recovery/times");
    let some = |times: &[f64]| times.iter().map(|time| Some(*time)).collect::<Vec<_>>();
    // the first time is wrong: one more row shows it
    let run = session(&case, &[], &rows([4e9, 0.0, 0.03, 0.06, 0.09]));
    let expected = [some(&[4e9]), vec![None], some(&[0.03, 0.06, 0.09])].concat();
    assert_eq!((answers(&run), run.status.code()), (expected, Some(3)));
    // one in the middle, ahead and behind, costs itself alone
    let run = session(&case, &[], &rows([50.0, 50.03, 4e9, 50.06, 3.0, 50.09]));
    let expected = vec![
        Some(50.0),
        Some(50.03),
        None,
        Some(50.06),
        None,
        Some(50.09),
    ];
    assert_eq!(answers(&run), expected);
    // a source that counts from 0 again, as a simulation that is reset
    let run = session(&case, &[], &rows([50.0, 50.03, 0.0, 0.03, 0.06]));
    let expected = vec![Some(50.0), Some(50.03), None, Some(0.03), Some(0.06)];
    assert_eq!(answers(&run), expected);
    let told = String::from_utf8_lossy(&run.stderr);
    assert!(told.contains("1 restart"), "{told}");
    // late rows that come in one burst are no other clock
    let run = session(&case, &[], &rows([9.0, 9.03, 8.0, 8.03, 8.06, 9.06]));
    let expected = vec![Some(9.0), Some(9.03), None, None, None, Some(9.06)];
    assert_eq!(answers(&run), expected);
}

#[test]
fn recording_of_a_session_with_wrong_times_can_be_read() {
    let case = Experiment::copy(SLIDE, "live_recovery/recorded");
    let wrong_first = || [4e9].into_iter().chain(steady(60));
    let wrong_later = || {
        steady(30)
            .chain([3e9, 3e9 + 1.0])
            .chain(steady(60).skip(30))
    };
    for (name, times) in [
        ("first.csv", wrong_first().collect::<Vec<_>>()),
        ("first.mcap", wrong_first().collect()),
        ("later.mcap", wrong_later().collect()),
    ] {
        let path = case.folder.join(name).display().to_string();
        let run = session(&case, &["--record", &path], &rows(times));
        let told = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(3), "{told}");
        let mut filter = stickslip();
        filter.args(["filter", &path, "--scene", &case.scene(), "--json"]);
        let frames = json(filter.args(["--method", "kalman"]))["frames"].as_u64();
        // all but the wrong ones and those that showed it
        assert!(frames >= Some(58), "{name}: {frames:?} rows, {told}");
    }
}

/// A recording that fails ends no session: the robot has its answers.
#[test]
#[cfg(target_os = "linux")]
fn session_goes_on_when_the_disk_of_its_recording_is_full() {
    let case = Experiment::copy(SLIDE, "live_recovery/full");
    for ending in ["csv", "mcap"] {
        let path = case.folder.join(format!("full.{ending}"));
        // no file may grow beyond 64 KiB, as on a full disk
        let source = case.folder.join("rows");
        fs::write(&source, rows(steady(2000))).unwrap();
        let mut command = std::process::Command::new("bash");
        let limited = "trap '' XFSZ; ulimit -f 64; exec \"$@\"";
        command.args(["-c", limited, "bash", env!("CARGO_BIN_EXE_stickslip")]);
        command.args(["live", &case.scene(), "--particles", "20", "--record"]);
        let pipe = command
            .arg(&path)
            .stdin(fs::File::open(&source).unwrap())
            .output();
        let run = pipe.unwrap();
        let told = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(3), "{told}");
        let expected: Vec<Option<f64>> = steady(2000).map(Some).collect();
        assert_eq!(answers(&run), expected);
        assert_eq!(told.matches("the session goes on").count(), 1, "{told}");

        let mut filter = stickslip();
        filter.args(["filter", &path.display().to_string(), "--method", "kalman"]);
        let read = filter
            .args(["--scene", &case.scene(), "--json"])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&read.stderr);
        assert_eq!(read.status.code(), Some(3), "{told}");
        let report: Value = serde_json::from_slice(&read.stdout).unwrap();
        assert!(report["frames"].as_u64() > Some(50), "{report}");
    }
}

#[test]
fn of_two_sessions_that_begin_one_recording_one_is_refused() {
    let case = Experiment::copy(SLIDE, "live_recovery/two");
    for round in 0..10 {
        let path = case.folder.join(format!("{round}.csv"));
        let begin = || {
            let mut command = stickslip();
            command.args(["live", &case.scene(), "--record"]).arg(&path);
            command.stdin(Stdio::null()).stdout(Stdio::null());
            command.stderr(Stdio::piped()).spawn().unwrap()
        };
        let both = [begin(), begin()].map(|child| child.wait_with_output().unwrap());
        let mut codes = both.each_ref().map(|run| run.status.code());
        codes.sort_unstable();
        assert_eq!(codes, [Some(0), Some(1)]);
        let refused = both
            .iter()
            .find(|run| run.status.code() == Some(1))
            .unwrap();
        let told = String::from_utf8_lossy(&refused.stderr);
        assert!(told.contains("is there already"), "{told}");
    }
}

#[test]
#[cfg(unix)]
fn signals_end_a_session_as_the_end_of_its_source_does() {
    use std::io::{BufRead, BufReader};
    let folder = empty_folder("live_recovery/signals");
    let case = Experiment::copy(SLIDE, "live_recovery/signals_case");
    for signal in ["-INT", "-TERM"] {
        let path = folder.join(format!("kept{signal}.mcap"));
        let mut command = stickslip();
        command.args(["live", &case.scene(), "--particles", "20", "--record"]);
        let pipes = command
            .arg(&path)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = pipes.spawn().unwrap();
        let mut input = child.stdin.take().unwrap();
        input.write_all(rows(steady(40)).as_bytes()).unwrap();
        let answers = BufReader::new(child.stdout.take().unwrap()).lines();
        assert_eq!(answers.take(40).map_while(Result::ok).count(), 40);
        let mut kill = std::process::Command::new("kill");
        let killed = kill.args([signal, &child.id().to_string()]).status();
        assert!(killed.unwrap().success());
        let run = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(0), "{told}");
        assert!(
            told.contains("40 rows") && told.contains("wrote "),
            "{told}"
        );
        drop(input);
        // with its footer, or the exit code would be 3
        let mut filter = stickslip();
        filter.args(["filter", &path.display().to_string(), "--method", "kalman"]);
        let frames = &json(filter.args(["--scene", &case.scene(), "--json"]))["frames"];
        assert_eq!(*frames, 40);
    }
}
