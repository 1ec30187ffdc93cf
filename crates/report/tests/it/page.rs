//! The report as a file: nothing is loaded, nothing breaks out of its place, the data are right and
//! few.

use crate::common::{experiment, log, setup, truth};
use serde_json::Value;
use stickslip::Log;
use stickslip::dynamics::Twist;
use stickslip_evaluation::Variant;
use stickslip_report::{Block, Report, ReportedExperiment, Section, Table};

const HOSTILE: &str = "</script><script>alert(1)</script> \"'<b>&amp; http://example.org";

fn page(rows: usize, particles: usize, name: &str) -> String {
    let (setup, log) = (setup(), log(rows));
    let experiment = experiment(name, &setup, &log, particles);
    Report {
        title: name.to_owned(),
        sections: vec![experiment.section()],
        ..Report::default()
    }
    .to_html()
}

/// The JSON that the page's script reads.
fn data(page: &str) -> Value {
    let start = page.find(r#"<script type="application/json">"#).unwrap()
        + r#"<script type="application/json">"#.len();
    let length = page[start..].find("</script>").unwrap();
    serde_json::from_str(&page[start..start + length]).unwrap()
}

#[test]
fn a_page_loads_nothing() {
    let text = page(60, 5, "test");
    for address in [
        "http:",
        "https:",
        "//cdn",
        "@import",
        "src=\"/",
        "url(/",
        "fetch(",
        "XMLHttpRequest",
        "import(",
    ] {
        // names of XML namespaces are no addresses
        let others = text.replace("http://www.w3.org/2000/svg", "");
        assert!(!others.contains(address), "{address}");
    }
    for link in text
        .split("href=\"")
        .skip(1)
        .chain(text.split("src=\"").skip(1))
    {
        assert!(
            link.starts_with("data:") || link.starts_with('#'),
            "{}",
            &link[..40]
        );
    }
}

/// A table is read back from its address as a browser does, by RFC 3986.
#[test]
fn a_download_holds_every_byte() {
    let bytes = "time,x,#,%\n0.5,-1e-9,\"a b\",μ\r\n".as_bytes();
    let block = Block::Download {
        name: "t.csv".to_owned(),
        what: "all".to_owned(),
        bytes: bytes.to_vec(),
    };
    let page = Report {
        summary: vec![block],
        ..Report::default()
    };
    let page = page.to_html();
    let (_, data) = page.split_once("href=\"data:text/csv,").unwrap();
    let mut parts = data.split_once('"').unwrap().0.split('%');
    let mut read = parts.next().unwrap().as_bytes().to_vec();
    for part in parts {
        read.push(u8::from_str_radix(&part[..2], 16).unwrap());
        read.extend(part[2..].bytes());
    }
    assert_eq!(read, bytes);
}

/// Poses that the camera lost just before the occlusion belong to it; others do not.
#[test]
fn the_camera_is_off_from_the_last_pose_on() {
    let (setup, mut log) = (setup(), log(90));
    for row in [10, 11, 50, 51, 52, 53, 60, 89] {
        log.object[row] = None;
    }
    // rows are hidden from 54 on
    let said = experiment("gaps", &setup, &log, 5).sentences();
    assert_eq!(
        said[1].text,
        "The camera turns off at 1.6 s, 0.2 s before the object touches a fixel, and stays off. \
         It also gives no pose in 2 of the 50 other rows."
    );
}

#[test]
fn camera_that_is_on_or_loses_the_object_is_said_so() {
    let (setup, mut log) = (setup(), log(90));
    let said = |log: &Log, latency: f64| {
        let mut experiment = experiment("on", &setup, log, 5);
        experiment.hidden.fill(false);
        experiment.reference.latency = latency;
        experiment.sentences()[1].text.clone()
    };
    assert_eq!(said(&log, 0.0), "The camera is on all the time.");
    log.object[20..23].fill(None);
    assert_eq!(
        said(&log, 0.16),
        "No row is occluded on purpose. The camera gives no pose in 3 of 90 rows. \
         The camera lags by 0.16 s: its poses and errors are drawn at the times of exposure."
    );
}

#[test]
fn hostile_names_stay_text() {
    let text = page(60, 5, HOSTILE);
    assert!(
        !text.contains("<script>alert") && !text.contains("<b>&"),
        "escaped"
    );
    // one style sheet's worth of scripts: the data and the player
    assert_eq!(text.matches("<script").count(), 2);
    assert_eq!(text.matches("</script>").count(), 2);
    assert_eq!(data(&text)["marks"][0][1], format!("pusher {HOSTILE}"));
}

/// Ten minutes at 30 Hz: the player covers them all, figures say their part, the page stays small.
#[test]
fn page_of_ten_minutes_shows_all_and_stays_small() {
    let rows = 18_000;
    let text = page(rows, 30, "long");
    assert!(text.len() < 5_000_000, "{} bytes", text.len());
    let data = data(&text);
    let time = data["time"].as_array().unwrap();
    let (stride, last) = (data["stride"].as_u64().unwrap(), time.last().unwrap());
    assert_eq!((stride, time.len()), (6, 3000));
    assert!(last.as_f64().unwrap() > 1e3 * 599.7, "{last}");
    for words in [
        "One row in 6 of 18000 is played back.",
        "Errors against time over the whole log.",
        " s of 0.0 to 600.0 s.",
        "is not in this page",
    ] {
        assert!(text.contains(words), "{words}");
    }
}

/// Camera at 10 Hz, pusher at 30 Hz: the camera is on between its poses, and no body blinks.
#[test]
fn rows_of_another_sensor_are_no_occlusion() {
    let (setup, mut log) = (setup(), log(90));
    for row in (0..90).filter(|row| row % 3 != 0) {
        log.object[row] = None;
    }
    let experiment = experiment("mixed", &setup, &log, 5);
    // before the second pose nothing tells how often they come
    let said = &experiment.sentences()[1].text;
    assert!(said.contains("no pose in 2 of the 54 other rows"), "{said}");
    let report = Report {
        sections: vec![experiment.section()],
        ..Report::default()
    };
    let data = data(&report.to_html());
    // hidden from row 54 on
    let hidden = data["hidden"].as_array().unwrap();
    assert!((3..54).all(|row| hidden[row] == 0), "{hidden:?}");
    let x = data["truth"]["x"].as_array().unwrap();
    assert!((3..90).all(|row| x[row].is_number()), "{x:?}");
}

#[test]
fn data_read_back_to_the_numbers_they_were() {
    let rows = 90;
    let data = data(&page(rows, 4, "test"));
    let number = |value: &Value| value.as_f64().unwrap();
    assert_eq!(
        (&data["stride"], data["time"].as_array().unwrap().len()),
        (&1.into(), rows)
    );
    for row in [0, 31, 89] {
        let pose = truth(row, rows);
        let at = |key: &str| number(&data["truth"][key][row]);
        assert!(
            (at("x") / 1e5 - pose.x).abs() <= 0.5e-5 && (at("y") / 1e5 - pose.y).abs() <= 0.5e-5
        );
        assert!((at("theta") / 1e4 - pose.theta).abs() <= 0.5e-4);
        assert_eq!(
            number(&data["time"][row]),
            (1e3 * row as f64 / 30.0).round()
        );
        // what the player draws is the sum of an estimate and a particle's offset
        let method = &data["methods"][3];
        for particle in 0..4 {
            let x = number(&method["pose"]["x"][row]) + number(&method["cloud"][row][3 * particle]);
            assert!((x / 1e5 - (pose.x + 1e-3 * libm::sin(particle as f64))).abs() <= 0.6e-5);
        }
        let off = 2e-4_f64;
        assert!(
            (number(&method["error"][row]) - 1e6 * off * libm::sin(row as f64).hypot(1.0)).abs()
                < 0.51
        );
    }
    assert!(data["fingerPoses"][0]["x"][3].is_null() && data["fingerPoses"][0]["x"][4].is_number());
    assert_eq!(data["dark"], serde_json::json!([[54, 90]]));
    assert_eq!(
        (&data["hidden"][53], &data["hidden"][54]),
        (&0.into(), &1.into())
    );
    assert_eq!(data["touches"][0]["truth"][0], 1);
    assert!(
        data["touches"][1]["truth"].is_null()
            && data["touches"][1]["sensed"][89] == 1
            && data["touches"][2]["sensed"].is_null()
    );
    // as the run has them, and more where drawn particles lie at a body
    for (body, least) in [50, 25, 100].into_iter().enumerate() {
        let shares: Vec<u64> = data["methods"][3]["contact"][body]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| p.as_u64().unwrap())
            .collect();
        assert_eq!(shares[..30], [least; 30]);
        assert!(shares.len() == 90 && shares.iter().all(|p| (least..=100).contains(p)));
    }
    assert!(
        data["methods"][2]["contact"].is_null(),
        "only one method's contacts are shown"
    );
    // the filter without touch is dashed, the one whose camera is on dotted
    assert_eq!(data["order"], serde_json::json!([0, 1, 3, 2, 4]));
}

#[test]
fn an_experiment_of_600_rows_stays_below_2_mb() {
    let (setup, log) = (setup(), log(600));
    let mut experiment = experiment("test", &setup, &log, 60);
    // without contacts, all rows are shown
    experiment.contacts.clear();
    let text = Report {
        sections: vec![experiment.section()],
        ..Report::default()
    }
    .to_html();
    assert_eq!(data(&text)["time"].as_array().unwrap().len(), 600);
    assert!(text.len() < 2_000_000, "{}", text.len());
}

#[test]
fn one_line_says_what_is_known_of_friction() {
    let (setup, log) = (setup(), log(60));
    let mut experiment = experiment("test", &setup, &log, 5);
    let line = |experiment: &ReportedExperiment<'_>| {
        let all = experiment.sentences().into_iter();
        let mut lines = all
            .map(|sentence| sentence.text)
            .filter(|line| line.contains("Friction"));
        (lines.next().unwrap(), lines.next())
    };
    let (unknown, none) = (
        "Friction: not identifiable from this push; the scene's values were used.".to_owned(),
        None,
    );
    assert_eq!(line(&experiment), (unknown, none));

    // seen in motion, with a prior four times as wide for all but mu_f
    for run in &mut experiment.runs {
        for (k, row) in run.scored.estimate.rows.iter_mut().enumerate() {
            row.visual = true;
            row.contact_pusher = Some(1.0);
            row.twist = Some(Twist {
                vx: 0.02,
                vy: 0.0,
                omega: 0.0,
            });
            if let Some(friction) = row
                .spread
                .as_mut()
                .and_then(|spread| spread.friction.as_mut())
                && k == 0
            {
                (friction.mu_s, friction.mu_p, friction.d_tri) = (0.04, 0.08, 0.004);
            }
        }
    }
    let (known, none) = (
        "Friction: mu_s 0.300 ± 0.010 (truth 0.350), mu_p 0.250 ± 0.020 (truth 0.200), d_tri 20.0 ± 1.0 mm (truth 21.0 mm). \
         Not identifiable from this push: mu_f."
            .to_owned(),
        None,
    );
    assert_eq!(line(&experiment), (known, none));
}

#[test]
fn figures_show_six_variants_and_the_table_all() {
    let (setup, log) = (setup(), log(60));
    let mut experiment = experiment("test", &setup, &log, 4);
    let run = experiment.runs[0].clone();
    experiment.runs = Variant::COMPARED
        .into_iter()
        .map(|variant| {
            let mut run = run.clone();
            run.scored.variant = variant;
            run
        })
        .collect();
    let table = experiment.scores().to_string();
    assert!(
        Variant::COMPARED
            .iter()
            .all(|variant| table.contains(variant.title()))
    );
    let names: Vec<String> = experiment
        .playback()
        .runs
        .into_iter()
        .map(|run| run.name)
        .collect();
    assert_eq!(names, Variant::DRAWN.map(Variant::title));
}

#[test]
fn an_animation_moves_every_body_and_is_small() {
    let (setup, log) = (setup(), log(600));
    let text = experiment("test", &setup, &log, 60).animation().to_svg();
    // pusher, truth, five estimates and 60 particles are moved and turned
    assert_eq!(text.matches("<animateTransform").count(), 2 * 67);
    let values = text.split("values=\"").skip(1);
    let frames: Vec<usize> = values
        .map(|rest| rest.split('"').next().unwrap().split(';').count())
        .collect();
    assert!(frames.iter().all(|count| *count == frames[0]), "{frames:?}");
    assert!(
        !text.contains("NaN") && text.len() < 500_000,
        "{}",
        text.len()
    );
}

#[test]
fn pages_of_nothing_and_of_one_row_are_pages() {
    for rows in [0, 1] {
        assert!(page(rows, 2, "test").ends_with("</html>"));
    }
    let block = Block::Table(Table::new(["a"]), String::new());
    let plain = Report {
        title: "t".to_owned(),
        summary: Vec::new(),
        sections: vec![Section {
            title: String::new(),
            blocks: vec![block],
        }],
        ..Report::default()
    };
    assert!(
        !plain.to_html().contains("<script"),
        "no script where nothing is played back"
    );
}

/// The paragraph next to the stage.
fn legend(experiment: &ReportedExperiment<'_>) -> String {
    let sections = vec![experiment.section()];
    let page = Report {
        sections,
        ..Report::default()
    };
    let text = page.to_html();
    let (_, after) = text.split_once("<p class=\"legend\">").unwrap();
    after.split_once("</p>").unwrap().0.to_owned()
}

/// A log of a camera tells of no contact; without sensors nothing is ever yellow, and a Kalman
/// filter has neither particles nor probabilities.
#[test]
fn the_legend_names_what_is_there() {
    let (setup, log) = (setup(), log(60));
    let known = experiment("test", &setup, &log, 5);
    assert_eq!(
        legend(&known),
        "Filled: the truth, dashed while the camera is off. Coloured outlines: estimates; thin ones: particles. \
         Pusher and fixels are yellow while they touch the object. \
         Rims turn yellow with the estimated probability of contact."
    );
    let mut sensed = experiment("test", &setup, &log, 5);
    sensed.touches.fill(None);
    assert!(legend(&sensed).contains("Fixels are yellow while their sensors are touched."));

    let mut bare = log.clone();
    bare.tactile.clear();
    let mut unknown = experiment("test", &setup, &bare, 5);
    unknown.touches.fill(None);
    unknown.runs.truncate(2);
    assert_eq!(
        legend(&unknown),
        "Filled: the truth, dashed while the camera is off. Coloured outlines: estimates."
    );
    let figures = unknown.figures();
    assert!(figures.iter().all(|figure| figure.name != "contacts"));
    assert!(!figures[0].caption.contains("shaded"));
}

/// A camera that sees the object before and after a push only: what is scored is shown.
#[test]
fn an_object_that_is_seen_at_the_ends_only_is_in_the_picture_and_compared() {
    let (setup, log) = (setup(), log(300));
    let mut experiment = experiment("test", &setup, &log, 5);
    experiment.reference.pose[1..299].fill(None);
    // without the pose at the end, the picture would end 4 s after the contact
    experiment.contacts.truncate(1);
    let sections = vec![experiment.section()];
    let text = Report {
        sections,
        ..Report::default()
    }
    .to_html();
    assert!(text.contains("against the truth, known in 2 of 300 rows."));
    let data = data(&text);
    assert_eq!(data["time"].as_array().unwrap().len(), 300);
    let view: Vec<f64> = serde_json::from_value(data["view"].clone()).unwrap();
    let [left, right] = [view[0], view[0] + view[2]];
    assert!(left < -25.0 && right > 60.0 + 25.0, "{view:?}");
    // the error at the end stands alone
    let errors = &experiment.figures()[0].drawing;
    assert!(errors.to_svg().contains("stroke-linecap=\"round\""));
}
