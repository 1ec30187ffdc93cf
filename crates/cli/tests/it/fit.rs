//! `stickslip fit`: its output and its refusals.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use crate::common::{Experiment, empty_folder, json, stickslip, succeeds};
use stickslip_formats::{Topics, read_log, write_log_mcap};

/// A plate on three feet that a finger pushes on; the pusher's friction is 0.3 to the scene.
fn scene(place: f64, turn: f64) -> String {
    let direction = std::f64::consts::FRAC_PI_2 + turn;
    let (x, y) = (place, -0.0285);
    format!(
        "# a plate
gravity = 9.81
object  = {{ mass = 0.5, inertia = 3.3e-4, shape = [{{ polygon = [[-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]] }}] }}
support = {{ friction = 0.3, tripod_radius = 0.025 }}
fixels  = {{ friction = 0.25 }}
camera  = {{ position_std = 3.0e-4, orientation_std = 5.0e-3 }}
[pusher]
friction = 0.30 # a guess
stall_force = 100.0
shape = [{{ disc = {{ radius = 0.005 }} }}]
[start]
object = [0, 0, 0]
pusher = [{x}, {y}, 0]
direction = {direction}
speed = 0.02
duration = 1.0
"
    )
}

/// Folders with `count` pushes under a pusher of friction 0.5, below one folder of this test.
fn pushes(test: &str, count: usize) -> PathBuf {
    let folder = empty_folder(test);
    for k in 0..count {
        let place = [-0.025, 0.015, -0.01, 0.028][k % 4];
        let turn = [0.5, -0.6, 0.3, -0.4][k % 4];
        let start = folder.join(format!("start-{k}.toml"));
        let true_scene = scene(place, turn).replace("friction = 0.30", "friction = 0.50");
        fs::write(&start, true_scene).unwrap();
        let push = folder.join("pushes").join(format!("push-{k}"));
        succeeds(
            stickslip()
                .args(["simulate", "--physics", "model", "--seed", &k.to_string()])
                .arg(&start)
                .arg("--out")
                .arg(&push),
        );
        fs::write(push.join("scene.toml"), scene(place, turn)).unwrap();
    }
    folder
}

fn fit(pushes: &Path, out: &Path) -> std::process::Command {
    let mut command = stickslip();
    command.arg("fit").arg(pushes).arg("--out").arg(out);
    command
}

#[test]
fn fit_writes_a_scene_that_filters_and_keeps_its_comments() {
    let folder = pushes("fit-writes", 4);
    let out = folder.join("out");
    let result = json(fit(&folder.join("pushes"), &out).args(["--free", "mu_p,mu_f", "--json"]));
    let written = fs::read_to_string(out.join("fit.json")).unwrap();
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&written).unwrap(),
        result
    );

    // the pusher's friction is found, that of fixels is not
    let [mu_p, mu_f] = [0, 1].map(|k| &result["parameters"][k]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert_eq!([&mu_p["determined"], &mu_f["determined"]], [true, false]);
    let [value, std] = ["value", "std"].map(|key| number(&mu_p[key]));
    assert!((value - 0.5).abs() < 3.0 * std && std < 0.1, "{mu_p}");
    assert!((number(&mu_f["value"]) - 0.25).abs() < 0.05, "{mu_f}");

    // both stand in the scene, which other commands take
    let scene = fs::read_to_string(out.join("scene.toml")).unwrap();
    let line = scene
        .lines()
        .find(|line| line.ends_with("# a guess"))
        .unwrap();
    let in_scene: f64 = line.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!((in_scene - value).abs() < 1e-5 * value, "{line}");
    for expected in [
        "# a plate",
        "[uncertainty]",
        "not identifiable from them: mu_f",
    ] {
        assert!(scene.contains(expected), "{expected} in {scene}");
    }
    let log = folder.join("pushes/push-0/log.csv");
    succeeds(
        stickslip()
            .arg("filter")
            .arg(log)
            .arg("--scene")
            .arg(out.join("scene.toml")),
    );

    // as text, with a push of --test
    let named = |k: usize| folder.join(format!("pushes/push-{k}"));
    let output = succeeds(
        fit(&named(0), &out)
            .arg(named(1))
            .arg(named(2))
            .args(["--free", "mu_f", "--folds", "0", "--test"])
            .arg(named(3))
            .arg("--report")
            .arg(out.join("fit.html")),
    );
    // the page plays the push of --test back, and has its final pose
    let page = fs::read_to_string(out.join("fit.html")).unwrap();
    for words in [
        "push-3: largest error of pushes of --test",
        "median of the posterior",
        "mu_f: R-hat",
        "final pose, predicted - measured (mm)",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("pushes of --test, median"), "{text}");
    assert!(text.contains("not identifiable"), "{text}");
}

/// Bags and tables without scenes of their own are fitted with one scene.
#[test]
fn logs_are_fitted_with_one_scene() {
    let folder = pushes("fit-logs", 3);
    let named = |k: usize| folder.join(format!("pushes/push-{k}"));
    let options = ["--free", "mu_p", "--folds", "0", "--json"];
    let of_folders = json(fit(&folder.join("pushes"), &folder.join("out")).args(options));
    let logs = [0, 1, 2].map(|k| {
        let log = fs::read(named(k).join("log.csv")).unwrap();
        let to = folder.join(if k < 2 {
            format!("push-{k}.mcap")
        } else {
            format!("push-{k}.csv")
        });
        let bytes = match k {
            2 => log,
            _ => {
                let (log, _) = read_log(log.as_slice(), "log.csv").unwrap();
                let topics = Topics::new(["object=/box".parse().unwrap()]).unwrap();
                let mut bytes = Cursor::new(Vec::new());
                write_log_mcap(&mut bytes, &log, &topics).unwrap();
                bytes.into_inner()
            }
        };
        fs::write(&to, bytes).unwrap();
        to
    });
    let scene = named(0).join("scene.toml");
    let of_logs = |logs: &[PathBuf], more: &[&str]| {
        let mut command = stickslip();
        command.arg("fit").args(logs).arg("--scene").arg(&scene);
        command.arg("--out").arg(folder.join("of-logs"));
        command.args(options).args(more);
        command
    };
    let close = |result: serde_json::Value, expected: &serde_json::Value| {
        let [a, b] = [&result, expected].map(|fit| fit["parameters"][0]["value"].as_f64().unwrap());
        // a bag has quaternions
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    };
    let bags = json(&mut of_logs(&logs[..2], &["--topic", "object=/box"]));
    let of_two = fit(&named(0), &folder.join("two"))
        .arg(named(1))
        .args(options)
        .output();
    close(
        bags,
        &serde_json::from_slice(&of_two.unwrap().stdout).unwrap(),
    );
    let tables = [0, 1, 2].map(|k| named(k).join("log.csv"));
    close(json(&mut of_logs(&tables, &[])), &of_folders);

    // a topic that is not there, and an input as the report's place
    let run = of_logs(&logs[..2], &[]).output().unwrap();
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(
        told.contains("push-0.mcap") && told.contains("--topic object="),
        "{told}"
    );
    let report = logs[1].to_str().unwrap();
    let run = of_logs(&logs[..2], &["--report", report]).output().unwrap();
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(told.contains("would destroy what is read"), "{told}");
}

/// A call that was interrupted after the first object goes on with the second one, and ends as if
/// it had made both. Other options or pushes are fitted again.
fn goes_on(pushes: &Path, out: &Path, options: &[&str], page: &str) {
    let files = ["heavy", "plate"].map(|name| out.join(name).join("fit.json"));
    let before = files
        .each_ref()
        .map(|file| fs::read_to_string(file).unwrap());
    let kept = |more: &[&str]| {
        let report = out.join("fit.html");
        let run = fit(pushes, out)
            .args(options)
            .arg("--report")
            .arg(report)
            .args(more)
            .output();
        let told = String::from_utf8(run.unwrap().stderr).unwrap();
        ["heavy", "plate"].map(|name| told.contains(&format!("{name}: this fit is of the same")))
    };
    fs::remove_file(&files[1]).unwrap();
    assert_eq!(kept(&[]), [true, false]);
    assert_eq!(
        files
            .each_ref()
            .map(|file| fs::read_to_string(file).unwrap()),
        before
    );
    assert_eq!(fs::read_to_string(out.join("fit.html")).unwrap(), page);
    assert_eq!(kept(&["--seed", "1"]), [false, false]);
    let log = pushes.join("heavy_1/log.csv");
    let rows = fs::read_to_string(&log).unwrap();
    let fewer = rows.trim_end().rsplit_once('\n').unwrap().0;
    fs::write(&log, fewer).unwrap();
    assert_eq!(kept(&["--seed", "1"]), [false, true]);
}

#[test]
fn objects_are_fitted_on_their_own() {
    let folder = pushes("fit-objects", 4);
    let pushes = folder.join("pushes");
    let named = |k: usize, name: &str| {
        let to = pushes.join(name);
        fs::rename(pushes.join(format!("push-{k}")), &to).unwrap();
        to
    };
    named(0, "plate_08");
    named(1, "plate_10");
    // a heavier plate moves the same way
    for (k, name) in [(2, "heavy_1"), (3, "heavy_2")] {
        let scene = named(k, name).join("scene.toml");
        let text = fs::read_to_string(&scene).unwrap();
        let heavier = text.replace(
            "mass = 0.5, inertia = 3.3e-4",
            "mass = 1.0, inertia = 6.6e-4",
        );
        fs::write(&scene, heavier).unwrap();
    }
    let options = ["--free", "mu_p", "--folds", "0"];
    let out = folder.join("out");
    let run = succeeds(
        fit(&pushes, &out)
            .args(options)
            .arg("--report")
            .arg(out.join("fit.html")),
    );
    let told = String::from_utf8(run.stdout).unwrap();
    for words in [
        "Fit to 2 pushes of heavy\n",
        "Fit to 2 pushes of plate\n",
        "object",
        "heavy ",
    ] {
        assert!(told.contains(words), "{words} in {told}");
    }
    let page = fs::read_to_string(out.join("fit.html")).unwrap();
    assert!(page.contains("Fits of 2 objects") && page.contains("plate: fitted parameters"));

    // each has the numbers of a call of its own
    for (name, folders) in [
        ("heavy", ["heavy_1", "heavy_2"]),
        ("plate", ["plate_08", "plate_10"]),
    ] {
        let [one, other] = folders.map(|push| pushes.join(push));
        let alone = folder.join("alone").join(name);
        succeeds(fit(&one, &alone).arg(other).args(options));
        let read = |out: &Path| -> serde_json::Value {
            serde_json::from_str(&fs::read_to_string(out.join("fit.json")).unwrap()).unwrap()
        };
        let (mut together, alone_json) = (read(&out.join(name)), read(&alone));
        assert_eq!(
            together.as_object_mut().unwrap().remove("object").unwrap(),
            name
        );
        assert_eq!(together, alone_json);
        let scene = |out: &Path| fs::read_to_string(out.join("scene.toml")).unwrap();
        assert_eq!(scene(&out.join(name)), scene(&alone));
    }
    assert!(!out.join("fit.json").exists());
    goes_on(&pushes, &out, &options, &page);

    // one push of an object is too few, found before any fit
    fs::remove_dir_all(pushes.join("plate_08")).unwrap();
    let run = fit(&pushes, &folder.join("none"))
        .args(options)
        .output()
        .unwrap();
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(
        told.contains("plate_10: 1 push given; at least 2"),
        "{told}"
    );
    assert!(!folder.join("none").exists());
}

#[test]
fn fit_refuses_with_the_next_step() {
    let folder = pushes("fit-refuses", 2);
    let (pushes, out) = (folder.join("pushes"), folder.join("out"));
    let refusal = |command: &mut std::process::Command| {
        let output = command.output().unwrap();
        assert!(!output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };

    let text = refusal(fit(&pushes, &out).args(["--free", "mu_pp"]));
    assert!(
        text.contains("`mu_pp` is no parameter") && text.contains("did you mean `mu_p`?"),
        "{text}"
    );
    let text = refusal(&mut fit(&pushes.join("push-0"), &out));
    assert!(text.contains("1 push given; at least 2"), "{text}");
    let text = refusal(stickslip().args(["fit", "--out"]).arg(&out));
    assert!(text.contains("<DIR>"), "{text}");
    let text = refusal(&mut fit(&folder.join("nowhere"), &out));
    assert!(text.contains("nowhere"), "{text}");
    let text = refusal(fit(&pushes, &pushes.join("push-0")).args(["--folds", "0"]));
    assert!(text.contains("would destroy what is read"), "{text}");
    let text = refusal(fit(&pushes, &out).arg("--test").arg(pushes.join("push-1")));
    assert!(
        text.contains("push-1: --test names a push that is also fitted"),
        "{text}"
    );
    let text = refusal(fit(&pushes, &out).args(["--folds", "2"]));
    assert!(text.contains("at least 4"), "{text}");

    // scenes that disagree
    let scene = pushes.join("push-1/scene.toml");
    let text = fs::read_to_string(&scene).unwrap();
    fs::write(&scene, text.replace("friction = 0.30", "friction = 0.35")).unwrap();
    let text = refusal(&mut fit(&pushes, &out));
    assert!(
        text.contains("mu_p is 0.3 ") && text.contains("0.35"),
        "{text}"
    );
    assert!(!out.exists(), "a fit that was refused leaves nothing");
}

/// The push that a test spoils.
fn push_1(folder: &Path) -> Experiment {
    Experiment {
        folder: folder.join("pushes/push-1"),
    }
}

#[test]
fn push_that_touches_nothing_is_no_push() {
    let folder = pushes("fit/untouched", 2);
    // as long as the object rests, the pusher 5 cm away
    push_1(&folder).edit_rows(|rows| {
        rows.truncate(5);
        rows.iter_mut().for_each(|row| row[5] -= 0.05);
    });
    let run = fit(&folder.join("pushes"), &folder.join("out"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(
        told.contains("push-1: nothing touches the object") && told.contains("It is no push"),
        "{told}"
    );
}

#[test]
fn push_that_filter_refuses_is_refused_unless_forced() {
    let folder = pushes("fit/millimetres", 2);
    push_1(&folder).edit_rows(|rows| {
        for row in rows {
            [1, 2, 4, 5].into_iter().for_each(|k| row[k] *= 1e3);
        }
    });
    let run = fit(&folder.join("pushes"), &folder.join("out"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(
        told.contains("push-1") && told.contains("millimetres") && told.contains("--force"),
        "{told}"
    );
    let mut forced = fit(&folder.join("pushes"), &folder.join("out"));
    succeeds(forced.args(["--force", "--folds", "0"]));
}
