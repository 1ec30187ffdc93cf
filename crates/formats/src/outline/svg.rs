//! Outlines from SVG: [`read_svg_outline`].

use roxmltree::{Document, Node};
use svgtypes::{
    Length, LengthUnit, PathParser, PointsParser, SimplePathSegment, SimplifyingPathParser, ViewBox,
};

use crate::outline::drawn_outline::{DrawnUnit, Outline};
use crate::outline::error::{OutlineError, OutlineProblem};
use crate::outline::flatten::Flattener;
use crate::outline::lines::Lines;
use crate::outline::{OutlineOptions, Point};

/// Metres of an inch, and of SVG's pixel.
const INCH: f64 = 0.0254;
const PIXEL: f64 = INCH / 96.0;
/// Most bytes of a drawing.
const LARGEST: usize = 1 << 24;
/// Largest number of a path.
const LARGEST_NUMBER: f64 = 1e9;
/// Elements that draw nothing themselves.
const NOT_DRAWN: [&str; 14] = [
    "defs",
    "clipPath",
    "mask",
    "symbol",
    "marker",
    "pattern",
    "metadata",
    "style",
    "title",
    "desc",
    "text",
    "image",
    "namedview",
    "linearGradient",
];

/// Reads the outline of an object from an SVG drawing: its lines, curves, rectangles, circles,
/// ellipses and polygons, whatever colour they have; `name` is shown in errors.
///
/// Lengths are those that `width`, `height` and `viewBox` say, or pixels of 1/96 inch. The
/// drawing's y points down, the object's up.
///
/// # Errors
/// [`OutlineError`]: no SVG, elements that refer to others, no closed line, several of them side by
/// side, one that crosses itself, sizes that cannot be.
///
/// ```
/// use stickslip_formats::{OutlineOptions, read_svg_outline};
/// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm" viewBox="0 0 80 60">
///     <path d="M10 10h40v20h-20v20h-20z"/></svg>"#;
/// let ell = read_svg_outline(svg, "ell.svg", &OutlineOptions::default())?;
/// assert_eq!((ell.parts.len(), ell.vertices), (2, 6));
/// assert!((ell.area - 1.2e-3).abs() < 1e-12);
/// # Ok::<(), stickslip_formats::OutlineError>(())
/// ```
pub fn read_svg_outline(
    text: &str,
    name: &str,
    options: &OutlineOptions,
) -> Result<Outline, OutlineError> {
    let error = |line, problem| OutlineError {
        file: name.to_owned(),
        line,
        problem,
    };
    let format = |why: String| OutlineProblem::Format {
        format: "SVG",
        why,
        next: "Save the drawing as plain SVG",
    };
    if text.len() > LARGEST {
        let why = format!("it has {} bytes, more than {LARGEST}", text.len());
        return Err(error(None, format(why)));
    }
    let document = Document::parse(text);
    let document = document.map_err(|problem| {
        let line = Some(problem.pos().row as usize);
        error(line, format(problem.to_string()))
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let why = format!("its first element is `{}`", root.tag_name().name());
        return Err(error(Some(1), format(why)));
    }
    let line_of = |node: Node<'_, '_>| Some(document.text_pos_at(node.range().start).row as usize);
    let unit = Unit::of(root, options.scale).map_err(|problem| error(line_of(root), problem))?;
    let mut drawing = Drawing {
        flattener: Flattener {
            tolerance: options.tolerance,
        },
        lines: Lines::default(),
    };
    // the stack is ours, so that no nesting overflows the program's
    let mut stack = vec![(root, unit.to_metres)];
    while let Some((node, above)) = stack.pop() {
        let drawn = drawing.element(node, above);
        let below = drawn.map_err(|problem| error(line_of(node), problem))?;
        if let Some(transform) = below {
            stack.extend(
                node.children()
                    .filter(Node::is_element)
                    .map(|child| (child, transform)),
            );
        }
    }
    Outline::of(drawing.lines.all(), unit.drawn, options).map_err(|problem| error(None, problem))
}

/// x ↦ (a x + c y + e, b x + d y + f).
#[derive(Clone, Copy)]
struct Affine([f64; 6]);

impl Affine {
    fn apply(&self, [x, y]: Point) -> Point {
        let [a, b, c, d, e, f] = self.0;
        [a * x + c * y + e, b * x + d * y + f]
    }

    /// Without its shift.
    fn turn(&self, [x, y]: Point) -> Point {
        let [a, b, c, d, ..] = self.0;
        [a * x + c * y, b * x + d * y]
    }

    /// This one after `first`.
    fn after(&self, first: &svgtypes::Transform) -> Self {
        let [a, b] = self.turn([first.a, first.b]);
        let [c, d] = self.turn([first.c, first.d]);
        let [e, f] = self.apply([first.e, first.f]);
        Self([a, b, c, d, e, f])
    }
}

/// The unit of a drawing, and how its numbers become metres, y up.
struct Unit {
    drawn: DrawnUnit,
    to_metres: Affine,
}

impl Unit {
    fn of(root: Node<'_, '_>, scale: Option<f64>) -> Result<Self, OutlineProblem> {
        let (drawn, metres) = match scale {
            Some(metres) => (DrawnUnit::Given(metres), metres),
            None => Self::said(root)?,
        };
        Ok(Self {
            drawn,
            to_metres: Affine([metres, 0.0, 0.0, -metres, 0.0, 0.0]),
        })
    }

    /// The unit that the root says by its size and its view box, as a whole fitted into it.
    fn said(root: Node<'_, '_>) -> Result<(DrawnUnit, f64), OutlineProblem> {
        let length = |key: &str| {
            let text = root.attribute(key)?;
            let length: Length = text.parse().ok()?;
            Some((
                length.number * metres_of(length.unit)?.1,
                metres_of(length.unit)?.0,
            ))
        };
        let view: Option<ViewBox> = match root.attribute("viewBox") {
            None => None,
            Some(text) => Some(text.parse().map_err(|_| OutlineProblem::Number {
                found: text.to_owned(),
                expected: "viewBox",
            })?),
        };
        let sides = [length("width"), length("height")];
        let Some(view) = view else {
            return Ok((DrawnUnit::Pixel, PIXEL));
        };
        let scales = sides.iter().zip([view.w, view.h]);
        let scales =
            scales.filter_map(|(side, of)| Some((side.as_ref()?.0 / of, side.as_ref()?.1)));
        let least = scales.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(match least {
            Some((metres, "px")) => (DrawnUnit::Pixel, metres),
            Some((metres, unit)) => (DrawnUnit::Said(unit), metres),
            None => (DrawnUnit::Pixel, PIXEL),
        })
    }
}

/// Name and metres of a unit; `None` for those that depend on something else.
fn metres_of(unit: LengthUnit) -> Option<(&'static str, f64)> {
    Some(match unit {
        LengthUnit::None | LengthUnit::Px => ("px", PIXEL),
        LengthUnit::In => ("in", INCH),
        LengthUnit::Cm => ("cm", 1e-2),
        LengthUnit::Mm => ("mm", 1e-3),
        LengthUnit::Pt => ("pt", INCH / 72.0),
        LengthUnit::Pc => ("pc", INCH / 6.0),
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return None,
    })
}

/// The lines of a drawing so far.
struct Drawing {
    flattener: Flattener,
    lines: Lines,
}

impl Drawing {
    /// Draws an element; returns the map of its content, `None` if that is not drawn.
    fn element(
        &mut self,
        node: Node<'_, '_>,
        above: Affine,
    ) -> Result<Option<Affine>, OutlineProblem> {
        let name = node.tag_name().name();
        let hidden = node.attribute("display") == Some("none")
            || node
                .attribute("style")
                .is_some_and(|style| style.replace(' ', "").contains("display:none"));
        if hidden || NOT_DRAWN.contains(&name) {
            return Ok(None);
        }
        let map = match node.attribute("transform") {
            None => above,
            Some(text) => above.after(&text.parse().map_err(|_| OutlineProblem::Number {
                found: text.to_owned(),
                expected: "transform",
            })?),
        };
        match name {
            "path" => self.path(node.attribute("d").unwrap_or(""), &map)?,
            "rect" => self.rectangle(node, &map)?,
            "circle" | "ellipse" => self.ellipse(node, &map)?,
            "polygon" | "polyline" => {
                let points = PointsParser::from(node.attribute("points").unwrap_or(""));
                let mut line: Vec<Point> = points.map(|(x, y)| map.apply([x, y])).collect();
                if name == "polygon" {
                    line.extend(line.first().copied());
                }
                self.lines.add(line)?;
            }
            "line" => {
                let [x1, y1, x2, y2] = lengths(node, ["x1", "y1", "x2", "y2"])?;
                self.lines
                    .add(vec![map.apply([x1, y1]), map.apply([x2, y2])])?;
            }
            "use" => {
                return Err(OutlineProblem::Unsupported {
                    what: "use".to_owned(),
                    next: "Unlink clones before saving",
                });
            }
            "svg" if node.parent_element().is_some() => {
                return Err(OutlineProblem::Unsupported {
                    what: "svg in svg".to_owned(),
                    next: "Save the inner drawing by itself",
                });
            }
            _ => {}
        }
        Ok(Some(map))
    }

    fn path(&mut self, d: &str, map: &Affine) -> Result<(), OutlineProblem> {
        let mut line: Vec<Point> = Vec::new();
        // the present point as it is drawn
        let mut at = [0.0; 2];
        check_numbers(d)?;
        for segment in SimplifyingPathParser::from(d) {
            let segment = segment.map_err(|problem| OutlineProblem::Number {
                found: problem.to_string(),
                expected: "path",
            })?;
            self.lines.check(line.len())?;
            match segment {
                SimplePathSegment::MoveTo { x, y } => {
                    self.lines.add(std::mem::take(&mut line))?;
                    at = [x, y];
                    line.push(map.apply(at));
                }
                SimplePathSegment::LineTo { x, y } => {
                    at = [x, y];
                    line.push(map.apply(at));
                }
                SimplePathSegment::Quadratic { x1, y1, x, y } => {
                    let points = [at, [x1, y1], [x, y]].map(|point| map.apply(point));
                    self.flattener.bezier(points, &mut line);
                    at = [x, y];
                }
                SimplePathSegment::CurveTo {
                    x1,
                    y1,
                    x2,
                    y2,
                    x,
                    y,
                } => {
                    let points = [at, [x1, y1], [x2, y2], [x, y]].map(|point| map.apply(point));
                    self.flattener.bezier(points, &mut line);
                    at = [x, y];
                }
                SimplePathSegment::ClosePath => line.extend(line.first().copied()),
            }
        }
        self.lines.add(line)
    }

    fn ellipse(&mut self, node: Node<'_, '_>, map: &Affine) -> Result<(), OutlineProblem> {
        let [cx, cy, r, rx, ry] = lengths(node, ["cx", "cy", "r", "rx", "ry"])?;
        let [rx, ry] = if node.has_tag_name("circle") || r > 0.0 {
            [r, r]
        } else {
            [rx, ry]
        };
        let (centre, a, b) = (
            map.apply([cx, cy]),
            map.turn([rx, 0.0]),
            map.turn([0.0, ry]),
        );
        let mut line = vec![[centre[0] + a[0], centre[1] + a[1]]];
        self.flattener
            .arc((centre, a, b), [0.0, std::f64::consts::TAU], &mut line);
        self.lines.add(line)
    }

    fn rectangle(&mut self, node: Node<'_, '_>, map: &Affine) -> Result<(), OutlineProblem> {
        use std::f64::consts::FRAC_PI_2;
        let [x, y, w, h, rx, ry] = lengths(node, ["x", "y", "width", "height", "rx", "ry"])?;
        // one radius stands for both
        let rx = if rx == 0.0 { ry } else { rx };
        let ry = if ry == 0.0 { rx } else { ry };
        let (rx, ry) = (rx.min(0.5 * w), ry.min(0.5 * h));
        let (a, b) = (map.turn([rx, 0.0]), map.turn([0.0, ry]));
        let corners = [
            [x + w - rx, y + h - ry],
            [x + rx, y + h - ry],
            [x + rx, y + ry],
            [x + w - rx, y + ry],
        ];
        let mut line = Vec::new();
        for (quarter, corner) in (0..4).zip(corners) {
            let centre = map.apply(corner);
            let from = f64::from(quarter) * FRAC_PI_2;
            let (sin, cos) = libm::sincos(from);
            line.push([
                centre[0] + a[0] * cos + b[0] * sin,
                centre[1] + a[1] * cos + b[1] * sin,
            ]);
            if rx > 0.0 && ry > 0.0 {
                self.flattener
                    .arc((centre, a, b), [from, from + FRAC_PI_2], &mut line);
            }
        }
        line.extend(line.first().copied());
        self.lines.add(line)
    }
}

/// Refuses numbers of a path that are too large: the number of curves for an arc grows with its
/// radius.
fn check_numbers(d: &str) -> Result<(), OutlineProblem> {
    use svgtypes::PathSegment::{
        ClosePath, CurveTo, EllipticalArc, HorizontalLineTo, LineTo, MoveTo, Quadratic,
        SmoothCurveTo, SmoothQuadratic, VerticalLineTo,
    };
    // a shape that is no path is reported at the place where it is drawn
    for segment in PathParser::from(d).map_while(Result::ok) {
        let numbers: [f64; 6] = match segment {
            MoveTo { x, y, .. } | LineTo { x, y, .. } | SmoothQuadratic { x, y, .. } => {
                [x, y, 0.0, 0.0, 0.0, 0.0]
            }
            HorizontalLineTo { x, .. } => [x, 0.0, 0.0, 0.0, 0.0, 0.0],
            VerticalLineTo { y, .. } => [y, 0.0, 0.0, 0.0, 0.0, 0.0],
            CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => [x1, y1, x2, y2, x, y],
            SmoothCurveTo { x2, y2, x, y, .. } => [x2, y2, x, y, 0.0, 0.0],
            Quadratic { x1, y1, x, y, .. } => [x1, y1, x, y, 0.0, 0.0],
            EllipticalArc { rx, ry, x, y, .. } => [rx, ry, x, y, 0.0, 0.0],
            ClosePath { .. } => [0.0; 6],
        };
        if let Some(number) = numbers
            .into_iter()
            .find(|number| number.abs() > LARGEST_NUMBER)
        {
            return Err(OutlineProblem::Number {
                found: number.to_string(),
                expected: "coordinate: they go up to 1e9",
            });
        }
    }
    Ok(())
}

/// Numbers of an element's attributes in the drawing's unit; 0 for those that are not there.
fn lengths<const N: usize>(
    node: Node<'_, '_>,
    keys: [&str; N],
) -> Result<[f64; N], OutlineProblem> {
    let mut numbers = [0.0; N];
    for (number, key) in numbers.iter_mut().zip(keys) {
        let Some(text) = node.attribute(key) else {
            continue;
        };
        let length: Option<Length> = text.parse().ok();
        let metres = length.and_then(|length| Some((length.number, metres_of(length.unit)?.1)));
        let (value, metres) = metres.ok_or_else(|| OutlineProblem::Number {
            found: text.to_owned(),
            expected: "length",
        })?;
        *number = value * metres / PIXEL;
    }
    Ok(numbers)
}
