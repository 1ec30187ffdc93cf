//! Units of lengths and masses: everything is SI, and newcomers bring millimetres and grams.

use stickslip_dynamics::{Feet, Part, Pose, Shape};

use super::evidence::{Evidence, mm};
use super::finding::{Finding, Subject};

/// Object sizes that can lie on a table (m).
const SIZE: [f64; 2] = [5e-4, 5.0];

/// A body's positions spread over at most this many object sizes.
const SPREAD: f64 = 100.0;

/// Masses per area of flat objects: from paper to a steel block of half a metre (kg/m²).
const AREAL_DENSITY: [f64; 2] = [0.02, 5e3];

/// Gravity on a table, perhaps tilted, perhaps on the Moon (m/s²).
const GRAVITY: [f64; 2] = [1.0, 30.0];

const METRES: &str = "give all lengths in metres";

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let positions = positions(evidence).or_else(|| fixels(evidence));
    let found: Vec<Finding> = [size, mass, inertia, gravity, tripod]
        .iter()
        .filter_map(|check| check(evidence))
        .chain(positions)
        .collect();
    if !found.is_empty() {
        return found;
    }
    let (mass, area) = (
        evidence.setup.scene.object.mass,
        area(&evidence.setup.scene.object.shape),
    );
    vec![Finding::ok(
        Subject::Units,
        format!(
            "object radius {}, mass {mass} kg ({:.0} kg/m^2)",
            mm(evidence.size()),
            mass / area
        ),
    )]
}

fn problem(found: String, advice: &str) -> Option<Finding> {
    Some(Finding::problem(Subject::Units, found, advice))
}

fn size(evidence: &Evidence<'_>) -> Option<Finding> {
    let size = evidence.size();
    let spread = spread(evidence.log.object.iter().chain(&evidence.log.pusher));
    // an outline in millimetres with a log in metres is hundreds of times larger than all that
    // happens
    let dwarfs = spread > 0.0 && size > 50.0 * spread && size > 1.0;
    if size > SIZE[1] || dwarfs {
        return problem(
            format!("object radius {size} m: the outline seems to be in millimetres"),
            METRES,
        );
    }
    (size < SIZE[0]).then(|| {
        Finding::warning(
            Subject::Units,
            format!(
                "object radius {} mm, small for an object on a table",
                1e3 * size
            ),
            METRES,
        )
    })
}

fn positions(evidence: &Evidence<'_>) -> Option<Finding> {
    let limit = SPREAD * evidence.size();
    let log = evidence.log;
    let far = |what: &str, spread: f64| {
        let times = spread / evidence.size();
        let found = format!(
            "{what} span {spread:.1} m, {times:.0} times the object's radius: they seem to be in millimetres"
        );
        problem(found, "divide these columns of the log by 1000")
    };
    let (object, pusher) = (spread(log.object.iter()), spread(log.pusher.iter()));
    let both = spread(log.object.iter().chain(&log.pusher));
    match (object > limit, pusher > limit) {
        (true, true) => far("object and pusher positions", both),
        (true, false) => far("object positions", object),
        (false, true) => far("pusher positions", pusher),
        (false, false) if both > limit => far("object and pusher positions", both),
        _ => None,
    }
}

fn fixels(evidence: &Evidence<'_>) -> Option<Finding> {
    let seen = evidence.log.object.iter().flatten().next()?;
    let fixels = &evidence.setup.scene.fixels;
    let far = |distance: f64| distance > SPREAD * evidence.size();
    let distance = |pose: &Pose| (pose.x - seen.x).hypot(pose.y - seen.y);
    let k = fixels.iter().position(|fixel| far(distance(&fixel.pose)))?;
    let found = format!(
        "fixel {} is {:.1} m from the object, {:.0} times its radius",
        k + 1,
        distance(&fixels[k].pose),
        distance(&fixels[k].pose) / evidence.size()
    );
    problem(
        format!("{found}: its position seems to be in millimetres"),
        METRES,
    )
}

fn mass(evidence: &Evidence<'_>) -> Option<Finding> {
    let object = &evidence.setup.scene.object;
    let density = object.mass / area(&object.shape);
    if density > AREAL_DENSITY[1] {
        let found = format!(
            "object mass {} kg on {:.4} m^2, {density:.0} kg/m^2: the mass seems to be in grams",
            object.mass,
            area(&object.shape)
        );
        return problem(found, "give the mass in kilograms");
    }
    let found = || {
        format!(
            "object mass {} kg, {density:.3} kg/m^2: lighter than paper",
            object.mass
        )
    };
    (density < AREAL_DENSITY[0])
        .then(|| Finding::warning(Subject::Units, found(), "give the mass in kilograms"))
}

fn inertia(evidence: &Evidence<'_>) -> Option<Finding> {
    let gyration = evidence.setup.scene.object.gyration_radius();
    let share = gyration / evidence.size();
    let found = format!(
        "radius of gyration sqrt(J/m) {}, {share:.2} times the object's radius",
        mm(gyration)
    );
    let advice = "give the inertia about the centre of mass in kg m^2";
    match share {
        share if !(0.05..=1.5).contains(&share) => problem(found, advice),
        share if !(0.3..=1.0).contains(&share) => {
            Some(Finding::warning(Subject::Units, found, advice))
        }
        _ => None,
    }
}

fn gravity(evidence: &Evidence<'_>) -> Option<Finding> {
    let gravity = evidence.setup.scene.gravity;
    let absurd = !(GRAVITY[0]..=GRAVITY[1]).contains(&gravity);
    absurd.then(|| {
        Finding::problem(
            Subject::Units,
            format!("gravity {gravity} m/s^2, not that of a table top"),
            "give gravity in m/s^2: 9.81 on a level table",
        )
    })
}

fn tripod(evidence: &Evidence<'_>) -> Option<Finding> {
    let radius = evidence.setup.scene.nominal.d_tri;
    let tripod = matches!(evidence.setup.scene.feet, Feet::Tripod { .. });
    let found = || {
        format!(
            "tripod radius {radius} m, object radius {} m: the feet are not under the object",
            evidence.size()
        )
    };
    (tripod && radius > evidence.size())
        .then(|| Finding::problem(Subject::Units, found(), "give the tripod radius in metres"))
}

/// Diagonal of the box about all positions (m).
fn spread<'p>(poses: impl Iterator<Item = &'p Option<Pose>>) -> f64 {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for pose in poses.flatten() {
        for (k, value) in [pose.x, pose.y].into_iter().enumerate() {
            low[k] = low[k].min(value);
            high[k] = high[k].max(value);
        }
    }
    if low[0] > high[0] {
        0.0
    } else {
        (high[0] - low[0]).hypot(high[1] - low[1])
    }
}

/// Area of all parts (m²); parts that overlap count twice.
fn area(shape: &Shape) -> f64 {
    shape.parts().iter().map(part_area).sum()
}

fn part_area(part: &Part) -> f64 {
    match part {
        Part::Disc { radius, .. } => std::f64::consts::PI * radius * radius,
        Part::Polygon { vertices } => {
            let next = vertices.iter().cycle().skip(1);
            0.5 * vertices
                .iter()
                .zip(next)
                .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
                .sum::<f64>()
        }
    }
}
