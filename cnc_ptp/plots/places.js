"use strict";
// The place on the paths at the time under the cursor, and the time at the place under the cursor.
(function () {
  const page = window.page;
  if (!page) return;

  // the two points of a sorted column around a value, and how far it is between them; null outside of it
  function between(column, value) {
    let [low, high] = [0, column.length - 1];
    if (high < 0 || value < column[low] || value > column[high]) return null;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (column[middle] <= value) low = middle;
      else high = middle;
    }
    const step = column[high] - column[low];
    return { low, high, share: step > 0 ? (value - column[low]) / step : 0 };
  }

  const at = (column, { low, high, share }) => column[low] + share * (column[high] - column[low]);

  function overlay(plot) {
    const layer = document.createElement("div");
    layer.className = "cursor-layer";
    plot.style.position = "relative";
    plot.appendChild(layer);
    return layer.appendChild(document.createElement("div"));
  }

  const inside = (axis, offset) => offset >= 0 && offset <= axis._length;

  // the place of a trace at a time, null where it has none
  function placeOf(plot, trace, time) {
    const { x, y, z, customdata } = plot._fullData[trace];
    const place = time === null ? null : between(customdata, time);
    return place && [x, y, z || x].map((column) => at(column, place));
  }

  function plane(plot, trace) {
    const mark = overlay(plot);
    mark.className = "cursor-place";
    return (time) => {
      const place = placeOf(plot, trace, time);
      const { xaxis, yaxis } = plot._fullLayout;
      const [left, top] = place ? [xaxis.d2p(place[0]), yaxis.d2p(place[1])] : [-1, -1];
      mark.hidden = !inside(xaxis, left) || !inside(yaxis, top);
      mark.style.background = plot._fullData[trace].line?.color || "";
      mark.style.left = xaxis._offset + left + "px";
      mark.style.top = yaxis._offset + top + "px";
    };
  }

  // points of their own; while Plotly draws them, only the last time waits
  function space(plot, traces, cursor) {
    let [busy, wanted] = [false, undefined];
    async function move() {
      if (busy || wanted === undefined) return;
      const places = traces.map((trace) => placeOf(plot, trace, wanted) || [null, null, null]);
      wanted = undefined;
      busy = true;
      try {
        const [x, y, z] = [0, 1, 2].map((axis) => [places.map((place) => place[axis])]);
        await Plotly.restyle(plot, { x, y, z }, [cursor]);
      } finally {
        busy = false;
        requestAnimationFrame(move);
      }
    }
    return (time) => {
      wanted = time;
      requestAnimationFrame(move);
    };
  }

  // a line at the length that the path has at that time
  function length(plot, { lengths, times }) {
    const mark = overlay(plot);
    mark.className = "cursor-line";
    return (time) => {
      const place = time === null ? null : between(times, time);
      const { xaxis, _size } = plot._fullLayout;
      const left = place ? xaxis.d2p(at(lengths, place)) : -1;
      mark.hidden = !inside(xaxis, left);
      Object.assign(mark.style, { left: _size.l + left + "px", top: _size.t + "px", height: _size.h + "px" });
    };
  }

  function timeOf(plot, point) {
    const { lengths, times } = plot.layout.meta;
    if (!lengths) return point.customdata;
    const place = between(lengths, point.x);
    return place ? at(times, place) : undefined;
  }

  function follower(plot) {
    const meta = plot.layout.meta;
    if (meta.lengths) return length(plot, meta);
    if ("cursor" in meta) return space(plot, meta.places, meta.cursor);
    const marks = meta.places.map((trace) => plane(plot, trace));
    return (time) => marks.forEach((mark) => mark(time));
  }

  for (const plot of document.querySelectorAll(".js-plotly-plot")) {
    if (plot === page.plot || !plot.layout.meta) continue;
    const follow = follower(plot);
    let last = null; // the time of its own cursor
    follow(null);
    page.followers.push((time) => time === last || follow((last = time)));
    plot.on("plotly_hover", ({ points: [point] }) => {
      const time = timeOf(plot, point);
      if (typeof time === "number") page.setCursor(time);
    });
    plot.on("plotly_unhover", () => page.setCursor(null));
    plot.on("plotly_relayout", () => follow(last));
  }
})();
