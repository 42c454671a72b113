//! naga (and tint, where installed) accept every shader; it matches the table and keeps to WebGPU's default limits.

use super::{ALL, Access, Field, LANES, MAX_FEATURES, Shader};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, ArraySize, Module, ScalarKind, StorageAccess, TypeInner};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;
use std::process::Command;

fn parse(shader: &Shader) -> Module {
    let source = shader.source();
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}: {}", shader.name, error.emit_to_string(&source)));
    // No capability beyond WebGPU's core.
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    if let Err(error) = validator.validate(&module) {
        panic!("{}: {}", shader.name, error.emit_to_string(&source));
    }
    module
}

#[test]
fn each_has_one_entry_point_of_its_name_within_the_limits() {
    for shader in ALL {
        let module = parse(shader);
        let [entry] = module.entry_points.as_slice() else { panic!("{}: more than one entry point", shader.name) };
        assert_eq!(entry.name, shader.entry());
        assert!(entry.workgroup_size.iter().product::<u32>() <= 256, "{}: invocations", shader.name);
        assert!(shader.bindings.len() <= 8, "{}: storage buffers", shader.name);
        let workgroup = module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup);
        let size = |inner: &TypeInner| match inner {
            TypeInner::Array { size: ArraySize::Pending(_), stride, .. } => stride * MAX_FEATURES as u32,
            inner => inner.size(module.to_ctx()),
        };
        let bytes: u32 = workgroup.map(|(_, v)| size(&module.types[v.ty].inner)).sum();
        assert!(bytes <= 16 << 10, "{}: {bytes} bytes of workgroup memory", shader.name);
    }
}

#[test]
fn bindings_are_those_of_the_table() {
    for shader in ALL {
        let module = parse(shader);
        let mut found = Vec::new();
        for (_, variable) in module.global_variables.iter() {
            let Some(binding) = variable.binding else { continue };
            assert_eq!(binding.group, 0, "{}", shader.name);
            found.push((binding.binding, variable.space));
        }
        found.sort_by_key(|(binding, _)| *binding);
        let access = |access: &Access| match access {
            Access::Read => StorageAccess::LOAD,
            Access::Write => StorageAccess::LOAD | StorageAccess::STORE,
        };
        let storage = shader.bindings.iter().map(|kind| AddressSpace::Storage { access: access(kind) });
        let wanted: Vec<_> = (0..).zip(std::iter::once(AddressSpace::Uniform).chain(storage)).collect();
        assert_eq!(found, wanted, "{}", shader.name);
    }
}

#[test]
fn params_are_those_of_rust() {
    for shader in ALL {
        let module = parse(shader);
        let params = module.types.iter().find(|(_, t)| t.name.as_deref() == Some("Params"));
        let (_, params) = params.unwrap_or_else(|| panic!("{}: no Params", shader.name));
        let TypeInner::Struct { members, .. } = &params.inner else { panic!("{}: Params is no struct", shader.name) };
        let kind = |inner: &TypeInner| match inner {
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Uint => "u32",
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => "f32",
            TypeInner::Vector { size: naga::VectorSize::Tri, scalar } if scalar.kind == ScalarKind::Float => "[f32; 3]",
            other => panic!("{}: {other:?}", shader.name),
        };
        let found: Vec<_> = members
            .iter()
            .map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize, kind(&module.types[m.ty].inner)))
            .collect();
        let wanted: Vec<_> =
            shader.params.iter().map(|Field { name, offset, kind }| ((*name).to_owned(), *offset, *kind)).collect();
        assert_eq!(found, wanted, "{}", shader.name);
    }
}

/// Value of a WGSL constant.
fn constant(module: &Module, name: &str) -> u32 {
    let found = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name));
    let (_, constant) = found.unwrap_or_else(|| panic!("no constant {name}"));
    match module.global_expressions[constant.init] {
        naga::Expression::Literal(naga::Literal::U32(value)) => value,
        ref other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn constants_are_those_of_rust() {
    let attend = parse(&super::ATTEND);
    let (_, room) = attend.overrides.iter().next().expect("an override");
    assert_eq!(room.name.as_deref(), Some(super::ROOM));
    let found = &attend.global_expressions[room.init.expect("a default")];
    assert!(matches!(found, naga::Expression::Literal(naga::Literal::U32(size)) if *size as usize == MAX_FEATURES));
    assert_eq!(constant(&attend, "SIZE") as usize, LANES);
    let linear = parse(&super::LINEAR);
    let [x, y, _] = linear.entry_points[0].workgroup_size;
    assert_eq!([x, y * constant(&linear, "ROWS")], super::LINEAR.tile);
    assert_eq!(constant(&parse(&super::LINEAR_ROW), "COLUMNS"), super::LINEAR_ROW.tile[0]);
}

#[test]
fn files_are_those_of_the_table_and_short() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let entries = std::fs::read_dir(folder).expect("the folder of shaders");
    let paths = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "wgsl"));
    let texts: BTreeSet<String> = paths.map(|path| std::fs::read_to_string(path).expect("a text")).collect();
    let used: BTreeSet<String> = ALL.iter().flat_map(|shader| shader.sources).map(|text| (*text).to_owned()).collect();
    assert_eq!(texts, used, "each file is used");
    texts.iter().for_each(|text| assert!(text.lines().count() <= 120, "longer than 120 lines: {text}"));
}

/// Naga alone misses barriers in control flow that is not uniform.
#[test]
#[cfg_attr(not(tint), ignore = "tint is not installed")]
fn tint_accepts_each() {
    let accepts = |source: &str| {
        let mut file = tempfile::Builder::new().suffix(".wgsl").tempfile().expect("a file");
        file.write_all(source.as_bytes()).expect("the text is written");
        let said = Command::new("tint").args(["--format", "wgsl"]).arg(file.path()).output().expect("tint runs");
        if said.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&said.stderr).into_owned()) }
    };
    for shader in ALL {
        accepts(&shader.source()).unwrap_or_else(|said| panic!("{}: {said}", shader.name));
    }
    let text = super::ATTEND.source();
    let broken = text.replacen("    gate(i, t, 0u);", "    if (t == 0u) {\n        gate(i, t, 0u);\n    }", 1);
    assert_ne!(broken, text);
    assert!(accepts(&broken).is_err(), "a barrier that not every invocation reaches is refused");
}
