/**
 * What importing one of the package's modules, `ctsn/ctsn_bg.wasm`, gives: that depends on the bundler, and `loadModel`
 * takes any of it.
 */
import type { WasmSource } from './dist/module.js';

declare const source: WasmSource;
export default source;
