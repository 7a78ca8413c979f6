//! Virtual metrology: what a tool removes from a part that turns, and what an inspector finds on it.
//!
//! A stream of [`Sample`]s (spindle angle, place of the tool) goes through a [`Cutter`], which cuts a [`Work`]: one
//! envelope of radii over Z for each of some hundred angles. [`measure`] finds the grooves in it and measures them as an
//! inspector does; [`Limits`] are those of the norm that a [`Designation`] names; [`inspect`] compares the two. [`recess`]
//! measures a groove, and a [`Contour`] the elements of a turned one.
//!
//! The tool lies in the axial plane. So its profile, put down where it passes an angle, is exactly what it removes there.
//!
//! An outer and an inner surface are treated alike: heights are `u`, the radius of an outer surface and minus the radius of
//! an inner one. A cut always lowers `u`.
//!
//! Knows nothing of programs, boards, buses and files.
//!
//! ```
//! use leadscrew_metrology::{Designation, Limits, Side};
//!
//! let thread = Designation::read("M24x2-6g", Side::External).expect("a thread of ISO 965");
//! assert_eq!(format!("{:.3}", thread.pitch_diameter().0), "22.701");
//! let pitch = Limits::of(&thread).pitch;
//! assert_eq!(pitch.high.map(|limit| format!("{:.3}", limit.0)).as_deref(), Some("22.663"));
//! ```

mod contour;
mod cutter;
mod designation;
mod gauge;
mod groove;
mod helix;
mod inspect;
mod limits;
mod line;
mod measure;
mod recess;
mod tables;
mod tool;
mod units;
mod work;

pub use contour::{Contour, Element, Place, Size, Turned};
pub use cutter::{Cutter, Sample};
pub use designation::{Designation, NotKnown, Series};
pub use gauge::Functional;
pub use helix::{Drunkenness, Lead};
pub use inspect::{Feature, Inspection, Row, inspect};
pub use limits::{Band, Limits, Origin};
pub use measure::{Measured, NoThread, Spread, Wires, measure};
pub use recess::{Recess, recess};
pub use tool::{Nose, Tool};
pub use units::{Cubic, Degrees, Mm, Side, Turns};
pub use work::{Chip, Grid, Stock, Work};

#[cfg(test)]
mod tests;
