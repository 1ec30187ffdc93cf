//! `shape = [ { polygon = ... }, { disc = ... }, { ellipse = ... } ]`.

use stickslip_dynamics::{Part, Shape};

use super::document::{Node, Table};
use super::error::{SceneError, SceneProblem};

const KINDS: [&str; 3] = ["polygon", "disc", "ellipse"];
/// Most parts of a shape.
pub(super) const MOST_PARTS: usize = 200;
/// Most vertices of a polygon: they resolve a disc of 1 m to 1 µm.
pub(super) const MOST_VERTICES: usize = 3000;

/// The shape under the key `shape` of a body's table.
pub(super) fn shape(body: &Table<'_>) -> Result<Shape, SceneError> {
    let node = body.required("shape")?;
    let items = node.items()?;
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
    let table = node.table_of("part")?;
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
    let vertices = node.items()?;
    at_most(MOST_VERTICES, "vertices", node, vertices.len())?;
    let vertices = vertices
        .iter()
        .map(|vertex| vertex.pair())
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
    let table = node.table()?;
    Ok(Part::Disc {
        radius: table.number("radius")?,
        centre: centre(&table)?,
    })
}

/// The polygon that stands for it.
fn ellipse(node: &Node<'_>) -> Result<Part, SceneError> {
    let table = node.table()?;
    let semi_axes = table.required("semi_axes")?.pair()?;
    let angle = table.number_or("angle", 0.0)?;
    Ok(Part::ellipse(semi_axes, centre(&table)?, angle))
}

fn centre(table: &Table<'_>) -> Result<[f64; 2], SceneError> {
    table
        .optional("centre")
        .map_or(Ok([0.0; 2]), |node| node.pair())
}
