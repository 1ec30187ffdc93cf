//! A camera's numbers as ROS and OpenCV write them: [`CameraInfo`], [`read_camera_info`].

use serde::Deserialize;

use crate::config::{ConfigError, Document};
use crate::lens::Lens;

/// Map from directions to pixels, called CameraInfo in ROS.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraInfo {
    /// Columns and rows of an image.
    pub size: [u32; 2],
    /// Name of the distortion model; empty for none, or for that of OpenCV.
    pub model: String,
    /// Its numbers: k1, k2, p1, p2, k3, and more of other models.
    pub distortion: Vec<f64>,
    /// The camera's matrix K, row by row (px).
    pub matrix: [f64; 9],
    /// Pixels of the sensor that are one of the image, along x and y; 0 is 1.
    pub binning: [u32; 2],
    /// The part of the sensor that is read out: left, top, width, height (px); width and height 0
    /// for all of it.
    pub window: [u32; 4],
}

/// Reason why a camera's numbers give no lens; `of` says whose they are.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraInfoError {
    /// A lens of another kind.
    #[error(
        "{of}: the distortion model is `{model}` with the numbers {numbers:?}; only that of Brown and Conrady can be read: plumb_bob, with k1, k2, p1, p2 and k3. Calibrate with `stickslip calibrate`, or rectify the images and tell the lens of the rectified ones"
    )]
    Model {
        /// Owner of the numbers.
        of: String,
        /// Name of the model.
        model: String,
        /// Its numbers.
        numbers: Vec<f64>,
    },
    /// Numbers of another model under the name of Brown's.
    #[error(
        "{of}: the distortion model is plumb_bob with {} numbers, {numbers:?}; plumb_bob has five, k1, k2, p1, p2 and k3, and the others must be 0. These are numbers of {right}, which cannot be read: calibrate with `stickslip calibrate`, or rectify the images", numbers.len()
    )]
    MoreNumbers {
        /// Owner of the numbers.
        of: String,
        /// Its numbers.
        numbers: Vec<f64>,
        /// Name of the model that has so many.
        right: &'static str,
    },
    /// A matrix that is none of a camera.
    #[error(
        "{of}: the camera matrix is {matrix:?}; it must be [fx, 0, cx, 0, fy, cy, 0, 0, 1] with focal lengths fx and fy above 0. Calibrate the camera"
    )]
    Matrix {
        /// Owner of the numbers.
        of: String,
        /// The matrix, row by row.
        matrix: [f64; 9],
    },
    /// Images that are not the whole sensor's.
    #[error(
        "{of}: the images are {what}, and the camera's numbers are those of the whole sensor at its full resolution. Record such images, or calibrate these with `stickslip calibrate`"
    )]
    Part {
        /// Owner of the numbers.
        of: String,
        /// Description of the images.
        what: String,
    },
    /// Columns or rows that are none.
    #[error(
        "{of}: an image has {columns} x {rows} pixels; both must be in 1 to 65535. Calibrate the camera"
    )]
    Size {
        /// Owner of the numbers.
        of: String,
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
    },
}

impl CameraInfo {
    /// The lens; `None` where the camera was not calibrated, which ROS says by a focal length of 0.
    /// `of` says in errors whose numbers they are.
    ///
    /// # Errors
    /// [`CameraInfoError`]: another model than Brown's, a matrix that is none, images of a part of
    /// the sensor.
    pub fn lens(&self, of: &str) -> Result<Option<Lens>, CameraInfoError> {
        if self.matrix[0] == 0.0 {
            return Ok(None);
        }
        let of = of.to_owned();
        let [columns, rows] = self.size;
        if [columns, rows].iter().any(|n| !(1..=65_535).contains(n)) {
            return Err(CameraInfoError::Size { of, columns, rows });
        }
        if let Some(what) = self.part() {
            return Err(CameraInfoError::Part { of, what });
        }
        let [fx, skew, cx, a, fy, cy, b, c, one] = self.matrix;
        let rest = [skew, a, b, c, one - 1.0];
        let finite = self.matrix.iter().all(|n| n.is_finite());
        if !finite || rest != [0.0; 5] || fx <= 0.0 || fy <= 0.0 {
            let matrix = self.matrix;
            return Err(CameraInfoError::Matrix { of, matrix });
        }
        let numbers = &self.distortion;
        let finite = numbers.iter().all(|n| n.is_finite());
        let only_five = numbers.iter().skip(5).all(|n| *n == 0.0);
        let is_brown = match self.model.as_str() {
            "plumb_bob" if finite && !only_five => {
                let right = match numbers.len() {
                    ..=8 => "rational_polynomial",
                    9..=12 => "OpenCV's thin prism model",
                    _ => "OpenCV's tilted model",
                };
                let numbers = numbers.clone();
                return Err(CameraInfoError::MoreNumbers { of, numbers, right });
            }
            // some drivers fill up with zeros
            "plumb_bob" => numbers.len() >= 4,
            "rational_polynomial" | "" => [0, 4, 5, 8, 12, 14].contains(&numbers.len()),
            _ => false,
        };
        let is_known = is_brown && finite && only_five;
        if !is_known && numbers.iter().any(|n| *n != 0.0) {
            return Err(CameraInfoError::Model {
                of,
                model: self.model.clone(),
                numbers: numbers.clone(),
            });
        }
        let [k1, k2, p1, p2, k3] = std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0.0));
        Ok(Some(Lens {
            size: self.size,
            focal: [fx, fy],
            centre: [cx, cy],
            radial: [k1, k2, k3],
            tangential: [p1, p2],
        }))
    }

    /// Reason why the images are not those that the numbers are of.
    fn part(&self) -> Option<String> {
        let [bx, by] = self.binning;
        if bx > 1 || by > 1 {
            return Some(format!("binned by {bx} x {by} pixels"));
        }
        let [left, top, width, height] = self.window;
        let whole =
            [left, top] == [0, 0] && ([width, height] == [0, 0] || [width, height] == self.size);
        (!whole).then(|| format!("a window of {width} x {height} pixels at ({left}, {top})"))
    }
}

/// The YAML files of ROS' `camera_calibration` and of OpenCV's calibration; other keys are not
/// read.
#[derive(Deserialize)]
struct CameraFile {
    #[serde(alias = "width")]
    image_width: u32,
    #[serde(alias = "height")]
    image_height: u32,
    #[serde(alias = "cameraMatrix", alias = "K", alias = "M")]
    camera_matrix: Matrix,
    #[serde(default)]
    distortion_model: String,
    #[serde(alias = "distCoeffs", alias = "dist_coeffs", alias = "D")]
    distortion_coefficients: Matrix,
}

/// A matrix as OpenCV writes it.
#[derive(Deserialize)]
struct Matrix {
    data: Vec<f64>,
}

/// Reads the numbers of a camera from YAML, as ROS (`camera_info.yaml`) or as OpenCV's
/// `FileStorage` writes it (`%YAML:1.0`); `name` is shown in errors.
///
/// # Errors
/// No YAML, a key that is missing or of another type, a camera matrix without nine numbers, each
/// with file and line.
///
/// ```
/// let yaml = "image_width: 640\nimage_height: 480\ndistortion_model: plumb_bob\n\
///     camera_matrix: {rows: 3, cols: 3, data: [600, 0, 320, 0, 601, 240, 0, 0, 1]}\n\
///     distortion_coefficients: {rows: 1, cols: 5, data: [-0.2, 0.1, 1e-3, 0, 0.02]}\n";
/// let lens = stickslip_vision::read_camera_info(yaml, "camera_info.yaml")?.lens("camera_info.yaml")?.unwrap();
/// assert_eq!((lens.focal, lens.radial), ([600.0, 601.0], [-0.2, 0.1, 0.02]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_camera_info(text: &str, name: &str) -> Result<CameraInfo, ConfigError> {
    const NEXT: &str = "Give image_width, image_height, camera_matrix and distortion_coefficients, as ROS' camera_calibration and OpenCV's FileStorage write them, or a calibration.toml";
    let document = Document { name, text };
    // OpenCV's first line is not as YAML has it, so the reader gets a comment of its length
    let rest = text.strip_prefix("%YAML:");
    let yaml = rest.map_or(text.to_owned(), |rest| format!("#YAML:{rest}"));
    let parsed: Result<CameraFile, _> = serde_saphyr::from_str(&yaml);
    let file = parsed.map_err(|error| {
        let line = error.location().map_or(1, |at| at.line() as usize).max(1);
        let found = text.lines().nth(line - 1).unwrap_or("").trim().to_owned();
        let message = error.to_string();
        let message = message.lines().next().unwrap_or("").to_owned();
        document.form(line, found, message, NEXT)
    })?;
    let matrix = file.camera_matrix.data;
    let Ok(matrix) = <[f64; 9]>::try_from(matrix.as_slice()) else {
        let line = text.lines().position(|line| line.contains("atrix"));
        let message = format!("the camera matrix has {} numbers, not 9", matrix.len());
        return Err(document.form(line.unwrap_or(0) + 1, String::new(), message, NEXT));
    };
    Ok(CameraInfo {
        size: [file.image_width, file.image_height],
        model: file.distortion_model,
        distortion: file.distortion_coefficients.data,
        matrix,
        binning: [0; 2],
        window: [0; 4],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info() -> CameraInfo {
        CameraInfo {
            size: [640, 480],
            model: "plumb_bob".to_owned(),
            distortion: vec![-0.25, 0.5, 1e-3, -2e-3, 0.125],
            matrix: [600.0, 0.0, 321.0, 0.0, 605.0, 239.0, 0.0, 0.0, 1.0],
            binning: [1, 1],
            window: [0, 0, 640, 480],
        }
    }

    #[test]
    fn plumb_bob_is_k1_k2_p1_p2_k3() {
        let lens = Lens {
            size: [640, 480],
            focal: [600.0, 605.0],
            centre: [321.0, 239.0],
            radial: [-0.25, 0.5, 0.125],
            tangential: [1e-3, -2e-3],
        };
        assert_eq!(info().lens("a").unwrap(), Some(lens));
        let mut longer = info();
        longer.model = "rational_polynomial".to_owned();
        longer.distortion.extend([0.0; 3]);
        assert_eq!(longer.lens("a").unwrap(), Some(lens));
        // as drivers fill up the numbers of plumb_bob
        longer.model = "plumb_bob".to_owned();
        assert_eq!(longer.lens("a").unwrap(), Some(lens));
        longer.distortion.push(0.0);
        assert_eq!(longer.lens("a").unwrap(), Some(lens));
        let none = CameraInfo {
            model: String::new(),
            distortion: Vec::new(),
            ..info()
        };
        assert!(!none.lens("a").unwrap().unwrap().is_distorted());
    }

    #[test]
    fn a_camera_that_is_not_calibrated_has_no_lens() {
        let unknown = CameraInfo {
            matrix: [0.0; 9],
            distortion: Vec::new(),
            ..info()
        };
        assert_eq!(unknown.lens("a"), Ok(None));
    }

    #[test]
    fn lens_names_what_is_wrong() {
        let eight = vec![0.1, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0];
        let model = |model: &str, distortion: &[f64]| CameraInfo {
            model: model.to_owned(),
            distortion: distortion.to_vec(),
            ..info()
        };
        let mut skewed = info();
        skewed.matrix[1] = 0.5;
        let mut backwards = info();
        backwards.matrix[4] = -605.0;
        let binned = CameraInfo {
            binning: [2, 2],
            ..info()
        };
        let window = CameraInfo {
            window: [10, 0, 600, 480],
            ..info()
        };
        for (info, words) in [
            (
                model("equidistant", &[0.1; 4]),
                "the distortion model is `equidistant`",
            ),
            (
                model("rational_polynomial", &eight),
                "only that of Brown and Conrady",
            ),
            (
                model("plumb_bob", &eight),
                "These are numbers of rational_polynomial",
            ),
            (
                model("plumb_bob", &[0.1; 12]),
                "These are numbers of OpenCV's thin prism model",
            ),
            (
                model("plumb_bob", &[f64::NAN; 5]),
                "only that of Brown and Conrady",
            ),
            (skewed, "with focal lengths fx and fy above 0"),
            (backwards, "with focal lengths fx and fy above 0"),
            (binned, "binned by 2 x 2 pixels"),
            (window, "a window of 600 x 480 pixels at (10, 0)"),
        ] {
            let text = info.lens("bag: /cam/camera_info").unwrap_err().to_string();
            assert!(
                text.starts_with("bag: /cam/camera_info: ") && text.contains(words),
                "{text}"
            );
        }
    }

    /// As OpenCV's samples/cpp/calibration.cpp writes it.
    const OPENCV: &str = "%YAML:1.0\n---\ncalibration_time: \"Tue 24 Nov 2026\"\nnframes: 12\nimage_width: 640\nimage_height: 480\n\
        camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 6.0e+02, 0., 321., 0.,\n       605., 239., 0., 0., 1. ]\n\
        distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ -2.5e-01, 0.5,\n       1.0000000000000000e-03, -2e-3, .125 ]\n\
        avg_reprojection_error: 1.5e-01\n";

    /// As ROS' camera_calibration_parsers writes it.
    const ROS: &str = "image_width: 640\nimage_height: 480\ncamera_name: overhead\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [600, 0, 321, 0, 605, 239, 0, 0, 1]\n\
        distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.25, 0.5, 0.001, -0.002, 0.125]\n\
        rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: [580, 0, 320, 0, 0, 590, 240, 0, 0, 0, 1, 0]\n";

    #[test]
    fn files_of_both_programs_say_the_same_lens() {
        let expected = info().lens("a").unwrap();
        for text in [OPENCV, ROS] {
            let read = read_camera_info(text, "c.yaml").unwrap();
            assert_eq!(read.lens("c.yaml").unwrap(), expected);
        }
    }

    #[test]
    fn read_camera_info_names_file_line_and_next_step() {
        for (from, to, words) in [
            ("image_width: 640\n", "", "image_width"),
            ("[600, 0, 321,", "[600, oh, 321,", "c.yaml:7: "),
            (
                "0, 0, 1]\ndistortion_model",
                "0, 1]\ndistortion_model",
                "has 8 numbers, not 9",
            ),
            ("camera_name: overhead", "camera_name: {", "c.yaml:"),
        ] {
            let text = read_camera_info(&ROS.replacen(from, to, 1), "c.yaml");
            let text = text.unwrap_err().to_string();
            assert!(
                text.contains(words) && text.contains("Give image_width"),
                "{text}"
            );
        }
    }
}
