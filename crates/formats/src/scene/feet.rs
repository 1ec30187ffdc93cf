//! The loads on three known feet.

use super::error::SceneProblem;

/// Share of the weight on each foot of an object whose centre of mass is the origin.
///
/// Force and moment balance, `sum N_k = 1`, `sum N_k r_k = 0`, make the loads the barycentric
/// coordinates of the origin in the triangle of the feet: N_1 = (r_2 x r_3) / A and its turns, with
/// A twice the triangle's area.
///
/// # Errors
/// The feet are on one line, or a load is negative: the origin is outside the triangle.
pub(super) fn loads([a, b, c]: [[f64; 2]; 3]) -> Result<[f64; 3], SceneProblem> {
    let double_area = cross(minus(b, a), minus(c, a));
    let longest = [minus(b, a), minus(c, b), minus(a, c)]
        .map(|edge| edge[0] * edge[0] + edge[1] * edge[1])
        .into_iter()
        .fold(0.0, f64::max);
    // a height of a billionth of the longest edge is rounding, not a triangle
    if double_area.abs().partial_cmp(&(1e-9 * longest)) != Some(std::cmp::Ordering::Greater) {
        return Err(SceneProblem::FeetOnLine);
    }
    let loads = [cross(b, c), cross(c, a), cross(a, b)].map(|area| area / double_area);
    let least = (0..3).fold(
        0,
        |least, k| if loads[k] < loads[least] { k } else { least },
    );
    if loads[least] >= 0.0 {
        Ok(loads)
    } else {
        Err(SceneProblem::FeetTip {
            foot: least + 1,
            load: loads[least],
        })
    }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn loads_of_an_even_tripod_are_thirds() {
        let height = 3.0_f64.sqrt() / 2.0;
        let loads = loads([[1.0, 0.0], [-0.5, height], [-0.5, -height]]).unwrap();
        assert!(
            loads.iter().all(|load| (load - 1.0 / 3.0).abs() < 1e-15),
            "{loads:?}"
        );
    }

    #[test]
    fn loads_do_not_depend_on_the_sense_of_rotation() {
        let feet = [[-0.02, -0.02], [0.01333, -0.00667], [-0.00667, 0.01333]];
        let [a, b, c] = loads(feet).unwrap();
        assert_eq!(loads([feet[0], feet[2], feet[1]]).unwrap(), [a, c, b]);
    }

    #[test]
    fn feet_on_a_line_and_feet_that_tip_are_refused() {
        assert_eq!(
            loads([[-1.0, -1.0], [0.0, 0.0], [1.0, 1.0]]),
            Err(SceneProblem::FeetOnLine)
        );
        assert_eq!(
            loads([[1.0, 0.0], [3.0, 0.0], [1.0, 2.0]]),
            Err(SceneProblem::FeetTip {
                foot: 2,
                load: -0.5
            })
        );
    }

    proptest! {
        #[test]
        fn loads_balance_force_and_moment(feet in prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64))) {
            if let Ok(loads) = loads(feet) {
                let moment = |axis: usize| (0..3).map(|k| loads[k] * feet[k][axis]).fold(0.0, |sum, m| sum + m);
                let scale = 1e-12 * loads.iter().fold(1.0, |most: f64, load| most.max(load.abs()));
                prop_assert!((loads[0] + loads[1] + loads[2] - 1.0).abs() < 1e-6);
                prop_assert!(moment(0).abs() < 1e-6 + scale && moment(1).abs() < 1e-6 + scale);
                prop_assert!(loads.iter().all(|load| *load >= 0.0));
            }
        }
    }
}
