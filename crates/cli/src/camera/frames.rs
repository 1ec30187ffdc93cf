//! A folder of images: [`FrameFolder`].

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;
use image::GrayImage;
use stickslip_formats::read_frames;
use stickslip_vision::read_picture;

use super::frame_names::FrameNames;
use crate::failure::hinted;

/// Endings of files that are taken for images.
const ENDINGS: [&str; 8] = ["png", "jpg", "jpeg", "bmp", "pgm", "ppm", "pnm", "pbm"];

/// The images of a folder in their order.
#[derive(Clone, Debug)]
pub struct FrameFolder {
    /// Folder of the images.
    folder: PathBuf,
    /// Their names in it.
    pub names: Vec<String>,
    /// Their times (s), where frames.csv gives them.
    pub time: Option<Vec<f64>>,
    /// Question that their names leave open about their order.
    pub question: Option<String>,
}

impl FrameFolder {
    /// Lists a folder: as frames.csv says where it is there, else all images by name, numbers in
    /// names by value.
    pub fn list(folder: &Path) -> Result<Self> {
        let list = folder.join("frames.csv");
        if list.is_file() {
            let bytes = fs::read(&list).map_err(|error| unreadable(&list, &error))?;
            let frames = read_frames(bytes.as_slice(), &list.display().to_string())?;
            return Ok(Self {
                folder: folder.to_owned(),
                names: frames.file,
                time: Some(frames.time),
                question: None,
            });
        }
        let entries = fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?;
        let mut names = Vec::new();
        for entry in entries {
            let path = entry.map_err(|error| unreadable(folder, &error))?.path();
            names.extend(
                path.file_name()
                    .and_then(|name| name.to_str())
                    .filter(|_| is_image(&path))
                    .map(str::to_owned),
            );
        }
        if names.is_empty() {
            let text = format!(
                "{}: there is no image in it, and no frames.csv",
                folder.display()
            );
            return Err(hinted(
                text,
                format!("give a folder with {} files", ENDINGS.join(", ")),
            ));
        }
        let FrameNames { names, question } = FrameNames::sort(names);
        Ok(Self {
            folder: folder.to_owned(),
            names,
            time: None,
            question,
        })
    }

    /// An image and its name for errors.
    pub fn load(&self, index: usize) -> Result<(String, GrayImage)> {
        let path = self.folder.join(&self.names[index]);
        let name = path.display().to_string();
        let bytes = fs::read(&path).map_err(|error| unreadable(&path, &error))?;
        let image = read_picture(&bytes, &name)?;
        Ok((name, image))
    }
}

fn is_image(path: &Path) -> bool {
    path.is_file()
        && path
            .extension()
            .and_then(|e| e.to_str())
            .is_some_and(|e| ENDINGS.contains(&e.to_ascii_lowercase().as_str()))
}

fn unreadable(path: &Path, error: &std::io::Error) -> anyhow::Error {
    hinted(
        format!("{}: cannot be read: {error}", path.display()),
        "give a folder of images, all of which can be read",
    )
}
