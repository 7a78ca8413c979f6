#![no_main]
//! See `leadscrew_tests::hostile::stored`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| leadscrew_tests::hostile::stored(data));
