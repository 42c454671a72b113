//! Seconds of computing and the machine's level, a line per pose, in `timing/INDEX-of-COUNT.csv`. The files of the
//! poses do not hold them: those are the same bytes on every machine of a level. Each shard has a file of its own, so
//! that folders of shards can be copied together.

use super::Shard;
use super::level::level;
use crate::dataset::Record;
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Measures this thread's processor time where the system tells it (Linux), else elapsed time, which on a shared
/// machine says little about a pose.
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

    /// Adds clip, frame, seconds and level of one pose.
    pub fn add(&self, record: &Record, taken: Duration) -> Result<()> {
        let line = format!("{},{},{:.3},{}\n", record.clip, record.frame, taken.as_secs_f64(), level());
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(line.as_bytes()).map_err(|source| Error::Io { path: self.path.clone(), source })
    }
}

/// What the runs of a dataset logged.
#[derive(Debug, Default, PartialEq)]
pub struct Log {
    /// Seconds per pose, in no order.
    pub seconds: Vec<f64>,
    /// Poses by the [`level`] of the machine; an older version noted none.
    pub levels: BTreeMap<String, usize>,
}

impl Log {
    /// Reads the logs of dataset `folder`; empty where there are none.
    pub fn read(folder: &Path) -> Result<Self> {
        let logs = folder_of(folder);
        let io = |source| Error::Io { path: logs.clone(), source };
        let mut log = Self::default();
        if logs.exists() {
            for entry in std::fs::read_dir(&logs).map_err(io)? {
                std::fs::read_to_string(entry.map_err(io)?.path()).map_err(io)?.lines().for_each(|line| log.add(line));
            }
        }
        Ok(log)
    }

    /// Adds what a line says; one cut short by a crash may say less.
    fn add(&mut self, line: &str) {
        let mut cells = line.split(',').skip(2);
        self.seconds.extend(cells.next().and_then(|seconds| seconds.parse::<f64>().ok()));
        if let Some(level) = cells.next() {
            *self.levels.entry(level.to_owned()).or_default() += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_says_how_long_poses_took_and_on_what() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Log::read(folder.path()).unwrap(), Log::default());
        let timing = Timing::open(folder.path(), Shard::WHOLE).unwrap();
        for _ in 0..2 {
            timing.add(&Record::default(), Duration::from_millis(1500)).unwrap();
        }
        // An older version's, another machine's, and one cut short.
        std::fs::write(folder_of(folder.path()).join("1-of-2.csv"), "0,1,2.000\n0,3,0.500,other\n0,5,").unwrap();
        let Log { mut seconds, levels } = Log::read(folder.path()).unwrap();
        seconds.sort_by(f64::total_cmp);
        assert_eq!(seconds, [0.5, 1.5, 1.5, 2.0]);
        assert_eq!(levels, BTreeMap::from([(level(), 2), ("other".to_owned(), 1)]));
    }
}
