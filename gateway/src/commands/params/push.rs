//! `params push`: a set to a board.

use crate::failure::{Failure, Outcome};
use crate::words::both;

/// Sends what was typed.
pub fn run() -> Outcome {
    Err(Failure::Usage(both!(
        "writing parameters to a board is not available yet",
        "向控制板写参数尚未提供"
    )))
}
