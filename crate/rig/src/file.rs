//! Files as every stage reads and writes them: whole.

use crate::{Error, Result};
use ctsn_core::file::Tensors;
use flate2::read::MultiGzDecoder;
use std::io::{Read, Write};
use std::num::NonZeroU64;
use std::path::Path;
use zopfli::{Format, Options};

/// What a file begins with that gzip has packed.
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// How often what packs a file tries again: fifteen times, its default, are twice the time for a 2,000th of the bytes.
const ROUNDS: NonZeroU64 = NonZeroU64::new(5).expect("five");
/// Into how many blocks a file is cut at most, each with a code of its own: a model's every tensor, and every matrix
/// of its bases, has other numbers. Fifteen, the default, make a model 3 to 5 % larger; twice as many save a 150th at
/// most.
const BLOCKS: u16 = 200;

/// Reads a whole file, unpacked if it was packed by gzip.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let io = |source| Error::Io { path: path.to_owned(), source };
    let bytes = std::fs::read(path).map_err(io)?;
    if !bytes.starts_with(&GZIP) {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut plain).map_err(io)?;
    Ok(plain)
}

/// Packs bytes by gzip, as small as it can.
pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let options = Options { iteration_count: ROUNDS, maximum_block_splits: BLOCKS, ..Options::default() };
    let mut packed = Vec::new();
    // A vector takes all that it is given.
    zopfli::compress(options, Format::Gzip, bytes, &mut packed).map_or_else(|_| Vec::new(), |()| packed)
}

/// Reads a safetensors file, naming the file in errors.
pub fn tensors(path: &Path) -> Result<Tensors<'static>> {
    let bytes = read(path)?;
    let parsed = Tensors::parse(&bytes).map(Tensors::into_owned);
    parsed.map_err(|error| Error::File { path: path.to_owned(), reason: error.to_string() })
}

/// Writes a whole file or nothing, and the folder it stands in: first beside it, under a name of its own, then moved
/// into place.
///
/// The name is drawn, not made of the process's number: containers that share a folder may all be number 1.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let io = |source| Error::Io { path: path.to_owned(), source };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(io)?;
    let mut partial = tempfile::Builder::new();
    partial.prefix(".partial-");
    // As any other file, not for its owner alone: less what the umask takes.
    #[cfg(unix)]
    partial.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = partial.tempfile_in(folder).map_err(io)?;
    file.write_all(bytes).map_err(io)?;
    file.persist(path).map(drop).map_err(|error| io(error.error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writers_of_one_process_number_do_not_tear_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/report.json");
        let texts: Vec<Vec<u8>> = (0..4).map(|writer| vec![b'a' + writer; 100_000 + usize::from(writer)]).collect();
        let repeat = |text: &Vec<u8>| (0..50).filter_map(|_| write(&path, text).err()).collect::<Vec<_>>();
        let failed: Vec<Error> = std::thread::scope(|scope| {
            let writers: Vec<_> = texts.iter().map(|text| scope.spawn(|| repeat(text))).collect();
            writers.into_iter().flat_map(|writer| writer.join().unwrap()).collect()
        });
        assert!(failed.is_empty(), "{failed:?}");
        assert!(texts.contains(&read(&path).unwrap()), "the parts of several writers");
        assert_eq!(std::fs::read_dir(folder.path().join("new")).unwrap().count(), 1, "something is left beside it");
    }

    #[test]
    fn what_stood_there_is_replaced_and_a_folder_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write(&path, b"older and longer").unwrap();
        write(&path, b"newer").unwrap();
        assert_eq!(read(&path).unwrap(), b"newer");
        let refused = write(folder.path(), b"bytes").unwrap_err().to_string();
        assert!(refused.contains(&folder.path().display().to_string()), "{refused}");
        let missing = tensors(&folder.path().join("none")).unwrap_err().to_string();
        assert!(missing.contains("none"), "{missing}");
    }

    #[test]
    #[cfg(unix)]
    fn whoever_may_read_other_files_may_read_this_one() {
        let mode =
            |path: &Path| std::os::unix::fs::PermissionsExt::mode(&std::fs::metadata(path).unwrap().permissions());
        let folder = tempfile::tempdir().unwrap();
        let [ours, plain] = ["ours", "plain"].map(|name| folder.path().join(name));
        write(&ours, b"").unwrap();
        std::fs::write(&plain, b"").unwrap();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
