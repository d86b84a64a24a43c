"use strict";
// Every cycle when zoomed, scales that follow, a cursor through all plots, two marks between which it measures. Reads
// what columns.py wrote. window.page is what places.js and paper.js share with it.
(function () {
  const plot = document.getElementById("time");
  const source = document.getElementById("columns");
  if (!plot || !source || !window.Plotly) return;
  const data = JSON.parse(source.textContent);
  const lines = data.lines;
  const MOST_POINTS = 6000;
  const STRIDE = data.stride; // cycles from one point of a column to the next
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
      if (x.length && i > add.last && line.cycle.at(i) - line.cycle.at(add.last) > STRIDE * (i - add.last)) {
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

  // words beside the marks of events and commands, as far as there is room up to the next mark of the same row

  const LETTER = 5.6; // pixels
  const MARK = 20;
  const ROWS = ["events", "commands"].map((row) => plot.data.flatMap((trace, i) => (trace.meta === row ? [i] : [])));

  function words() {
    const texts = {};
    for (const row of ROWS) {
      const marks = row.flatMap((index) =>
        Array.from(plot.data[index].x, (time, i) => ({ index, i, left: plot._fullLayout.xaxis.d2p(time) }))
      );
      marks.sort((one, other) => one.left - other.left);
      marks.forEach(({ index, i, left }, place) => {
        const next = place + 1 < marks.length ? marks[place + 1].left : plot._fullLayout._size.w;
        const letters = Math.floor((next - left - MARK) / LETTER);
        const text = plot.data[index].customdata[i];
        const none = left < 0 || letters < 6;
        (texts[index] ||= [])[i] = none ? "" : text.length <= letters ? text : text.slice(0, letters - 1) + "\u2026";
      });
    }
    return texts;
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
    const texts = words();
    const marks = Object.keys(texts);
    if (marks.length) await Plotly.restyle(plot, { text: marks.map((index) => texts[index]) }, marks.map(Number));
    await Plotly.update(plot, { x: xs, y: ys }, ranges, traces.map((trace) => trace.index));
  }

  // cursor and marks

  const layer = document.createElement("div");
  layer.className = "cursor-layer";
  plot.style.position = "relative";
  plot.appendChild(layer);
  const measured = document.getElementById("measured");
  let cursor = null; // s
  let marks = []; // s, of A and B
  const page = (window.page = { plot, data, followers: [], setCursor, marks: () => marks });

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
    const i = Math.min(line.n - 1, indexAt(line, time - 0.5 * STRIDE * data.cycle_time));
    return Math.abs(line.time(i) - time) < 1.5 * STRIDE * data.cycle_time ? line.value(i) : NaN;
  }

  // value, difference and slope of a line between two times, as texts
  function difference(line, from, to) {
    const [before, value] = [valueAt(line, from), valueAt(line, to)];
    const digits = digitsOf(line);
    const text = (number, write, of) => (Number.isFinite(number) ? write(number, of) : "\u2013");
    const slope = (value - before) / (to - from);
    const fine = Math.max(0, 4 - Math.ceil(Math.log10(Math.abs(slope) + 1e-12)));
    return {
      before: text(before, short, digits),
      value: text(value, short, digits),
      change: text(value - before, signed, digits),
      slope: text(slope, signed, Math.min(9, fine)) + " /s",
    };
  }

  function element(className, style, text) {
    const made = document.createElement("div");
    made.className = className;
    Object.assign(made.style, style);
    made.textContent = text || "";
    layer.appendChild(made);
    return made;
  }

  function drawLine(time, className, name) {
    const left = toLeft(time);
    if (left < size().l || left > size().l + size().w) return;
    const style = { left: left + "px", top: size().t + "px", height: size().h + "px" };
    element(className, style);
    if (name) element("cursor-name", { left: left + 2 + "px", top: size().t + size().h + 2 + "px" }, name);
  }

  function drawValues(axis, of) {
    const box = plot._fullLayout[axis];
    const right = plot.clientWidth - size().l - size().w + 4;
    const made = element("cursor-values", { right: right + "px", top: box._offset + 3 + "px" });
    for (const trace of of) {
      const shown = plot._fullData[trace.index];
      const row = document.createElement("span");
      const { value, change, slope } = difference(trace.line, marks.length ? marks[0] : cursor, cursor);
      row.style.color = shown.line.color;
      const behind = marks.length ? "  \u0394 " + change + "  " + slope : "";
      row.textContent = (of.length > 1 ? shown.name + " " : "") + value + behind;
      made.appendChild(row);
    }
  }

  function draw() {
    layer.textContent = "";
    marks.forEach((mark, i) => drawLine(mark, "cursor-line mark", "AB"[i]));
    for (const follow of page.followers) follow(cursor);
    if (cursor === null) return;
    drawLine(cursor, "cursor-line");
    const behind = marks.length ? "   \u0394t " + signed(cursor - marks[0], TIME_DIGITS) + " s" : "";
    const left = Math.max(0, Math.min(toLeft(cursor) + 6, plot.clientWidth - 180));
    element("cursor-time", { left: left + "px", top: size().t - 4 + "px" }, short(cursor, TIME_DIGITS) + " s" + behind);
    const rows = {};
    for (const trace of traces) if (plot._fullData[trace.index].visible === true) (rows[axisOf(trace)] ||= []).push(trace);
    for (const [axis, of] of Object.entries(rows)) drawValues(axis, of);
  }

  function setCursor(time) {
    cursor = time;
    draw();
  }

  // the marks: A, then B, then A anew

  function setMark(time) {
    marks = marks.length === 1 ? [marks[0], time] : [time];
    measure();
    draw();
  }

  function clear() {
    marks = [];
    measure();
    draw();
  }

  function measure() {
    measured.textContent = "";
    measured.hidden = marks.length < 2;
    if (measured.hidden) return;
    const [a, b] = marks;
    const head = ["A " + short(a, TIME_DIGITS) + " s, B " + short(b, TIME_DIGITS) + " s, \u0394t " + signed(b - a, TIME_DIGITS) + " s", "A", "B", "\u0394", "slope"];
    const table = document.createElement("table");
    const add = (cells, kind) => {
      const row = table.insertRow();
      cells.forEach((text, i) => {
        const cell = row.appendChild(document.createElement(kind));
        if (i) cell.className = "number";
        cell.textContent = text;
      });
    };
    add(head, "th");
    for (const trace of traces) {
      const shown = plot._fullData[trace.index];
      if (shown.visible !== true) continue;
      const { before, value, change, slope } = difference(trace.line, a, b);
      const title = plot.layout.annotations[Number(axisOf(trace).slice(5)) - 1].text;
      add([title + ", " + shown.name, before, value, change, slope], "td");
    }
    const box = measured.appendChild(document.createElement("div"));
    box.className = "scroll";
    box.appendChild(table);
  }

  function leftOf(event) {
    const left = event.clientX - plot.getBoundingClientRect().left;
    return left >= size().l && left <= size().l + size().w ? left : null;
  }

  // pointers: mouse and finger
  function listen() {
    let pressed = null;
    plot.addEventListener("pointermove", (event) => {
      const left = leftOf(event);
      setCursor(left === null ? null : snapped(toTime(left)));
    });
    plot.addEventListener("pointerleave", (event) => event.pointerType === "touch" || setCursor(null));
    plot.addEventListener("pointerdown", (event) => (pressed = event.target.closest(".nsewdrag") ? event : null), true);
    window.addEventListener(
      "pointerup",
      (event) => {
        if (pressed === null) return;
        const moved = Math.abs(event.clientX - pressed.clientX) + Math.abs(event.clientY - pressed.clientY);
        const left = leftOf(pressed);
        pressed = null;
        if (moved > NEAR || left === null) return;
        setMark(snapped(toTime(left)));
      },
      true
    );
    plot.on("plotly_doubleclick", clear); // the whole run; its clicks are no marks
    window.addEventListener("keydown", (event) => event.key === "Escape" && clear());
    plot.on("plotly_relayout", zoomed);
    plot.on("plotly_restyle", ([change]) => "text" in change || zoomed()); // the words are its own
    for (const button of document.querySelectorAll(".legend button")) button.addEventListener("click", () => toggle(button));
  }

  function toggle(button) {
    const off = button.classList.toggle("off");
    const group = plot.data.flatMap((trace, i) => (trace.legendgroup === button.dataset.group ? [i] : []));
    Plotly.restyle(plot, { visible: off ? "legendonly" : true }, group);
  }

  // a narrow page: room for the plots, and a finger scrolls instead of zooming
  async function fit() {
    const narrow = plot.clientWidth < 600;
    const change = { "margin.l": narrow ? 66 : 86, "margin.r": narrow ? 8 : 24 };
    change["margin.t"] = narrow ? 56 : 34; // the buttons stand over the title
    for (const legend of Object.keys(plot.layout).filter((name) => /^legend\d/.test(name))) {
      change[legend + ".yanchor"] = narrow ? "top" : "bottom"; // in the plot instead of beside its title
      change[legend + ".font.size"] = narrow ? 9 : 12;
      change[legend + ".bgcolor"] = narrow ? "rgba(255,255,255,0.7)" : "rgba(0,0,0,0)";
    }
    if (window.matchMedia("(pointer: coarse)").matches) change.dragmode = false;
    if (plot.layout.margin.l !== change["margin.l"]) await Plotly.relayout(plot, change);
  }

  async function begin() {
    await unpackAll();
    listen();
    await fit();
    window.addEventListener("resize", fit);
    await zoomed();
    plot.dataset.cycles = "all"; // every cycle is there
  }

  if (window.DecompressionStream) begin();
})();
