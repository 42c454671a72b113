// The browsers, their drivers and what emulates another processor: where they are, and the flags under which Chromium
// draws WebGL and WebGPU without a screen.
import { existsSync, readFileSync, realpathSync } from 'node:fs';
import path from 'node:path';
import { at, Stop } from './step.mjs';

const names = {
  CHROMIUM: ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable'],
  CHROMEDRIVER: ['chromedriver'],
  FIREFOX: ['firefox-esr', 'firefox'],
  WEBKITDRIVER: ['WebKitWebDriver'],
  XVFB: ['Xvfb'],
  ARM_COMPILER: ['aarch64-linux-gnu-gcc'],
  ARM_EMULATOR: ['qemu-aarch64-static'],
};
/** Debian's packages of all of them. */
const packages =
  'chromium chromium-driver firefox-esr webkit2gtk-driver xvfb gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user-static';
const folders = [...(process.env.PATH ?? '').split(path.delimiter), '/Applications/Google Chrome.app/Contents/MacOS', '/Applications/Chromium.app/Contents/MacOS'];

/** Path of the program: the environment variable of that name, else the first found. A missing one stops the script. */
function find(variable) {
  const set = process.env[variable];
  const candidates = set ? [set] : names[variable].flatMap((name) => folders.map((folder) => path.join(folder, name)));
  const found = candidates.find((file) => existsSync(file));
  if (found) return found;
  throw new Stop(`${names[variable][0]} is missing, and the tests cannot run without it. Install it (Debian: apt-get install ${packages}) or set ${variable} to its path.`);
}

/** Path of Chromium. */
export const chromium = () => find('CHROMIUM');

/** Path of chromedriver. */
export const chromedriver = () => find('CHROMEDRIVER');

/** Path of Firefox. */
export const firefox = () => find('FIREFOX');

/** Path of the driver of WebKitGTK's MiniBrowser. */
export const webkitDriver = () => find('WEBKITDRIVER');

/** Path of the X server without a screen. */
export const xvfb = () => find('XVFB');

/** Path of the compiler that links for ARM. */
export const armCompiler = () => find('ARM_COMPILER');

/** Path of the program that runs what is compiled for ARM. */
export const armEmulator = () => find('ARM_EMULATOR');

/** The command line flags, from the file that wasm-bindgen's test runner reads too. */
export function flags() {
  return JSON.parse(readFileSync(at('tests', 'webdriver.json'), 'utf8'))['goog:chromeOptions'].args;
}

/**
 * Variables that name the browser's Vulkan driver. WebGL and WebGPU share it. It must be Chromium's own SwiftShader:
 * with Mesa's, where installed, there is no WebGL.
 */
export function vulkan() {
  const folders = [path.dirname(realpathSync(chromium())), '/usr/lib/chromium', '/usr/lib64/chromium'];
  const driver = folders.map((folder) => path.join(folder, 'vk_swiftshader_icd.json')).find((file) => existsSync(file));
  return driver ? { VK_ICD_FILENAMES: driver, VK_DRIVER_FILES: driver } : {};
}

/** The environment to start the browser in. */
export const environment = () => ({ ...process.env, ...vulkan() });
