//! Nose.
