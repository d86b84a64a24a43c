// Graphs by uPlot: over time with two cursors, spectra, and one signal over another.
import uPlot from "../vendor/uplot.js";
import { h } from "../dom.js";
import { short } from "../format.js";

const LIGHT = ["#1f5fa8", "#b3261e", "#17653a", "#8a4b00", "#6a3aa8", "#00707a", "#a3186b", "#4d5966"];
const DARK = ["#7db8f0", "#ff9d94", "#7fd6a0", "#f0c36a", "#c3a5f5", "#6fd3dc", "#f59bc9", "#b8c2cc"];
const SYNC = "scope";
const GRIP = 0.5;
const MOST_DECIMALS = 6; // of a tick
const DOTS = { paths: () => null, points: { show: true, size: 9 } };

export const isDark = () => document.documentElement.dataset.theme === "dark";
export const colourOf = (index) => (isDark() ? DARK : LIGHT)[index % LIGHT.length];
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function axis(label, extra = {}) {
  return { stroke: style("--ink"), grid: { stroke: style("--line"), width: 1 }, ticks: { stroke: style("--line") }, label, labelSize: 22, size: 62, values: ticks, ...extra };
}

/** As many decimals as the step has, so that each tick is what is written at it; none is -0. */
export function ticks(_plot, splits, _axis, _space, step) {
  const isWhole = (value) => Math.abs(value - Math.round(value)) < 1e-6 * value;
  let decimals = 0;
  while (decimals <= MOST_DECIMALS && !isWhole(step * 10 ** decimals)) decimals += 1;
  return splits.map((value) => (Math.abs(value) < step / 1000 ? "0" : decimals > MOST_DECIMALS ? value.toExponential(2) : value.toFixed(decimals)));
}

/** A graph of several channels over time. `onCursor(which, time)`: which is A or B. */
export class TimeGraph {
  constructor(host, channels, { height = 260, unit = "", cursors, onCursor, title }) {
    this.channels = channels;
    this._host = host;
    this._cursors = cursors;
    this.zoom = null;
    const series = channels.map(({ name, index }) => ({ label: name, stroke: colourOf(index), width: 1.4, points: { show: false }, value: (_, value) => short(value) }));
    const options = {
      width: Math.max(200, host.clientWidth), height, title, legend: { live: true },
      scales: { x: { time: false } }, axes: [axis("s", { size: 44 }), axis(unit)],
      series: [{ label: "Time in s", value: (_, value) => short(value, 7) }, ...series],
      cursor: { sync: { key: SYNC }, drag: { x: true, y: false, setScale: true } },
      hooks: { draw: [(plot) => this._drawCursors(plot)], setSelect: [(plot) => this._zoomed(plot)] },
    };
    this.plot = new uPlot(options, [[], ...channels.map(() => [])], host);
    this._listen(onCursor);
    this._observer = new ResizeObserver(() => this.plot.setSize({ width: Math.max(200, host.clientWidth), height }));
    this._observer.observe(host);
  }

  _listen(onCursor) {
    let down = 0;
    const { over } = this.plot;
    over.addEventListener("pointerdown", (event) => (down = event.offsetX));
    over.addEventListener("click", (event) => {
      if (Math.abs(event.offsetX - down) < 4) onCursor(event.shiftKey ? "B" : "A", this.plot.posToVal(event.offsetX, "x"));
    });
    over.addEventListener("dblclick", () => (this.zoom = null));
    over.addEventListener("wheel", (event) => this._wheel(event), { passive: false });
  }

  _wheel(event) {
    event.preventDefault();
    const at = this.plot.posToVal(event.offsetX, "x");
    const { min, max } = this.plot.scales.x;
    const factor = event.deltaY > 0 ? 1.25 : 0.8;
    this.zoom = [at - (at - min) * factor, at + (max - at) * factor];
  }

  _zoomed(plot) {
    const { left, width } = plot.select;
    if (width > 3) this.zoom = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
  }

  get pixels() {
    return Math.max(100, Math.round(this.plot.bbox.width / (window.devicePixelRatio || 1)));
  }

  draw(data, range) {
    const [min, max] = this.zoom || range;
    this.plot.batch(() => {
      this.plot.setData(data, false);
      if (max > min) this.plot.setScale("x", { min, max });
    });
  }

  _drawCursors(plot) {
    const { ctx, bbox } = plot;
    for (const [name, time] of Object.entries(this._cursors)) {
      if (time === null) continue;
      const x = Math.round(plot.valToPos(time, "x", true)) + GRIP;
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.save();
      ctx.strokeStyle = style("--bad");
      ctx.fillStyle = style("--bad");
      ctx.setLineDash([6, 4]);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.fillText(name, x + 4, bbox.top + 12);
      ctx.restore();
    }
  }

  end() {
    this._observer.disconnect();
    this.plot.destroy();
  }
}

/** A curve or several over another quantity: spectra, curves of spindles. `dots`: a last column that is drawn as points. */
export class CurveGraph {
  constructor(host, names, { height = 240, xLabel = "", yLabel = "", xName = xLabel, dots = "" } = {}) {
    const columns = dots ? [...names, dots] : names;
    const series = columns.map((label, i) => ({ label, stroke: colourOf(i), width: 1.4, points: { show: false }, value: (_, value) => short(value), ...(i === names.length && DOTS) }));
    this.plot = new uPlot(
      { width: Math.max(200, host.clientWidth), height, scales: { x: { time: false } }, axes: [axis(xLabel, { size: 44 }), axis(yLabel)], series: [{ label: xName, value: (_, value) => short(value) }, ...series] },
      [[], ...columns.map(() => [])], host,
    );
    this._observer = new ResizeObserver(() => this.plot.setSize({ width: Math.max(200, host.clientWidth), height }));
    this._observer.observe(host);
  }

  draw(data) {
    this.plot.setData(data);
  }

  end() {
    this._observer.disconnect();
    this.plot.destroy();
  }
}

/** Curves of points in a plane, not sorted: XY plots and polar plots. `equal`: the same scale in both directions. */
export class PlaneGraph {
  constructor(host, names, { height = 340, xLabel = "", yLabel = "", equal = false } = {}) {
    this._equal = equal;
    this._range = [[-1, 1], [-1, 1]];
    const series = names.map((label, i) => ({ label, stroke: colourOf(i), paths: (plot, index) => path(plot, index) }));
    this.plot = new uPlot(
      {
        mode: 2, width: Math.max(200, host.clientWidth), height, legend: { live: false }, cursor: { drag: { x: true, y: true } },
        scales: { x: { time: false, range: (plot, min, max) => this._scale(0, min, max) }, y: { range: (plot, min, max) => this._scale(1, min, max) } },
        axes: [axis(xLabel, { size: 44 }), axis(yLabel)], series: [{}, ...series],
      },
      [null, ...names.map(() => [[0], [0]])], host,
    );
    this._observer = new ResizeObserver(() => this.plot.setSize({ width: Math.max(200, host.clientWidth), height }));
    this._observer.observe(host);
  }

  _scale(which) {
    return this._range[which];
  }

  /** `curves`: for each name [xs, ys]. */
  draw(curves) {
    this._range = this._fit(curves);
    this.plot.setData([null, ...curves]);
  }

  _fit(curves) {
    const bounds = [[Infinity, -Infinity], [Infinity, -Infinity]];
    for (const curve of curves) curve.forEach((values, k) => values.forEach((value) => {
      if (value < bounds[k][0]) bounds[k][0] = value;
      if (value > bounds[k][1]) bounds[k][1] = value;
    }));
    const ranges = bounds.map(([low, high]) => (low > high ? [-1, 1] : spread(low, high, (high - low) * 0.05 || Math.abs(high) * 0.05 || 1)));
    if (!this._equal) return ranges;
    const { width, height } = this.plot.bbox;
    const scale = Math.max((ranges[0][1] - ranges[0][0]) / (width || 1), (ranges[1][1] - ranges[1][0]) / (height || 1));
    return ranges.map(([low, high], k) => spread((low + high) / 2, (low + high) / 2, (scale * [width || 1, height || 1][k]) / 2));
  }

  end() {
    this._observer.disconnect();
    this.plot.destroy();
  }
}

const spread = (low, high, by) => [low - by, high + by];

/** Draws a line through the points of a series of a plot of mode 2. */
function path(plot, index) {
  uPlot.orient(plot, index, (series, xs, ys, scaleX, scaleY, toX, toY, left, top, width, height) => {
    const [points, values] = plot.data[index];
    const { ctx } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.beginPath();
    ctx.strokeStyle = colourOf(index - 1);
    ctx.lineWidth = 1.3 * (window.devicePixelRatio || 1);
    for (let i = 0; i < points.length; i++) {
      const [x, y] = [toX(points[i], scaleX, width, left), toY(values[i], scaleY, height, top)];
      if (i === 0) ctx.moveTo(x, y);
      else ctx.lineTo(x, y);
    }
    ctx.stroke();
    ctx.restore();
  });
  return null;
}

export function host(label) {
  return h("div", { class: "graph", role: "img", "aria-label": label });
}
