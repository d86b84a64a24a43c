"use strict";
// On paper: the plots over time in groups that fit on a page, with their marks, and all others as wide as the paper.
(function () {
  const page = window.page;
  if (!page) return;
  const WIDTH = 700; // pixels of A4 between its margins
  const PATH_HEIGHT = 400;
  const PAGE = 1020; // pixels of height
  const HEADING = 170;
  const [ROW, GAP, AROUND] = [140, 48, 70];
  const plot = page.plot;
  const paper = document.createElement("div");
  paper.className = "paper";
  plot.before(paper);
  const others = () => [...document.querySelectorAll(".js-plotly-plot")].filter((one) => !one.closest(".paper, #time"));

  const suffix = (row) => (row === 1 ? "" : String(row));
  const rows = plot.layout.annotations.length;

  function marks() {
    return page.marks().map((time, i) => ({
      shape: { type: "line", xref: "x", yref: "paper", x0: time, x1: time, y0: 0, y1: 1, line: { color: "#b0271d", width: 1, dash: "dash" } },
      name: { xref: "x", yref: "paper", x: time, y: 0, yanchor: "top", text: "AB"[i], showarrow: false, font: { color: "#b0271d" } },
    }));
  }

  function heightOf(row) {
    const own = plot.layout;
    const [low, high] = own["yaxis" + suffix(row)].domain;
    return row === 1 ? (high - low) * (own.height - own.margin.t - own.margin.b) : ROW;
  }

  // first rows of the groups, and the row behind the last
  function groups() {
    const found = [1];
    let height = AROUND + HEADING;
    for (let row = 1; row <= rows; row++) {
      height += heightOf(row) + GAP;
      if (height <= PAGE || row === found[found.length - 1]) continue;
      found.push(row);
      height = AROUND + ROW + GAP;
    }
    return [...found, rows + 1];
  }

  // rows of the plot as a figure of their own
  function group(first, behind) {
    const own = plot.layout;
    const heights = [];
    for (let row = first; row < behind; row++) heights.push(heightOf(row));
    const inner = heights.reduce((sum, height) => sum + height + GAP, -GAP);
    const layout = { width: WIDTH, height: inner + AROUND, margin: { l: 66, r: 8, t: 30, b: 40 }, showlegend: true };
    for (const name of ["template", "font", "barmode", "bargap", "separators", "paper_bgcolor", "plot_bgcolor"]) layout[name] = own[name];
    layout.annotations = marks().map((mark) => mark.name);
    layout.shapes = [...(own.shapes || []), ...marks().map((mark) => mark.shape)];
    const data = [];
    let top = inner;
    for (let row = first; row < behind; row++) {
      const place = suffix(row - first + 1);
      const domain = [(top - heights[row - first]) / inner, top / inner];
      const [x, y] = [own["xaxis" + suffix(row)], own["yaxis" + suffix(row)]];
      layout["xaxis" + place] = { ...x, anchor: "y" + place, matches: place ? "x" : undefined, range: own.xaxis.range };
      layout["yaxis" + place] = { ...y, anchor: "x" + place, domain };
      layout.annotations.push({ ...own.annotations[row - 1], y: domain[1] });
      const legend = own["legend" + row];
      if (legend) layout["legend" + (row - first + 1)] = { ...legend, y: domain[1] };
      for (const trace of plot.data) {
        if ((trace.yaxis || "y") !== "y" + suffix(row)) continue;
        const copy = { ...trace, xaxis: "x" + place, yaxis: "y" + place };
        if (legend) copy.legend = "legend" + (row - first + 1);
        data.push(copy);
      }
      top -= heights[row - first] + GAP;
    }
    return { data, layout };
  }

  function before() {
    paper.textContent = "";
    const bounds = groups();
    bounds.slice(1).forEach((behind, i) => {
      const box = paper.appendChild(document.createElement("div"));
      const { data, layout } = group(bounds[i], behind);
      box.style.height = layout.height + "px";
      Plotly.newPlot(box, data, layout, { staticPlot: true });
    });
    for (const other of others()) {
      const height = other.closest(".paths") ? PATH_HEIGHT : other.layout.height;
      other.dataset.height ||= other.layout.height;
      other.style.height = height + "px";
      Plotly.relayout(other, { width: WIDTH, height, autosize: false });
    }
  }

  function after() {
    paper.textContent = "";
    for (const other of others()) {
      const height = Number(other.dataset.height);
      other.style.height = height + "px";
      Plotly.relayout(other, { width: null, height, autosize: true });
    }
  }

  window.addEventListener("beforeprint", before);
  window.addEventListener("afterprint", after);
})();
