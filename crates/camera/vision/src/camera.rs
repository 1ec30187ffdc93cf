//! A calibrated camera over the table: [`Camera`], and its file: [`read_camera`], [`write_camera`].

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};
use serde::Deserialize;

use crate::config::{ConfigError, Document};
use crate::lens::Lens;
use crate::motion::{Motion, nearest_rotation};

/// Next step for a file that is no calibration.
const MAKE_IT: &str = "Make the file with `stickslip calibrate`";
/// Lenses that see every direction at most this far apart are one (px).
const SAME_LENS: f64 = 0.5;
/// A rotation matrix from a file may be off by this much: files have rounded numbers.
const ROUNDED: f64 = 1e-6;

/// A lens, and the place of the table before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    lens: Lens,
    /// From the world's frame to the camera's (x right, y down, z forwards).
    to_camera: Motion,
}

/// calibration.toml as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibrationFile {
    lens: Option<LensTable>,
    table: PlaneTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LensTable {
    size: [u32; 2],
    focal: [f64; 2],
    centre: [f64; 2],
    /// k1, k2 and, where it is not 0, k3
    radial: Vec<f64>,
    tangential: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaneTable {
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Camera {
    pub(crate) fn new(lens: Lens, to_camera: Motion) -> Self {
        Self { lens, to_camera }
    }

    /// Its lens.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// Its centre of projection in the world (m).
    pub fn centre(&self) -> [f64; 3] {
        self.to_camera.inverse().translation.into()
    }

    /// The pixel at which a point of the world (m) is seen; `None` behind the camera.
    pub fn project(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        Some(self.lens.distort(self.ideal(point)?.0.into()))
    }

    /// The point at height `z` (m) that is seen at a pixel; `None` where there is none.
    pub fn point_at(&self, pixel: [f64; 2], z: f64) -> Option<[f64; 2]> {
        self.on_plane(self.lens.undistort(pixel)?.into(), z)
            .map(Into::into)
    }

    /// The ideal pixel of a point of the world, with its derivatives by x and y; `None` behind the
    /// camera.
    pub(crate) fn ideal(&self, point: [f64; 3]) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let at = self.to_camera.apply(point.into());
        if at.z <= 0.0 {
            return None;
        }
        let by_point = Matrix2x3::new(
            1.0 / at.z,
            0.0,
            -at.x / (at.z * at.z),
            0.0,
            1.0 / at.z,
            -at.y / (at.z * at.z),
        );
        let by_plane = by_point * self.to_camera.rotation.fixed_columns::<2>(0);
        let focal = Matrix2::from_diagonal(&self.lens.focal.into());
        Some((self.lens.ideal(at.xy() / at.z), focal * by_plane))
    }

    /// The point at height `z` that an ideal pixel sees; `None` where there is none before the
    /// camera.
    pub(crate) fn on_plane(&self, ideal: Vector2<f64>, z: f64) -> Option<Vector2<f64>> {
        let to_world = self.to_camera.inverse();
        let direction = to_world.rotation * self.lens.direction(ideal).push(1.0);
        let depth = (z - to_world.translation.z) / direction.z;
        (depth > 0.0 && depth.is_finite()).then(|| (to_world.translation + direction * depth).xy())
    }
}

/// Reads a calibration; `name` is shown in errors.
///
/// # Errors
/// Not TOML, a key that is missing, unknown or of another type, or a number against its rule, each
/// with file and line.
pub fn read_camera(text: &str, name: &str) -> Result<Camera, ConfigError> {
    let document = Document { name, text };
    let CalibrationFile { lens, table } = document.parse(MAKE_IT)?;
    let lens = lens.map(|lens| lens.check(&document)).transpose()?;
    let Some(lens) = lens else {
        return Err(no_lens(&document));
    };
    camera(&document, lens, table)
}

/// Reads a calibration for images that come with a lens of their own: the file's may be left out,
/// and must else be the same.
///
/// # Errors
/// Those of [`read_camera`]; the file's lens and `lens` see some direction more than half a pixel
/// apart.
pub fn read_camera_with(text: &str, name: &str, lens: &Lens) -> Result<Camera, ConfigError> {
    let document = Document { name, text };
    let CalibrationFile { lens: own, table } = document.parse(MAKE_IT)?;
    let own = own.map(|own| own.check(&document)).transpose()?;
    if let Some(own) = own {
        let pixels = |[columns, rows]: [u32; 2]| format!("{columns} x {rows} pixels");
        let rule = format!(
            "that of the images' own lens, {}, through which the table must be seen",
            pixels(lens.size)
        );
        document.require(own.size == lens.size, "size", pixels(own.size), &rule)?;
        let apart = own.apart(lens);
        if apart > SAME_LENS {
            return Err(document.other_lens(apart));
        }
    }
    camera(&document, *lens, table)
}

/// Reads the lens of a calibration, whatever the table is; `name` is shown in errors.
///
/// # Errors
/// Those of [`read_camera`], but those of the table.
pub fn read_lens(text: &str, name: &str) -> Result<Lens, ConfigError> {
    /// The table may be anything.
    #[derive(Deserialize)]
    struct LensFile {
        lens: Option<LensTable>,
    }
    let document = Document { name, text };
    match document.parse::<LensFile>(MAKE_IT)?.lens {
        Some(lens) => lens.check(&document),
        None => Err(no_lens(&document)),
    }
}

fn no_lens(document: &Document<'_>) -> ConfigError {
    let found = String::new();
    document.form(
        1,
        found,
        "there is no [lens]".to_owned(),
        "Make the file with `stickslip calibrate`, or track a bag that has CameraInfo",
    )
}

fn camera(document: &Document<'_>, lens: Lens, table: PlaneTable) -> Result<Camera, ConfigError> {
    let camera = Camera::new(lens, table.check(document)?);
    let height = camera.centre()[2];
    document.require(
        height > 0.0,
        "translation",
        format!("that of a camera at the height {height} m"),
        "that of a camera above the table",
    )?;
    Ok(camera)
}

impl LensTable {
    fn check(self, document: &Document<'_>) -> Result<Lens, ConfigError> {
        let Self {
            size,
            focal,
            centre,
            radial,
            tangential,
        } = self;
        let numbers = [&focal[..], &centre, &radial, &tangential].concat();
        document.require(
            numbers.iter().all(|n| n.is_finite()),
            "lens",
            "not finite",
            "finite numbers",
        )?;
        document.require(
            size.iter().all(|n| (1..=65_535).contains(n)),
            "size",
            format!("{size:?}"),
            "columns and rows in 1 to 65535",
        )?;
        document.require(
            focal.iter().all(|f| *f > 0.0),
            "focal",
            format!("{focal:?}"),
            "positive, in pixels",
        )?;
        let rule = "two or three numbers, k1, k2 and k3";
        let known = (2..=3).contains(&radial.len());
        document.require(known, "radial", format!("{radial:?}"), rule)?;
        Ok(Lens {
            size,
            focal,
            centre,
            radial: std::array::from_fn(|k| radial.get(k).copied().unwrap_or(0.0)),
            tangential,
        })
    }
}

impl PlaneTable {
    fn check(self, document: &Document<'_>) -> Result<Motion, ConfigError> {
        let rotation = Matrix3::from(self.rotation).transpose();
        let nearest =
            nearest_rotation(rotation).filter(|nearest| (nearest - rotation).amax() < ROUNDED);
        document.require(
            nearest.is_some(),
            "rotation",
            "no rotation",
            "three rows, each of length 1 and at right angles to the others",
        )?;
        let translation = Vector3::from(self.translation);
        document.require(
            translation.iter().all(|x| x.is_finite()),
            "translation",
            "not finite",
            "finite, in metres",
        )?;
        Ok(Motion {
            rotation: nearest.unwrap_or(rotation),
            translation,
        })
    }
}

/// A calibration as text; every number reads back to the same bits.
pub fn write_camera(camera: &Camera) -> String {
    let Lens {
        size,
        focal,
        centre,
        radial,
        tangential,
    } = camera.lens;
    let rotation: Vec<String> = camera
        .to_camera
        .rotation
        .row_iter()
        .map(|row| format!("  [{}, {}, {}],\n", row[0], row[1], row[2]))
        .collect();
    let [x, y, z] = camera.to_camera.translation.into();
    let known = if radial[2] == 0.0 {
        &radial[..2]
    } else {
        &radial
    };
    let radial: Vec<String> = known.iter().map(f64::to_string).collect();
    let radial = radial.join(", ");
    format!(
        "# A calibrated camera over the table. Pixels: the centre of the first one is (0, 0).\n\n\
         [lens]                      # Brown-Conrady, as OpenCV has it\n\
         size = [{}, {}]            # columns, rows\n\
         focal = [{}, {}]           # fx, fy (px)\n\
         centre = [{}, {}]          # cx, cy (px)\n\
         radial = [{radial}]          # k1, k2, and k3 where it is not 0\n\
         tangential = [{}, {}]      # p1, p2\n\n\
         [table]                     # from the world to the camera (x right, y down, z forwards): rotation x + translation (m)\n\
         rotation = [\n{}]\n\
         translation = [{x}, {y}, {z}]\n",
        size[0],
        size[1],
        focal[0],
        focal[1],
        centre[0],
        centre[1],
        tangential[0],
        tangential[1],
        rotation.concat(),
    )
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::motion::rotation;

    /// A camera 0.6 m above the table, tilted by 0.15 rad.
    pub(crate) fn camera() -> Camera {
        let lens = Lens {
            size: [640, 480],
            focal: [1210.0, 1200.0],
            centre: [330.0, 236.0],
            radial: [-0.2, 0.1, 0.05],
            tangential: [1e-3, -1e-3],
        };
        let down = rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        Camera::new(
            lens,
            Motion {
                rotation: rotation(Vector3::new(0.1, -0.11, 0.02)) * down,
                translation: Vector3::new(0.01, -0.02, 0.6),
            },
        )
    }

    #[test]
    fn point_at_undoes_project_at_any_height() {
        for point in [[0.0, 0.0, 0.0], [0.1, -0.05, 0.03], [-0.08, 0.07, 0.2]] {
            let [x, y] = camera()
                .point_at(camera().project(point).unwrap(), point[2])
                .unwrap();
            assert!(
                (x - point[0]).abs() < 1e-12 && (y - point[1]).abs() < 1e-12,
                "{point:?}"
            );
        }
        assert_eq!(camera().project([0.0, 0.0, 0.7]), None);
    }

    /// Derivatives against central differences.
    #[test]
    fn ideal_has_the_derivatives_of_its_value() {
        const H: f64 = 1e-6;
        let at = |x: f64, y: f64| camera().ideal([x, y, 0.02]).unwrap().0;
        let (_, by_plane) = camera().ideal([0.05, -0.03, 0.02]).unwrap();
        let numeric = [
            (at(0.05 + H, -0.03) - at(0.05 - H, -0.03)) / (2.0 * H),
            (at(0.05, -0.03 + H) - at(0.05, -0.03 - H)) / (2.0 * H),
        ];
        assert!((Matrix2::from_columns(&numeric) - by_plane).amax() < 1e-3 * by_plane.amax());
    }

    #[test]
    fn write_camera_reads_back_to_the_same_camera() {
        let read = read_camera(&write_camera(&camera()), "c.toml").unwrap();
        assert_eq!(read.lens(), camera().lens());
        assert!((read.to_camera.rotation - camera().to_camera.rotation).amax() < 1e-14);
        assert_eq!(read.to_camera.translation, camera().to_camera.translation);
    }

    #[test]
    fn read_camera_names_line_value_rule_and_next_step() {
        let good = write_camera(&camera());
        let refused = |from: &str, to: &str| {
            read_camera(&good.replacen(from, to, 1), "c.toml")
                .unwrap_err()
                .to_string()
        };
        let text = refused("focal = [1210", "focal = [-1210");
        assert!(
            text.contains("c.toml:5: `focal` is [-1210.0, 1200.0]")
                && text.contains("must be positive"),
            "{text}"
        );
        let text = refused("rotation = [\n  [", "rotation = [\n  [2");
        assert!(
            text.contains("c.toml:11: `rotation` is no rotation") && text.contains("right angles"),
            "{text}"
        );
        let text = refused("radial", "radail");
        assert!(
            text.starts_with("c.toml:7: ")
                && text.contains("`radail`")
                && text.contains("stickslip calibrate"),
            "{text}"
        );
        let text = refused("0.6]", "-0.6]");
        assert!(
            text.contains("`translation`") && text.contains("above the table"),
            "{text}"
        );
    }
}
