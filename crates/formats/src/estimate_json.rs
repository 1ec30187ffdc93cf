//! An estimate's row as one line of JSON: [`estimate_json`], keys named as the columns of
//! `estimate.csv`, and the effect of a deadline on it.

use stickslip::{EstimateRow, Setup};

use crate::estimate_csv::{EstimateColumns, cells, header};

/// Effect of a deadline on the estimates so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// Particles that this estimate is made of.
    pub particles: usize,
    /// Answers before this one that came after their deadline.
    pub missed: u64,
}

/// A row of an estimate as a JSON object on one line, its keys and numbers those of `estimate.csv`,
/// `null` for an empty cell; every number reads back to the same bits. Where there is a deadline,
/// the keys `particles` and `missed` come after them.
///
/// # Panics
/// If the row has not one contact probability per fixel and other finger and other finger of
/// `setup`.
#[must_use]
pub fn estimate_json(time: f64, row: &EstimateRow, setup: &Setup, pace: Option<Pace>) -> String {
    let columns = EstimateColumns {
        others: setup.scene.others(),
        has_tripod: setup.has_tripod(),
    };
    let named = header(columns.others)
        .into_iter()
        .zip(cells(time, row, columns));
    let entries = named.map(|(name, cell)| {
        let value = if cell.is_empty() { "null" } else { &cell };
        format!("\"{name}\":{value}")
    });
    let paced = pace
        .map(|Pace { particles, missed }| format!("\"particles\":{particles},\"missed\":{missed}"));
    let entries: Vec<String> = entries.chain(paced).collect();
    format!("{{{}}}", entries.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = include_str!("../../testkit/experiments/slide-ell-disc-110/scene.toml");

    #[test]
    fn line_is_json_with_the_columns_as_keys() {
        let setup = crate::read_scene(SCENE, "scene.toml").expect("a scene");
        let row = EstimateRow {
            ess: Some(1e-7),
            resampled: Some(true),
            ..EstimateRow::default()
        };
        let line = estimate_json(0.1, &row, &setup, None);
        let value: serde_json::Value = serde_json::from_str(&line).expect("JSON");
        let object = value.as_object().expect("an object");
        assert_eq!(object.len(), 39 + 4 * setup.scene.others());
        let pace = Pace {
            particles: 64,
            missed: 3,
        };
        let line = estimate_json(0.1, &row, &setup, Some(pace));
        let paced: serde_json::Value = serde_json::from_str(&line).expect("JSON");
        assert_eq!(
            (&paced["particles"], &paced["missed"]),
            (&64.into(), &3.into())
        );
        assert_eq!(
            (
                &object["time"],
                &object["ess"],
                &object["x"],
                &object["resampled"]
            ),
            (
                &0.1.into(),
                &1e-7.into(),
                &serde_json::Value::Null,
                &1.into()
            )
        );
    }
}
