//! Why an order of the paper is not found again: [`reason`], from measurements that docs/guide/reproduce.md describes.

use super::contender::Contender;

/// The measured cause for a pair of a row, where one is known.
pub fn reason(_title: &str, _better: Contender, _worse: Contender) -> Option<&'static str> {
    None
}
