//! The files of the repository, for tests of its rules.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A text file of the repository.
pub struct Source {
    /// Path from the root, with forward slashes.
    pub path: String,
    /// What is in it.
    pub text: String,
}

/// The repository's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What a program says, run in the root.
pub fn say(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(root()).output();
    let output = output.unwrap_or_else(|error| panic!("{program}: {error}"));
    assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Path of every file that git keeps or would keep.
pub fn names() -> Vec<String> {
    let list = say("git", &["ls-files", "--cached", "--others", "--exclude-standard"]);
    list.lines().filter(|path| root().join(path).exists()).map(str::to_owned).collect()
}

/// Every text file among them.
pub fn tree() -> Vec<Source> {
    let read = |path: String| {
        let text = std::fs::read(root().join(&path)).ok().and_then(|bytes| String::from_utf8(bytes).ok())?;
        Some(Source { path, text })
    };
    let tree: Vec<Source> = names().into_iter().filter_map(read).collect();
    assert!(tree.iter().any(|source| source.path == "crate/core/src/lib.rs"), "git found no sources");
    tree
}

impl Source {
    /// Rust.
    pub fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// TypeScript.
    pub fn is_typescript(&self) -> bool {
        self.path.ends_with(".ts")
    }

    /// Shipped code: of the crates, the package and the site, without their tests.
    pub fn is_product(&self) -> bool {
        let folders = ["crate/", "web/src/", "www/src/"];
        let test = ["/tests/", "/tests.rs", "/test.rs"].iter().any(|part| self.path.contains(part));
        (self.is_rust() || self.is_typescript()) && folders.iter().any(|folder| self.path.starts_with(folder)) && !test
    }

    /// Asserts that none of `words` is in the text.
    pub fn lacks(&self, words: &[&str], why: &str) {
        for word in words {
            if let Some(line) = self.text.lines().position(|line| line.contains(word)) {
                panic!("{}:{}: {word} — {why}", self.path, line + 1);
            }
        }
    }
}
