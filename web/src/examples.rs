//! The programs that the page offers, and the machine of each folder. A browser has no files: the list is in the module,
//! and a test compares it with the folders.

use leadscrew_core::params::{Entry, Params, Part};
use leadscrew_core::units::Axis;

/// Programs with the machine they are for.
#[derive(Clone, Copy, Debug)]
pub struct Folder {
    /// Under `examples/`.
    pub name: &'static str,
    /// What its machine file says otherwise than the built-in machine.
    values: &'static [(u16, Part, i64)],
    /// File name and text.
    pub programs: &'static [(&'static str, &'static str)],
}

/// All of them.
pub const FOLDERS: &[Folder] = include!("examples/list.rs");

impl Folder {
    /// The parameters of its machine.
    #[must_use]
    pub fn params(&self) -> Params {
        let mut params = Params::slant_bed();
        for &(no, part, raw) in self.values {
            // They come from a set of this table, so that each is found and allowed.
            let part = (part != Part::Whole).then_some(part);
            let set = Entry::find(no, part).is_ok_and(|entry| params.set(entry, raw).is_ok());
            debug_assert!(set, "{no} is a parameter");
        }
        params
    }
}
