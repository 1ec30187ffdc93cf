//! Properties that follow from an outline where nothing else is known: [`Plate`].

use stickslip_dynamics::Part;

/// Lines that an outline is cut into.
const LINES: u32 = 4000;

/// A plate of one thickness and density, which presses evenly on the support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plate {
    /// Its centre of mass (m).
    pub centre: [f64; 2],
    /// Mean square of the distance from the origin (m²): the moment of inertia about it, per mass.
    pub mean_square: f64,
    /// Mean distance from the origin (m): a tripod of this radius resists turning as the whole
    /// surface does, since friction's moment is mu N times the mean distance of the points that
    /// carry.
    pub mean_radius: f64,
}

impl Plate {
    /// The plate that the union of `parts` covers, by integrals along lines in x, exact there.
    pub fn of(parts: &[Part]) -> Self {
        let low = parts.iter().map(|part| range(part)[0]);
        let high = parts.iter().map(|part| range(part)[1]);
        let [low, high] = [low.fold(f64::MAX, f64::min), high.fold(f64::MIN, f64::max)];
        let step = (high - low) / f64::from(LINES);
        let [mut area, mut x1, mut y1, mut square, mut radius] = [0.0; 5];
        for line in 0..LINES {
            let y = low + (f64::from(line) + 0.5) * step;
            for [from, to] in covered(parts, y) {
                let width = to - from;
                area += width;
                x1 += 0.5 * (to * to - from * from);
                y1 += width * y;
                square += (to * to * to - from * from * from) / 3.0 + width * y * y;
                radius += distances(to, y) - distances(from, y);
            }
        }
        Self {
            centre: [x1 / area, y1 / area],
            mean_square: square / area,
            mean_radius: radius / area,
        }
    }
}

/// Integral over x of the distance of (x, y) from the origin.
fn distances(x: f64, y: f64) -> f64 {
    let r = (x * x + y * y).sqrt();
    let bent = if y == 0.0 {
        0.0
    } else {
        y * y * libm::asinh(x / y.abs())
    };
    0.5 * (x * r + bent)
}

/// Lowest and highest y of a part (m).
fn range(part: &Part) -> [f64; 2] {
    match part {
        Part::Polygon { vertices } => {
            let ys = || vertices.iter().map(|vertex| vertex[1]);
            [ys().fold(f64::MAX, f64::min), ys().fold(f64::MIN, f64::max)]
        }
        Part::Disc { radius, centre } => [centre[1] - radius, centre[1] + radius],
    }
}

/// Covered intervals of a line of constant y, from left to right.
fn covered(parts: &[Part], y: f64) -> Vec<[f64; 2]> {
    let mut pieces: Vec<[f64; 2]> = parts.iter().filter_map(|part| cut(part, y)).collect();
    pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut union: Vec<[f64; 2]> = Vec::new();
    for [from, to] in pieces {
        match union.last_mut() {
            Some(last) if from <= last[1] => last[1] = last[1].max(to),
            _ => union.push([from, to]),
        }
    }
    union
}

/// Interval of a line of constant y in a part.
fn cut(part: &Part, y: f64) -> Option<[f64; 2]> {
    match part {
        Part::Polygon { vertices } => cut_polygon(vertices, y),
        Part::Disc { radius, centre } => {
            let dy = y - centre[1];
            let half = (radius * radius - dy * dy).max(0.0).sqrt();
            (half > 0.0).then_some([centre[0] - half, centre[0] + half])
        }
    }
}

fn cut_polygon(vertices: &[[f64; 2]], y: f64) -> Option<[f64; 2]> {
    let next = vertices.iter().cycle().skip(1);
    let crossing = vertices
        .iter()
        .zip(next)
        .filter(|(a, b)| (a[1] <= y) != (b[1] <= y));
    let crossed = crossing.map(|(a, b)| a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]));
    let [from, to] = crossed.fold([f64::MAX, f64::MIN], |[from, to], x| {
        [from.min(x), to.max(x)]
    });
    (to > from).then_some([from, to])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, exact: f64) {
        assert!(
            (found - exact).abs() < 1e-5 * exact.abs().max(1e-3),
            "{found}, {exact}"
        );
    }

    #[test]
    fn disc_has_its_closed_forms() {
        let plate = Plate::of(&[Part::Disc {
            radius: 0.03,
            centre: [0.0, 0.0],
        }]);
        near(plate.mean_square, 0.03 * 0.03 / 2.0);
        near(plate.mean_radius, 2.0 / 3.0 * 0.03);
        let moved = Plate::of(&[Part::Disc {
            radius: 0.03,
            centre: [0.04, -0.01],
        }]);
        near(moved.centre[0], 0.04);
        near(
            moved.mean_square,
            0.03 * 0.03 / 2.0 + 0.04 * 0.04 + 0.01 * 0.01,
        );
    }

    #[test]
    fn rectangle_and_turned_ellipse_have_theirs() {
        let [w, h] = [0.06, 0.04];
        let vertices = vec![
            [-w / 2.0, -h / 2.0],
            [w / 2.0, -h / 2.0],
            [w / 2.0, h / 2.0],
            [-w / 2.0, h / 2.0],
        ];
        let plate = Plate::of(&[Part::Polygon { vertices }]);
        near(plate.mean_square, (w * w + h * h) / 12.0);
        // mean distance from the middle of a unit square: (sqrt 2 + asinh 1) / 6
        let unit = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        near(
            Plate::of(&[Part::Polygon { vertices: unit }]).mean_radius,
            0.382_597_858_232_106,
        );
        let ellipse = Plate::of(&[Part::ellipse([0.05, 0.02], [0.0, 0.0], 0.7)]);
        near(ellipse.mean_square, (0.05 * 0.05 + 0.02 * 0.02) / 4.0);
    }

    #[test]
    fn what_parts_share_counts_once() {
        let disc = || Part::Disc {
            radius: 0.03,
            centre: [0.0, 0.0],
        };
        assert_eq!(Plate::of(&[disc(), disc()]), Plate::of(&[disc()]));
    }
}
