//! The tag family 36h11: the cells of its tags, [`tag_cells`].

use kornia_apriltag::family::TagFamily;

/// Tags of the family 36h11, numbered from 0.
pub const TAG_COUNT: u16 = 587;

/// Cells of a tag with its black border, [row][column] from the top left as printed; true is white.
/// `None` past [`TAG_COUNT`].
pub fn tag_cells(id: u16) -> Option<[[bool; 8]; 8]> {
    let family = TagFamily::tag36_h11();
    let code = family.code_data.get(usize::from(id))?;
    let mut cells = [[false; 8]; 8];
    // the code's bits, highest first, in the family's own order of cells
    for (bit, (x, y)) in family.bit_x.iter().zip(&family.bit_y).enumerate() {
        cells[*y as usize][*x as usize] = code >> (family.nbits - 1 - bit) & 1 == 1;
    }
    Some(cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tag_cells_end_with_the_family() {
        assert!(tag_cells(TAG_COUNT - 1).is_some());
        assert_eq!(tag_cells(TAG_COUNT), None);
    }
}
