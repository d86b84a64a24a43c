// How fine the path may be drawn while it is turned, from how long pictures take.

// [each so many-th point is joined, pixels of the picture for one of the screen]
const LEVELS = [[1, 1], [4, 0.75], [8, 0.5], [16, 0.5], [32, 0.5], [64, 0.4], [128, 0.35]];
const [SLOW, QUICK] = [28, 19]; // ms of a picture: coarser; as quick as the screen: finer
const RETRY = 2000; // ms after a coarser level until a finer one is tried
const STILL = 250; // ms without turning until all is drawn again
const PAUSE = 400; // ms; longer ones between two pictures are none of drawing

export class Pace {
  /** `choose(step, ratio)`: each step-th point is joined, in a picture of so many pixels. */
  constructor(choose) {
    this._choose = choose;
    this._level = 0;
    this._before = 0;
    this._times = [];
    this._still = 0;
    this._retryAt = 0;
    this.isTurned = false;
  }

  turned() {
    clearTimeout(this._still);
    this._still = setTimeout(() => this._rest(), STILL);
    if (this.isTurned) return;
    this.isTurned = true;
    this._before = 0;
    if (this._level) this._choose(...LEVELS[this._level]);
  }

  _rest() {
    this.isTurned = false;
    this._before = 0;
    if (this._level) this._choose(...LEVELS[0]);
  }

  /** A picture was drawn: the time from one to the next counts, the drawing itself happens in between. */
  drawn() {
    if (!this.isTurned) return;
    const now = performance.now();
    const took = now - this._before;
    const counts = this._before > 0 && took < PAUSE * 2;
    this._before = now;
    if (!counts) return;
    this._times.push(took);
    if (this._times.length < 3 && took < 2 * SLOW) return;
    const mean = this._times.reduce((sum, time) => sum + time, 0) / this._times.length;
    this._times = [];
    const next = this._next(mean, now);
    if (next === this._level) return;
    if (next > this._level) this._retryAt = now + RETRY;
    this._level = next;
    this._choose(...LEVELS[next]);
  }

  _next(mean, now) {
    if (mean > SLOW) return Math.min(this._level + (mean > 3 * SLOW ? 2 : 1), LEVELS.length - 1);
    return mean < QUICK && now > this._retryAt ? Math.max(this._level - 1, 0) : this._level;
  }

  get step() {
    return LEVELS[this._level][0];
  }

  end() {
    clearTimeout(this._still);
  }
}
