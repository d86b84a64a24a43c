// What the scope has caught: samples of the server and math channels in one ring, the trigger, and the piece that is shown.
import { formula } from "./expression.js";
import { drawn, readFrame, readRecorded, Ring } from "./samples.js";
import { Trigger } from "./trigger.js";

const [SECONDS, MOST_SAMPLES] = [120, 500000]; // that a ring holds

export class Capture {
  constructor(app) {
    this.app = app;
    this.channels = []; // {name, graph, formula?}
    this.window = 2; // s
    this.pre = 0.2; // share of the window before the trigger
    this.mode = "off"; // off, normal, single
    this.source = "";
    this.trigger = new Trigger();
    this.held = null; // as shown() gives it
    this.isFrozen = false;
    this.ring = new Ring(0, 1);
    [this._step, this._shift] = [1, 0]; // sample n of the ring is that of cycle n · step + shift
    this.version = 0;
    this._columns = [];
    this._stream = -1;
    this._turn = 0;
    this._wanted = null; // time of a recording that is to be read next
    this._isReading = false;
    this._end = app.store.on("event", (event) => this.mode !== "off" && this.trigger.takeEvent(event) && this._fired());
    app.connection.onBinary = (data) => this._take(data);
  }

  get cycleTime() {
    return this.app.store.machine?.cycle_time || 0.001;
  }

  get isRecording() {
    return Boolean(this.app.store.machine?.recording);
  }

  /** Asks for the signals of all channels anew; what was caught is gone. Throws Error for a formula that is none. */
  async subscribe() {
    const turn = ++this._turn;
    const formulas = this.channels.map((channel) => (channel.formula ? formula(channel.formula) : null));
    const needed = new Set();
    this.channels.forEach((channel, i) => (formulas[i] ? formulas[i].names : [channel.name]).forEach((name) => needed.add(name)));
    this._formulas = formulas;
    this._names = [...needed].filter((name) => !this.channels.some((channel) => channel.formula && channel.name === name));
    this._fresh();
    if (this._names.length === 0) {
      this.app.connection.send({ type: "scope_stop" });
      return;
    }
    if (this.isRecording) return;
    const answer = await this.app.request("scope", { signals: this._names, bits: 64 });
    if (!answer || turn !== this._turn) return;
    this._stream = answer.stream;
  }

  _fresh() {
    const count = this.channels.length;
    this._stream = -1;
    this.ring = new Ring(count, Math.min(Math.round(SECONDS / this.cycleTime), Math.floor(MOST_SAMPLES / Math.max(1, count)) + 1000));
    [this._step, this._shift] = [1, 0];
    this.held = null;
    this.isFrozen = false;
    this.trigger.arm();
    this.version += 1;
  }

  _take(data) {
    let frame;
    try {
      frame = readFrame(data);
    } catch (error) {
      this.app.notices.refused(error);
      return;
    }
    if (frame.stream === this._stream) this._push(frame);
  }

  _push(frame) {
    const known = new Map(this._names.map((name, i) => [name, frame.columns[i]]));
    const columns = this.channels.map((channel, i) => {
      const values = this._formulas[i] ? this._formulas[i].evaluate(known, frame.count, this.cycleTime * frame.step) : known.get(channel.name);
      known.set(channel.name, values);
      return values;
    });
    [this._step, this._shift] = [frame.step, frame.cycle % frame.step];
    this.ring.push(Math.floor(frame.cycle / frame.step), columns, frame.count);
    this.version += 1;
    if (this.mode === "off" || this.isFrozen) return;
    const source = this.channels.findIndex((channel) => channel.name === this.source);
    if (source >= 0 && this.trigger.takeSamples(frame.cycle, columns[source])) this._fired();
    this._hold();
  }

  /** The piece of a recording around a time (s); while one is read, the last time that is wanted waits. */
  async read(time) {
    this._wanted = time;
    if (this._isReading) return;
    this._isReading = true;
    try {
      while (this._wanted !== null) {
        const next = this._wanted;
        this._wanted = null;
        await this._readAround(next);
      }
    } finally {
      this._isReading = false;
    }
  }

  /** Every cycle, as far as the ring holds so many. */
  async _readAround(time) {
    if (!this._names?.length) return;
    const turn = this._turn;
    const { start = 0, end = 0 } = this.app.store.machine;
    const from = Math.max(start, Math.min(time - this.window / 2, end - this.window));
    const path = `/api/recorded?signals=${encodeURIComponent(this._names.join(","))}&from=${from}&to=${Math.min(end, from + this.window)}&points=${this.ring.capacity}`;
    const bytes = await this.app.attempt(this.app.connection.http(path, { as: "bytes" }));
    if (!bytes || turn !== this._turn) return;
    const frame = readRecorded(bytes);
    this._formulas = this.channels.map((channel) => (channel.formula ? formula(channel.formula) : null));
    this.ring.clear();
    this._push(frame);
    this.ring.lost = missing(frame);
  }

  // the trigger

  arm(options) {
    this.trigger = new Trigger(options);
    this.held = null;
    this.isFrozen = false;
    this.version += 1;
  }

  _fired() {
    this.firedAt = this.trigger.cycle;
    this.version += 1;
  }

  /** Keeps the piece around a trigger once all of it is there. */
  _hold() {
    const { cycle } = this.trigger;
    if (cycle === null) return;
    const cycles = Math.round(this.window / this.cycleTime);
    const from = cycle - Math.round(this.pre * cycles);
    if (this.ring.end < from + cycles) return;
    this.held = { ring: this.ring.copy(), from, to: from + cycles, zero: cycle, step: 1, shift: 0 };
    if (this.mode === "single") this.isFrozen = true;
    else this.trigger.arm();
  }

  freeze(on) {
    this.isFrozen = on;
    if (on) this.held = this.shown(true);
    else {
      this.held = null;
      this.trigger.arm();
    }
    this.version += 1;
  }

  /** What is shown: a ring, its samples from and to, the cycle that counts as 0 s, and which cycles its samples are of. */
  shown(asCopy = false) {
    if (this.held) return this.held;
    const [step, shift] = [this._step, this._shift];
    const count = Math.max(2, Math.round(this.window / (this.cycleTime * step)));
    const ring = asCopy ? this.ring.copy() : this.ring;
    return { ring, from: Math.max(ring.begin, ring.end - count), to: ring.end, zero: 0, step, shift };
  }

  get sampleTime() {
    return this.cycleTime * this.shown().step;
  }

  /** Times (s) and values of channels for a graph of so many pixels; null at what is missing. */
  data(indices, pixels, range = null) {
    const shown = this.shown();
    const [first, behind] = range ? range.map((time) => this._sampleAt(time, shown)) : [shown.from, shown.to];
    const [samples, ...columns] = drawn(shown.ring, indices, first, behind, pixels);
    return [Array.from(samples, (sample) => this._timeOf(sample, shown)), ...columns.map((column) => Array.from(column, (value) => (Number.isNaN(value) ? null : value)))];
  }

  /** Samples of the picture: {cycle, time (s), values}. */
  *rows() {
    const shown = this.shown();
    const { ring, from, to, step, shift } = shown;
    for (let sample = Math.max(from, ring.begin); sample < Math.min(to, ring.end); sample++) {
      yield { cycle: sample * step + shift, time: this._timeOf(sample, shown), values: ring.columns.map((_, i) => ring.at(i, sample)) };
    }
  }

  /** The samples of a channel between two times (s) of the picture. */
  between(index, begin, end) {
    const shown = this.shown();
    return shown.ring.slice(index, Math.round(this._sampleAt(begin, shown)), Math.round(this._sampleAt(end, shown)) + 1);
  }

  valueAt(index, time) {
    const shown = this.shown();
    return shown.ring.at(index, Math.round(this._sampleAt(time, shown)));
  }

  /** The first cycle of the picture. */
  get begin() {
    const { ring, from, step, shift } = this.shown();
    return Math.max(from, ring.begin) * step + shift;
  }

  /** The cycle behind the picture. */
  get behind() {
    const { ring, to, step, shift } = this.shown();
    return Math.min(to, ring.end) * step + shift;
  }

  /** First and last time (s) of the picture. */
  get range() {
    const shown = this.shown();
    return [this._timeOf(shown.from, shown), this._timeOf(shown.to, shown)];
  }

  _timeOf(sample, { zero, step, shift }) {
    return (sample * step + shift - zero) * this.cycleTime;
  }

  _sampleAt(time, { zero, step, shift }) {
    return (time / this.cycleTime + zero - shift) / step;
  }

  end() {
    this._turn += 1;
    this._wanted = null;
    this._end();
    this.app.connection.onBinary = () => {};
    this.app.connection.send({ type: "scope_stop" });
  }
}

/** Samples of a piece of a recording that some signal does not have. */
function missing({ columns, count }) {
  let lost = 0;
  for (let i = 0; i < count; i++) if (columns.some((column) => Number.isNaN(column[i]))) lost += 1;
  return lost;
}
