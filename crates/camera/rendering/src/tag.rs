//! A printed fiducial tag: [`Tag`].

/// Cells of a tag with its black border, [row][column] from the top left as printed; true is white.
pub type TagCells = [[bool; 8]; 8];

/// Grey of black ink.
const INK: f32 = 0.06;
/// Grey of paper.
pub(crate) const PAPER: f32 = 0.86;

/// A printed tag of 8 × 8 cells with a white margin one cell wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tag {
    /// Its cells.
    pub cells: TagCells,
    /// Edge of the black square (m).
    pub size: f64,
}

impl Tag {
    /// Edge of the whole print, white margin included (m).
    pub fn print_size(&self) -> f64 {
        self.size * 10.0 / 8.0
    }

    /// Grey at a point of the tag's frame: origin in its middle, x right, y up, as printed (m).
    pub(crate) fn grey(&self, [x, y]: [f64; 2]) -> f32 {
        let cell = |along: f64| (along / self.size + 0.5) * 8.0;
        let (column, row) = (cell(x), cell(-y));
        let inside = |cell: f64| (0.0..8.0).contains(&cell);
        // the casts cut off towards the first cell
        if !inside(column) || !inside(row) || self.cells[row as usize][column as usize] {
            PAPER
        } else {
            INK
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_reads_rows_from_the_top() {
        let mut cells = [[false; 8]; 8];
        cells[1][2] = true;
        let tag = Tag { cells, size: 0.08 };
        assert_eq!(tag.grey([-0.015, 0.025]), PAPER);
        assert_eq!(tag.grey([-0.015, -0.025]), INK);
        assert_eq!(tag.grey([0.041, 0.0]), PAPER);
    }
}
