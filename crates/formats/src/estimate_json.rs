//! An estimate's row as one line of JSON: [`estimate_json`], keys named as the columns of
//! `estimate.csv`.

use stickslip::{EstimateRow, Setup};

use crate::estimate_csv::{EstimateColumns, cells, header};

/// A row of an estimate as a JSON object on one line, its keys and numbers those of `estimate.csv`,
/// `null` for an empty cell; every number reads back to the same bits.
///
/// # Panics
/// If the row has not one contact probability per fixel of `setup`.
#[must_use]
pub fn estimate_json(time: f64, row: &EstimateRow, setup: &Setup) -> String {
    let columns = EstimateColumns {
        fixels: setup.scene.fixels.len(),
        has_tripod: setup.has_tripod(),
    };
    let named = header(columns.fixels)
        .into_iter()
        .zip(cells(time, row, columns));
    let entries = named.map(|(name, cell)| {
        let value = if cell.is_empty() { "null" } else { &cell };
        format!("\"{name}\":{value}")
    });
    format!("{{{}}}", entries.collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = include_str!("../../cli/demo/slide-ell-disc-110/scene.toml");

    #[test]
    fn line_is_json_with_the_columns_as_keys() {
        let setup = crate::read_scene(SCENE, "scene.toml").expect("a scene");
        let row = EstimateRow {
            ess: Some(1e-7),
            resampled: Some(true),
            ..EstimateRow::default()
        };
        let line = estimate_json(0.1, &row, &setup);
        let value: serde_json::Value = serde_json::from_str(&line).expect("JSON");
        let object = value.as_object().expect("an object");
        assert_eq!(object.len(), 24 + setup.scene.fixels.len());
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
