//! `shape = [ { polygon = ... }, { disc = ... }, { ellipse = ... } ]`.

use stickslip::{Rule, Unit};
use stickslip_dynamics::{Part, Shape};

use super::document::{Node, Table};
use super::error::{SceneError, SceneProblem};
use super::quantity::Quantity;

const KINDS: [&str; 3] = ["polygon", "disc", "ellipse"];
const SHAPE: &str =
    "the outline as a list of parts, each { polygon = ... }, { disc = ... } or { ellipse = ... }";
/// Most parts of a shape.
const MOST_PARTS: usize = 200;
/// Most vertices of a polygon: they resolve a disc of 1 m to 1 µm.
const MOST_VERTICES: usize = 3000;
const POLYGON: &str = "the vertices as [[x, y], ...] in m, counter-clockwise";
const DISC: &str = "{ radius = ... } in m";
const ELLIPSE: &str = "{ semi_axes = [..., ...] } in m";
const VERTEX: Quantity = Quantity::new("polygon", "a vertex as [x, y]", Unit::Metre, Rule::Finite);
const RADIUS: Quantity = Quantity::new("radius", "the disc's radius", Unit::Metre, Rule::Positive);
const SEMI_AXES: Quantity = Quantity::new(
    "semi_axes",
    "the half lengths of the two axes as [a, b]",
    Unit::Metre,
    Rule::Positive,
);
const CENTRE: Quantity = Quantity::new("centre", "the centre as [x, y]", Unit::Metre, Rule::Finite);
const ANGLE: Quantity = Quantity::new(
    "angle",
    "the angle of the first axis",
    Unit::Radian,
    Rule::Finite,
);

/// The shape under the key `shape` of a body's table.
pub(super) fn shape(body: &Table<'_>) -> Result<Shape, SceneError> {
    let node = body.required("shape", SHAPE)?;
    let items = node.items(SHAPE)?;
    at_most(MOST_PARTS, "parts", &node, items.len())?;
    let parts = items.iter().map(part).collect::<Result<Vec<Part>, _>>()?;
    Shape::new(parts.clone()).map_err(|source| {
        // the place is that of the first part that is refused by itself, else of the whole
        let refused = parts
            .iter()
            .position(|part| Shape::new(vec![part.clone()]).is_err());
        let place = refused.map_or(&node, |index| &items[index]);
        place.error(SceneProblem::Shape {
            key: place.path().to_owned(),
            source,
        })
    })
}

fn part(node: &Node<'_>) -> Result<Part, SceneError> {
    let table = node.table(&KINDS, SHAPE)?;
    let [polygon, disc, ellipse] = KINDS.map(|kind| table.optional(kind));
    match (polygon, disc, ellipse) {
        (Some(node), None, None) => self::polygon(&node),
        (None, Some(node), None) => self::disc(&node),
        (None, None, Some(node)) => self::ellipse(&node),
        several => {
            let found = [several.0, several.1, several.2].iter().flatten().count();
            Err(node.error(SceneProblem::PartKind {
                key: node.path().to_owned(),
                found,
            }))
        }
    }
}

fn polygon(node: &Node<'_>) -> Result<Part, SceneError> {
    let vertices = node.items(POLYGON)?;
    at_most(MOST_VERTICES, "vertices", node, vertices.len())?;
    let vertices = vertices
        .iter()
        .map(|vertex| vertex.pair(&VERTEX))
        .collect::<Result<_, _>>()?;
    Ok(Part::Polygon { vertices })
}

/// Refuses outlines so fine that looking for contacts takes longer than anything else.
fn at_most(most: usize, of: &'static str, node: &Node<'_>, found: usize) -> Result<(), SceneError> {
    if found <= most {
        return Ok(());
    }
    let key = node.path().to_owned();
    Err(node.error(SceneProblem::TooMany {
        key,
        found,
        of,
        most,
    }))
}

fn disc(node: &Node<'_>) -> Result<Part, SceneError> {
    let table = node.table(&["radius", "centre"], DISC)?;
    Ok(Part::Disc {
        radius: table.number(&RADIUS)?,
        centre: centre(&table)?,
    })
}

fn ellipse(node: &Node<'_>) -> Result<Part, SceneError> {
    let table = node.table(&["semi_axes", "centre", "angle"], ELLIPSE)?;
    let semi_axes = table.required(SEMI_AXES.key, ELLIPSE)?.pair(&SEMI_AXES)?;
    Ok(Part::Ellipse {
        semi_axes,
        centre: centre(&table)?,
        angle: table.number_or(&ANGLE, 0.0)?,
    })
}

fn centre(table: &Table<'_>) -> Result<[f64; 2], SceneError> {
    table
        .optional(CENTRE.key)
        .map_or(Ok([0.0; 2]), |node| node.pair(&CENTRE))
}
