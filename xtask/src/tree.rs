//! The workspace's files, read once: [`Tree`]. Checks work on it, so that their tests need no disk.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Folders that hold nothing of the project's own.
const SKIPPED: [&str; 3] = [".git", "target", "out"];

/// Endings of the files whose text is read.
const TEXT: [&str; 4] = ["rs", "toml", "md", "py"];

/// Paths from the root with `/` between names, with the text of those that are read.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    files: BTreeMap<String, Option<String>>,
}

impl Tree {
    /// All files below `root`.
    ///
    /// # Errors
    /// A folder or file cannot be read.
    pub fn read(root: &Path) -> Result<Self, String> {
        let mut tree = Self::default();
        tree.add_folder(root, "")?;
        Ok(tree)
    }

    fn add_folder(&mut self, folder: &Path, prefix: &str) -> Result<(), String> {
        let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
        for entry in fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{prefix}{name}");
            if entry.path().is_dir() {
                if !SKIPPED.contains(&name.as_str()) && !name.starts_with("target-") {
                    self.add_folder(&entry.path(), &format!("{path}/"))?;
                }
                continue;
            }
            let looked_at = path
                .rsplit_once('.')
                .is_some_and(|(_, ending)| TEXT.contains(&ending));
            let text = looked_at
                .then(|| {
                    fs::read_to_string(entry.path()).map_err(|error| format!("{path}: {error}"))
                })
                .transpose()?;
            self.files.insert(path, text);
        }
        Ok(())
    }

    /// Returns true if a file below `folder` has a path that ends with this one, whole names only.
    pub fn has_file(&self, folder: &str, path: &str) -> bool {
        let ending = format!("/{path}");
        self.files
            .keys()
            .any(|file| file.starts_with(folder) && file.ends_with(&ending))
    }

    /// Number of files.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Text of one file.
    pub fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path)?.as_deref()
    }

    /// Paths and texts of the files with this ending, sorted.
    pub fn texts<'a>(&'a self, ending: &'a str) -> impl Iterator<Item = (&'a str, &'a str)> {
        self.files.iter().filter_map(move |(path, text)| {
            Some((path.as_str(), text.as_deref()?)).filter(|_| path.ends_with(ending))
        })
    }

    /// Returns true if a file or folder of this path exists; a `/` at its end does not matter.
    pub fn exists(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        let folder = format!("{path}/");
        self.files.contains_key(path)
            || self
                .files
                .range(folder.clone()..)
                .next()
                .is_some_and(|(p, _)| p.starts_with(&folder))
    }
}

#[cfg(test)]
impl Tree {
    /// Of these paths and texts.
    pub fn of(files: &[(&str, &str)]) -> Self {
        let entry = |(path, text): &(&str, &str)| (path.to_string(), Some(text.to_string()));
        Self {
            files: files.iter().map(entry).collect(),
        }
    }
}

#[cfg(test)]
impl<const N: usize> From<[(&str, &str); N]> for Tree {
    fn from(files: [(&str, &str); N]) -> Self {
        Self::of(&files)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exists_knows_files_and_folders() {
        let tree = Tree::from([("crates/a/src/lib.rs", ""), ("crates/ab.md", "")]);
        for path in ["crates", "crates/a", "crates/a/src/", "crates/a/src/lib.rs"] {
            assert!(tree.exists(path), "{path}");
        }
        for path in ["crates/b", "crates/a/src/li", "lib.rs"] {
            assert!(!tree.exists(path), "{path}");
        }
    }
}
