//! Cycles: calls in, moves out, against the worked examples, against a slow reference written from the text, and at
//! random.

mod build;
mod examples;
