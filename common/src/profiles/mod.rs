//! Profiles of drives: what is known of a drive, each fact with its source, and what the simulation makes of it.
//!
//! A profile is a file of `params/drives`, or one that the user names. Nothing in it is without a source, and what nobody
//! has seen in the maker's own document says "not verified". Figures of loops and mechanics, which no maker states for a
//! machine, come from [`TYPICAL`] where the profile has none.
//!
//! Knows no board and no bus.

mod chosen;
mod facts;
mod read;
mod servo;
#[cfg(test)]
mod tests;

pub use chosen::{Choice, Chosen};
pub use facts::{Fact, Quirk, Reference};

use std::fmt;
use std::path::Path;

use leadscrew_core::alarm::Lang;

use crate::failure::{Failure, Outcome};
use crate::params;
use crate::words::{Both, both};

/// The profile whose figures stand in for those that a profile does not have.
pub const TYPICAL: &str = "small-lathe";

/// The drive that is where it is told: no profile.
pub const IDEAL: &str = "ideal";

macro_rules! built_in {
    ($($name:literal)*) => {
        /// The profiles that are built in: name and text.
        const BUILT_IN: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../drives/", $name, ".toml")))),*
        ];
    };
}

built_in! {
    "small-lathe" "kv15" "kv30" "kv100"
    "bonfiglioli-active-cube" "copley-accelnet" "delta-asda-a2" "elmo-dsp402" "faulhaber-mc5000" "infranor-xtrapuls"
    "kollmorgen-akd" "leadshine-em-can" "lexium-32a" "maxon-epos4" "nanotec-cpb" "technosoft-ipos"
}

/// What is known of a drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Profile {
    /// Its name on the command line.
    pub name: String,
    /// The drive, for a person.
    pub title: String,
    /// In the order of the file.
    pub facts: Vec<Fact>,
    /// What is odd about it.
    pub quirks: Vec<Quirk>,
}

impl Profile {
    /// All built-in ones.
    pub fn built_in() -> impl Iterator<Item = Self> {
        BUILT_IN.iter().filter_map(|(name, _)| Self::named(name))
    }

    fn named(name: &str) -> Option<Self> {
        let (name, text) = BUILT_IN.iter().find(|known| known.0 == name)?;
        // A test reads all of them.
        read::profile(&format!("params/drives/{name}.toml"), text).ok()
    }

    /// The built-in profile of this name, or that of a file whose name ends with `.toml`.
    ///
    /// # Errors
    /// No such profile, or a file that is wrong.
    pub fn find(name: &str, lang: Lang) -> Outcome<Self> {
        Self::find_at(name, Path::new(name), lang)
    }

    /// The same, with the path of that file.
    pub(crate) fn find_at(name: &str, path: &Path, lang: Lang) -> Outcome<Self> {
        if let Some(profile) = Self::named(name) {
            return Ok(profile);
        }
        if !name.ends_with(".toml") {
            let all: Vec<&str> = BUILT_IN.iter().map(|(name, _)| *name).collect();
            let all = all.join(", ");
            return Err(Failure::Usage(both!(
                "there is no drive `{name}`; there are {IDEAL}, {all}, and a file of your own, whose name ends with `.toml`",
                "没有驱动器 `{name}`；有 {IDEAL}、{all}，也可指定自己的 `.toml` 文件"
            )));
        }
        let text = params::read(path, lang)?;
        read::profile(name, &text).map_err(|mistake| Failure::WrongBecause(mistake.0))
    }

    /// The fact of this path.
    #[must_use]
    pub fn fact(&self, path: &str) -> Option<&Fact> {
        self.facts.iter().find(|fact| fact.path == path)
    }

    /// A drive with its profile, and how much of that nobody has verified.
    #[must_use]
    pub fn of_drive(&self, drive: impl fmt::Display) -> Both {
        let name = &self.name;
        let (all, unverified) = self.counts();
        both!(
            "{drive} {name} ({unverified} of its {all} facts not verified)",
            "{drive} {name}（{all} 项中 {unverified} 项未核实）"
        )
    }

    /// Facts and quirks, and how many of them are not verified.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let of_facts = self.facts.iter().map(|fact| &fact.source);
        let all = of_facts.chain(self.quirks.iter().map(|quirk| &quirk.source));
        let unverified = all.clone().filter(|source| !source.verified).count();
        (all.count(), unverified)
    }
}
