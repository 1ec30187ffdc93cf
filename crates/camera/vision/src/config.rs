//! Small TOML files: why one was refused, [`ConfigError`], and where in it: [`Document`].

use serde::de::DeserializeOwned;

/// Reason why a TOML file was refused, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}: {problem}")]
pub struct ConfigError {
    /// Display name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// The problem.
    pub problem: ConfigProblem,
}

/// Problem of a TOML file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigProblem {
    /// Not TOML, or a key that is missing, unknown or of another type.
    #[error("`{found}`: {message}. {next}")]
    Form {
        /// The line as it stands.
        found: String,
        /// Message of the reader.
        message: String,
        /// Next step for the user.
        next: String,
    },
    /// A lens that is not that of the images.
    #[error(
        "`lens` sees some direction {apart} px from where the images' own lens, that of CameraInfo, sees it; the table was found through one lens and the images are seen through the other. Find the table again with `stickslip calibrate --lens`"
    )]
    OtherLens {
        /// Distance between both directions (px).
        apart: String,
    },
    /// A value against its rule.
    #[error("`{key}` is {found}; it must be {rule}. Correct it")]
    Rule {
        /// The key.
        key: String,
        /// The value found.
        found: String,
        /// The rule.
        rule: String,
    },
}

/// The text of a file with its name.
#[derive(Clone, Copy)]
pub(crate) struct Document<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

impl Document<'_> {
    /// Its tables; `next` says what to do about a file that has not the right ones.
    pub(crate) fn parse<T: DeserializeOwned>(&self, next: &str) -> Result<T, ConfigError> {
        toml::from_str(self.text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let line = self.text[..start].matches('\n').count() + 1;
            let found = self
                .text
                .lines()
                .nth(line - 1)
                .unwrap_or("")
                .trim()
                .to_owned();
            let message = error.message().lines().collect::<Vec<_>>().join(", ");
            self.form(line, found, message, next)
        })
    }

    /// An error about a line that has not the right form.
    pub(crate) fn form(
        &self,
        line: usize,
        found: String,
        message: String,
        next: &str,
    ) -> ConfigError {
        let next = next.to_owned();
        self.error(
            line,
            ConfigProblem::Form {
                found,
                message,
                next,
            },
        )
    }

    /// The error about a lens that sees directions `apart` (px) from where another one does.
    pub(crate) fn other_lens(&self, apart: f64) -> ConfigError {
        let line = self.line_of(|line| line.trim() == "[lens]") + 1;
        let apart = format!("{apart:.1}");
        self.error(line, ConfigProblem::OtherLens { apart })
    }

    /// An error unless `kept`: the value of `key` is `found` and must follow `rule`.
    pub(crate) fn require(
        &self,
        kept: bool,
        key: &str,
        found: impl Into<String>,
        rule: &str,
    ) -> Result<(), ConfigError> {
        if kept {
            return Ok(());
        }
        let named = |line: &str| {
            line.trim_start()
                .trim_start_matches('[')
                .starts_with(key.rsplit('.').next().unwrap_or(key))
        };
        let below = key.split_once('.').map_or(0, |(table, _)| {
            self.line_of(|line| line.trim() == format!("[{table}]"))
        });
        let line = below + self.text.lines().skip(below).position(named).unwrap_or(0) + 1;
        Err(self.error(
            line,
            ConfigProblem::Rule {
                key: key.to_owned(),
                found: found.into(),
                rule: rule.to_owned(),
            },
        ))
    }

    fn line_of(&self, is_it: impl Fn(&str) -> bool) -> usize {
        self.text.lines().position(is_it).unwrap_or(0)
    }

    fn error(&self, line: usize, problem: ConfigProblem) -> ConfigError {
        ConfigError {
            file: self.name.to_owned(),
            line,
            problem,
        }
    }
}
