#![no_main]
//! See `leadscrew_tests::hostile::sdo`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| leadscrew_tests::hostile::sdo(data));
