//! A scene file, read: [`Scene`].

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::{Setup, counted};
use stickslip_dynamics::{Dynamics, Friction};
use stickslip_formats::read_scene;

use crate::error::refused;

/// Prior knowledge of an experiment: scene, sensors and filter settings, as in scene.toml.
#[pyclass(frozen, module = "stickslip")]
pub struct Scene {
    pub setup: Setup,
    pub dynamics: Dynamics,
    #[pyo3(get)]
    pub text: String,
    #[pyo3(get)]
    pub name: String,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (text, name = "scene.toml"))]
    fn new(text: &str, name: &str) -> PyResult<Self> {
        let setup = read_scene(text, name).map_err(refused)?;
        Ok(Self {
            dynamics: Dynamics::new(setup.scene.clone()),
            setup,
            text: text.to_owned(),
            name: name.to_owned(),
        })
    }

    /// Number of fixels.
    #[getter]
    fn fixels(&self) -> usize {
        self.setup.scene.fixels.len()
    }

    /// Nominal friction; the tripod radius is NaN where the feet are known.
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Friction {
            mu_s,
            mu_p,
            mu_f,
            d_tri,
        } = self.setup.scene.nominal;
        let d_tri = if self.setup.has_tripod() {
            d_tri
        } else {
            f64::NAN
        };
        let values = PyDict::new(py);
        for (name, value) in [
            ("mu_s", mu_s),
            ("mu_p", mu_p),
            ("mu_f", mu_f),
            ("d_tri", d_tri),
        ] {
            values.set_item(name, value)?;
        }
        Ok(values)
    }

    /// Weight of an angle in scores: the object's radius of gyration (m).
    #[getter]
    fn virtual_radius(&self) -> f64 {
        self.setup.virtual_radius()
    }

    /// Friction (K, 4) from the scene's prior, by standard normal numbers (K, 4): mu_s, mu_p, mu_f,
    /// d_tri.
    fn drawn_friction<'py>(
        &self,
        py: Python<'py>,
        normals: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = normals.as_slice()?.as_chunks::<4>().0;
        if normals.shape() != [rows.len(), 4] {
            return Err(refused("normals must have the shape (K, 4)"));
        }
        let drawn = rows.iter().flat_map(|normals| {
            let Friction {
                mu_s,
                mu_p,
                mu_f,
                d_tri,
            } = self.setup.drawn_friction(*normals);
            [mu_s, mu_p, mu_f, d_tri]
        });
        PyArray1::from_iter(py, drawn).reshape([rows.len(), 4])
    }

    fn __repr__(&self) -> String {
        format!(
            "Scene({:?}, {})",
            self.name,
            counted(self.fixels() as u64, "fixel")
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, (String, String)) {
        let scene = slf.get();
        (
            slf.get_type().into_any(),
            (scene.text.clone(), scene.name.clone()),
        )
    }
}
