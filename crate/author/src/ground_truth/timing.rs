//! Seconds of computing per pose, a line each in `timing/INDEX-of-COUNT.csv`: apart from the poses, which are to be the same bytes on
//! every machine, and a file per shard, so that folders of shards can be copied together.

use super::Shard;
use crate::dataset::Record;
use crate::{Error, Result};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A clock of this thread's work: of its processor time where the system tells it (Linux), else of the time that passes, which on a
/// shared machine says little about a pose.
pub(super) struct Stopwatch {
    start: Instant,
    busy: Option<Duration>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self { start: Instant::now(), busy: busy() }
    }

    pub fn elapsed(&self) -> Duration {
        let busy = busy().zip(self.busy).and_then(|(now, then)| now.checked_sub(then));
        busy.unwrap_or_else(|| self.start.elapsed())
    }
}

/// Processor time of this thread so far: the first number of its `schedstat`, nanoseconds.
fn busy() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split(' ').next()?.parse().ok().map(Duration::from_nanos)
}

/// The log of one run.
pub(super) struct Timing {
    path: PathBuf,
    file: Mutex<File>,
}

fn folder_of(dataset: &Path) -> PathBuf {
    dataset.join("timing")
}

impl Timing {
    /// Opens the log of a shard, behind what earlier runs wrote.
    pub fn open(dataset: &Path, shard: Shard) -> Result<Self> {
        let path = folder_of(dataset).join(format!("{}-of-{}.csv", shard.index, shard.count));
        let open = || {
            std::fs::create_dir_all(folder_of(dataset))?;
            OpenOptions::new().create(true).append(true).open(&path)
        };
        let file = Mutex::new(open().map_err(|source| Error::Io { path: path.clone(), source })?);
        Ok(Self { path, file })
    }

    /// Adds clip, frame and seconds of one pose.
    pub fn add(&self, record: &Record, taken: Duration) -> Result<()> {
        let line = format!("{},{},{:.3}\n", record.clip, record.frame, taken.as_secs_f64());
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(line.as_bytes()).map_err(|source| Error::Io { path: self.path.clone(), source })
    }
}

/// Seconds per pose that the runs of dataset `folder` logged, in no order; empty when there is no log.
pub fn seconds(folder: &Path) -> Result<Vec<f64>> {
    let logs = folder_of(folder);
    let io = |source| Error::Io { path: logs.clone(), source };
    let mut seconds = Vec::new();
    if logs.exists() {
        for entry in std::fs::read_dir(&logs).map_err(io)? {
            let text = std::fs::read_to_string(entry.map_err(io)?.path()).map_err(io)?;
            // A line cut short by a crash is left out.
            seconds.extend(text.lines().filter_map(|line| line.split(',').nth(2)?.parse::<f64>().ok()));
        }
    }
    Ok(seconds)
}
