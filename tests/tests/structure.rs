//! The rules of ARCHITECTURE.md that a search of the tree can check. Native only: it reads the sources.
#![cfg(feature = "machine")]

use ctsn_tests::tree::{Source, say, tree};

/// Longest file and longest function, lines.
const FILE: usize = 300;
const FUNCTION: usize = 60;

#[test]
fn the_model_alone_knows_tensor_names() {
    let tree = tree();
    let text: String = tree
        .iter()
        .filter(|source| source.path.starts_with("crate/core/src/model/"))
        .map(|source| source.text.as_str())
        .collect();
    // Quoted words with one dot, as "cloth.rest"; the names of layers are put together from their first part.
    let quoted = text.split('"').filter(|word| {
        let mut parts = word.split('.');
        let name = |part: Option<&str>| {
            part.is_some_and(|part| part.len() > 1 && part.bytes().all(|b| b.is_ascii_lowercase()))
        };
        name(parts.next()) && name(parts.next()) && parts.next().is_none()
    });
    let mut names: Vec<String> = quoted.map(|name| format!("\"{name}\"")).collect();
    names.extend(["embedding", "graph", "vertex"].map(|part| format!("\"{part}.")));
    for known in ["\"cloth.rest\"", "\"skeleton.basis\"", "\"pose.std\"", "\"reference.index\"", "\"draw.uv\""] {
        assert!(names.iter().any(|name| name == known), "{known} is no longer found in model/");
    }
    // A dataset's setup is a file of its own, whose names are its own, though cloth, body and drawing are called alike.
    let shared = ["\"cloth.rest\"", "\"cloth.triangles\"", "\"draw.vertex\"", "\"draw.uv\"", "\"draw.triangles\""];
    let body = ["\"body.rest\"", "\"body.triangles\"", "\"body.weights\""];
    let shared = [&shared[..], &body].concat();
    let elsewhere = |source: &&Source| source.is_product() && !source.path.starts_with("crate/core/src/model/");
    for source in tree.iter().filter(elsewhere) {
        let known: &[&str] = if source.path == "crate/train/src/dataset/setup.rs" { &shared } else { &[] };
        let words: Vec<&str> = names.iter().map(String::as_str).filter(|name| !known.contains(name)).collect();
        source.lacks(&words, "only crate/core/src/model knows tensor names");
    }
}

#[test]
fn one_file_knows_safetensors() {
    let knows = |source: &&Source| source.is_product() && source.text.contains(concat!("data_", "offsets"));
    let tree = tree();
    let found: Vec<&str> = tree.iter().filter(knows).map(|source| source.path.as_str()).collect();
    // A page must know how much of a file is there before it hands it to the core.
    assert_eq!(found, ["crate/core/src/file.rs", "web/src/model-file.ts"]);
}

#[test]
fn every_operation_has_its_twins() {
    let tree = tree();
    let has = |path: &str| tree.iter().any(|source| source.path == path);
    let has_kernel =
        |name: &str| ["network", "repair"].iter().any(|part| has(&format!("crate/core/src/cpu/{part}/{name}.rs")));
    let list = tree.iter().find(|source| source.path == "crate/core/src/operation.rs").expect("operation.rs");
    let (_, list) = list.text.split_once("operations! { $").expect("the list of operations");
    let (list, _) = list.split_once("\n}").expect("its end");
    // `    BodyFrame<R, W> {` -> `body_frame`.
    let snake = |name: &str| -> String {
        let upper =
            |(i, c): (usize, char)| (i > 0 && c.is_uppercase()).then_some('_').into_iter().chain(c.to_lowercase());
        name.chars().enumerate().flat_map(upper).collect()
    };
    let names = list.lines().filter_map(|line| line.strip_prefix("    ")?.strip_suffix("> {")?.split('<').next());
    let operations: Vec<(&str, String)> = names.map(|name| (name, snake(name))).collect();
    for known in ["BodyFrame", "Linear", "Blend", "Skin", "Attend", "Normals", "Settle"] {
        assert!(operations.iter().any(|(name, _)| *name == known), "the list of operations has no {known}");
    }
    let folder = "crate/train/src/training/gradient";
    let gradients = tree.iter().find(|source| source.path == format!("{folder}/mod.rs")).expect("the gradients");
    for (name, file) in &operations {
        assert!(has_kernel(file), "{name} has no file in crate/core/src/cpu");
        assert!(has(&format!("shaders/{file}.wgsl")), "{name} has no shader");
        let runs_backwards = gradients.text.contains(&format!("Operation::{name}("));
        assert_eq!(has(&format!("{folder}/{file}.rs")), runs_backwards, "{name}: a file in {folder}");
        assert!(runs_backwards || !["Linear", "Blend", "Skin", "Attend"].contains(name), "{name} has no gradient");
    }
    // And each shader, NAME.wgsl or NAME.VARIANT.wgsl, has its twin.
    let shaders = tree.iter().filter_map(|source| source.path.strip_prefix("shaders/")?.strip_suffix(".wgsl"));
    for name in shaders.filter_map(|file| file.split('.').next()) {
        assert!(has_kernel(name), "{name}.wgsl has no twin in crate/core/src/cpu");
    }
}

#[test]
fn files_are_short() {
    let tree = tree();
    let code = tree.iter().filter(|source| source.is_rust() || source.is_typescript() || source.path.ends_with(".mjs"));
    let long = code.filter(|source| source.text.lines().count() > FILE);
    // An exception says so in its first line: "Longer than 300 lines: …".
    let bare =
        long.filter(|source| !source.text.lines().next().is_some_and(|line| line.contains("Longer than 300 lines:")));
    let found: Vec<String> = bare.map(|source| format!("{}: {}", source.path, source.text.lines().count())).collect();
    assert!(found.is_empty(), "longer than {FILE} lines, without saying why: {found:#?}");
}

/// Whether a method in TypeScript begins in this line, whose parameters end there, too.
fn is_method(line: &str) -> bool {
    let modifiers = ["static ", "override ", "async ", "private ", "get ", "set "];
    let name = modifiers.iter().fold(line.trim_start(), |rest, modifier| rest.strip_prefix(modifier).unwrap_or(rest));
    let (name, rest) = name.split_once(['(', '<']).unwrap_or_default();
    let named = !name.is_empty() && name.chars().all(|letter| letter.is_alphanumeric() || "#_$".contains(letter));
    let isnt = ["if", "for", "while", "switch", "catch", "match", "return"].contains(&name);
    line.starts_with("  ") && named && !isnt && rest.contains(')') && rest.ends_with(" {") && !rest.ends_with("=> {")
}

/// Name and length of every function, in lines. Counts on the formatter: a body ends where its closing brace stands
/// alone, as far in as the function began.
fn functions(source: &Source) -> Vec<(&str, usize)> {
    let lines: Vec<&str> = source.text.lines().collect();
    let begins = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let at = words.iter().position(|word| ["fn", "function"].contains(word));
        let before = ["pub", "pub(super)", "pub(crate)", "const", "async", "unsafe", "export", "default"];
        at.is_some_and(|at| words[..at].iter().all(|word| before.contains(word)))
            || !source.is_rust() && is_method(line)
    };
    let length = |start: usize| {
        let indent = lines[start].len() - lines[start].trim_start().len();
        let opens = (start..lines.len()).find(|i| lines[*i].ends_with(['{', ';', '}'])).expect("an end");
        if !lines[opens].ends_with('{') {
            return opens + 1 - start;
        }
        let closes = |i: &usize| {
            lines[*i].len() - lines[*i].trim_start().len() == indent && ["}", "},"].contains(&lines[*i].trim())
        };
        (opens + 1..lines.len()).find(closes).expect("a closing brace") + 1 - start
    };
    (0..lines.len()).filter(|i| begins(lines[*i])).map(|i| (lines[i].trim(), length(i))).collect()
}

#[test]
fn functions_are_short() {
    let tree = tree();
    let (mut count, mut long) = (0, Vec::new());
    for source in tree.iter().filter(|source| source.is_rust() || source.is_typescript()) {
        for (name, length) in functions(source) {
            count += 1;
            if length > FUNCTION {
                long.push(format!("{}: {name}: {length}", source.path));
            }
        }
    }
    assert!(count > 500, "only {count} functions found");
    assert!(long.is_empty(), "longer than {FUNCTION} lines: {long:#?}");
    let of = |path: &str, text: &str| -> Vec<usize> {
        let source = Source { path: path.to_owned(), text: text.to_owned() };
        functions(&source).iter().map(|(_, length)| *length).collect()
    };
    assert_eq!(of(".rs", "fn f(\n    a: u8,\n) {\n    if a {\n    }\n}\nfn g();\n"), [6, 1]);
    assert_eq!(of(".ts", "class A {\n  async #f<T>(a: T) {\n    if (a) {\n    }\n  }\n}\n"), [4]);
}

#[test]
fn platforms_keep_to_their_crates() {
    let (bindgen, system) = (["wasm_bindgen", "wasm-bindgen", "js_sys"], ["std::fs", "std::net", "std::env"]);
    let intrinsics = [concat!("std::", "arch"), concat!("core::", "arch"), concat!("_mm", "_"), concat!("_mm", "256_")];
    let (mut wasm, mut core) = (0, 0);
    for source in &tree() {
        if ["crate/wasm/", "crate/wasm-gpu/"].iter().any(|path| source.path.starts_with(path)) {
            wasm += usize::from(source.text.contains(bindgen[0]));
        } else if source.path.starts_with("crate/") {
            source.lacks(&bindgen, "only crate/wasm and crate/wasm-gpu speak to the browser");
        }
        if source.path.starts_with("crate/core/src/") {
            core += 1;
            source.lacks(&system, "the core does no I/O");
            if !source.path.ends_with("cpu/pool.rs") {
                source.lacks(&["std::thread"], "the core has threads in its pool alone");
            }
        }
        if source.is_rust() {
            source.lacks(&intrinsics, "SIMD is written once, over a portable crate");
        }
    }
    assert!(wasm > 0 && core > 10, "{wasm} files of crate/wasm and crate/wasm-gpu, {core} of crate/core");
}

/// `wrap` < `simulate` < `garment` within crate/cloth; tests dress what they simulate.
#[test]
fn the_rooms_of_cloth_know_none_above_them() {
    let rooms = [("wrap/", &["crate::simulate", "crate::garment"][..]), ("simulate/", &["crate::garment"])];
    for (room, above) in rooms {
        let path = format!("crate/cloth/src/{room}");
        let all = tree();
        let own = all.iter().filter(|source| source.path.starts_with(&path) && !source.path.contains("/tests/"));
        assert!(own.clone().count() > 5, "the room {room}");
        own.for_each(|source| source.lacks(above, "garment stands on simulate, and both on wrap"));
    }
}

#[test]
fn one_file_imports_each_glue() {
    let tree = tree();
    // Where a file is imported, at load or, by `import()`, when it is wanted; types alone load nothing.
    let importers = |name: &str| -> Vec<&str> {
        let imports = |line: &str| line.contains("import") && !line.contains("import type") && line.contains(name);
        let files = tree.iter().filter(|source| source.is_typescript() && source.path.starts_with("web/src/"));
        files.filter(|source| source.text.lines().any(imports)).map(|source| source.path.as_str()).collect()
    };
    assert_eq!(importers("/glue/ctsn.js"), ["web/src/raw.ts"]);
    assert_eq!(importers("/glue/inline.js"), ["web/src/raw.ts"]);
    assert_eq!(importers("/glue/ctsn_threads.js"), ["web/src/raw-threads.ts", "web/src/thread.ts"]);
    assert_eq!(importers("/raw-threads.js"), ["web/src/load.ts"]);
    assert_eq!(importers("/glue/ctsn_gpu.js"), ["web/src/raw-gpu.ts"]);
    assert_eq!(importers("/raw-gpu.js"), ["web/src/gpu-side.ts"]);
    assert_eq!(importers("/gpu-side.js"), ["web/src/load.ts"]);
}

#[test]
fn the_modules_hold_no_authoring_and_the_processors_no_gpu() {
    let packages = |module: &str| -> Vec<String> {
        let arguments = ["tree", "--locked", "--package", module, "--edges", "normal", "--prefix", "none"];
        let list = say(env!("CARGO"), &[&arguments[..], &["--target", "wasm32-unknown-unknown"]].concat());
        list.lines().filter_map(|line| Some(line.split(' ').next()?.to_owned())).collect()
    };
    let lacks = |module: &str, wanted: &[&str], unwanted: &[&str]| {
        let packages = packages(module);
        let has = |package: &&&str| packages.iter().any(|found| found == **package);
        assert_eq!(wanted.iter().find(|package| !has(package)), None, "{module} depends on {packages:?}");
        assert_eq!(unwanted.iter().find(has), None, "{module} depends on it");
    };
    let authoring =
        ["ctsn-rig", "ctsn-tests", "gltf", "faer", "clap", "rayon", "image", "serde_json", "naga", "wgpu-core"];
    let gpu = ["ctsn-gpu", "ctsn-shaders", "wgpu"];
    lacks("ctsn-wasm", &["ctsn-core", "wasm-bindgen"], &[&authoring[..], &gpu].concat());
    lacks("ctsn-wasm-gpu", &[&["ctsn-core", "wasm-bindgen"], &gpu[..]].concat(), &authoring);
}

#[test]
fn no_file_names_a_machine() {
    let places = [concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("/Us", "ers/")];
    tree().iter().for_each(|source| source.lacks(&places, "a path of one machine"));
}
