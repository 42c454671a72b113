//! Rows of an operation shared out over threads: in parts, which each thread takes as it finds time, with scratch of
//! its own. A row is computed by the same instructions whatever part it is in, so the numbers do not depend on how many
//! threads there are.

#[cfg(feature = "threads")]
use super::pool::Pool;
use std::ops::Range;
#[cfg(feature = "threads")]
use std::sync::atomic::{AtomicUsize, Ordering};
#[cfg(feature = "threads")]
use std::sync::{Arc, Mutex};

/// Rows that are worth a part; also more than any tile of `linear`, which takes fewer rows one by one.
#[cfg(feature = "threads")]
const FEWEST: usize = 64;

/// Parts for each thread: one that other programs hold up leaves its parts to the others.
#[cfg(feature = "threads")]
const PARTS: usize = 4;

/// The threads that operations are shared out over: by default the caller's alone.
#[derive(Clone, Default)]
pub struct Threads {
    #[cfg(feature = "threads")]
    pool: Option<Arc<Owned>>,
}

/// A pool whose threads end with it.
#[cfg(feature = "threads")]
struct Owned(Arc<Pool>);

#[cfg(feature = "threads")]
impl Drop for Owned {
    fn drop(&mut self) {
        self.0.close();
    }
}

#[cfg(feature = "threads")]
impl Threads {
    /// Most of them.
    pub const MOST: usize = 32;

    /// `count` threads, [`Self::MOST`] at most, the caller's among them. The others wait for work as long as this or a
    /// clone of it lives.
    ///
    /// # Errors
    /// The system gives no more threads.
    pub fn new(count: usize) -> std::io::Result<Self> {
        let threads = Self::awaited(count);
        threads.pool.iter().try_for_each(|pool| pool.0.spawn())?;
        Ok(threads)
    }

    /// The same where threads are begun by others, as in a browser. Until they serve, the caller works alone.
    pub fn awaited(count: usize) -> Self {
        let count = count.min(Self::MOST);
        Self { pool: (count > 1).then(|| Arc::new(Owned(Arc::new(Pool::new(count - 1))))) }
    }

    /// Has the thread that calls this be the one of that `index`, from 1, until the last clone is gone.
    pub fn serve(&self, index: usize) {
        let pool = self.pool.as_ref().map(|owned| owned.0.clone());
        pool.iter().for_each(|pool| pool.serve(index));
    }

    /// How often one of the others has joined the caller in an operation.
    pub fn joined(&self) -> usize {
        self.pool.as_ref().map_or(0, |owned| owned.0.joined())
    }

    /// Says that one of them has panicked where nothing unwinds, so that the caller does not wait for it.
    pub fn fail(&self) {
        self.pool.iter().for_each(|owned| owned.0.fail());
    }
}

impl Threads {
    /// How many compute.
    pub fn count(&self) -> usize {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool {
            return pool.0.count();
        }
        1
    }

    /// Calls `work(rows, outputs of these rows, scratch)` for all `rows`, a part of them at a time. An output has the
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
        if let Some(pool) = &self.pool
            && rows >= 2 * FEWEST
        {
            return share_out(&pool.0, rows, outputs, scratch, &work);
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

/// Rows and their outputs, until a thread takes them.
#[cfg(feature = "threads")]
type Part<'a, const N: usize> = Mutex<Option<(Range<usize>, [&'a mut [f32]; N])>>;

/// No lock is ever waited for: a part is one thread's, and so is a room.
#[cfg(feature = "threads")]
fn share_out<const N: usize, S: Send>(
    pool: &Pool,
    rows: usize,
    mut outputs: [&mut [f32]; N],
    scratch: &mut [S],
    work: &(impl Fn(Range<usize>, [&mut [f32]; N], &mut S) + Sync),
) {
    let count = (PARTS * pool.count()).min(rows / FEWEST);
    let widths = std::array::from_fn::<_, N, _>(|output| outputs[output].len() / rows);
    let parts: [Part<N>; PARTS * Threads::MOST] = std::array::from_fn(|part| {
        let rows = rows * part / count..rows * (part + 1) / count;
        Mutex::new((part < count).then(|| {
            let mut output = outputs.iter_mut().zip(widths);
            let outputs = std::array::from_fn(|_| {
                let (output, width) = output.next().expect("as many outputs");
                output.split_off_mut(..rows.len() * width).expect("as many rows")
            });
            (rows, outputs)
        }))
    });
    let mut scratch = scratch.iter_mut();
    let rooms: [_; Threads::MOST] = std::array::from_fn(|_| Mutex::new(scratch.next()));
    let next = AtomicUsize::new(0);
    pool.run(&|thread| {
        let mut room = rooms[thread].lock().expect("its own");
        let scratch = room.as_mut().expect("one for each thread");
        while let Some(part) = parts.get(next.fetch_add(1, Ordering::Relaxed)) {
            let Some((rows, outputs)) = part.lock().expect("its own").take() else { break };
            work(rows, outputs, scratch);
        }
    });
}
