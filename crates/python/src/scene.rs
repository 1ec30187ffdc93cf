//! A scene file, read: [`Scene`].

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyList, PyTuple};
use stickslip::{Setup, counted};
use stickslip_dynamics::{Dynamics, Friction};
use stickslip_formats::{SceneEdit, read_scene};
use toml_edit::{Array, InlineTable, Value};

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
    fn new(text: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let Ok(text) = text.extract::<&str>() else {
            let kind = text.get_type().name()?;
            return Err(refused(format!(
                "the scene is {kind}; give the text of scene.toml, or use Scene.from_numbers"
            )));
        };
        Self::of_text(text, name)
    }

    /// A scene of tables by their names.
    #[staticmethod]
    #[pyo3(signature = (**tables))]
    fn from_numbers(tables: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        edited(SceneEdit::default(), tables, "scene.toml")
    }

    /// The scene with other values.
    #[pyo3(signature = (**values))]
    fn replace(&self, values: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let edit = SceneEdit::new(&self.text, &self.name).map_err(refused)?;
        edited(edit, values, &self.name)
    }

    /// Number of the other fingers of a hand, besides the pusher.
    #[getter]
    fn fingers(&self) -> usize {
        self.setup.scene.pusher.fingers.len() - 1
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

impl Scene {
    fn of_text(text: &str, name: &str) -> PyResult<Self> {
        let setup = read_scene(text, name).map_err(refused)?;
        Ok(Self {
            dynamics: Dynamics::new(setup.scene.clone()),
            setup,
            text: text.to_owned(),
            name: name.to_owned(),
        })
    }
}

/// The scene with values in place: by the names of friction parameters, by ways of keys, or by
/// tables of values.
fn edited(mut edit: SceneEdit, values: Option<&Bound<'_, PyDict>>, name: &str) -> PyResult<Scene> {
    let mut put = |way: &str, value: &Bound<'_, PyAny>| {
        let value = (!value.is_none())
            .then(|| toml_of(way, value))
            .transpose()?;
        edit.put(way, value).map_err(refused)
    };
    for (key, value) in values.into_iter().flatten() {
        let key: String = key.extract()?;
        let way = match key.as_str() {
            "mu_s" => "support.friction",
            "mu_p" => "pusher.friction",
            "mu_f" => "fixels.friction",
            "d_tri" => "support.tripod_radius",
            other => other,
        };
        match value.cast::<PyDict>() {
            Ok(table) if !way.contains('.') => {
                for (key, value) in table {
                    put(&format!("{way}.{key}"), &value)?;
                }
            }
            _ => put(way, &value)?,
        }
    }
    Scene::of_text(&edit.text(), name)
}

/// A value of Python in a scene's file; arrays of NumPy become lists.
fn toml_of(way: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(truth.is_true().into());
    }
    if let Ok(text) = value.extract::<String>() {
        return Ok(text.into());
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let mut inline = InlineTable::new();
        for (key, value) in table {
            inline.insert(key.to_string(), toml_of(way, &value)?);
        }
        return Ok(inline.into());
    }
    if value.hasattr("tolist")? {
        return toml_of(way, &value.call_method0("tolist")?);
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| toml_of(way, &item?));
        return Ok(items.collect::<PyResult<Array>>()?.into());
    }
    if let Ok(whole) = value.cast::<PyInt>().map(|whole| whole.extract::<i64>()) {
        let whole = whole.map_err(|_| refused(format!("{way} is {value}, which is too large")))?;
        return Ok(whole.into());
    }
    match value.extract::<f64>() {
        Ok(number) => Ok(number.into()),
        Err(_) => Err(refused(format!(
            "{way} is {}; a scene has numbers, texts, lists and tables",
            value.repr()?
        ))),
    }
}
