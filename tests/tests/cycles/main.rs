//! Cycles: calls in, moves out, against the worked examples, against a slow reference written from the text, and at
//! random; and from program text, as it is typed.

mod alarms;
mod build;
mod counted;
mod examples;
mod random;
mod reference;
mod taps;
mod taps_random;
mod texts;
mod vectors;
