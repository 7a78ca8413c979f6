//! Against a board inside this process.
