//! Nothing allocates per frame: after the first prediction the allocator is not called again. Native only; one test, so
//! that no other thread of this binary allocates for its own reasons.
#![cfg(not(target_arch = "wasm32"))]

use ctsn_core::cpu::{Level, Threads};
use ctsn_core::file::Tensors;
use ctsn_core::model::HostModel;
use ctsn_core::{Folds, Predictor, Shares, Streams};
use ctsn_tests::random::column_major;
use ctsn_tests::{golden, layered, sphere};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};

thread_local! {
    /// Calls for memory by this thread.
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

/// Calls for memory by all threads.
static ALL_CALLS: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counted.
struct Counting;

fn count() {
    CALLS.with(|calls| calls.set(calls.get() + 1));
    ALL_CALLS.fetch_add(1, Ordering::Relaxed);
}

// SAFETY: every call goes to the system's allocator unchanged; counting touches a cell that needs no memory.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Calls for memory during `work`.
fn calls(work: impl FnOnce()) -> usize {
    let before = CALLS.get();
    work();
    CALLS.get() - before
}

#[test]
fn prediction_allocates_once() {
    let small = &golden::ALL[1];
    assert_eq!(small.name, "small");
    let file = Tensors::parse(small.expected).expect("golden file");
    let poses = file.tensors["pose.joints"].to_f32().expect("poses");
    for level in [Level::fallback(), Level::baseline(), Level::new()] {
        let mut made = None;
        let mut model = HostModel::parse(small.model).expect("golden model");
        model.body = Some(sphere::body(model.sizes.vertices));
        let model = layered::itself(&model);
        assert!(calls(|| made = Some(Predictor::from_model(model, level))) > 10, "the counter counts");
        let mut predictor = made.expect("a predictor");
        let size = 12 * predictor.sizes().joints;
        let columns: Vec<Vec<f32>> = poses.chunks_exact(size).map(column_major).collect();
        predictor.predict(&columns[0], Streams::Both).expect("a golden pose");
        for streams in [Streams::Both, Streams::Skeleton, Streams::None] {
            let found = calls(|| {
                for (rows, columns) in poses.chunks_exact(size).zip(&columns) {
                    predictor.predict(columns, streams).expect("a golden pose");
                    predictor.predict_row_major(rows, streams).expect("a golden pose");
                }
            });
            assert_eq!(found, 0, "{level:?} {streams:?}: calls for memory in {} frames", 2 * columns.len());
        }
        let mut folds = Folds::new(predictor.sizes().vertices);
        let found = calls(|| {
            for (i, columns) in columns.iter().enumerate() {
                predictor.predict_folds(columns, &mut folds, (i % 2 == 0, 0.5), Shares::ALL).expect("a golden pose");
            }
        });
        assert_eq!(found, 0, "{level:?}: calls for memory in frames of held folds");
    }
    threads_allocate_nothing_but_their_scratch(&poses);
}

/// A thread makes room for itself in the first part of each operation that it takes, and may be late to take one.
fn threads_allocate_nothing_but_their_scratch(poses: &[f32]) {
    let mut model = HostModel::parse(golden::ALL[1].model).expect("golden model");
    model.body = Some(sphere::body(model.sizes.vertices));
    let model = layered::itself(&model);
    let pose = &poses[..12 * model.sizes.joints];
    let mut predictor = Predictor::on_threads(model, Level::new(), Threads::new(3).expect("threads"));
    let mut predict = |frames: usize| {
        (0..frames).for_each(|_| predictor.predict_row_major(pose, Streams::Both).expect("a golden pose"));
    };
    predict(200);
    let before = ALL_CALLS.load(Ordering::Relaxed);
    predict(630);
    let found = ALL_CALLS.load(Ordering::Relaxed) - before;
    assert!(found <= 11, "{found} calls for memory in 630 frames on three threads");
}
