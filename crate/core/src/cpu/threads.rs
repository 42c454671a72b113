//! Rows of an operation shared out over threads: each thread gets as many, one after the other, and scratch of its own.
//! A row is computed by the same instructions whatever thread has it, so the numbers do not depend on how many there
//! are.

use std::ops::Range;
#[cfg(feature = "threads")]
use std::sync::Arc;

/// Rows that are worth a thread; also more than any tile of `linear`, which takes fewer rows one by one.
#[cfg(feature = "threads")]
const FEWEST: usize = 64;

/// The threads that operations are shared out over: by default the caller's alone.
#[derive(Clone, Default)]
pub struct Threads {
    #[cfg(feature = "threads")]
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl Threads {
    /// `count` threads, which wait for work as long as this or a clone of it lives. The caller waits while they work.
    /// For one thread there is none but the caller's.
    ///
    /// # Errors
    /// The system gives no more threads.
    #[cfg(feature = "threads")]
    pub fn new(count: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = || rayon::ThreadPoolBuilder::new().num_threads(count).build().map(Arc::new);
        Ok(Self { pool: if count > 1 { Some(pool()?) } else { None } })
    }

    /// How many compute.
    pub fn count(&self) -> usize {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool {
            return pool.current_num_threads();
        }
        1
    }

    /// Does `work` on one of the threads. Once there, sharing out costs no change of threads: so a prediction is
    /// entered as a whole. Now and then, every 63 times, this makes rayon allocate a block of its queue.
    #[inline(always)]
    pub fn enter<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool {
            return pool.install(work);
        }
        work()
    }

    /// Calls `work(rows, outputs of these rows, scratch)` for all `rows`, a part of them per thread. An output has the
    /// same number of values for each row. `scratch`: one for each thread.
    #[inline(always)]
    pub(super) fn share<const N: usize, S: Send>(
        &self,
        rows: usize,
        outputs: [&mut [f32]; N],
        scratch: &mut [S],
        work: impl Fn(Range<usize>, [&mut [f32]; N], &mut S) + Sync,
    ) {
        #[cfg(feature = "threads")]
        if self.count() > 1 && rows >= 2 * FEWEST {
            let parts = self.count().min(rows / FEWEST);
            return self.enter(|| fork(0..rows, outputs, &mut scratch[..parts], &work));
        }
        work(0..rows, outputs, &mut scratch[0]);
    }
}

/// The numbers of some `rows` of an operand that has `width` for each. Without threads the rows are all there are: a
/// page need not download the check.
#[inline(always)]
pub(super) fn of<'a, T>(operand: &'a [T], rows: &Range<usize>, width: usize) -> &'a [T] {
    if cfg!(feature = "threads") { &operand[rows.start * width..rows.end * width] } else { operand }
}

/// As many parts as there is scratch. (`scope` and `broadcast` allocate at each call, `join` does not.)
#[cfg(feature = "threads")]
fn fork<const N: usize, S: Send>(
    rows: Range<usize>,
    outputs: [&mut [f32]; N],
    scratch: &mut [S],
    work: &(impl Fn(Range<usize>, [&mut [f32]; N], &mut S) + Sync),
) {
    if let [scratch] = scratch {
        return work(rows, outputs, scratch);
    }
    let (parts, half) = (scratch.len(), scratch.len() / 2);
    let (before, after) = scratch.split_at_mut(half);
    let count = rows.len() * half / parts;
    let middle = rows.start + count;
    let mut rest: [&mut [f32]; N] = std::array::from_fn(|_| &mut [][..]);
    let mut output = outputs.into_iter().zip(&mut rest);
    let first: [&mut [f32]; N] = std::array::from_fn(|_| {
        let (output, rest) = output.next().expect("as many outputs");
        let width = output.len() / rows.len();
        let (first, last) = output.split_at_mut(count * width);
        *rest = last;
        first
    });
    rayon::join(|| fork(rows.start..middle, first, before, work), || fork(middle..rows.end, rest, after, work));
}
