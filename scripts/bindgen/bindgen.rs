//! `bindgen MODULE FOLDER NAME`: writes what a browser needs of a compiled module into a folder, under a name: the glue
//! in JavaScript, its types, and the module that the glue loads.

use anyhow::bail;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [module, folder, name] = &arguments[..] else {
        bail!("wanted a module, a folder and a name, found {arguments:?}");
    };
    let mut bindgen = Bindgen::new();
    bindgen.web(true)?.typescript(true).omit_default_module_path(true).remove_producers_section(true);
    bindgen.input_path(module).out_name(name).generate(folder)
}
