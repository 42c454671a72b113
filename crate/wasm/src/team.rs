//! The threads of a page: workers that JavaScript starts, each with an instance of this module on the same memory.

use ctsn_core::cpu::Threads;
use std::sync::OnceLock;
use wasm_bindgen::prelude::*;

static TEAM: OnceLock<Threads> = OnceLock::new();

/// The page's own thread alone before [`enlist`].
pub fn threads() -> Threads {
    TEAM.get().cloned().unwrap_or_default()
}

/// Makes room for `count` threads, the page's own among them, and answers how many there may be. Once, before models
/// are read and workers serve.
#[wasm_bindgen]
pub fn enlist(count: usize) -> usize {
    let threads = TEAM.get_or_init(|| Threads::awaited(count));
    std::panic::set_hook(Box::new(|panic| {
        console_error_panic_hook::hook(panic);
        threads.fail();
    }));
    threads.count()
}

/// Works as thread `index`, from 1. Never returns: only in a worker.
#[wasm_bindgen]
pub fn serve(index: usize) {
    threads().serve(index);
}

/// How often a worker has joined the page's thread in an operation.
#[wasm_bindgen]
pub fn joined() -> usize {
    threads().joined()
}
