mod dictionary;
pub(super) mod drives;
mod servos;
mod spindle;
mod stand_ins;
