/** Median of the last 90 durations. */
export class Meter {
  readonly #recent = new Float64Array(90);
  readonly #sorted = new Float64Array(90);
  #count = 0;

  /** Records a duration in milliseconds. */
  add(milliseconds: number): void {
    this.#recent[this.#count++ % this.#recent.length] = milliseconds;
  }

  /** How many durations were recorded. */
  get count(): number {
    return this.#count;
  }

  /** Milliseconds. */
  get median(): number {
    const known = Math.min(this.#count, this.#recent.length);
    this.#sorted.set(this.#recent);
    return this.#sorted.subarray(0, known).sort()[known >> 1] ?? 0;
  }

  /** Forgets what was recorded. */
  reset(): void {
    this.#count = 0;
  }
}
