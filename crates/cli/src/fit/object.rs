//! Pushes of each object: [`objects`].

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use stickslip_fit::{Push, by_object};

/// The pushes of one object.
#[derive(Debug)]
pub struct Object {
    /// Its name, where there are several objects.
    pub name: Option<String>,
    /// Folder for its fit.
    pub out: PathBuf,
    pub folders: Vec<PathBuf>,
    pub pushes: Vec<Push>,
    /// Those of `--test`.
    pub test: Vec<Push>,
}

/// The objects of the pushes. Where there are several, each has a folder of its name in `out`.
///
/// # Errors
/// A push of `test` whose object no other push has.
pub fn objects(
    out: &Path,
    (folders, pushes): (Vec<PathBuf>, Vec<Push>),
    test: Vec<Push>,
) -> Result<Vec<Object>> {
    let taught = pushes.len();
    let (folders, all) = (&folders, [pushes, test].concat());
    let groups = by_object(&all);
    let names = object_names(&all, &groups);
    let object = |(group, name): (Vec<usize>, String)| {
        let (pushes, test): (Vec<usize>, Vec<usize>) = group.iter().partition(|k| **k < taught);
        if pushes.is_empty() {
            bail!(
                "{}: this push of --test has an object that no fitted push has: another outline, mass, inertia or feet. \
                 Add pushes of this object, or leave it out",
                all[test[0]].name
            );
        }
        let name = (groups.len() > 1).then_some(name);
        let of = |chosen: Vec<usize>| chosen.into_iter().map(|k| all[k].clone()).collect();
        Ok(Object {
            out: out.join(name.as_deref().unwrap_or_default()),
            name,
            folders: pushes.iter().map(|k| folders[*k].clone()).collect(),
            pushes: of(pushes),
            test: of(test),
        })
    };
    groups.clone().into_iter().zip(names).map(object).collect()
}

/// Name of each object: what the names of its pushes begin with, or its number where they have
/// nothing in common or two objects would have one name.
fn object_names(pushes: &[Push], groups: &[Vec<usize>]) -> Vec<String> {
    let common = |group: &Vec<usize>| {
        let mut names = group.iter().map(|k| pushes[*k].name.as_str());
        let first = names.next().unwrap_or_default();
        let of_both = |common: &str, name: &str| -> usize {
            let pairs = common.chars().zip(name.chars());
            let same = pairs.take_while(|(a, b)| a == b);
            same.map(|(letter, _)| letter.len_utf8()).sum()
        };
        let common = names.fold(first, |common, name| &common[..of_both(common, name)]);
        // push-10 and push-11 are both pushes
        let is_digit = |letter: char| letter.is_ascii_digit();
        let cuts_number = |k: &usize| pushes[*k].name[common.len()..].starts_with(is_digit);
        let common = match group.iter().any(cuts_number) {
            true => common.trim_end_matches(is_digit),
            false => common,
        };
        common.trim_end_matches(|letter: char| !letter.is_alphanumeric())
    };
    let names: Vec<&str> = groups.iter().map(common).collect();
    let name = |(k, name): (usize, &&str)| {
        let is_own = names.iter().filter(|other| *other == name).count() == 1;
        match is_own && !name.is_empty() {
            true => (*name).to_owned(),
            false => format!("object-{}", k + 1),
        }
    };
    names.iter().enumerate().map(name).collect()
}
