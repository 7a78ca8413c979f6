mod dictionary;
pub(super) mod drives;
mod spindle;
mod stand_ins;
