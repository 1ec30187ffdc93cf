//! Recordings with several runs, repeated messages, bodies that were not seen.

use std::io::Cursor;

use crate::bag::{
    Line, MS, Order, file, object, pose, pusher, quaternion, read, stamped, touch, transforms, xs,
};
use proptest::prelude::*;
use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{
    BagOptions, BagPart, Reason, Topics, read_bag, read_bag_info, read_log_mcap, write_log_mcap,
};

fn refused(lines: &[Line]) -> String {
    let read = read_log_mcap(&file(lines)[..], "bag.mcap", &Topics::default());
    read.expect_err("must be refused").to_string()
}

/// A message recorded at a time of its own.
fn at(log_time: i64, line: Line) -> Line {
    Line { log_time, ..line }
}

/// Poses of both bodies at 30 Hz from `stamp` on, recorded from `log_time` on.
fn run(count: i64, stamp: i64, log_time: i64) -> Vec<Line> {
    let frames = (0..count).map(|k| 33 * MS * k);
    frames
        .flat_map(|t| {
            [
                at(log_time + t, object(stamp + t, 0.001 * (t / MS) as f64)),
                at(log_time + t, pusher(stamp + t, 0.002 * (t / MS) as f64)),
            ]
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn stamps_that_jump_back_are_refused(
        count in 10..60_i64,
        back in 0.1..1.0_f64,
        wait in 0..5000_i64,
    ) {
        let length = 33 * MS * count;
        let back = (back * length as f64) as i64;
        prop_assume!(back > 5 * 33 * MS);
        let start = 5000 * MS;
        let mut lines = run(count, start, start);
        lines.extend(run(count, start + length - back, start + length + wait * MS));
        let text = refused(&lines);
        let place = format!("bag.mcap: /object/pose, message {}", count + 1);
        prop_assert!(text.starts_with(&place), "{text}");
        prop_assert!(text.contains("header.stamp jumps back from") && text.contains("Read one run"), "{text}");
    }
}

#[test]
fn jump_back_is_found_in_every_topic_and_clock() {
    let mut lines = run(30, 0, 0);
    // the recorder's clock only matters for readings
    lines.extend((0..30).map(|k| touch(1, (2000 + 33 * k) * MS, false)));
    lines.extend((0..30).map(|k| touch(1, 33 * k * MS, false)));
    let text = refused(&lines);
    assert!(
        text.contains("/fixel_1/contact, message 31")
            && text.contains("the log time jumps back from 2.957000000 to 0.000000000 s")
            && text.contains("Record each run in a bag of its own"),
        "{text}"
    );
    // a recording in simulated time
    let text = refused(&[run(30, 0, 0), run(30, 0, 0)].concat());
    assert!(
        text.contains("header.stamp, as the log time, jumps back"),
        "{text}"
    );
    // transforms, frame by frame
    let up = |x| [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let twice = (0..2).flat_map(|_| 0..30).map(|k| {
        let tag = (33 * k * MS, "table", "tag", up(k as f64));
        let arm = (5000 * MS + 33 * k * MS, "table", "arm", up(k as f64));
        transforms("/tf", &[tag, arm])
    });
    let lines: Vec<Line> = twice.chain([pusher(0, 0.0)]).collect();
    let options = BagOptions {
        topics: Topics::new(["object=/tf:table.tag".parse().unwrap()]).unwrap(),
        ..BagOptions::default()
    };
    let text = read_bag([("f".to_owned(), &file(&lines)[..])], &options).unwrap_err();
    assert!(text.to_string().contains("/tf, message 31"), "{text}");
}

#[test]
fn jump_between_the_files_of_a_bag_is_found_whatever_their_order() {
    let [first, second] = [run(30, 0, 10_000 * MS), run(30, 500 * MS, 20_000 * MS)];
    for files in [[&first, &second], [&second, &first]] {
        let files = files.map(|lines| file(lines));
        let named = ["a", "b"]
            .map(str::to_owned)
            .into_iter()
            .zip(files.iter().map(|f| &f[..]));
        let text = read_bag(named, &BagOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            text.contains("jumps back from 0.957000000 to 0.500000000 s"),
            "{text}"
        );
    }
}

#[test]
fn messages_that_are_a_little_late_are_sorted_and_counted() {
    let mut lines = run(30, 0, 0);
    // one frame of the object comes after the next, another one after three more
    lines.swap(20, 22);
    let late = lines.remove(40);
    lines.insert(46, late);
    let (log, warnings) = read(&file(&lines));
    let (sorted, none) = read(&file(&run(30, 0, 0)));
    assert_eq!((log, none), (sorted, vec![]));
    let text = warnings[0].to_string();
    assert!(
        text.contains("/object/pose: 2 messages were recorded after later ones, by up to 99.0 ms"),
        "{text}"
    );
}

#[test]
fn message_that_is_equal_to_an_earlier_one_counts_once() {
    let lines = run(30, 0, 0);
    let twice: Vec<Line> = lines
        .iter()
        .flat_map(|line| [line.clone(), line.clone()])
        .collect();
    let (log, warnings) = read(&file(&twice));
    assert_eq!(log, read(&file(&lines)).0);
    let counts: Vec<_> = warnings.iter().map(|w| w.left_out().unwrap()).collect();
    assert_eq!(
        counts
            .iter()
            .map(|c| (c.place.as_str(), c.count, c.of))
            .collect::<Vec<_>>(),
        [("/object/pose", 30, 60), ("/pusher/pose", 30, 60)]
    );
    assert!(counts.iter().all(|c| c.reason == Reason::Repeated));
    // two poses at one time contradict each other
    let text = refused(&[&lines[..4], &[object(33 * MS, 9.0)]].concat());
    assert!(
        text.contains("header.stamp is 0.033000000 s, as in message 2"),
        "{text}"
    );
}

#[test]
fn body_that_was_not_seen_is_a_missing_measurement() {
    let hidden = |numbers: [f64; 7]| {
        let data = stamped(Order::Little, 33 * MS, "", &numbers);
        Line {
            data,
            ..object(33 * MS, 0.0)
        }
    };
    let nan = f64::NAN;
    for numbers in [
        [0.0; 7],
        [0.3, 0.2, 0.1, 0.0, 0.0, 0.0, 0.0],
        [nan, nan, nan, 0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, f64::INFINITY, 0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, nan, nan, nan, nan],
    ] {
        let lines = [
            object(0, 1.0),
            hidden(numbers),
            object(66 * MS, 2.0),
            pusher(0, 3.0),
        ];
        let (log, warnings) = read(&file(&lines));
        assert_eq!(xs(&log.object), [Some(1.0), Some(2.0)]);
        let left_out = warnings[0].left_out().unwrap();
        assert_eq!(
            (left_out.count, left_out.of, &left_out.reason),
            (1, 3, &Reason::NotMeasured)
        );
        let (info, _) = read_bag_info([("bag.mcap".to_owned(), &file(&lines)[..])]).unwrap();
        assert_eq!(info.left_out, std::slice::from_ref(left_out));
    }
    // nor is an unfinished quaternion one
    let text = refused(&[
        quaternion("/object/pose", 0, 0.0, [0.0, 0.0, 0.0, 0.5]),
        pusher(0, 0.0),
    ]);
    assert!(text.contains("the orientation's length is 0.5"), "{text}");
}

#[test]
fn transform_of_a_frame_that_was_not_seen_is_a_missing_measurement() {
    let up = |x| [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let tf = |k: i64, numbers| transforms("/tf", &[(33 * MS * k, "table", "tag", numbers)]);
    let lines = [
        tf(0, up(1.0)),
        tf(1, [0.0; 7]),
        tf(2, up(2.0)),
        pose("/pusher/pose", 0, 0.0),
    ];
    let lines = lines.map(|line| match line.topic.as_str() {
        "/tf" => line,
        _ => Line {
            data: stamped(Order::Little, 0, "table", &up(0.0)),
            ..line
        },
    });
    let options = BagOptions {
        topics: Topics::new(["object=/tf:table.tag".parse().unwrap()]).unwrap(),
        ..BagOptions::default()
    };
    let (log, warnings) = read_bag([("f".to_owned(), &file(&lines)[..])], &options).unwrap();
    assert_eq!(xs(&log.object), [Some(1.0), Some(2.0)]);
    assert_eq!(warnings[0].left_out().unwrap().place, "/tf:table.tag");
}

/// A log whose rows have any of their measurements, from 1.2 ms after one another on.
fn scattered() -> impl Strategy<Value = Log> {
    let pose = || prop::option::of((-1.0..1.0_f64, -1.0..1.0_f64, -3.0..3.0_f64));
    let row = (
        1_200_000..90_000_000_i64,
        pose(),
        pose(),
        any::<[Option<bool>; 2]>(),
    );
    prop::collection::vec(row, 2..60).prop_map(|rows| {
        let mut log = Log {
            tactile: vec![Vec::new(); 2],
            ..Log::default()
        };
        let mut time = 1_700_000_000_000 * MS;
        for (step, object, pusher, touches) in rows {
            // a row has something, and the first one both poses
            let (x, first) = ((0.5, 0.0, 0.0), log.is_empty());
            let nothing = object.is_none() && pusher.is_none() && touches == [None; 2];
            let object = object.or((first || nothing).then_some(x));
            let pusher = pusher.or(first.then_some(x));
            time += step;
            log.time.push(time as f64 / 1e9);
            let pose = |(x, y, theta): (f64, f64, f64)| Pose::new(x, y, theta / 3.0);
            log.object.push(object.map(pose));
            log.pusher.push(pusher.map(pose));
            for (column, cell) in log.tactile.iter_mut().zip(touches) {
                column.push(cell);
            }
        }
        // readings count up to 1 s after the last pose
        let last = log.len() - 1;
        log.object[last] = log.object[last].or(Some(Pose::default()));
        log
    })
}

proptest! {
    #[test]
    fn bag_of_a_table_is_the_table(log in scattered()) {
        let mut bytes = Cursor::new(Vec::new());
        write_log_mcap(&mut bytes, &log, &Topics::default()).unwrap();
        let (back, warnings) = read(bytes.get_ref());
        let touched = |k: usize| log.tactile[k].iter().any(Option::is_some);
        prop_assert_eq!(warnings, vec![]);
        prop_assert_eq!(&back.time, &log.time);
        prop_assert_eq!(xs(&back.object), xs(&log.object));
        prop_assert_eq!(xs(&back.pusher), xs(&log.pusher));
        for k in 0..back.tactile.len() {
            prop_assert!(back.tactile[k] == log.tactile[k] || !touched(k));
        }
    }
}

#[test]
fn part_of_a_recording_is_one_of_its_runs() {
    let lines = [
        run(30, 3000 * MS, 10_000 * MS),
        run(40, 3000 * MS, 20_000 * MS),
    ]
    .concat();
    let text = refused(&lines);
    let words = "Read one run: the log times up to 10.957000000 s, or those from 20.000000000 s on";
    assert!(text.contains(words), "{text}");
    let bytes = file(&lines);
    let of = |part: BagPart| {
        let options = BagOptions {
            part,
            ..BagOptions::default()
        };
        read_bag([("f".to_owned(), &bytes[..])], &options)
            .unwrap()
            .0
            .len()
    };
    let [to, from] = ["10.957", "20"].map(|text| Some(text.parse().unwrap()));
    assert_eq!(of(BagPart { from: None, to }), 30);
    assert_eq!(of(BagPart { from, to: None }), 40);
}

#[test]
fn topics_that_are_not_read_are_named_with_their_messages() {
    let others = [
        pose("/arm/tool0", 0, 1.0),
        pose("/arm/tool0", MS, 1.0),
        touch(1, 0, true),
    ];
    let mut lines = [&run(3, 0, 0)[..], &others].concat();
    lines[8].topic = "/left/touch".to_owned();
    lines.push(transforms("/tf", &[]));
    let (_, warnings) = read(&file(&lines));
    let text = warnings[0].to_string();
    assert!(
        text.contains("not read: 3 messages of /arm/tool0, /left/touch. Map"),
        "{text}"
    );
    assert_eq!(warnings.len(), 1);
}

/// A sender whose clock has not begun stamps its messages with 0.
#[test]
fn messages_with_a_stamp_of_zero_are_left_out_and_counted() {
    let now = 1_700_000_000_000 * MS;
    let later = run(30, now, now);
    let early = [
        at(now - 90 * MS, object(0, 9.0)),
        at(now - 50 * MS, object(0, 9.0)),
        at(now - 40 * MS, pusher(0, 9.0)),
    ];
    let (log, warnings) = read(&file(&[&early[..], &later].concat()));
    assert_eq!(log, read(&file(&later)).0);
    let counts: Vec<_> = warnings.iter().filter_map(|w| w.left_out()).collect();
    let found: Vec<_> = counts.iter().map(|c| (c.place.as_str(), c.count)).collect();
    assert_eq!(found, [("/object/pose", 2), ("/pusher/pose", 1)]);
    assert!(counts.iter().all(|c| c.reason == Reason::Unstamped));
}

/// ROS 1 wrote `/world` where ROS 2 writes `world`.
#[test]
fn frame_with_a_leading_slash_is_the_frame_without() {
    let in_frame = |line: Line, stamp: i64, x: f64, frame: &str| Line {
        data: stamped(
            Order::Little,
            stamp,
            frame,
            &[x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ),
        ..line
    };
    let lines: Vec<Line> = (0..10)
        .flat_map(|k| {
            let (t, x) = (33 * MS * k, 0.001 * k as f64);
            [
                in_frame(object(t, x), t, x, "/world"),
                in_frame(pusher(t, x), t, x, "world"),
            ]
        })
        .collect();
    assert_eq!(read(&file(&lines)).0.object.len(), 10);
}

/// A program may write the latest message first; readers go by the log times.
#[test]
fn messages_written_in_another_order_are_read_by_their_log_times() {
    let mut lines = run(30, 5000 * MS, 5000 * MS);
    let (log, _) = read(&file(&lines));
    lines.reverse();
    let (reversed, warnings) = read(&file(&lines));
    assert_eq!(log, reversed);
    assert!(warnings.is_empty(), "{warnings:?}");
}
