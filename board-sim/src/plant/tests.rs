mod dictionary;
mod drives;
mod spindle;
mod stand_ins;
