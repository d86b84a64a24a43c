// The graphs of a scope with cursors and measures; drawn ten times a second while something has changed.
import { field, h, panel, say, select } from "../dom.js";
import { short } from "../format.js";
import { unitOfSignal } from "./catalogue.js";
import { CurveGraph, host, PlaneGraph, TimeGraph } from "./graphs.js";
import { measure, spectrum } from "./measures.js";

const PERIOD = 100; // ms
const MOST_POINTS = 20000; // of an XY plot and a spectrum

export class Picture {
  constructor(app, capture, { height = 250, extras = true } = {}) {
    this.app = app;
    this.capture = capture;
    this.cursors = { A: null, B: null };
    this._height = height;
    this._graphs = [];
    this._seen = -1;
    this._over = h("div", { class: "graphs" });
    this._measures = h("tbody", {});
    this._fft = extras ? this._spectrumPart() : null;
    this._xy = extras ? this._planePart() : null;
    this.element = h("div", { class: "graphs" }, this._over, this._measurePart(), this._fft?.element, this._xy?.element);
    this._timer = setInterval(() => this.draw(), PERIOD);
    this._theme = () => this.rebuild();
    window.addEventListener("theme", this._theme);
  }

  _measurePart() {
    const inputs = Object.keys(this.cursors).map((name) => {
      const input = h("input", { type: "number", step: "0.001", dataset: { cursor: name } });
      input.addEventListener("change", () => this.setCursor(name, input.value === "" ? null : Number(input.value)));
      return field(`Cursor ${name} in s`, input);
    });
    this._inputs = inputs.map((one) => one.querySelector("input"));
    this._between = h("p", { class: "muted number", role: "status" });
    const names = ["Signal", "Min", "Max", "Mean", "RMS", "Peak to peak", "Slope /s", "A", "B", "B − A"];
    const head = h("thead", {}, h("tr", {}, names.map((name) => h("th", { scope: "col" }, name))));
    const table = h("div", { class: "scroll", tabIndex: 0, role: "region", "aria-label": "Table of measures" }, h("table", { class: "measures" }, head, this._measures));
    return panel("Measures", h("div", { class: "row end" }, inputs, this._between), table);
  }

  _spectrumPart() {
    const which = select([["", "off"]], {});
    const place = host("Spectrum");
    return { which, place, graph: null, element: panel("Spectrum (FFT)", field("Signal", which), place) };
  }

  _planePart() {
    const [x, y] = [select([["", "off"]]), select([["", "off"]])];
    const place = host("One signal over another");
    return { x, y, place, graph: null, element: panel("XY plot", h("div", { class: "row" }, field("X", x), field("Y", y)), place) };
  }

  setCursor(name, time) {
    this.cursors[name] = time;
    const index = Object.keys(this.cursors).indexOf(name);
    this._inputs[index].value = time === null ? "" : time.toFixed(3);
    this._seen = -1;
    this._graphs.forEach((graph) => graph.plot.redraw(false));
  }

  /** After channels or colours have changed. */
  rebuild() {
    this._graphs.forEach((graph) => graph.end());
    this._over.replaceChildren();
    const byGraph = new Map();
    this.capture.channels.forEach((channel, index) => {
      const key = channel.graph || 1;
      byGraph.set(key, [...(byGraph.get(key) || []), { name: channel.name, index }]);
    });
    this._graphs = [...byGraph].sort(([a], [b]) => a - b).map(([, channels]) => {
      const place = host(`Graph of ${channels.map(({ name }) => name).join(", ")}`);
      this._over.append(h("div", { class: "panel" }, place));
      return new TimeGraph(place, channels, { height: this._height, unit: this._units(channels).join(", "), cursors: this.cursors, onCursor: (name, time) => this.setCursor(name, time) });
    });
    if (this._graphs.length === 0) this._over.append(h("p", { class: "panel" }, "No signals. Add one."));
    this._fillChoices();
    this._seen = -1;
  }

  /** Each once. */
  _units(channels) {
    return [...new Set(channels.map(({ name }) => unitOfSignal(this.app.store, name)).filter(Boolean))];
  }

  _fillChoices() {
    const names = this.capture.channels.map(({ name }) => name);
    for (const choice of this._choices) {
      const { value } = choice;
      choice.replaceChildren(h("option", { value: "" }, "off"), ...names.map((name) => h("option", { value: name }, name)));
      choice.onchange = () => this._chosen();
      pick(choice, value);
    }
    this._chosen();
  }

  /** Graphs of signals that are chosen are made anew with the next drawing. */
  _chosen() {
    for (const part of [this._fft, this._xy]) {
      part?.graph?.end();
      if (part) part.graph = null;
    }
    this._seen = -1;
  }

  get _choices() {
    return [this._fft?.which, this._xy?.x, this._xy?.y].filter(Boolean);
  }

  /** What is shown besides the channels: the signals of the spectrum and of the XY plot, the cursors. */
  get extras() {
    const [spectrum, x, y] = this._choices.map((choice) => choice.value);
    return { spectrum, x, y, cursors: { ...this.cursors } };
  }

  /** Shows it again, as far as it is given. */
  show({ spectrum, x, y, cursors }) {
    [spectrum, x, y].forEach((name, i) => name !== undefined && pick(this._choices[i], name));
    for (const [name, time] of Object.entries(cursors || {})) if (name in this.cursors) this.setCursor(name, Number.isFinite(time) ? time : null);
    this._chosen();
  }

  draw() {
    const zoomed = this._graphs.map((graph) => String(graph.zoom)).join();
    if (document.hidden || (this._seen === this.capture.version && this._zoomed === zoomed)) return;
    this._seen = this.capture.version;
    this._zoomed = zoomed;
    const { range } = this.capture;
    for (const graph of this._graphs) graph.draw(this.capture.data(graph.channels.map(({ index }) => index), graph.pixels, graph.zoom), range);
    this._drawMeasures(range);
    if (this._fft) this._drawSpectrum(range);
    if (this._xy) this._drawPlane(range);
  }

  /** Between the cursors, or over the whole picture. */
  get span() {
    const { A, B } = this.cursors;
    return A !== null && B !== null ? [Math.min(A, B), Math.max(A, B)] : this.capture.range;
  }

  _drawMeasures() {
    const [begin, end] = this.span;
    const { A, B } = this.cursors;
    const rows = this.capture.channels.map(({ name }, i) => {
      const found = measure(this.capture.between(i, begin, end), this.capture.sampleTime);
      const at = (time) => (time === null ? NaN : this.capture.valueAt(i, time));
      const values = [found.min, found.max, found.mean, found.rms, found.peak, found.slope, at(A), at(B), at(B) - at(A)];
      return [[name, unitOfSignal(this.app.store, name)].filter(Boolean).join(" in "), ...values.map((value) => short(value))];
    });
    fillTable(this._measures, rows);
    say(this._between, A !== null && B !== null ? `B − A = ${short(B - A, 6)} s, ${short(1 / Math.abs(B - A))} Hz` : `over ${short(end - begin)} s`);
  }

  _drawSpectrum() {
    const { which, place } = this._fft;
    const index = this.capture.channels.findIndex(({ name }) => name === which.value);
    place.hidden = index < 0;
    if (index < 0) return;
    this._fft.graph ||= new CurveGraph(place, [which.value], { xLabel: "Hz", yLabel: "amplitude" });
    const [begin, end] = this.span;
    const { frequencies, amplitudes } = spectrum(this.capture.between(index, begin, end).subarray(-2 * MOST_POINTS), this.capture.sampleTime);
    this._fft.graph.draw([Array.from(frequencies), Array.from(amplitudes)]);
  }

  _drawPlane() {
    const { x, y, place } = this._xy;
    const [of, over] = [y.value, x.value].map((wanted) => this.capture.channels.findIndex(({ name }) => name === wanted));
    place.hidden = of < 0 || over < 0;
    if (place.hidden) return;
    this._xy.graph ||= new PlaneGraph(place, [`${y.value} over ${x.value}`], { xLabel: x.value, yLabel: y.value });
    const [begin, end] = this.span;
    const [xs, ys] = [over, of].map((index) => this.capture.between(index, begin, end).subarray(-MOST_POINTS));
    const kept = [...xs.keys()].filter((i) => !Number.isNaN(xs[i]) && !Number.isNaN(ys[i]));
    this._xy.graph.draw([[kept.map((i) => xs[i]), kept.map((i) => ys[i])]]);
  }

  end() {
    clearInterval(this._timer);
    window.removeEventListener("theme", this._theme);
    this._graphs.forEach((graph) => graph.end());
    this._fft?.graph?.end();
    this._xy?.graph?.end();
  }
}

/** Chooses a row; the first one where there is none of this value. */
function pick(choice, value) {
  choice.value = value;
  if (choice.selectedIndex < 0) choice.selectedIndex = 0;
}

function fillTable(body, rows) {
  while (body.children.length > rows.length) body.lastChild.remove();
  rows.forEach((cells, i) => {
    const row = body.children[i] || body.appendChild(h("tr", {}, cells.map((_, k) => h(k ? "td" : "th", k ? { class: "number" } : { scope: "row" }))));
    cells.forEach((text, k) => say(row.children[k], text));
  });
}
