//! Every figure is a picture whatever its numbers are, and its content lies where it should.

use crate::common::{HALF, disc, experiment, log, setup, square, truth};
use resvg::tiny_skia::Pixmap;
use resvg::usvg::{Options, Tree};
use stickslip_dynamics::Pose;
use stickslip_report::{
    Bars, Body, Colour, Curve, Drawing, Level, Mark, Overlay, Panel, ParticleCloud, Scale,
    TimeFigure, png_of,
};

/// The size of an SVG that must be whole.
#[track_caller]
fn size(svg: &str) -> [f64; 2] {
    assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{svg}");
    let tree =
        Tree::from_str(svg, &Options::default()).unwrap_or_else(|error| panic!("{error}\n{svg}"));
    [
        f64::from(tree.size().width()),
        f64::from(tree.size().height()),
    ]
}

fn pixels(svg: &str) -> Pixmap {
    Pixmap::decode_png(&png_of(svg).unwrap()).unwrap()
}

/// Returns true if the pixel of a point of the SVG has this colour, within a little.
fn has(pixels: &Pixmap, [x, y]: [f64; 2], colour: Colour) -> bool {
    let found = pixels.pixel((2.0 * x) as u32, (2.0 * y) as u32).unwrap();
    [
        (found.red(), colour.0),
        (found.green(), colour.1),
        (found.blue(), colour.2),
    ]
    .iter()
    .all(|(a, b)| a.abs_diff(*b) < 40)
}

fn figure(points: Vec<[f64; 2]>, scale: Scale) -> TimeFigure {
    let band = points
        .iter()
        .map(|[time, value]| [*time, value - 1.0, value + 1.0])
        .collect();
    let level = Level {
        name: "truth".to_owned(),
        value: f64::NAN,
        ..Level::default()
    };
    let curves = vec![Curve {
        band,
        ..Curve::new("a", Colour::SKY, points)
    }];
    let panel = Panel {
        label: "x_1 (mm)".to_owned(),
        scale,
        curves,
        levels: vec![level],
        ..Panel::default()
    };
    let marks = vec![
        Mark {
            time: 0.5,
            name: "fixel 1".to_owned(),
        },
        Mark {
            time: f64::NAN,
            name: "never".to_owned(),
        },
    ];
    let panel = Panel {
        bars: vec![Bars {
            times: vec![[0.0, f64::NAN], [0.2, 0.4]],
            ..Bars::default()
        }],
        ..panel
    };
    TimeFigure {
        dark: vec![[0.3, f64::INFINITY]],
        marks,
        panels: vec![panel.clone(), panel],
        ..TimeFigure::default()
    }
}

#[test]
fn time_figures_are_drawn_whatever_their_numbers_are() {
    let log = Scale::Log { floor: 0.01 };
    let odd = vec![
        [0.0, f64::NAN],
        [0.5, f64::INFINITY],
        [f64::NAN, 1.0],
        [0.7, -3.0],
        [0.9, 1e300],
    ];
    for points in [vec![], vec![[0.5, 0.0]], vec![[0.0, 1.0], [1.0, 1.0]], odd] {
        for scale in [Scale::Linear, log] {
            let whole = figure(points.clone(), scale);
            size(&whole.drawing().to_svg());
            size(
                &TimeFigure {
                    span: [1.0, 1.0],
                    ..whole.clone()
                }
                .drawing()
                .to_svg(),
            );
            size(
                &TimeFigure {
                    columns: 0,
                    panels: Vec::new(),
                    ..whole
                }
                .drawing()
                .to_svg(),
            );
        }
    }
}

#[test]
fn other_figures_are_drawn_whatever_their_numbers_are() {
    size(&ParticleCloud::default().drawing().to_svg());
    let lost = Pose::new(f64::NAN, 0.0, 0.0);
    size(
        &ParticleCloud {
            particles: vec![lost, Pose::default()],
            ..ParticleCloud::default()
        }
        .drawing()
        .to_svg(),
    );
    size(&Overlay::default().drawing().to_svg());
    let bodies = vec![Body::new("lost", &disc(0.01), &lost, Colour::SKY)];
    size(
        &Overlay {
            bodies,
            ..Overlay::default()
        }
        .drawing()
        .to_svg(),
    );
    assert_eq!(size(&Drawing::grid(&[], 3).to_svg()).len(), 2);
}

#[test]
fn every_figure_of_an_experiment_is_drawn_even_of_one_row() {
    let setup = setup();
    for rows in [0, 1, 2, 90] {
        let log = log(rows);
        let figures = experiment("<&\"'>", &setup, &log, 5).figures();
        assert!(rows < 90 || figures.len() == 5);
        for figure in figures {
            let [width, height] = size(&figure.drawing.to_svg());
            assert!(
                (width - figure.drawing.width).abs() < 0.01
                    && (height - figure.drawing.height).abs() < 0.01
            );
        }
    }
}

/// Without a reference for the object, the pictures contain the estimate of it.
#[test]
fn a_picture_without_a_reference_holds_the_estimate() {
    let (setup, log) = (setup(), log(90));
    let holds = |known: bool| {
        let mut experiment = experiment("dark", &setup, &log, 5);
        if !known {
            experiment.reference.pose.fill(None);
        }
        let [[left, low], [right, high]] = experiment.poses_at(89).view.unwrap();
        let at = truth(89, 90);
        assert!(left < at.x - HALF && right > at.x + HALF, "{left} {right}");
        assert!(low < at.y - HALF && high > at.y + HALF, "{low} {high}");
    };
    holds(true);
    holds(false);
}

/// A curve at 2 from 0 to 1 s on an axis from 0 to 4 is drawn in the middle of its panel. Shading
/// covers only the occluded times.
#[test]
fn a_curve_lies_where_its_values_are() {
    let panel = Panel {
        limits: Some([0.0, 4.0]),
        curves: vec![Curve::new(
            "",
            Colour::VERMILLION,
            vec![[0.0, 2.0], [1.0, 2.0]],
        )],
        ..Panel::default()
    };
    let figure = TimeFigure {
        panels: vec![panel],
        dark: vec![[0.5, 1.0]],
        panel_size: [394.0, 224.0],
        ..TimeFigure::default()
    };
    let shown = pixels(&figure.drawing().to_svg());
    // the panel goes from x = 76 to 376; the legend of the shade and the title's margin stand
    // above, 28 px
    let [left, right] = [76.0, 376.0];
    let middle = 28.0 + 0.5 * (10.0 + 224.0 - 14.0);
    for x in [0.02, 0.5, 0.98] {
        assert!(
            has(
                &shown,
                [left + x * (right - left), middle],
                Colour::VERMILLION
            ),
            "at {x}"
        );
        assert!(
            !has(
                &shown,
                [left + x * (right - left), middle + 6.0],
                Colour::VERMILLION
            ),
            "at {x}"
        );
    }
    let shade = Colour(236, 233, 226);
    let white = |x: f64| {
        shown
            .pixel(
                (2.0 * (left + x * (right - left))) as u32,
                (2.0 * (middle + 20.0)) as u32,
            )
            .unwrap()
            .blue()
            == 255
    };
    assert!(
        white(0.45)
            && !white(0.55)
            && has(&shown, [left + 0.9 * (right - left), middle + 20.0], shade)
    );
}

/// Sides of a square of 50 mm in a view of 100 mm over 476 px.
#[test]
fn an_overlay_lies_where_its_body_is() {
    let body = Body::new(
        "",
        &square(HALF),
        &Pose::new(0.05, 0.05, 0.0),
        Colour::VERMILLION,
    );
    let overlay = Overlay {
        bodies: vec![body],
        view: Some([[0.0, 0.0], [0.1, 0.1]]),
        width: 500.0,
        ..Overlay::default()
    };
    let shown = pixels(&overlay.drawing().to_svg());
    let at = |x: f64, y: f64| [12.0 + 4760.0 * x, 12.0 + 4760.0 * (0.1 - y)];
    for side in [
        at(0.025, 0.06),
        at(0.075, 0.04),
        at(0.04, 0.025),
        at(0.06, 0.075),
    ] {
        assert!(has(&shown, side, Colour::VERMILLION), "{side:?}");
    }
    assert!(
        !has(&shown, at(0.05, 0.052), Colour::VERMILLION)
            && !has(&shown, at(0.02, 0.06), Colour::VERMILLION)
    );
}

#[test]
fn png_has_two_pixels_per_unit_text_and_refuses_what_is_no_svg() {
    let svg = figure(vec![[0.0, 1.0], [1.0, 2.0]], Scale::Linear)
        .drawing()
        .to_svg();
    let ([width, height], shown) = (size(&svg), pixels(&svg));
    assert_eq!(
        [shown.width(), shown.height()],
        [width, height].map(|length| (2.0 * length).ceil() as u32)
    );
    // only letters are drawn above the panels: without a font there would be none
    let above = |y: u32| {
        (0..shown.width())
            .filter(|x| shown.pixel(*x, y).unwrap().red() < 120)
            .count()
    };
    assert!((10..44).map(above).sum::<usize>() > 100);
    assert_eq!(png_of(&svg).unwrap(), png_of(&svg).unwrap());
    assert!(png_of("<html>").unwrap_err().to_string().contains("no SVG"));
    assert!(
        png_of(r#"<svg xmlns="http://www.w3.org/2000/svg" width="90000" height="90000"/>"#)
            .unwrap_err()
            .to_string()
            .contains("180000")
    );
}
