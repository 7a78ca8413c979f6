#![no_std]
//! The library of the images: values that the optimiser cannot know, and the steps that are counted.

pub mod any;
pub mod work;
