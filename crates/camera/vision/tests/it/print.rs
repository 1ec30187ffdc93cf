//! The detector finds tags and boards that are drawn for the printer, when another program draws
//! them at a known scale.

use image::GrayImage;
use resvg::{tiny_skia, usvg};
use stickslip_vision::{Board, Detector, Paper, PrintError, print_board, print_tags};

const PER_MM: f32 = 4.0;
const A4: Paper = Paper {
    width: 297.0,
    height: 210.0,
};

/// The sheet as pixels, four a millimetre.
fn drawn(svg: &str) -> GrayImage {
    let tree = usvg::Tree::from_str(svg, &usvg::Options::default()).unwrap();
    // SVG's own unit is 1/96 inch
    let scale = PER_MM * 25.4 / 96.0;
    let size = [A4.width, A4.height].map(|side| side as u32 * PER_MM as u32);
    let mut pixels = tiny_skia::Pixmap::new(size[0], size[1]).unwrap();
    let transform = tiny_skia::Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    let grey = pixels.pixels().iter().map(|pixel| pixel.red());
    GrayImage::from_raw(size[0], size[1], grey.collect()).unwrap()
}

/// Numbers and corners (mm on the paper, y down) of the tags found, by number.
fn found(svg: &str) -> Vec<(u16, [[f64; 2]; 4])> {
    let image = drawn(svg);
    let detector = Detector::new([image.width(), image.height()]);
    let mut tags: Vec<_> = detector
        .find(&image)
        .iter()
        .map(|tag| {
            // the centre of the first pixel is at (0, 0)
            let mm = |corner: [f64; 2]| corner.map(|pixel| (pixel + 0.5) / f64::from(PER_MM));
            (tag.id, tag.corners().map(mm))
        })
        .collect();
    tags.sort_by_key(|tag| tag.0);
    tags
}

/// Lengths of a square's edges.
fn edges(corners: [[f64; 2]; 4]) -> [f64; 4] {
    std::array::from_fn(|k| {
        let ([x, y], [u, v]) = (corners[k], corners[(k + 1) % 4]);
        ((u - x) * (u - x) + (v - y) * (v - y)).sqrt()
    })
}

#[test]
fn tags_are_found_with_their_size() {
    let tags = found(&print_tags(&[0, 1, 586, 42], 0.028, A4).unwrap().svg());
    assert_eq!(
        tags.iter().map(|tag| tag.0).collect::<Vec<_>>(),
        [0, 1, 42, 586]
    );
    for (id, corners) in tags {
        for edge in edges(corners) {
            assert!((edge - 28.0).abs() < 0.15, "tag {id}: {edge} mm");
        }
    }
}

#[test]
fn board_is_found_where_its_frame_says() {
    let board = Board {
        rows: 4,
        columns: 6,
        tag_size: 0.030,
        gap: 0.008,
        first_tag: 100,
    };
    let tags = found(&print_board(&board, A4).unwrap().svg());
    assert_eq!(
        tags.iter().map(|tag| tag.0).collect::<Vec<_>>(),
        (100..124).collect::<Vec<_>>()
    );
    let middle = |corners: [[f64; 2]; 4]| {
        [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0)
    };
    let origin = middle(tags[0].1);
    for (id, corners) in &tags {
        let expected = middle(board.corners(*id).unwrap()).map(|x| 1e3 * x - 15.0);
        let place = middle(*corners);
        // y up on the board, down on the paper
        let apart = [
            place[0] - origin[0] - expected[0],
            origin[1] - place[1] - expected[1],
        ];
        assert!(
            apart.iter().all(|x| x.abs() < 0.1),
            "tag {id}: {apart:?} mm"
        );
    }
}

#[test]
fn ruler_is_as_long_as_it_says() {
    let image = drawn(&print_tags(&[0], 0.028, A4).unwrap().svg());
    // its line, with half a stroke at both ends, is the longest dark run near the paper's foot
    let dark = |row: u32| {
        (0..image.width())
            .filter(|x| image.get_pixel(*x, row).0[0] < 200)
            .count()
    };
    let longest = (image.height() - 100..image.height())
        .map(dark)
        .max()
        .unwrap();
    assert!(
        (longest as f32 / PER_MM - 100.0).abs() < 0.6,
        "{longest} pixels"
    );
}

#[test]
fn what_does_not_fit_or_is_no_tag_is_refused() {
    assert!(matches!(
        print_tags(&[0], 0.2, A4),
        Err(PrintError::TooLarge { .. })
    ));
    let error = print_tags(&[587], 0.02, A4).unwrap_err();
    assert_eq!(
        error.to_string(),
        "tag 587 is none of the family 36h11, which has 0 to 586. Choose another number"
    );
}

/// The table at a PDF's end leads to its objects, and the page's stream is as long as it says.
#[test]
fn pdf_is_built_as_its_table_says() {
    let pdf = print_tags(&[0, 1], 0.028, A4).unwrap().pdf();
    let text = String::from_utf8(pdf).unwrap();
    let table: usize = text.lines().rev().nth(1).unwrap().parse().unwrap();
    let rows: Vec<&str> = text[table..].lines().collect();
    assert_eq!(rows[..2], ["xref", "0 6"]);
    for (number, row) in (1..).zip(&rows[3..8]) {
        let at: usize = row[..10].parse().unwrap();
        assert!(
            text[at..].starts_with(&format!("{number} 0 obj\n")),
            "{row}"
        );
        assert_eq!(row.len() + 1, 20);
    }
    let length = text
        .split("/Length ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap();
    let stream = text.split("stream\n").nth(1).unwrap();
    let drawn = stream.strip_suffix("end").unwrap();
    assert_eq!(drawn.len(), length.parse::<usize>().unwrap());
    // A4 in points
    assert!(text.contains("/MediaBox [0 0 841.8898 595.2756]"), "{text}");
    assert!(text.contains("(36h11, tag 1, 28.0 mm) Tj"), "{text}");
}
