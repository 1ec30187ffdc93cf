//! Lengths that lie take no memory: the memory of a reader follows the size of the input.

use crate::bag::{MS, file_with, object, pusher, touch};
use allocation_counter::measure;
use mcap::Compression;
use proptest::prelude::*;
use stickslip_formats::{
    Topics, read_bag_info, read_bag_metadata, read_estimate, read_log, read_log_mcap,
    read_row_json, read_scene, read_truth_json,
};

/// Memory that any reader may take at once for a small input (bytes).
const SMALL: u64 = 32 << 20;

const SCENE: &str = include_str!("full_scene.toml");

/// The most that was in use at a time (bytes).
fn peak(work: impl FnOnce()) -> u64 {
    measure(work).bytes_max
}

/// A small bag, in chunks that are packed or not.
fn small_bag(compression: Option<Compression>) -> Vec<u8> {
    let frames = (0..4).map(|k| 30 * k * MS);
    let lines: Vec<_> = frames
        .flat_map(|t| [object(t, 0.1), pusher(t, 0.0), touch(1, t, true)])
        .collect();
    file_with(&lines, compression, 300)
}

/// All readers, on the same bytes.
fn read_with_all(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let _ = read_scene(&text, "f");
    let _ = read_truth_json(&text, "f");
    let _ = read_row_json(&text);
    let _ = read_bag_metadata(&text, "f");
    let _ = read_log(bytes, "f");
    let _ = read_estimate(bytes, "f");
    let _ = read_bag_info([("f".to_owned(), bytes)]);
    let _ = read_log_mcap(bytes, "f", &Topics::default());
}

/// A recording of one chunk packed with zstd: the unpacked size that it claims, and its content.
fn one_chunk(says: u64, packed: &[u8]) -> Vec<u8> {
    chunks(says, packed, 1)
}

/// A recording of `count` such chunks.
fn chunks(says: u64, packed: &[u8], count: usize) -> Vec<u8> {
    let text = |text: &str| {
        [
            &u32::try_from(text.len()).unwrap().to_le_bytes()[..],
            text.as_bytes(),
        ]
        .concat()
    };
    let record =
        |kind: u8, body: Vec<u8>| [&[kind][..], &(body.len() as u64).to_le_bytes(), &body].concat();
    let magic = [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];
    let size = packed.len() as u64;
    let chunk = [
        &[0; 16][..],
        &says.to_le_bytes(),
        &[0; 4],
        &text("zstd"),
        &size.to_le_bytes(),
        packed,
    ];
    [
        &magic[..],
        &record(1, [text("ros2"), text("")].concat()),
        &record(6, chunk.concat()).repeat(count),
    ]
    .concat()
}

/// Channels of both bodies and a sensor, and as many touches: 36 bytes each.
fn touches(count: usize) -> Vec<u8> {
    let text = |text: &str| {
        let length = u32::try_from(text.len()).unwrap().to_le_bytes();
        [&length[..], text.as_bytes()].concat()
    };
    let record =
        |kind: u8, body: Vec<u8>| [&[kind][..], &(body.len() as u64).to_le_bytes(), &body].concat();
    let schema = [
        &[1, 0][..],
        &text("std_msgs/msg/Bool"),
        &text("ros2msg"),
        &text(""),
    ];
    let mut bytes = record(3, schema.concat());
    for (id, topic) in ["/fixel_1/contact", "/object/pose", "/pusher/pose"]
        .iter()
        .enumerate()
    {
        let id = u16::try_from(id).unwrap().to_le_bytes();
        let channel = [&id[..], &[1, 0], &text(topic), &text("cdr"), &[0; 4]];
        bytes.extend(record(4, channel.concat()));
    }
    let message = record(5, [&[0; 22][..], &[0, 1, 0, 0, 1]].concat());
    bytes.extend(message.repeat(count));
    bytes
}

#[test]
fn messages_of_a_small_bag_take_little_memory_however_many_they_are() {
    let content = touches(600_000);
    let packed = zstd::encode_all(&content[..], 1).unwrap();
    let bytes = chunks(content.len() as u64, &packed, 3);
    let file = || [("f".to_owned(), &bytes[..])];
    let taken = peak(|| {
        let error = read_log_mcap(&bytes[..], "f", &Topics::default()).unwrap_err();
        let words = "messages of the needed topics take 25 MB, far more than the recording";
        assert!(error.to_string().contains(words), "{error}");
        let (info, _) = read_bag_info(file()).unwrap();
        assert_eq!(info.topics[0].messages, 1_800_000);
    });
    assert!(taken < 100_000_000, "{taken}");
}

#[test]
fn recording_that_unpacks_to_far_more_than_its_size_is_refused() {
    let words = "it unpacks to more than 512 MiB and 100 times its size";
    let content = touches(1_000_000);
    let packed = zstd::encode_all(&content[..], 1).unwrap();
    let of_chunks = chunks(content.len() as u64, &packed, 40);
    let whole = chunks(0, &[], 0)
        .into_iter()
        .chain([7; 9])
        .collect::<Vec<_>>();
    let zeros = std::io::Read::take(std::io::repeat(0), 3 << 30);
    let of_file = zstd::encode_all(std::io::Read::chain(&whole[..], zeros), 1).unwrap();
    for bytes in [of_chunks, of_file] {
        let taken = peak(|| {
            let error = read_bag_info([("f".to_owned(), &bytes[..])]).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        });
        assert!(taken < SMALL, "{taken}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn overwritten_inputs_take_little_memory(
        which in 0..5_usize,
        at in any::<prop::sample::Index>(),
        over in prop_oneof![
            prop::collection::vec(any::<u8>(), 1..9),
            Just(vec![0xff; 4]),
            Just(vec![0xff, 0xff, 0xff, 0x7f]),
            Just(vec![0xff, 0xff, 0xff, 0x0f, 0, 0, 0, 0]),
            Just(b"999999999".to_vec()),
        ],
    ) {
        let mut bytes = match which {
            0 => small_bag(None),
            1 => small_bag(Some(Compression::Zstd)),
            2 => small_bag(Some(Compression::Lz4)),
            3 => SCENE.as_bytes().to_vec(),
            _ => b"time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta,tactile_1\n0,1,2,3,4,5,6,0\n".to_vec(),
        };
        let start = at.index(bytes.len());
        for (byte, over) in bytes[start..].iter_mut().zip(over) {
            *byte = over;
        }
        let taken = peak(|| read_with_all(&bytes));
        prop_assert!(taken < SMALL, "{taken} bytes for {}", bytes.len());
    }
}

#[test]
fn a_chunk_that_unpacks_to_gigabytes_is_not_unpacked() {
    let two_gigabytes = std::io::Read::take(std::io::repeat(0), 2 << 30);
    let packed = zstd::encode_all(two_gigabytes, 1).unwrap();
    for says in [0, 1000, 1 << 20, 1 << 28, 2 << 30, u64::MAX] {
        let bytes = one_chunk(says, &packed);
        let taken = peak(|| {
            let read = read_log_mcap(&bytes[..], "f", &Topics::default());
            let message = read.unwrap_err().to_string();
            assert!(message.starts_with("f: "), "{message}");
            assert!(read_bag_info([("f".to_owned(), &bytes[..])]).is_ok());
        });
        assert!(taken < SMALL, "{taken} bytes where the chunk says {says}");
    }
}

#[test]
fn a_million_vertices_are_refused_in_the_memory_of_their_text() {
    let text = SCENE.replacen(
        "polygon = [",
        &format!("polygon = [{}", "[0.01, 0.02], ".repeat(1_000_000)),
        1,
    );
    assert!(text.len() > 13_000_000);
    let mut message = String::new();
    let taken = peak(|| message = read_scene(&text, "f").unwrap_err().to_string());
    assert!(
        message.starts_with("f:"),
        "{}",
        &message[..200.min(message.len())]
    );
    assert!(
        message.len() < 1000 && taken < 100 * text.len() as u64,
        "{taken}: {message}"
    );
}

#[test]
fn a_row_that_nests_or_repeats_takes_little_memory() {
    let nested = "[".repeat(60_000);
    let keys = format!("{{{}\"time\": 1}}", "\"time\": 1, ".repeat(5_000));
    let sensors = "{\"time\": 1, \"tactile_999999999999\": 1}";
    let far = "{\"time\": 1, \"tactile_900000000\": 1}";
    for text in [&nested, &keys, sensors, far] {
        let taken = peak(|| assert!(read_row_json(text).is_err(), "{}", &text[..40]));
        assert!(taken < SMALL, "{taken}: {}", &text[..30]);
    }
}
