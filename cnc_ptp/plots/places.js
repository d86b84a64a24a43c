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

  function plane(plot, trace) {
    const mark = overlay(plot);
    mark.className = "cursor-place";
    return (time) => {
      const { x, y, customdata } = plot._fullData[trace];
      const place = time === null ? null : between(customdata, time);
      const { xaxis, yaxis } = plot._fullLayout;
      const [left, top] = place ? [xaxis.d2p(at(x, place)), yaxis.d2p(at(y, place))] : [-1, -1];
      mark.hidden = !inside(xaxis, left) || !inside(yaxis, top);
      mark.style.left = xaxis._offset + left + "px";
      mark.style.top = yaxis._offset + top + "px";
    };
  }

  // a point of its own; while Plotly draws it, only the last place waits
  function space(plot, trace, cursor) {
    let [busy, wanted] = [false, undefined];
    async function move() {
      if (busy || wanted === undefined) return;
      const { x, y, z, customdata } = plot._fullData[trace];
      const place = wanted === null ? null : between(customdata, wanted);
      wanted = undefined;
      busy = true;
      try {
        const [a, b, c] = [x, y, z].map((column) => [[place ? at(column, place) : null]]);
        await Plotly.restyle(plot, { x: a, y: b, z: c }, [cursor]);
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
    return "cursor" in meta ? space(plot, meta.places, meta.cursor) : plane(plot, meta.places);
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
