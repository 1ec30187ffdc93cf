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
        &record(6, chunk.concat()),
    ]
    .concat()
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
    // the last is the largest that is unpacked: three times its size while the buffer grows
    let most = [0, 1000, 1 << 20, 2 << 30, u64::MAX].map(|says| (says, SMALL));
    for (says, most) in most.into_iter().chain([(1 << 28, 1 << 30)]) {
        let bytes = one_chunk(says, &packed);
        let taken = peak(|| {
            let read = read_log_mcap(&bytes[..], "f", &Topics::default());
            let message = read.unwrap_err().to_string();
            assert!(message.starts_with("f: "), "{message}");
            assert!(read_bag_info([("f".to_owned(), &bytes[..])]).is_ok());
        });
        assert!(taken < most, "{taken} bytes where the chunk says {says}");
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
