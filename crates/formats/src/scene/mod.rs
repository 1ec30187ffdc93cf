//! `scene.toml`, the prior knowledge of an experiment: [`read_scene`].
//!
//! SI units, angles counter-clockwise; the object's frame has its origin in the centre of mass.

mod document;
mod edit;
mod error;
mod feet;
mod keys;
mod new_scene;
mod plate;
mod schema;
mod sensing;
mod shapes;
mod start;
mod tags;
mod uncertainty;

use std::f64::consts::FRAC_PI_2;

use stickslip::{ASSUMED_STALL, FilterSettings, Setup};
use stickslip_dynamics::{Feet, Fixel, Friction, MOST_FINGERS, Object, Pose, Pusher, Scene};
use toml::de::DeTable;

use crate::mounts::Mounts;

use document::{Node, Source, Table};
pub use edit::{SceneEdit, SceneWayError};
pub use error::{SceneError, SceneProblem};
pub use new_scene::NEW_SCENE;
use plate::Plate;
pub use schema::scene_schema;
use shapes::shape;

type Result<T> = std::result::Result<T, SceneError>;

/// Largest scene file (bytes).
const LARGEST: usize = 1_000_000;

/// Reads a scene file; `name` is shown in errors.
///
/// # Errors
/// The first of: no TOML, an unknown key, a missing key, a value of a wrong type or against its
/// rule, a shape or feet that cannot be; with line and column.
///
/// ```
/// let error = stickslip_formats::read_scene("gravity = 0\n", "scene.toml").unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "scene.toml:1:11: gravity is 0 m/s^2; it must be positive. Give the gravity that presses the object on the support in m/s^2"
/// );
/// ```
pub fn read_scene(text: &str, name: &str) -> Result<Setup> {
    parsed(text, name, |root| {
        let setup = setup(root)?;
        tags::mounts(root)?;
        Ok(setup)
    })
}

/// Reads from a scene file how tags sit on object and pusher; `name` is shown in errors.
///
/// # Errors
/// Those of [`read_scene`] about syntax, keys and tags.
///
/// ```
/// let scene = "[object]\ntags = { tag_7 = [0.01, 0.0, 1.57] }\n[pusher]\n";
/// let mounts = stickslip_formats::read_mounts(scene, "scene.toml")?;
/// assert_eq!(mounts.object["tag_7"].x, 0.01);
/// # Ok::<(), stickslip_formats::SceneError>(())
/// ```
pub fn read_mounts(text: &str, name: &str) -> Result<Mounts> {
    parsed(text, name, tags::mounts)
}

/// Assumptions of [`read_scene`] about values that a scene file leaves out and that follow from the
/// outline, in a sentence each.
///
/// # Errors
/// Those of [`read_scene`] about syntax, keys, mass, shape and support.
///
/// ```
/// let scene = "[object]\nmass = 0.5\nshape = [ { disc = { radius = 0.02 } } ]\n[support]\nfeet = [[0.01, 0], [-0.01, 0.01], [-0.01, -0.01]]\n";
/// let assumed = stickslip_formats::scene_assumptions(scene, "scene.toml")?;
/// assert_eq!(assumed, ["object.inertia is missing; 1.000e-4 kg m^2 is assumed, that of a uniform plate"]);
/// # Ok::<(), stickslip_formats::SceneError>(())
/// ```
pub fn scene_assumptions(text: &str, name: &str) -> Result<Vec<String>> {
    parsed(text, name, |root| {
        let (table, support) = (root.section("object")?, root.section("support")?);
        let mut lines = Vec::new();
        if table.optional("inertia").is_none() {
            let inertia = object(&table)?.inertia;
            lines.push(format!(
                "object.inertia is missing; {} kg m^2 is assumed, that of a uniform plate",
                format_args!("{inertia:.3e}")
            ));
        }
        if ["feet", "tripod_radius"]
            .iter()
            .all(|key| support.optional(key).is_none())
        {
            let (_, radius) = feet(&support, &table)?;
            lines.push(format!(
                "support.tripod_radius is missing; {radius:.4} m is assumed, the mean distance of the outline's inside from the centre of mass"
            ));
        }
        Ok(lines)
    })
}

/// Result of `read` on the document.
fn parsed<T>(text: &str, name: &str, read: impl FnOnce(&Table<'_>) -> Result<T>) -> Result<T> {
    let source = Source { name, text };
    if text.len() > LARGEST {
        let found = text.len();
        return Err(source.error(0, SceneProblem::TooLarge { found }));
    }
    let document = DeTable::parse(text).map_err(|error| syntax_error(source, &error))?;
    read(&Table::root(source, &document)?)
}

fn syntax_error(source: Source<'_>, error: &toml::de::Error) -> SceneError {
    let place = error.span().map_or(0, |span| span.start);
    syntax(source, place, error.message())
}

/// Syntax error with the message of a TOML parser about a place.
fn syntax(source: Source<'_>, place: usize, message: &str) -> SceneError {
    let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
    source.error(
        place,
        SceneProblem::Syntax {
            found: source.line_at(place).to_owned(),
            message,
        },
    )
}

fn setup(root: &Table<'_>) -> Result<Setup> {
    let scene = scene(root)?;
    let by_default = FilterSettings::around(&scene.nominal);
    let unknown = uncertainty::with_support(&root.section("support")?);
    Ok(Setup {
        stall_force_assumed: root.section("pusher")?.optional("stall_force").is_none(),
        camera: root
            .section_if("camera")?
            .as_ref()
            .map(sensing::camera)
            .transpose()?,
        tactile: root
            .section_if("tactile")?
            .as_ref()
            .map(sensing::tactile)
            .transpose()?
            .unwrap_or_default(),
        wrench: root
            .section_if("wrench")?
            .as_ref()
            .map(sensing::wrench)
            .transpose()?,
        filter: root
            .section_if("filter")?
            .as_ref()
            .map(|table| sensing::filter(table, by_default))
            .transpose()?
            .unwrap_or(by_default),
        uncertainty: match root.section_if("uncertainty")? {
            Some(table) => uncertainty::uncertainty(&table, unknown)?,
            None => unknown,
        },
        start: match root.section_if("start")? {
            Some(table) => Some(start::start(&table, &fingers(root)?)?),
            None => None,
        },
        scene,
    })
}

fn scene(root: &Table<'_>) -> Result<Scene> {
    let gravity = root.number("gravity")?;
    let body = root.section("object")?;
    let object = object(&body)?;
    let support = root.section("support")?;
    let (mu_s, (feet, d_tri)) = (support.number("friction")?, feet(&support, &body)?);
    let sliding = mu_s * object.mass * gravity;
    let (mu_p, pusher) = pusher(root, sliding)?;
    let mu_f = root.section("fixels")?.number("friction")?;
    Ok(Scene {
        gravity,
        object,
        feet,
        pusher,
        fixels: fixels(root)?,
        nominal: Friction {
            mu_s,
            mu_p,
            mu_f,
            d_tri,
        },
    })
}

fn object(table: &Table<'_>) -> Result<Object> {
    let mass = table.number("mass")?;
    let inertia = match table.optional("inertia") {
        Some(inertia) => inertia.number()?,
        None => mass * plate(table, "object.inertia")?.mean_square,
    };
    Ok(Object {
        mass,
        inertia,
        shape: shape(table)?,
    })
}

/// The object as a uniform plate, from which the missing `key` is worked out.
fn plate(table: &Table<'_>, key: &'static str) -> Result<Plate> {
    /// Largest distance of the middle of the outline from the centre of mass, as a share of the
    /// radius of gyration.
    const OFF: f64 = 0.05;
    let plate = Plate::of(shape(table)?.parts());
    let [x, y] = plate.centre;
    if x * x + y * y > OFF * OFF * plate.mean_square {
        let problem = SceneProblem::OffCentre { key, x, y };
        return Err(table.required("shape")?.error(problem));
    }
    Ok(plate)
}

/// The pusher, with the other fingers of a hand, and its friction; `sliding` is the force (N) that
/// slides the object.
fn pusher(root: &Table<'_>, sliding: f64) -> Result<(f64, Pusher)> {
    let table = &root.section("pusher")?;
    let mut fingers = vec![shape(table)?];
    for other in self::fingers(root)? {
        fingers.push(shape(&other)?);
    }
    let pusher = Pusher {
        fingers,
        stall_force: stall_force(table, sliding)?,
    };
    Ok((table.number("friction")?, pusher))
}

/// The tables of a hand's other fingers.
fn fingers<'a>(root: &Table<'a>) -> Result<Vec<Table<'a>>> {
    let Some(others) = root.optional("finger") else {
        return Ok(Vec::new());
    };
    let others = others.items()?;
    let most = MOST_FINGERS - 1;
    match others.get(most) {
        Some(other) => Err(other.error(SceneProblem::TooManyFingers { most })),
        None => others.iter().map(Node::table).collect(),
    }
}

/// The force (N) at which the drive yields; `None` where the file says that it never does.
///
/// No drive is rigid, and a jam under a rigid one has no solution: where the file says nothing, it
/// is a multiple of `sliding`. It must be given where that is no force, on a table without
/// friction.
fn stall_force(table: &Table<'_>, sliding: f64) -> Result<Option<f64>> {
    let assumed = ASSUMED_STALL * sliding;
    let force = if assumed > 0.0 && assumed.is_finite() {
        table.number_or("stall_force", assumed)?
    } else {
        table.number("stall_force")?
    };
    Ok(force.is_finite().then_some(force))
}

/// The feet with the nominal d_tri; where the file has none, that of a plate of the object's
/// outline.
fn feet(support: &Table<'_>, object: &Table<'_>) -> Result<(Feet, f64)> {
    match support.optional("feet") {
        Some(feet) => known_feet(support, &feet),
        None => {
            let angle = support.number_or("tripod_angle", FRAC_PI_2)?;
            let radius = match support.optional("tripod_radius") {
                Some(radius) => radius.number()?,
                None => plate(object, "support.tripod_radius")?.mean_radius,
            };
            Ok((Feet::Tripod { angle }, radius))
        }
    }
}

/// Known feet; their mean radius stands in for the d_tri that nothing uses.
fn known_feet(support: &Table<'_>, node: &Node<'_>) -> Result<(Feet, f64)> {
    for key in ["tripod_radius", "tripod_angle"] {
        if let Some(tripod) = support.optional(key) {
            return Err(tripod.error(SceneProblem::FeetAndTripod { key }));
        }
    }
    let [a, b, c] = node.exactly::<3>()?;
    let positions = [a.pair()?, b.pair()?, c.pair()?];
    let loads = match support.optional("foot_loads") {
        None => feet::loads(positions).map_err(|problem| node.error(problem))?,
        Some(given) => given_loads(&given)?,
    };
    let [a, b, c] = positions.map(|[x, y]| (x * x + y * y).sqrt());
    Ok((Feet::Known { positions, loads }, (a + b + c) / 3.0))
}

/// Loads that are not those of statics: where friction acts about another point than the centre of
/// mass.
fn given_loads(node: &Node<'_>) -> Result<[f64; 3]> {
    let [a, b, c] = node.exactly::<3>()?;
    let loads = [a.number()?, b.number()?, c.number()?];
    if (loads.iter().sum::<f64>() - 1.0).abs() > 1e-6 {
        return Err(node.out_of_range("three shares that sum to 1"));
    }
    Ok(loads)
}

fn fixels(root: &Table<'_>) -> Result<Vec<Fixel>> {
    let Some(node) = root.optional("fixel") else {
        return Ok(Vec::new());
    };
    let fixel = |node: &Node<'_>| {
        let table = node.table()?;
        let [x, y] = table.required("position")?.pair()?;
        Ok(Fixel {
            pose: Pose::new(x, y, table.number_or("angle", 0.0)?),
            shape: shape(&table)?,
        })
    };
    node.items()?.iter().map(fixel).collect()
}
