#![no_main]
//! See `leadscrew_tests::hostile::language`.

libfuzzer_sys::fuzz_target!(|data: &[u8]| leadscrew_tests::hostile::language(data));
