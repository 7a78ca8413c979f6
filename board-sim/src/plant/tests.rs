mod dictionary;
mod drives;
mod spindle;
