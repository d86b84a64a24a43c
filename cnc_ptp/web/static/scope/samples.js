// Samples of signals: frames of the server into rings, and what is drawn of them.

const FIELDS = 5; // uint32 of a header

/** A binary frame of /ws: stream, first cycle, and a column of float32 or float64 for each signal. Throws Error. */
export function readFrame(buffer) {
  if (buffer.byteLength < FIELDS * 4) throw new Error("a frame of the scope is too short");
  const [stream, low, high, signals, count] = new Uint32Array(buffer, 0, FIELDS);
  return { stream, cycle: high * 2 ** 32 + low, step: 1, columns: columnsOf(buffer, FIELDS * 4, signals, count), count };
}

/** Samples of a recording: a frame with the cycles between two samples in place of its stream. */
export function readRecorded(buffer) {
  const frame = readFrame(buffer);
  return { ...frame, step: frame.stream };
}

function columnsOf(buffer, from, signals, count) {
  const size = count === 0 || signals === 0 ? 4 : (buffer.byteLength - from) / (signals * count);
  if (size !== 4 && size !== 8) throw new Error("a frame of the scope has another length than it says");
  const values = new (size === 8 ? Float64Array : Float32Array)(buffer.slice(from));
  return Array.from({ length: signals }, (_, i) => values.subarray(i * count, (i + 1) * count));
}

/** The newest samples of several signals; all have the same cycles, one after the other. */
export class Ring {
  constructor(signals, capacity) {
    this.capacity = capacity;
    this.columns = Array.from({ length: signals }, () => new Float64Array(capacity)); // integers and exports are exact
    this.clear();
  }

  clear() {
    this.end = 0; // cycle behind the newest sample
    this.length = 0;
    this.lost = 0;
  }

  get begin() {
    return this.end - this.length;
  }

  /** Takes columns that begin at a cycle; a gap is filled with NaN and counted. */
  push(cycle, columns, count) {
    if (this.length === 0) this.end = cycle;
    const gap = cycle - this.end;
    if (gap < 0 || gap >= this.capacity) {
      this.lost += Math.max(0, gap);
      this.length = 0;
      this.end = cycle;
    } else if (gap > 0) {
      this.lost += gap;
      const nothing = new Float64Array(gap).fill(NaN);
      this._write(columns.map(() => nothing), gap);
    }
    this._write(columns, count);
  }

  _write(columns, count) {
    for (let i = 0; i < columns.length; i++) {
      for (let k = 0; k < count; k++) this.columns[i][(this.end + k) % this.capacity] = columns[i][k];
    }
    this.end += count;
    this.length = Math.min(this.length + count, this.capacity);
  }

  at(signal, cycle) {
    return cycle >= this.begin && cycle < this.end ? this.columns[signal][cycle % this.capacity] : NaN;
  }

  /** The samples of a signal from a cycle up to another one. */
  slice(signal, from, to) {
    const [first, behind] = [Math.max(from, this.begin), Math.min(to, this.end)];
    const found = new Float64Array(Math.max(0, behind - first));
    const column = this.columns[signal];
    for (let i = 0; i < found.length; i++) found[i] = column[(first + i) % this.capacity];
    return found;
  }

  /** A ring of its own with the same samples, which stays. */
  copy() {
    const other = new Ring(0, this.capacity);
    Object.assign(other, { columns: this.columns.map((column) => column.slice()), end: this.end, length: this.length, lost: this.lost });
    return other;
  }
}

/**
 * What is drawn between two cycles: cycles, and a column of each signal. With more samples than pixels the smallest and
 * the largest one of each pixel, in their order, so that no peak is lost.
 */
export function drawn(ring, signals, from, to, pixels) {
  const [first, behind] = [Math.max(Math.floor(from), ring.begin), Math.min(Math.ceil(to), ring.end)];
  const count = Math.max(0, behind - first);
  if (count <= 2 * pixels) {
    const cycles = Float64Array.from({ length: count }, (_, i) => first + i);
    return [cycles, ...signals.map((signal) => ring.slice(signal, first, behind))];
  }
  const cycles = new Float64Array(2 * pixels);
  const columns = signals.map(() => new Float64Array(2 * pixels));
  for (let pixel = 0; pixel < pixels; pixel++) {
    const [begin, end] = [first + Math.floor((pixel * count) / pixels), first + Math.floor(((pixel + 1) * count) / pixels)];
    cycles[2 * pixel] = begin;
    cycles[2 * pixel + 1] = begin + (end - begin) / 2;
    signals.forEach((signal, i) => extremes(ring, signal, begin, end, columns[i], 2 * pixel));
  }
  return [cycles, ...columns];
}

function extremes(ring, signal, begin, end, into, place) {
  const [column, { capacity }] = [ring.columns[signal], ring];
  let [low, high, lowAt, highAt] = [Infinity, -Infinity, begin, begin];
  for (let cycle = begin; cycle < end; cycle++) {
    const value = column[cycle % capacity];
    if (value < low) [low, lowAt] = [value, cycle];
    if (value > high) [high, highAt] = [value, cycle];
  }
  const known = low <= high;
  into[place] = known ? (lowAt <= highAt ? low : high) : NaN;
  into[place + 1] = known ? (lowAt <= highAt ? high : low) : NaN;
}
