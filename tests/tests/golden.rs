//! Every stage of every golden model within the given tolerances: scalar and SIMD, native and in the browser.

use ctsn_core::cpu::Level;
use ctsn_tests::golden;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

#[test]
fn scalar() {
    golden::ALL.iter().for_each(|golden| golden.check(Level::fallback()));
}

#[test]
fn simd() {
    assert!(!Level::new().is_fallback(), "this machine offers no SIMD level to test");
    golden::ALL.iter().for_each(|golden| golden.check(Level::new()));
}

/// The level every x86-64 machine has, beside the best one.
#[test]
fn baseline() {
    golden::ALL.iter().for_each(|golden| golden.check(Level::baseline()));
}
