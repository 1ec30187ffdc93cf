//! Messages of the program about files that are no logs of its own, and about times in other units.

use std::fs;
use std::process::{Command, Stdio};

use crate::common::{Experiment, SLIDE, empty_folder, stickslip, succeeds};

/// Message of `filter` about a log under another name or with other content.
fn refusal(case: &Experiment, log: &str) -> String {
    let run = stickslip()
        .args(["filter", log, "--scene", &case.scene()])
        .output()
        .unwrap();
    let talk = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(1), "{talk}");
    talk
}

#[test]
#[cfg(unix)]
fn logs_in_pipes_are_refused_and_scenes_in_pipes_read() {
    let case = Experiment::copy(SLIDE, "inputs/pipes");
    let run = |arguments: [&str; 2], input: &str| {
        let file = fs::File::open(input).unwrap();
        let mut cat = Command::new("cat")
            .stdin(file)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let pipe = cat.stdout.take().unwrap();
        let mut command = stickslip();
        command.arg("check").args(arguments).stdin(pipe);
        let run = command.output().unwrap();
        cat.wait().unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    let (log, scene) = (case.log(), case.scene());
    let (code, told) = run(["/dev/stdin", &scene], &log);
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("/dev/stdin: this is a pipe"), "{told}");
    let (code, told) = run([&log, "--scene=/dev/stdin"], &scene);
    assert_eq!(code, Some(0), "{told}");
}

#[test]
fn other_kinds_of_recordings_are_named() {
    let case = Experiment::copy(SLIDE, "inputs/kinds");
    let write = |name: &str, bytes: &[u8]| {
        let path = case.folder.join(name);
        fs::write(&path, bytes).unwrap();
        path.display().to_string()
    };
    let bag = write("bag_0.db3", b"SQLite format 3\0 and more");
    assert!(refusal(&case, &bag).contains("ros2 bag convert"));
    let here = stickslip()
        .current_dir(&case.folder)
        .args(["filter", "bag_0.db3", "--scene", "scene.toml"])
        .output();
    let talk = String::from_utf8(here.unwrap().stderr).unwrap();
    assert!(talk.contains("ros2 bag convert -i . -o"), "{talk}");
    let info = stickslip().args(["info", &bag]).output().unwrap();
    let talk = String::from_utf8(info.stderr).unwrap();
    assert!(talk.contains("ros2 bag convert"), "{talk}");
    let packed = write("bag.mcap.zstd", &[0x28, 0xb5, 0x2f, 0xfd, 0, 0]);
    assert!(refusal(&case, &packed).contains("nothing could be read"));
    let table = write("log.csv.zstd", &[0x28, 0xb5, 0x2f, 0xfd, 0, 0]);
    assert!(refusal(&case, &table).contains("zstd -d"));
    let misnamed = write("bag.bin", b"\x89MCAP0\r\n");
    assert!(refusal(&case, &misnamed).contains("let its name end in .mcap"));
    let bag = case.folder.join("bag");
    fs::create_dir(&bag).unwrap();
    let told = |metadata: &str| {
        fs::write(bag.join("metadata.yaml"), metadata).unwrap();
        refusal(&case, &bag.display().to_string())
    };
    let of = |storage: &str, files: &str| {
        format!(
            "rosbag2_bagfile_information:\n  storage_identifier: {storage}\n  relative_file_paths: {files}\n"
        )
    };
    for (metadata, words) in [
        (
            "rosbag2_bagfile_information:\n".to_owned(),
            "this is no metadata of a bag: ",
        ),
        (
            of("mcap", "[../log.csv]"),
            "relative_file_paths has `../log.csv`; a bag's files lie in its folder",
        ),
        (
            of("mcap", "[a.mcap, b.mcap]"),
            "none of the bag's files is there: a.mcap, b.mcap",
        ),
        (
            of("sqlite3", "[a.db3]"),
            "this is a bag in SQLite (.db3); bags are read as MCAP",
        ),
        (
            of("sqlite3", "[a.db3]"),
            "bag_mcap, storage_id: mcap, all: true}]` into convert.yaml, then `ros2 bag convert -i",
        ),
    ] {
        let told = told(&metadata);
        assert!(told.contains(words), "{told}");
    }
}

#[test]
fn times_in_other_units_are_named() {
    for (name, factor, offset) in [
        ("milliseconds", 1e3, 0.0),
        ("microseconds", 1e6, 0.0),
        ("nanoseconds", 1e9, 1.7e18),
    ] {
        let case = Experiment::copy(SLIDE, &format!("inputs/{name}"));
        case.edit_rows(|rows| {
            for row in rows {
                row[0] = offset + factor * row[0];
            }
        });
        let talk = refusal(&case, &case.log());
        assert!(
            talk.contains("row 1 is at") && talk.contains(name),
            "{talk}"
        );
        assert!(talk.contains("Give all times in seconds"), "{talk}");
    }
}

#[test]
fn a_message_is_printable_and_of_a_length_to_read() {
    let case = Experiment::copy(SLIDE, "inputs/long");
    case.edit("scene.toml", |text| {
        format!("\"\\u001b[31mred\" = 1\n{text}")
    });
    let talk = refusal(&case, &case.log());
    assert!(
        talk.contains("u{1b}[31mred") && !talk.contains('\u{1b}'),
        "{talk:?}"
    );
    case.edit("scene.toml", |text| {
        format!("{}\n{text}", "x".repeat(1_000_000))
    });
    assert!(refusal(&case, &case.log()).len() < 5000);
}

#[test]
fn compare_takes_topics() {
    let case = Experiment::copy(SLIDE, "inputs/topics");
    let bag = |topic: &str| {
        let mut command = stickslip();
        command.args([
            "compare",
            &case.folder.display().to_string(),
            "--topic",
            topic,
        ]);
        let run = command.output().unwrap();
        String::from_utf8(run.stderr).unwrap()
    };
    assert!(bag("object=/box").contains("topics are for MCAP logs"));
    assert!(bag("nobody=/box").contains("none of the keys"));
}

#[test]
fn new_scene_is_ready_to_use() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("inputs/new");
    let _ = fs::remove_dir_all(&folder);
    let at = |name: &str| folder.join(name).display().to_string();
    let run = succeeds(stickslip().args(["new", &at("")]));
    let told = String::from_utf8(run.stdout).unwrap();
    assert!(
        told.contains("object.inertia is missing; 2.083e-4 kg m^2 is assumed"),
        "{told}"
    );
    let again = stickslip().args(["new", &at("")]).output().unwrap();
    assert_eq!(again.status.code(), Some(1), "a scene is not written over");
    assert!(
        fs::read_to_string(at("scene.schema.json"))
            .unwrap()
            .contains("\"tripod_radius\"")
    );
}

#[test]
fn new_takes_an_outline_from_a_drawing() {
    let folder = empty_folder("inputs/outline");
    let at = |name: &str| folder.join(name).display().to_string();
    fs::write(
        at("ell.svg"),
        "<svg xmlns='http://www.w3.org/2000/svg' width='80mm' height='60mm' viewBox='0 0 80 60'><path d='M10 10h40v20h-20v20h-20z'/></svg>",
    )
    .unwrap();
    let run = succeeds(stickslip().args(["new", &at("my"), "--outline", &at("ell.svg")]));
    let told = String::from_utf8(run.stdout).unwrap();
    for words in [
        "outline: 40.000 x 40.000 mm, 1200.0 mm^2, 6 vertices in 2 convex parts",
        "the drawing is in mm, as it says",
        "object.inertia is missing",
    ] {
        assert!(told.contains(words), "{words} is not in\n{told}");
    }
    let scene = fs::read_to_string(folder.join("my/scene.toml")).unwrap();
    let shape = stickslip_formats::read_scene(&scene, "scene.toml").unwrap();
    assert_eq!(shape.scene.object.shape.parts().len(), 2);

    fs::write(at("hole.svg"), "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0h40v40h-40z M25 5h10v10h-10z'/></svg>").unwrap();
    let run = succeeds(stickslip().args([
        "new",
        &at("other"),
        "--outline",
        &at("hole.svg"),
        "--scale",
        "0.001",
    ]));
    let warned = String::from_utf8(run.stderr).unwrap();
    assert!(warned.contains("1 hole left out"), "{warned}");

    for (arguments, words) in [
        (
            &["--outline", "part.step"][..],
            "only drawings whose names end in .svg or .dxf",
        ),
        (&["--outline", &at("none.dxf")], "none.dxf"),
    ] {
        let run = stickslip()
            .args(["new", &at("third")])
            .args(arguments)
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(
            run.status.code() == Some(1) && told.contains(words),
            "{told}"
        );
        assert!(
            !folder.join("third").exists(),
            "nothing is written where a drawing is refused"
        );
    }
}
