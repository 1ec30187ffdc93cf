//! Outlines from drawings, against areas and centres in closed form.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use stickslip_dynamics::{Part, Shape};
use stickslip_formats::{
    DrawnUnit, Outline, OutlineError, OutlineOptions, read_dxf_outline, read_scene,
    read_svg_outline, scene_assumptions,
};

fn svg(head: &str, body: &str) -> Result<Outline, OutlineError> {
    let text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {head}>\n{body}\n</svg>");
    read_svg_outline(&text, "part.svg", &OutlineOptions::default())
}

const MM: &str = r#"width="100mm" height="50mm" viewBox="0 0 100 50""#;

fn dxf(unit: &str, entities: &str) -> Result<Outline, OutlineError> {
    let text = format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}\n0\nENDSEC\n0\nEOF\n"
    );
    read_dxf_outline(&text, "part.dxf", &OutlineOptions::default())
}

/// Groups of an entity, given as `LINE 10 0 20 1.5`.
fn entity(text: &str) -> String {
    "0\n".to_owned() + &text.split(' ').collect::<Vec<_>>().join("\n")
}

/// Area and centre of the parts together.
fn moments(outline: &Outline) -> (f64, [f64; 2]) {
    let (mut twice, mut sum) = (0.0, [0.0; 2]);
    for part in &outline.parts {
        for (k, p) in part.iter().enumerate() {
            let q = part[(k + 1) % part.len()];
            let cross = p[0] * q[1] - q[0] * p[1];
            twice += cross;
            sum = [
                sum[0] + cross * (p[0] + q[0]),
                sum[1] + cross * (p[1] + q[1]),
            ];
        }
    }
    (0.5 * twice, sum.map(|sum| sum / (3.0 * twice)))
}

#[track_caller]
fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() < within, "{found}, not {expected}");
}

/// The parts are convex, the scene is one that can be read, and its outline's middle is the origin.
#[track_caller]
fn assert_usable(outline: &Outline) {
    let setup = read_scene(&outline.scene(), "scene.toml").unwrap();
    assert_eq!(setup.scene.object.shape.parts().len(), outline.parts.len());
    let (area, centre) = moments(outline);
    if outline.holes == 0 {
        near(
            area,
            outline.area,
            1e-6 * outline.size[0].max(outline.size[1]),
        );
        near(centre[0], 0.0, 2e-7);
        near(centre[1], 0.0, 2e-7);
        assert!(scene_assumptions(&outline.scene(), "scene.toml").is_ok());
    }
}

#[test]
fn a_concave_svg_outline_is_cut_into_convex_parts() {
    // an L: 40 x 20 below 20 x 20, y down
    let ell = svg(
        MM,
        r#"<g transform="translate(5,3)"><path d="M10 10 h40 v20 h-40 z M90,0"/></g>"#,
    );
    near(ell.unwrap().area, 8e-4, 1e-12);
    let ell = svg(
        MM,
        r#"<polygon points="10,10 30,10 30,30 50,30 50,50 10,50"/>"#,
    )
    .unwrap();
    assert_eq!((ell.parts.len(), ell.vertices, ell.holes), (2, 6, 0));
    near(ell.area, 12e-4, 1e-12);
    // the centre of 20 x 20 at (20, 20) and 40 x 20 at (30, 40), y up
    near(
        ell.centre[0],
        (400.0 * 20.0 + 800.0 * 30.0) / 1200.0 * 1e-3,
        1e-12,
    );
    near(
        ell.centre[1],
        -(400.0 * 20.0 + 800.0 * 40.0) / 1200.0 * 1e-3,
        1e-12,
    );
    assert_eq!(ell.unit, DrawnUnit::Said("mm"));
    assert_usable(&ell);
}

#[test]
fn svg_shapes_have_their_areas() {
    let perimeter = |outline: &Outline| 4.0 * (outline.size[0] + outline.size[1]);
    for (body, area) in [
        (r#"<circle cx="20" cy="20" r="15"/>"#, PI * 225.0),
        (r#"<ellipse cx="20" cy="20" rx="15" ry="8"/>"#, PI * 120.0),
        (r#"<rect x="5" y="5" width="30" height="20"/>"#, 600.0),
        (
            r#"<rect x="5" y="5" width="30" height="20" rx="4"/>"#,
            600.0 - (4.0 - PI) * 16.0,
        ),
        // a half circle by an arc, and by scaling a smaller one
        (r#"<path d="M10 20 A10 10 0 0 1 30 20 Z"/>"#, PI * 50.0),
        (
            r#"<g transform="scale(2)"><path d="M5 10 a5 5 0 0 1 10 0 z"/></g>"#,
            PI * 50.0,
        ),
        // a parabola over its chord of 20: two thirds of 20 x 10
        (
            r#"<path d="M10 20 Q20 40 30 20 Z"/>"#,
            2.0 / 3.0 * 20.0 * 10.0,
        ),
        // two open lines that close each other
        (
            r#"<polyline points="0,0 10,0 10,10"/><path d="M0 0 L0 10 L10 10"/>"#,
            100.0,
        ),
        (
            r#"<line x1="0" y1="0" x2="10" y2="0"/><polyline points="10,0 10,10 0,0"/>"#,
            50.0,
        ),
    ] {
        let outline = svg(MM, body).unwrap();
        // lines lie at most 0.02 mm inside of the curve
        near(outline.area, 1e-6 * area, 2e-5 * perimeter(&outline));
        assert_usable(&outline);
    }
}

#[test]
fn units_of_svg_are_those_it_says() {
    let square = r#"<rect width="48" height="24"/>"#;
    for (head, width, unit) in [
        (
            r#"width="96mm" height="96mm" viewBox="0 0 96 96""#,
            0.048,
            DrawnUnit::Said("mm"),
        ),
        (
            r#"width="10cm" height="10cm" viewBox="0 0 1000 1000""#,
            0.0048,
            DrawnUnit::Said("cm"),
        ),
        (
            r#"width="2in" height="2in" viewBox="0 0 96 96""#,
            0.0254,
            DrawnUnit::Said("in"),
        ),
        (
            r#"width="200" height="100" viewBox="0 0 200 100""#,
            0.0127,
            DrawnUnit::Pixel,
        ),
        (
            r#"width="100%" viewBox="0 0 200 100""#,
            0.0127,
            DrawnUnit::Pixel,
        ),
        ("", 0.0127, DrawnUnit::Pixel),
    ] {
        let outline = svg(head, square).unwrap();
        near(outline.size[0], width, 1e-12);
        assert_eq!(outline.unit, unit, "{head}");
    }
    let text = format!("<svg xmlns='http://www.w3.org/2000/svg' width='5mm'>{square}</svg>");
    let options = OutlineOptions {
        scale: Some(1e-3),
        ..OutlineOptions::default()
    };
    let outline = read_svg_outline(&text, "part.svg", &options).unwrap();
    near(outline.size[0], 0.048, 1e-12);
}

/// A plate of 40 x 40 mm with a hole of 10 x 10 mm in a corner.
#[test]
fn holes_count_for_the_centre_and_not_for_the_outline() {
    let plate = svg(MM, r#"<path d="M0 0h40v40h-40z M25 5h10v10h-10z"/>"#).unwrap();
    assert_eq!((plate.holes, plate.parts.len()), (1, 1));
    near(plate.area, 15e-4, 1e-12);
    near(
        plate.centre[0],
        (1600.0 * 20.0 - 100.0 * 30.0) / 1500.0 * 1e-3,
        1e-12,
    );
    near(
        plate.centre[1],
        -(1600.0 * 20.0 - 100.0 * 10.0) / 1500.0 * 1e-3,
        1e-12,
    );
    near(moments(&plate).0, 16e-4, 1e-9);
}

#[test]
fn dxf_outlines_have_their_areas() {
    // a slot: straight sides of 2 in, half circles with a diameter of 1 in
    let slot =
        entity("LWPOLYLINE 90 4 70 1 10 0 20 0 42 0 10 2 20 0 42 1 10 2 20 1 42 0 10 0 20 1 42 1");
    let outline = dxf("1", &slot).unwrap();
    near(outline.area, (2.0 + PI / 4.0) * 0.0254 * 0.0254, 2e-5 * 0.2);
    assert_eq!(outline.unit, DrawnUnit::Said("in"));
    assert_usable(&outline);

    // the same as vertices of their own, and as lines and arcs in any order and direction
    let vertices = [
        "POLYLINE 66 1 70 1",
        "VERTEX 10 0 20 0",
        "VERTEX 10 2 20 0 42 1",
        "VERTEX 10 2 20 1",
        "VERTEX 10 0 20 1 42 1",
        "SEQEND",
    ];
    let lines = [
        "LINE 10 0 20 0 11 2 21 0",
        "ARC 10 0 20 .5 40 .5 50 90 51 270",
        "LINE 10 0 20 1 11 2 21 1",
        "TEXT 1 slot",
        "ARC 10 2 20 .5 40 .5 50 -90 51 90",
    ];
    for entities in [&vertices[..], &lines] {
        let entities: Vec<String> = entities.iter().map(|text| entity(text)).collect();
        let same = dxf("1", &entities.join("\n")).unwrap();
        near(same.area, outline.area, 1e-12);
        near(same.centre[0], 0.0254, 1e-9);
        near(same.centre[1], 0.0127, 1e-9);
    }

    let disc = dxf("6", &entity("CIRCLE 10 1 20 2 40 0.05")).unwrap();
    near(disc.area, PI * 0.0025, 2e-5 * TAU * 0.05);
    let half = [
        entity("ELLIPSE 10 0 20 0 11 0 21 30 40 0.5 41 0 42 3.141592653589793"),
        entity("LINE 10 0 20 30 11 0 21 -30"),
    ];
    let half = dxf("4", &half.join("\n")).unwrap();
    // half axes of 30 and 15 mm; its middle is 4/(3 pi) of the shorter one from the straight side
    near(half.area, 1e-6 * PI * 225.0, 2e-5 * 0.2);
    near(half.centre[0], -4.0 / (3.0 * PI) * 0.015, 3e-5);
}

/// Asserts that no outline was read, with these words.
fn refused(outline: Result<Outline, OutlineError>, words: &[&str]) {
    let text = outline.unwrap_err().to_string();
    assert!(words.iter().all(|word| text.contains(word)), "{text}");
}

#[test]
fn svg_that_is_no_outline_is_refused_with_place_and_next_step() {
    refused(
        svg(MM, "<path d='M0 0h10v10'/>"),
        &[
            "part.svg: a line from (0, 0) to (10, -10) mm does not close",
            "Close the outline",
        ],
    );
    refused(
        svg(MM, "<path d='M0 0h10v10z M20 0h5v5z'/>"),
        &["there are 2 outlines", "Delete the others"],
    );
    refused(
        svg(MM, "<path d='M0 0L10 10L10 0L0 9z'/>"),
        &["crosses or touches itself", "simple line"],
    );
    refused(
        svg(MM, "<g>\n<use href='#a'/></g>"),
        &["part.svg:3: `use`", "Unlink clones"],
    );
    refused(svg(MM, "<text>no line</text>"), &["no closed line"]);
    refused(
        svg(MM, "<rect width='5em' height='3'/>"),
        &["part.svg:2: `5em` is no length"],
    );
    refused(
        svg(MM, "<path d='M0 0 L oh'/>"),
        &["part.svg:2: ", "is no path"],
    );
    // arcs and curves of these would be more lines than memory holds
    refused(
        svg(MM, "<path d='M10 2e37A10 10 0 0 1 30 20Z'/>"),
        &["part.svg:2: `2", "is no coordinate", "up to 1e9"],
    );
    let circles = "<circle r='1e8'/>".repeat(200);
    refused(
        svg(MM, &circles),
        &[
            "part.svg:2: its curves are more than 100000 points",
            "--tolerance",
        ],
    );
    let waves = "q5e8 1e9 1e9 0 q-5e8 1e9 -1e9 0".repeat(200);
    refused(
        svg(MM, &format!("<path d='M0 0{waves}z'/>")),
        &["part.svg:2: its curves are more than 100000 points"],
    );
    refused(
        svg(MM, "<rect width='1e6' height='10'/>"),
        &["1000000 x 10 mm", "--scale"],
    );
    refused(svg(MM, "<g>"), &["this is no SVG drawing", "plain SVG"]);
    // teeth finer than a scene takes
    let teeth: String = (0..700)
        .map(|k| {
            format!(
                "L{} {} L{} 0 ",
                0.1 * f64::from(k) + 0.05,
                1,
                0.1 * f64::from(k) + 0.1
            )
        })
        .collect();
    refused(
        svg(MM, &format!("<path d='M0 0 {teeth} L70 -10 L0 -10 z'/>")),
        &["1403 vertices", "--tolerance"],
    );
}

#[test]
fn dxf_that_is_no_outline_is_refused_with_place_and_next_step() {
    let circle = entity("CIRCLE 10 0 20 0 40 20");
    refused(
        dxf("0", &circle),
        &["part.dxf: ", "in which unit", "0.001 for millimetres"],
    );
    refused(
        dxf("4", &entity("SPLINE 70 8")),
        &["part.dxf:15: `SPLINE`", "splines into polylines"],
    );
    refused(
        dxf("4", &entity("CIRCLE 10 0 20 0")),
        &["CIRCLE without group 40"],
    );
    refused(
        dxf("4", &entity("CIRCLE 10 0 20 zero 40 1")),
        &["`zero` is no number"],
    );
    refused(
        dxf("4", &entity("CIRCLE 10 0 20 0 40 20 230 -1")),
        &["extrusion along -z"],
    );
    let read = |text: &str| read_dxf_outline(text, "part.dxf", &OutlineOptions::default());
    refused(read("AutoCAD Binary DXF\r\n"), &["it is binary", "ASCII"]);
    refused(read("0\nEOF\n"), &["no section ENTITIES"]);
    refused(read("zero\nEOF\n"), &["`zero` is no group code"]);
}

/// A star-shaped polygon about the origin: radii (mm) at equal angles.
fn star() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec(5.0..40.0_f64, 3..40).prop_map(|radii| {
        let n = radii.len() as f64;
        let vertex = |(k, r): (usize, &f64)| {
            let angle = TAU * k as f64 / n;
            [r * libm::cos(angle), r * libm::sin(angle)]
        };
        radii.iter().enumerate().map(vertex).collect()
    })
}

/// Returns true if a point is in a polygon, by the turns of the boundary about it.
fn winds(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let angle = |k: usize| {
        let [px, py] = polygon[k % polygon.len()];
        libm::atan2(py - y, px - x)
    };
    let turns: f64 = (0..polygon.len())
        .map(|k| {
            let turn = angle(k + 1) - angle(k);
            turn - TAU * (turn / TAU).round()
        })
        .sum();
    turns.abs() > PI
}

proptest! {
    #[test]
    fn parts_cover_the_outline_and_nothing_else(
        star in star(),
        points in prop::collection::vec([-40.0..40.0_f64, -40.0..40.0], 20),
    ) {
        let d: Vec<String> = star.iter().map(|[x, y]| format!("{x} {}", -y)).collect();
        let outline = svg(MM, &format!("<path d='M{}z'/>", d.join("L")))
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let (area, _) = moments(&outline);
        let twice: f64 = (0..star.len()).map(|k| {
            let (p, q) = (star[k], star[(k + 1) % star.len()]);
            p[0] * q[1] - q[0] * p[1]
        }).sum();
        prop_assert!((area / (0.5e-6 * twice) - 1.0).abs() < 1e-3, "{area} {twice}");
        let parts = outline.parts.iter().map(|part| Part::Polygon { vertices: part.clone() });
        prop_assert!(Shape::new(parts.collect()).is_ok());
        for point in points {
            // not where rounding decides
            let edge = (0..star.len()).any(|k| {
                let (p, q) = (star[k], star[(k + 1) % star.len()]);
                let length = libm::hypot(q[0] - p[0], q[1] - p[1]);
                ((q[0] - p[0]) * (point[1] - p[1]) - (q[1] - p[1]) * (point[0] - p[0])).abs() < 0.01 * length
            });
            if edge {
                continue;
            }
            let own = [0, 1].map(|k| 1e-3 * point[k] - outline.centre[k]);
            let inside = outline.parts.iter().filter(|part| winds(part, own)).count();
            prop_assert_eq!(inside, usize::from(winds(&star, point)), "{:?}", point);
        }
    }

    #[test]
    fn damaged_drawings_are_read_or_refused(
        which in any::<bool>(),
        at in any::<prop::sample::Index>(),
        cut in 0..12_usize,
        insert in "[-0-9a-zA-Z.,<>/\"= \n]{0,6}",
    ) {
        let good = if which {
            format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {MM}><g transform=\"rotate(10)\"><rect width=\"9\" height=\"5\" rx=\"1\"/></g></svg>")
        } else {
            format!("9\n$INSUNITS\n70\n4\n2\nENTITIES\n{}\n0\nENDSEC\n", entity("LWPOLYLINE 70 1 10 0 20 0 42 .3 10 9 20 0 10 9 20 9"))
        };
        let start = at.index(good.len());
        let text = format!("{}{insert}{}", &good[..start], good.get(start + cut..).unwrap_or(""));
        let options = OutlineOptions::default();
        let read = if which { read_svg_outline(&text, "f", &options) } else { read_dxf_outline(&text, "f", &options) };
        match read {
            Ok(outline) => {
                let scene = read_scene(&outline.scene(), "s");
                prop_assert!(scene.is_ok(), "{text}: {scene:?}");
            }
            Err(error) => prop_assert!(error.to_string().starts_with('f'), "{error}"),
        }
    }
}
