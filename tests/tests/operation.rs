//! Every operation by its suite in the core: at every SIMD level, natively and in the browser, and on the GPU.

use ctsn_core::cpu::{Cpu, Level};
use ctsn_core::device::Device;
use ctsn_core::suite::cases;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen_test::{wasm_bindgen_test as test, wasm_bindgen_test_configure};

#[cfg(target_arch = "wasm32")]
wasm_bindgen_test_configure!(run_in_browser);

fn check(level: Level) {
    let mut cpu = Cpu::with_level(level);
    cases().iter().for_each(|case| case.check(|operation| cpu.run(operation.lend())));
}

#[test]
fn scalar() {
    check(Level::fallback());
}

#[test]
fn simd() {
    check(Level::new());
}

/// The level every x86-64 machine has, beside the best one.
#[test]
fn baseline() {
    check(Level::baseline());
}

/// The shaders for software adapters and those for all others.
#[cfg(feature = "machine")]
#[test]
fn gpu() {
    let gpu = pollster::block_on(ctsn_gpu::Gpu::new()).expect("a Vulkan adapter (Debian: mesa-vulkan-drivers)");
    for gpu in [true, false].map(|software| gpu.treated_as_software(software)) {
        for case in cases() {
            case.check(|operation| pollster::block_on(ctsn_gpu::evaluate(&gpu, operation)).expect(&case.name));
        }
    }
}
