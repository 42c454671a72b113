// Running other programs from the npm scripts: progress lines, and failures that say what to do.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { fileURLToPath } from 'node:url';
import path from 'node:path';

/** The repository's root folder. */
export const root = fileURLToPath(new URL('..', import.meta.url));

/** A path below the repository's root. */
export const at = (...parts) => path.join(root, ...parts);

/** A line on the terminal that says what happens now. */
export function say(text) {
  console.log(`ctsn: ${text}`);
}

/** Ends a script with a message for the person at the terminal, without a stack trace. */
export class Stop extends Error {}

const bins = at('node_modules', '.bin');
/** Signals that end a script from outside, besides the terminal's Ctrl-C, which all that it runs gets, too. */
export const ENDS = ['SIGTERM', 'SIGHUP'];

/**
 * Runs a program to its end and answers { status, output }; `output` is what it wrote when `capture` or `tee` is set.
 * `capture`: keep the output to ourselves; `tee`: keep it and show it.
 */
export async function run(program, args, { capture = false, tee = false, env = {}, cwd = root } = {}) {
  const quiet = capture || tee;
  const child = spawn(program, args, {
    cwd,
    env: { ...process.env, PATH: `${bins}${path.delimiter}${process.env.PATH}`, ...env },
    stdio: quiet ? ['ignore', 'pipe', 'pipe'] : 'inherit',
    shell: process.platform === 'win32',
  });
  let output = '';
  if (quiet) {
    for (const [pipe, screen] of [[child.stdout, process.stdout], [child.stderr, process.stderr]]) {
      pipe.setEncoding('utf8').on('data', (text) => {
        output += text;
        if (tee) screen.write(text);
      });
    }
  }
  // Ctrl-C reaches the program by itself; of what ends this script alone it hears from us, before we go.
  const end = (signal) => {
    child.once('close', () => process.kill(process.pid, signal));
    child.kill(signal);
  };
  ENDS.forEach((signal) => process.once(signal, end));
  // A program that is not there raises 'error'; to the caller that is a status like any other.
  const [status] = await once(child, 'close').catch((error) => [error.code ?? 'failed']);
  ENDS.forEach((signal) => process.off(signal, end));
  return { status, output };
}

/** Runs a program and stops the script when it fails. */
export async function need(program, args, options = {}) {
  const { status, output } = await run(program, args, options);
  if (status === 0) return output;
  if (options.capture) process.stderr.write(output);
  throw new Stop(`\`${[program, ...args].join(' ')}\` ended with ${status}.`);
}

/** Waits for all of the steps, then stops the script if one failed: its message is the last on the screen. */
export async function all(steps) {
  const failed = (await Promise.allSettled(steps)).find(({ status }) => status === 'rejected');
  if (failed) throw failed.reason;
}

/** Runs a script's main function: a `Stop` becomes one line and exit code 1, everything else keeps its stack. */
export async function main(body) {
  try {
    await body();
  } catch (error) {
    if (!(error instanceof Stop)) throw error;
    console.error(`ctsn: ${error.message}`);
    process.exitCode = 1;
  }
}
