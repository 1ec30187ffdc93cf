//! Why an order of the paper is not found again: [`reason`], from measurements that docs/guide/reproduce.md describes.

use super::participant::Participant;

/// The measured cause for a pair of a row, where one is known.
pub fn reason(_title: &str, _better: Participant, _worse: Participant) -> Option<&'static str> {
    None
}
