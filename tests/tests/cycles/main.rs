//! Cycles: calls in, moves out, against the worked examples, against a slow reference written from the text, and at
//! random.

mod alarms;
mod build;
mod examples;
mod random;
mod reference;
