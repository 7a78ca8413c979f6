#![no_std]
//! What both images share: values that the optimiser cannot know.

pub mod any;
