//! What a source or a page names is there: documents, their headings, paths. And what is meant to be read is short
//! enough for it.
#![cfg(feature = "machine")]

use ctsn_tests::tree::{Source, names, root, tree};

/// Endings of what is written by hand; other files may be made by what is told.
const WRITTEN: [&str; 8] = [".rs", ".wgsl", ".ts", ".mjs", ".py", ".md", ".toml", ".svg"];
/// Longest line of a comment, columns.
const COLUMNS: usize = 120;

/// Sources and pages, with whatever they name.
fn readable() -> Vec<Source> {
    let ends = |source: &Source| WRITTEN[..6].iter().any(|end| source.path.ends_with(end));
    let found: Vec<Source> = tree().into_iter().filter(ends).collect();
    assert!(found.iter().any(|source| source.path == "docs/network.md"), "git found no pages");
    found
}

/// `path` from the folder of `page`, without dots.
fn beside(page: &str, path: &str) -> String {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in path.split('/').filter(|part| !["", "."].contains(part)) {
        if part == ".." {
            parts.pop();
        } else {
            parts.push(part);
        }
    }
    parts.join("/")
}

/// The lines of a page outside of its listings.
fn prose(page: &Source) -> impl Iterator<Item = &str> {
    let mut listing = false;
    page.text.lines().filter(move |line| {
        let fence = line.starts_with("```");
        listing ^= fence;
        !listing && !fence
    })
}

/// Titles of a page's headings.
fn headings(page: &Source) -> Vec<&str> {
    prose(page).filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim()).collect()
}

/// The anchor that a heading gets.
fn anchor(title: &str) -> String {
    let kept = title.chars().filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
    kept.map(|letter| if letter == ' ' { '-' } else { letter.to_ascii_lowercase() }).collect()
}

/// Every section that a text cites, a page's name followed by `§2` or by `§2, §3`: the page's name, and the section.
fn citations(text: &str) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    for (end, _) in text.match_indices(".md") {
        let letter = |letter: char| letter.is_ascii_alphanumeric() || "_-./".contains(letter);
        let name = &text[text[..end].rfind(|each| !letter(each)).map_or(0, |at| at + 1)..end + 3];
        let mut rest = text[end + 3..].trim_start_matches(['`', ']']);
        while let Some(number) = [" §", ", §"].iter().find_map(|mark| rest.strip_prefix(*mark)) {
            let length = number.find(|letter: char| !letter.is_ascii_digit() && letter != '.').unwrap_or(number.len());
            found.push((name, number[..length].trim_end_matches('.')));
            rest = &number[length..];
        }
    }
    found
}

#[test]
fn every_section_cited_exists() {
    let sources = readable();
    let page = |from: &str, name: &str| {
        let places = [beside(from, name), name.to_owned(), format!("docs/{name}")];
        places.iter().find_map(|place| sources.iter().find(|source| source.path == *place))
    };
    let (mut count, mut lost) = (0, Vec::new());
    for source in &sources {
        for (name, section) in citations(&source.text) {
            count += 1;
            let titles = page(&source.path, name).map(headings).unwrap_or_default();
            let number = |title: &&str| title.split(' ').next().map(|word| word.trim_end_matches('.')) == Some(section);
            if !titles.iter().any(number) {
                lost.push(format!("{}: {name} §{section}", source.path));
            }
        }
    }
    assert!(count > 50, "only {count} citations found");
    assert!(lost.is_empty(), "sections that are not there: {lost:#?}");
    let cited = citations("`docs/simulation.md` §2, §3.1–3.");
    assert_eq!(cited, [("docs/simulation.md", "2"), ("docs/simulation.md", "3.1")]);
}

#[test]
fn every_link_leads_somewhere() {
    let (sources, files) = (readable(), names());
    let (mut count, mut lost) = (0, Vec::new());
    for page in sources.iter().filter(|source| source.path.ends_with(".md")) {
        let text: String = prose(page).flat_map(|line| [line, "\n"]).collect();
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for target in targets.filter(|target| !target.contains(':')) {
            count += 1;
            let (path, wanted) = target.split_once('#').unwrap_or((target, ""));
            let path = if path.is_empty() { page.path.clone() } else { beside(&page.path, path) };
            let there = files.iter().any(|file| *file == path || file.starts_with(&format!("{path}/")));
            let titles = sources.iter().find(|source| source.path == path).map(headings).unwrap_or_default();
            if !there || !wanted.is_empty() && !titles.iter().any(|title| anchor(title) == wanted) {
                lost.push(format!("{}: {target}", page.path));
            }
        }
    }
    assert!(count > 20, "only {count} links found");
    assert!(lost.is_empty(), "links that lead nowhere: {lost:#?}");
}

#[test]
fn every_path_named_exists() {
    let files = names();
    let ignored = std::fs::read_to_string(root().join(".gitignore")).expect(".gitignore");
    let made: Vec<&str> = ignored.lines().filter_map(|line| line.strip_prefix('/')?.strip_suffix('/')).collect();
    let is_top = |part: &str| files.iter().any(|file| file.split_once('/').is_some_and(|(top, _)| top == part));
    let (mut count, mut lost) = (0, Vec::new());
    for source in readable() {
        let letter = |letter: char| letter.is_alphanumeric() || "_-./{}*<>$:…".contains(letter);
        for word in source.text.split(|each| !letter(each)) {
            let word = word.trim_start_matches("../").trim_start_matches("./").trim_end_matches(['.', ':', '/']);
            let written = WRITTEN.iter().any(|end| word.ends_with(end) && !word.starts_with('.'));
            let rooted = word.split_once('/').is_some_and(|(top, _)| is_top(top));
            let pattern =
                word.contains(['{', '*', '<', '$', ':', '…']) || word.contains("NAME") || word.starts_with('/');
            let is_made = made.iter().any(|folder| word == *folder || word.starts_with(&format!("{folder}/")));
            if pattern || is_made || !(written || rooted) {
                continue;
            }
            count += 1;
            // TypeScript is imported by the name that it is compiled to.
            let typed = word.strip_suffix(".js").map(|stem| format!("{stem}.ts"));
            let exact = |file: &str, word: &str| file == word || file.starts_with(&format!("{word}/"));
            let below = |file: &str, word: &str| !rooted && file.ends_with(&format!("/{word}"));
            let there = |word: &str| files.iter().any(|file| exact(file, word) || below(file, word));
            if !there(word) && !typed.as_deref().is_some_and(there) {
                lost.push(format!("{}: {word}", source.path));
            }
        }
    }
    assert!(count > 200, "only {count} paths found");
    assert!(lost.is_empty(), "paths that are not there: {lost:#?}");
}

#[test]
fn comments_are_not_wide() {
    let is_comment = |line: &str| ["//", "/*", "* ", "# "].iter().any(|mark| line.trim_start().starts_with(mark));
    let mut wide = Vec::new();
    for source in readable().iter().filter(|source| !source.path.ends_with(".md")) {
        let lines = source.text.lines().enumerate();
        let lines = lines.filter(|(_, line)| is_comment(line) && line.chars().count() > COLUMNS);
        wide.extend(lines.map(|(number, _)| format!("{}:{}", source.path, number + 1)));
    }
    assert!(wide.is_empty(), "comments wider than {COLUMNS} columns: {wide:#?}");
}

#[test]
fn the_entrance_is_short() {
    for (path, most) in [("README.md", 110), ("ARCHITECTURE.md", 80)] {
        let lines = std::fs::read_to_string(root().join(path)).expect(path).lines().count();
        assert!(lines <= most, "{path}: wanted at most {most} lines, found {lines}");
    }
}
