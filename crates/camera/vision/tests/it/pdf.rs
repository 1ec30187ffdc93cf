//! Drawings as PDF are to scale, by another program that draws them: poppler's `pdftoppm`.
//!
//! `cargo test -p stickslip-vision --test it -- --ignored pdf::`, with that program.

use std::fs;
use std::path::Path;
use std::process::Command;

use image::GrayImage;
use stickslip_vision::{Board, Detector, Paper, Sheet, print_board, print_tags, read_picture};

const A4: Paper = Paper {
    width: 297.0,
    height: 210.0,
};
/// Pixels in an inch, and in a millimetre.
const DPI: &str = "101.6";
const PER_MM: f64 = 4.0;

fn drawn(sheet: &Sheet, name: &str) -> GrayImage {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pdf");
    fs::create_dir_all(&folder).unwrap();
    let (pdf, image) = (folder.join(format!("{name}.pdf")), folder.join(name));
    fs::write(&pdf, sheet.pdf()).unwrap();
    let mut program = Command::new("pdftoppm");
    program.args(["-r", DPI, "-gray", "-singlefile"]);
    let run = program.args([&pdf, &image]).output().unwrap();
    let told = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && told.is_empty(), "{told}");
    let bytes = fs::read(image.with_extension("pgm")).unwrap();
    read_picture(&bytes, name).unwrap()
}

#[test]
#[ignore = "needs pdftoppm; .ci/run installs it and runs this"]
fn tags_and_boards_are_to_scale() {
    let board = Board {
        rows: 4,
        columns: 6,
        tag_size: 0.030,
        gap: 0.008,
        first_tag: 100,
    };
    for (sheet, name, edge, count) in [
        (
            print_tags(&[0, 1, 586, 42], 0.028, A4).unwrap(),
            "tags",
            28.0,
            4,
        ),
        (print_board(&board, A4).unwrap(), "board", 30.0, 24),
    ] {
        let image = drawn(&sheet, name);
        let (width, height) = image.dimensions();
        // the program rounds up
        assert!((1188..=1189).contains(&width) && (840..=841).contains(&height));
        let tags = Detector::new([width, height]).find(&image);
        assert_eq!(tags.len(), count);
        for tag in &tags {
            let corners = tag.corners();
            for k in 0..4 {
                let ([x, y], [u, v]) = (corners[k], corners[(k + 1) % 4]);
                let length = libm::hypot(u - x, v - y) / PER_MM;
                assert!(
                    (length - edge).abs() < 0.15,
                    "{name} {}: {length} mm",
                    tag.id
                );
            }
        }
    }
}

#[test]
#[ignore = "needs pdftoppm; .ci/run installs it and runs this"]
fn the_ruler_is_as_long_as_it_says() {
    let image = drawn(&print_tags(&[0], 0.028, A4).unwrap(), "ruler");
    let dark = |row: u32| {
        let row = (0..image.width()).filter(|x| image.get_pixel(*x, row).0[0] < 200);
        row.count()
    };
    let longest = (image.height() - 100..image.height())
        .map(dark)
        .max()
        .unwrap();
    assert!(
        (longest as f64 / PER_MM - 100.0).abs() < 0.6,
        "{longest} pixels"
    );
}
