//! Outlines from DXF: [`read_dxf_outline`].

use crate::outline::drawn_outline::{DrawnUnit, Outline};
use crate::outline::error::{OutlineError, OutlineProblem};
use crate::outline::flatten::Flattener;
use crate::outline::lines::Lines;
use crate::outline::{OutlineOptions, Point};

/// Next step for a file that is no DXF.
const SAVE_AS: &str = "Save the drawing as DXF in ASCII, R12 or later";
/// Entities that draw no line of the outline.
const NOT_DRAWN: [&str; 10] = [
    "POINT",
    "TEXT",
    "MTEXT",
    "DIMENSION",
    "LEADER",
    "HATCH",
    "VIEWPORT",
    "ATTDEF",
    "SEQEND",
    "ENDSEC",
];

/// Reads the outline of an object from a DXF drawing in ASCII: its lines, polylines with their
/// arcs, circles and ellipses; `name` is shown in errors. Lengths are in the unit that `$INSUNITS`
/// says.
///
/// # Errors
/// [`OutlineError`]: no DXF, no unit, entities that cannot be read, no closed line, several of them
/// side by side, one that crosses itself, sizes that cannot be.
pub fn read_dxf_outline(
    text: &str,
    name: &str,
    options: &OutlineOptions,
) -> Result<Outline, OutlineError> {
    let error = |(line, problem): (Option<usize>, OutlineProblem)| OutlineError {
        file: name.to_owned(),
        line,
        problem,
    };
    let pairs = pairs(text).map_err(error)?;
    let (drawn, metres) = match options.scale {
        Some(metres) => (DrawnUnit::Given(metres), metres),
        None => unit(&pairs).ok_or_else(|| error((None, OutlineProblem::NoUnit)))?,
    };
    let mut drawing = Drawing {
        metres,
        flattener: Flattener {
            tolerance: options.tolerance,
        },
        lines: Lines::default(),
        polyline: None,
    };
    for entity in entities(&pairs) {
        let line = entity[0].line;
        drawing
            .entity(entity)
            .map_err(|problem| error((Some(line), problem)))?;
    }
    Outline::of(drawing.lines.all(), drawn, options).map_err(|problem| error((None, problem)))
}

/// A group: a code and its value.
#[derive(Clone, Copy)]
struct Group<'t> {
    code: i32,
    value: &'t str,
    line: usize,
}

type Refusal = (Option<usize>, OutlineProblem);

fn pairs(text: &str) -> Result<Vec<Group<'_>>, Refusal> {
    let format = |line, why: String| {
        let problem = OutlineProblem::Format {
            format: "DXF",
            why,
            next: SAVE_AS,
        };
        (Some(line), problem)
    };
    if text.starts_with("AutoCAD Binary DXF") {
        return Err(format(1, "it is binary".to_owned()));
    }
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut pairs = Vec::with_capacity(lines.len() / 2);
    for (k, pair) in lines.chunks(2).enumerate() {
        let line = 2 * k + 1;
        let [code, value] = *pair else {
            match pair {
                [""] => break,
                _ => return Err(format(line, "a group code has no value".to_owned())),
            }
        };
        let Ok(code) = code.parse() else {
            return Err(format(line, format!("`{code}` is no group code")));
        };
        pairs.push(Group { code, value, line });
    }
    match pairs
        .iter()
        .any(|group| group.code == 2 && group.value == "ENTITIES")
    {
        true => Ok(pairs),
        false => Err(format(1, "it has no section ENTITIES".to_owned())),
    }
}

/// Name and metres of the drawing's unit, if it says one.
fn unit(pairs: &[Group<'_>]) -> Option<(DrawnUnit, f64)> {
    let at = pairs
        .iter()
        .position(|group| group.code == 9 && group.value == "$INSUNITS")?;
    let (name, metres) = match pairs.get(at + 1)?.value {
        "1" => ("in", 0.0254),
        "2" => ("ft", 0.3048),
        "4" => ("mm", 1e-3),
        "5" => ("cm", 1e-2),
        "6" => ("m", 1.0),
        "9" => ("thousandths of an inch", 2.54e-5),
        "13" => ("um", 1e-6),
        "14" => ("dm", 0.1),
        _ => return None,
    };
    Some((DrawnUnit::Said(name), metres))
}

/// The entities, each with its groups.
fn entities<'a, 't>(pairs: &'a [Group<'t>]) -> Vec<&'a [Group<'t>]> {
    let start = pairs
        .iter()
        .position(|group| group.code == 2 && group.value == "ENTITIES");
    let rest = &pairs[start.map_or(pairs.len(), |start| start + 1)..];
    let end = rest
        .iter()
        .position(|group| group.code == 0 && group.value == "ENDSEC");
    let section = &rest[..end.unwrap_or(rest.len())];
    let starts: Vec<usize> = (0..section.len())
        .filter(|k| section[*k].code == 0)
        .chain([section.len()])
        .collect();
    starts
        .array_windows()
        .map(|[from, to]| &section[*from..*to])
        .collect()
}

/// Vertices of a polyline with the bulge of the arc behind each, and whether it is closed.
#[derive(Default)]
struct Polyline {
    vertices: Vec<(Point, f64)>,
    closed: bool,
}

/// The lines of a drawing so far.
struct Drawing {
    metres: f64,
    flattener: Flattener,
    lines: Lines,
    /// One whose vertices are entities of their own.
    polyline: Option<Polyline>,
}

impl Drawing {
    fn entity(&mut self, groups: &[Group<'_>]) -> Result<(), OutlineProblem> {
        let kind = groups[0].value;
        if kind != "VERTEX"
            && let Some(polyline) = self.polyline.take()
        {
            self.draw(&polyline)?;
        }
        let of = Entity {
            groups,
            metres: self.metres,
        };
        if of.number(230)?.is_some_and(|z| z < 0.0) {
            return Err(OutlineProblem::Unsupported {
                what: format!("{kind} seen from below (extrusion along -z)"),
                next: "Draw it in the xy-plane, seen from above",
            });
        }
        match kind {
            "LINE" => {
                let line = vec![of.point(10)?, of.point(11)?];
                self.lines.add(line)?;
            }
            "CIRCLE" | "ARC" => self.arc(&of, kind == "ARC")?,
            "ELLIPSE" => self.ellipse(&of)?,
            "LWPOLYLINE" => {
                let polyline = of.lightweight()?;
                self.draw(&polyline)?;
            }
            "POLYLINE" => {
                self.polyline = Some(Polyline {
                    vertices: Vec::new(),
                    closed: of.is_closed()?,
                });
            }
            "VERTEX" => {
                let vertex = (of.point(10)?, of.number(42)?.unwrap_or(0.0));
                if let Some(polyline) = &mut self.polyline {
                    polyline.vertices.push(vertex);
                }
            }
            "SPLINE" | "INSERT" => {
                return Err(OutlineProblem::Unsupported {
                    what: kind.to_owned(),
                    next: "Turn splines into polylines or arcs, and explode blocks, before saving",
                });
            }
            other if NOT_DRAWN.contains(&other) => {}
            other => {
                return Err(OutlineProblem::Unsupported {
                    what: other.to_owned(),
                    next: "Delete it, or turn it into lines, arcs and polylines",
                });
            }
        }
        Ok(())
    }

    fn draw(&mut self, polyline: &Polyline) -> Result<(), OutlineProblem> {
        let vertices = &polyline.vertices;
        let Some((first, _)) = vertices.first() else {
            return Ok(());
        };
        let mut line = vec![*first];
        for [(_, bulge), (to, _)] in vertices.array_windows() {
            self.lines.check(line.len())?;
            self.flattener.bulge(*to, *bulge, &mut line);
        }
        if polyline.closed {
            let bulge = vertices[vertices.len() - 1].1;
            self.flattener.bulge(*first, bulge, &mut line);
        }
        self.lines.add(line)
    }

    fn arc(&mut self, of: &Entity<'_>, is_part: bool) -> Result<(), OutlineProblem> {
        let centre = of.point(10)?;
        let radius = of.needed(40)? * self.metres;
        let range = if is_part {
            let [from, to] = [of.needed(50)?.to_radians(), of.needed(51)?.to_radians()];
            [from, behind(from, to)]
        } else {
            [0.0, std::f64::consts::TAU]
        };
        self.add((centre, [radius, 0.0], [0.0, radius]), range)
    }

    fn ellipse(&mut self, of: &Entity<'_>) -> Result<(), OutlineProblem> {
        let (centre, a, ratio) = (of.point(10)?, of.point(11)?, of.needed(40)?);
        let from = of.number(41)?.unwrap_or(0.0);
        let to = of.number(42)?.unwrap_or(std::f64::consts::TAU);
        self.add(
            (centre, a, [-a[1] * ratio, a[0] * ratio]),
            [from, behind(from, to)],
        )
    }

    fn add(
        &mut self,
        (centre, a, b): (Point, Point, Point),
        [from, to]: [f64; 2],
    ) -> Result<(), OutlineProblem> {
        let (sin, cos) = libm::sincos(from);
        let start = [
            centre[0] + a[0] * cos + b[0] * sin,
            centre[1] + a[1] * cos + b[1] * sin,
        ];
        let mut line = vec![start];
        self.flattener.arc((centre, a, b), [from, to], &mut line);
        self.lines.add(line)
    }
}

/// `to` plus the turns that bring it behind `from`, counter-clockwise.
fn behind(from: f64, to: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let ahead = to - from;
    from + ahead - turn * ((ahead - 1e-12) / turn).floor()
}

/// The groups of an entity.
struct Entity<'g> {
    groups: &'g [Group<'g>],
    metres: f64,
}

impl Entity<'_> {
    fn number(&self, code: i32) -> Result<Option<f64>, OutlineProblem> {
        self.groups
            .iter()
            .find(|group| group.code == code)
            .map(value)
            .transpose()
    }

    fn needed(&self, code: i32) -> Result<f64, OutlineProblem> {
        self.number(code)?.ok_or_else(|| OutlineProblem::Number {
            found: format!("{} without group {code}", self.groups[0].value),
            expected: "whole entity",
        })
    }

    /// A point (m) whose y has the code ten higher.
    fn point(&self, code: i32) -> Result<Point, OutlineProblem> {
        Ok([
            self.needed(code)? * self.metres,
            self.needed(code + 10)? * self.metres,
        ])
    }

    fn is_closed(&self) -> Result<bool, OutlineProblem> {
        Ok(self.number(70)?.is_some_and(|flags| flags as i64 & 1 == 1))
    }

    /// A polyline whose vertices follow each other in one entity.
    fn lightweight(&self) -> Result<Polyline, OutlineProblem> {
        let mut polyline = Polyline {
            vertices: Vec::new(),
            closed: self.is_closed()?,
        };
        for group in self.groups {
            let last = polyline.vertices.last_mut();
            match (group.code, last) {
                (10, _) => polyline
                    .vertices
                    .push(([value(group)? * self.metres, 0.0], 0.0)),
                (20, Some(vertex)) => vertex.0[1] = value(group)? * self.metres,
                (42, Some(vertex)) => vertex.1 = value(group)?,
                _ => {}
            }
        }
        Ok(polyline)
    }
}

fn value(group: &Group<'_>) -> Result<f64, OutlineProblem> {
    let number = group
        .value
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| OutlineProblem::Number {
        found: group.value.to_owned(),
        expected: "number",
    })
}
