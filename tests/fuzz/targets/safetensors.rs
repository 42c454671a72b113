//! Any bytes as a safetensors file: refused, or read, and then written again the same.
#![no_main]

use ctsn_core::file::Tensors;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = Tensors::parse(bytes) {
        let written = file.to_bytes();
        assert_eq!(Tensors::parse(&written).as_ref(), Ok(&file));
    }
});
