// The path of a program as /api/backplot gives it, and what is drawn of it.

const FLOATS = 5; // x y z feed line, of each point
const [HEADER, TURNING] = [16, 1];

/** Points of a binary answer: `rows` has x, y, z (mm), feed (mm/min, 0: rapid), line, one after the other. Throws Error. */
export function readPath(buffer) {
  const head = new Uint32Array(buffer, 0, HEADER / 4);
  const count = head[1];
  if (head[0] !== 1 || buffer.byteLength !== HEADER + count * FLOATS * 4) throw new Error("the backplot of the server is in another format");
  return { count, flags: head[2], isTurning: Boolean(head[2] & TURNING), rows: new Float32Array(buffer, HEADER, count * FLOATS) };
}

/** Positions of points, pairs of points that are joined, and the box around them. */
export function geometry({ count, rows }) {
  const positions = new Float32Array(count * 3);
  const pairs = new Uint32Array(Math.max(0, count - 1) * 2);
  const box = { min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity] };
  let used = 0;
  let joined = false;
  for (let i = 0; i < count; i++) {
    const from = i * FLOATS;
    const known = !Number.isNaN(rows[from]);
    for (let k = 0; k < 3; k++) {
      const value = known ? rows[from + k] : 0;
      positions[3 * i + k] = value;
      if (known && value < box.min[k]) box.min[k] = value;
      if (known && value > box.max[k]) box.max[k] = value;
    }
    if (known && joined) {
      pairs[used++] = i - 1;
      pairs[used++] = i;
    }
    joined = known;
  }
  return { positions, pairs: pairs.subarray(0, used), box };
}

/** Pairs that join only each `step`-th point of what is joined, with both ends: coarser, and as long. */
export function coarser(pairs, step) {
  const found = [];
  let from = pairs[0];
  for (let i = 0, since = 1; i < pairs.length; i += 2, since++) {
    const to = pairs[i + 1];
    const isEnd = i + 2 >= pairs.length || pairs[i + 2] !== to;
    if (since < step && !isEnd) continue;
    found.push(from, to);
    from = pairs[i + 2];
    since = 0;
  }
  return new Uint32Array(found);
}

const RAPID = [0.55, 0.6, 0.66];
// from slow to fast; bright enough on light and dark
const SCALE = [[0.12, 0.35, 0.75], [0.0, 0.55, 0.5], [0.75, 0.5, 0.0], [0.8, 0.15, 0.1]];

/** A colour of the scale, `share` 0 … 1. */
export function scaleColour(share) {
  const place = Math.min(Math.max(share, 0), 1) * (SCALE.length - 1);
  const low = Math.min(Math.floor(place), SCALE.length - 2);
  return SCALE[low].map((value, k) => value + (place - low) * (SCALE[low + 1][k] - value));
}

/** Colours of points, 3 bytes each; by `feed` or by `block`, and the largest feed. */
export function colours({ count, rows }, by) {
  const bytes = new Uint8Array(count * 3);
  let [fastest, last] = [0, 1];
  for (let i = 0; i < count; i++) {
    if (rows[i * FLOATS + 3] > fastest) fastest = rows[i * FLOATS + 3];
    if (rows[i * FLOATS + 4] > last) last = rows[i * FLOATS + 4];
  }
  for (let i = 0; i < count; i++) {
    const [feed, line] = [rows[i * FLOATS + 3], rows[i * FLOATS + 4]];
    const colour = by === "block" ? scaleColour(line / last) : feed > 0 ? scaleColour(feed / (fastest || 1)) : RAPID;
    for (let k = 0; k < 3; k++) bytes[3 * i + k] = colour[k] * 255;
  }
  return { bytes, fastest, last };
}

/** How many pairs end at `line` or before it; points are taken to go forward through the program. */
export function pairsUpTo({ rows }, pairs, line) {
  return pairsWithin(pairs, (point) => rows[point * FLOATS + 4] <= line);
}

/** How many pairs at the beginning end at a point that `isWithin`; behind them none does. */
export function pairsWithin(pairs, isWithin) {
  let [low, high] = [0, pairs.length / 2];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (isWithin(pairs[2 * middle + 1])) low = middle + 1;
    else high = middle;
  }
  return low;
}
