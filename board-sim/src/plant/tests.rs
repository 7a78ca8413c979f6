mod drives;
mod spindle;
