"use strict";
// Every cycle when zoomed, scales that follow, a cursor through all plots with a reference. Reads what columns.py wrote.
(function () {
  const plot = document.getElementById("time");
  const source = document.getElementById("columns");
  if (!plot || !source || !window.Plotly) return;
  const data = JSON.parse(source.textContent);
  const lines = data.lines;
  const MOST_POINTS = 6000;
  const NO_NUMBER = -2147483648;
  const NEAR = 4; // pixels that a click may move

  // columns

  async function unpack(column) {
    const text = Uint8Array.from(atob(column.text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([text]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const n = column.n;
    const numbers = new Int32Array(n);
    for (let i = 0; i < n; i++) {
      const zigzag = bytes[i] | (bytes[n + i] << 8) | (bytes[2 * n + i] << 16) | (bytes[3 * n + i] << 24);
      numbers[i] = (zigzag >>> 1) ^ -(zigzag & 1);
    }
    for (let order = 0; order < column.order; order++) {
      let sum = 0;
      for (let i = 0; i < n; i++) numbers[i] = sum = (sum + numbers[i]) | 0;
    }
    return (i) => (numbers[i] === NO_NUMBER ? NaN : column.offset + column.step * numbers[i]);
  }

  async function unpackAll() {
    const cycles = [];
    for (const column of data.cycles) cycles.push({ n: column.n, at: await unpack(column) });
    for (const line of lines) {
      const values = await unpack(line.values);
      line.cycle = cycles[line.cycles];
      line.n = line.cycle.n;
      line.time = (i) => line.cycle.at(i) * data.cycle_time;
      line.value = (i) => values(i) * line.factor;
    }
  }

  // first index whose time is not before `time`
  function indexAt(line, time) {
    let low = 0;
    let high = line.n;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (line.time(middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  // all points of a stretch, or the extremes of each part of it; interrupted where cycles are missing
  function points(line, first, behind) {
    const x = [];
    const y = [];
    const add = (i) => {
      if (x.length && i > add.last && line.cycle.at(i) - line.cycle.at(add.last) > i - add.last) {
        x.push(null);
        y.push(null);
      }
      x.push(line.time(i));
      y.push(line.value(i));
      add.last = i;
    };
    const parts = Math.max(1, Math.floor((2 * (behind - first)) / MOST_POINTS));
    for (let i = first; i < behind; i += parts) {
      if (parts < 3) {
        for (let k = i; k < Math.min(i + parts, behind); k++) add(k);
        continue;
      }
      let low = i;
      let high = i;
      for (let k = i; k < Math.min(i + parts, behind); k++) {
        const value = line.value(k);
        if (value < line.value(low)) low = k;
        if (value > line.value(high)) high = k;
      }
      add(Math.min(low, high));
      if (low !== high) add(Math.max(low, high));
    }
    return { x, y };
  }

  // words beside the marks of commands, as far as there is room up to the next mark

  const LETTER = 5.6; // pixels
  const MARK = 20;
  const marks = plot.data.findIndex((trace) => trace.meta === "commands");

  function commandWords() {
    if (marks < 0) return null;
    const trace = plot.data[marks];
    const places = Array.from(trace.x, (time) => plot._fullLayout.xaxis.d2p(time));
    return trace.customdata.map((words, i) => {
      const next = i + 1 < places.length ? places[i + 1] : plot._fullLayout._size.w;
      const letters = Math.floor((next - places[i] - MARK) / LETTER);
      if (places[i] < 0 || letters < 6) return "";
      return words.length <= letters ? words : words.slice(0, letters - 1) + "\u2026";
    });
  }

  // zoom

  const traces = plot.data.map((trace, index) => ({ index, line: lines[trace.meta] })).filter((trace) => trace.line);
  const axisOf = (trace) => plot.data[trace.index].yaxis.replace("y", "yaxis");
  let updating = false;
  let again = false;

  // what comes while Plotly is at work is done behind it
  async function zoomed() {
    if (updating) {
      again = true;
      return;
    }
    updating = true;
    again = false;
    try {
      await fill();
    } finally {
      updating = false;
      if (again) await zoomed();
    }
    draw();
  }

  async function fill() {
    const [begin, end] = plot._fullLayout.xaxis.range;
    const xs = [];
    const ys = [];
    const limits = {};
    for (const trace of traces) {
      const line = trace.line;
      const first = Math.max(0, indexAt(line, begin) - 1);
      const behind = Math.min(line.n, indexAt(line, end) + 1);
      const { x, y } = points(line, first, behind);
      xs.push(x);
      ys.push(y);
      if (plot._fullData[trace.index].visible !== true) continue;
      const limit = (limits[axisOf(trace)] ||= [Infinity, -Infinity]);
      for (const value of y) {
        if (value === null || Number.isNaN(value)) continue;
        if (value < limit[0]) limit[0] = value;
        if (value > limit[1]) limit[1] = value;
      }
    }
    const ranges = {};
    for (const [axis, [low, high]] of Object.entries(limits)) {
      if (low > high) continue;
      const margin = high > low ? 0.06 * (high - low) : Math.max(1e-6, 0.05 * Math.abs(low));
      ranges[axis + ".range"] = [low - margin, high + margin];
    }
    const words = commandWords();
    if (words) await Plotly.restyle(plot, { text: [words] }, [marks]);
    await Plotly.update(plot, { x: xs, y: ys }, ranges, traces.map((trace) => trace.index));
  }

  // cursor and reference

  const layer = document.createElement("div");
  layer.className = "cursor-layer";
  plot.style.position = "relative";
  plot.appendChild(layer);
  let cursor = null; // s
  let reference = null;

  const size = () => plot._fullLayout._size;
  const toTime = (left) => plot._fullLayout.xaxis.p2d(left - size().l);
  const toLeft = (time) => plot._fullLayout.xaxis.d2p(time) + size().l;
  const short = (value, digits) => String(Number(value.toFixed(digits))).replace("-", "\u2212");
  const signed = (value, digits) => (value < 0 ? "" : "+") + short(value, digits);
  const TIME_DIGITS = Math.ceil(-Math.log10(data.cycle_time)) + 1;

  // as many as the steps of a column are fine
  function digitsOf(line) {
    return Math.min(12, Math.max(0, Math.ceil(-Math.log10(line.values.step * line.factor)) - 1));
  }

  function snapped(time) {
    const [begin, end] = plot._fullLayout.xaxis.range;
    const inside = Math.min(Math.max(time, begin), end);
    return Math.round(inside / data.cycle_time) * data.cycle_time;
  }

  function valueAt(line, time) {
    const i = Math.min(line.n - 1, indexAt(line, time - 0.5 * data.cycle_time));
    return Math.abs(line.time(i) - time) < 1.5 * data.cycle_time ? line.value(i) : NaN;
  }

  function element(className, style, text) {
    const made = document.createElement("div");
    made.className = className;
    Object.assign(made.style, style);
    made.textContent = text || "";
    layer.appendChild(made);
    return made;
  }

  function drawLine(time, className) {
    const left = toLeft(time);
    if (left < size().l || left > size().l + size().w) return;
    const style = { left: left + "px", top: size().t + "px", height: size().h + "px" };
    element(className, style);
  }

  function drawValues(axis, of) {
    const box = plot._fullLayout[axis];
    const right = plot.clientWidth - size().l - size().w + 4;
    const made = element("cursor-values", { right: right + "px", top: box._offset + 3 + "px" });
    for (const trace of of) {
      const value = valueAt(trace.line, cursor);
      const before = reference === null ? NaN : valueAt(trace.line, reference);
      const digits = digitsOf(trace.line);
      const words = (number, write) => (Number.isNaN(number) ? "\u2013" : write(number, digits));
      const difference = reference === null ? "" : "  \u0394y " + words(value - before, signed);
      const row = document.createElement("span");
      const shown = plot._fullData[trace.index];
      row.style.color = shown.line.color;
      row.textContent = (of.length > 1 ? shown.name + " " : "") + words(value, short) + difference;
      made.appendChild(row);
    }
  }

  function draw() {
    layer.textContent = "";
    if (reference !== null) drawLine(reference, "cursor-line reference");
    if (cursor === null) return;
    drawLine(cursor, "cursor-line");
    const difference = reference === null ? "" : "   \u0394t " + signed(cursor - reference, TIME_DIGITS) + " s";
    const left = Math.min(toLeft(cursor) + 6, plot.clientWidth - 230);
    element("cursor-time", { left: left + "px", top: size().t - 4 + "px" }, short(cursor, TIME_DIGITS) + " s" + difference);
    const rows = {};
    for (const trace of traces) if (plot._fullData[trace.index].visible === true) (rows[axisOf(trace)] ||= []).push(trace);
    for (const [axis, of] of Object.entries(rows)) drawValues(axis, of);
  }

  function leftOf(event) {
    const left = event.clientX - plot.getBoundingClientRect().left;
    return left >= size().l && left <= size().l + size().w ? left : null;
  }

  function listen() {
    let pressed = null;
    plot.addEventListener("mousemove", (event) => {
      const left = leftOf(event);
      cursor = left === null ? null : snapped(toTime(left));
      draw();
    });
    plot.addEventListener("mouseleave", () => {
      cursor = null;
      draw();
    });
    plot.addEventListener("mousedown", (event) => (pressed = event.target.closest(".nsewdrag") ? event : null), true);
    window.addEventListener(
      "mouseup",
      (event) => {
        if (pressed === null) return;
        const moved = Math.abs(event.clientX - pressed.clientX) + Math.abs(event.clientY - pressed.clientY);
        const left = leftOf(pressed);
        pressed = null;
        if (moved > NEAR || left === null || event.detail > 1) return;
        reference = snapped(toTime(left));
        draw();
      },
      true
    );
    window.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      reference = null;
      draw();
    });
    plot.on("plotly_relayout", zoomed);
    plot.on("plotly_restyle", ([change]) => "text" in change || zoomed()); // the words are its own
  }

  async function begin() {
    await unpackAll();
    listen();
    await zoomed();
    plot.dataset.cycles = "all"; // every cycle is there
  }

  if (window.DecompressionStream) begin();
})();
