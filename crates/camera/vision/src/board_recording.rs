//! Frames of a tag board, searched for tags: [`BoardRecording`].

use image::GrayImage;
use rayon::prelude::*;

use crate::calibration_error::CalibrationError;
use crate::detector::{Detector, FoundTag};

/// A frame of the board.
#[derive(Clone, Debug)]
pub struct CalibrationFrame {
    /// Display name.
    pub name: String,
    /// The tags in it.
    pub tags: Vec<FoundTag>,
}

/// Frames of one size, searched for tags.
#[derive(Clone, Debug)]
pub struct BoardRecording {
    /// The frames.
    pub frames: Vec<CalibrationFrame>,
    /// Their columns and rows.
    pub size: [u32; 2],
}

/// Searches the frames 0 to `count` - 1, which `load` brings as a name and an image, from any
/// thread.
///
/// # Errors
/// Those of `load`; frames of several sizes.
pub fn search_board<E: From<CalibrationError> + Send>(
    count: usize,
    load: impl Fn(usize) -> Result<(String, GrayImage), E> + Sync,
) -> Result<BoardRecording, E> {
    let search = |index: usize| {
        let (name, image) = load(index)?;
        let size = [image.width(), image.height()];
        Ok((
            CalibrationFrame {
                name,
                tags: Detector::new(size).find(&image),
            },
            size,
        ))
    };
    let found: Vec<(CalibrationFrame, [u32; 2])> = (0..count)
        .into_par_iter()
        .map(search)
        .collect::<Result<_, E>>()?;
    let size = found.first().map_or([0; 2], |first| first.1);
    if let Some((odd, other)) = found.iter().find(|(_, other)| *other != size) {
        let text = |[columns, rows]: [u32; 2]| format!("{columns} x {rows}");
        let (name, first) = (odd.name.clone(), found[0].0.name.clone());
        return Err(CalibrationError::Size {
            name,
            found: text(*other),
            first,
            expected: text(size),
        }
        .into());
    }
    Ok(BoardRecording {
        frames: found.into_iter().map(|(frame, _)| frame).collect(),
        size,
    })
}
