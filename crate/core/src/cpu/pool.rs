//! Threads that call one function together, for as long as one call lasts: the only unsafe code of this crate.
//! The caller never waits for a thread to begin, and may not: in a browser it is the page's own thread, which must not
//! block. It does the work itself and waits, turning, only for those who have begun.
#![allow(unsafe_code)]

use std::cell::UnsafeCell;
use std::hint::spin_loop;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{Builder, Thread, current, panicking, park, yield_now};

/// Set in `guests` while the task may be begun.
const OPEN: usize = 1 << (usize::BITS - 1);

/// How often a thread looks for the next task before it sleeps: longer than what lies between two tasks of one
/// prediction, because waking takes as long as a task.
const LOOKS: usize = 20_000;

/// Waits a moment. The system has other threads run now and then, where there is one: a thread of the pool may have no
/// core. Always false.
fn turn(look: usize) -> bool {
    if look % 64 == 63 {
        yield_now()
    } else {
        spin_loop()
    }
    false
}

type Task<'a> = dyn Fn(usize) + Sync + 'a;

/// A caller and further threads, which are numbered from 1.
pub struct Pool {
    /// The further threads that have come.
    threads: Box<[OnceLock<Thread>]>,
    /// What they are to call: whole while `guests` is not 0.
    task: UnsafeCell<&'static Task<'static>>,
    /// Tasks so far.
    round: AtomicUsize,
    /// Threads in the task, and `OPEN`.
    guests: AtomicUsize,
    /// How often a thread has begun a task.
    joined: AtomicUsize,
    /// A caller has the threads; another one works alone.
    taken: AtomicBool,
    /// A thread has panicked.
    failed: AtomicBool,
    closed: AtomicBool,
}

// SAFETY: `task` is written by the one caller that has `taken` the pool, while `guests` is 0. It is read only by
// threads that have counted themselves in `guests` while it was OPEN, that is after the writing (release, acquire), and
// the caller writes again, or lets the task die, only after it has closed it and seen them all leave (release,
// acquire).
unsafe impl Sync for Pool {}
// SAFETY: what `task` refers to is `Sync`, and nothing in here belongs to a thread.
unsafe impl Send for Pool {}

impl Pool {
    /// Room for so many threads beside the caller. They come by [`Self::serve`].
    pub fn new(threads: usize) -> Self {
        Self {
            threads: (0..threads).map(|_| OnceLock::new()).collect(),
            task: UnsafeCell::new(&|_| ()),
            round: AtomicUsize::new(0),
            guests: AtomicUsize::new(0),
            joined: AtomicUsize::new(0),
            taken: AtomicBool::new(false),
            failed: AtomicBool::new(false),
            closed: AtomicBool::new(false),
        }
    }

    /// The caller and the threads that there is room for.
    pub fn count(&self) -> usize {
        self.threads.len() + 1
    }

    /// How often one of the further threads has begun a task.
    pub fn joined(&self) -> usize {
        self.joined.load(Ordering::Relaxed)
    }

    /// Calls `task(0)` here and `task(i)` on those of the threads `i` that come before it has returned; returns when
    /// all calls have. So `task` must share its work out as long as there is some. A thread may call it more than once.
    pub fn run(&self, task: &Task) {
        if self.taken.swap(true, Ordering::Acquire) {
            return task(0);
        }
        // SAFETY: only the lifetime changes, and `Round` does not let this frame end, by a panic neither, before every
        // thread has left the task. For the writing see `Sync`.
        unsafe { *self.task.get() = std::mem::transmute::<&Task, &'static Task<'static>>(task) };
        let round = Round(self);
        self.guests.store(OPEN, Ordering::Release);
        self.round.fetch_add(1, Ordering::Release);
        self.threads.iter().filter_map(OnceLock::get).for_each(Thread::unpark);
        task(0);
        drop(round);
    }

    /// Begins the threads that there is room for.
    ///
    /// # Errors
    /// The system gives no more threads.
    pub fn spawn(self: &Arc<Self>) -> io::Result<()> {
        for index in 1..self.count() {
            let pool = self.clone();
            Builder::new().spawn(move || pool.serve(index))?;
        }
        Ok(())
    }

    /// Works as thread `index`, from 1, until [`Self::close`].
    ///
    /// # Panics
    /// There is no room for `index`, or it has come before.
    pub fn serve(&self, index: usize) {
        self.threads[index - 1].set(current()).expect("a thread of each index");
        let mut seen = 0;
        while !self.closed.load(Ordering::Acquire) {
            let news = || self.round.load(Ordering::Acquire) != seen || self.closed.load(Ordering::Acquire);
            if !(0..LOOKS).any(|look| news() || turn(look)) {
                park();
                continue;
            }
            seen = self.round.load(Ordering::Acquire);
            let enter = |guests: usize| (guests & OPEN != 0).then_some(guests + 1);
            if self.guests.fetch_update(Ordering::AcqRel, Ordering::Acquire, enter).is_ok() {
                let _guest = Guest(self);
                self.joined.fetch_add(1, Ordering::Relaxed);
                // SAFETY: counted in `guests` while it was open. See `Sync`.
                let task = unsafe { *self.task.get() };
                task(index);
            }
        }
    }

    /// Says that a thread has panicked where nothing unwinds: the caller panics too, instead of waiting for ever.
    pub fn fail(&self) {
        self.failed.store(true, Ordering::Release);
    }

    /// Sends the threads home.
    pub fn close(&self) {
        self.closed.store(true, Ordering::Release);
        self.threads.iter().filter_map(OnceLock::get).for_each(Thread::unpark);
    }
}

/// A task that is open. Its end waits for those who are in it.
struct Round<'a>(&'a Pool);

impl Drop for Round<'_> {
    fn drop(&mut self) {
        let Self(pool) = self;
        pool.guests.fetch_and(!OPEN, Ordering::AcqRel);
        let failed = || pool.failed.load(Ordering::Acquire);
        // Where nothing unwinds a thread that has panicked never leaves.
        let busy = |_: &usize| pool.guests.load(Ordering::Acquire) != 0 && !(cfg!(panic = "abort") && failed());
        (0..).take_while(busy).for_each(|look| _ = turn(look));
        assert!(panicking() || !failed(), "a thread of the pool has panicked");
        pool.taken.store(false, Ordering::Release);
    }
}

/// A thread within a task.
struct Guest<'a>(&'a Pool);

impl Drop for Guest<'_> {
    fn drop(&mut self) {
        if panicking() {
            self.0.fail();
        }
        self.0.guests.fetch_sub(1, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicU32;

    fn pool(threads: usize) -> Arc<Pool> {
        let pool = Arc::new(Pool::new(threads));
        pool.spawn().expect("threads");
        pool
    }

    #[test]
    fn every_part_of_every_task_is_done_once_before_its_caller_goes_on() {
        let pool = pool(3);
        for round in 0..20_000 {
            let parts: [AtomicU32; 8] = Default::default();
            let next = AtomicUsize::new(0);
            pool.run(&|_| {
                while let Some(part) = parts.get(next.fetch_add(1, Ordering::Relaxed)) {
                    part.fetch_add(round + 1, Ordering::Relaxed);
                }
            });
            assert!(parts.iter().all(|part| part.load(Ordering::Relaxed) == round + 1), "task {round}");
        }
        pool.close();
    }

    #[test]
    fn all_threads_work() {
        let (pool, came) = (pool(2), AtomicU32::new(0));
        // Each waits for the others.
        pool.run(&|thread| {
            came.fetch_or(1 << thread, Ordering::Relaxed);
            while came.load(Ordering::Relaxed) != 0b111 {
                std::thread::yield_now();
            }
        });
        pool.close();
    }

    #[test]
    fn a_task_within_a_task_is_done_by_its_caller() {
        let (pool, inner) = (pool(1), AtomicU32::new(0));
        let count = |thread| {
            assert_eq!(thread, 0);
            inner.fetch_add(1, Ordering::Relaxed);
        };
        pool.run(&|_| pool.run(&count));
        assert!(inner.load(Ordering::Relaxed) > 0);
        pool.close();
    }

    #[test]
    #[should_panic(expected = "a thread of the pool has panicked")]
    fn a_panic_reaches_the_caller() {
        let (pool, gone) = (pool(1), AtomicBool::new(false));
        pool.run(&|thread| {
            if thread == 1 {
                gone.store(true, Ordering::Relaxed);
                panic!("as it should");
            }
            while !gone.load(Ordering::Relaxed) {
                spin_loop();
            }
        });
    }
}
