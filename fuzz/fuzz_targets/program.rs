#![no_main]
//! See `leadscrew_tests::hostile::program`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| leadscrew_tests::hostile::program(data));
