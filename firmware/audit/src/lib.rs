#![no_std]
//! What the images are made of: values that the optimiser cannot know, and the steps that are counted.

pub mod any;
pub mod work;
