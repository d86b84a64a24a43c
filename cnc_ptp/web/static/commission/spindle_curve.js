// The curve of a spindle: the acceleration that each of its gears gives over the speed, with its points.
import { h, panel, say } from "../dom.js";
import { short } from "../format.js";
import { CurveGraph, host } from "../scope/graphs.js";

export function spindleCurve(app, unit) {
  const status = h("p", { class: "muted", role: "status" }, "Reading …");
  const element = h("div", { class: "cards" }, status);
  const graphs = [];

  async function read() {
    let answer;
    try {
      answer = await app.connection.http(`/api/curve?spindle=${encodeURIComponent(unit.name)}`);
    } catch (error) {
      say(status, error.message);
      return;
    }
    const gears = (answer.gears || []).filter(({ points }) => points.length > 0);
    say(status, gears.length ? "" : "This spindle has no curve.");
    for (const gear of gears) {
      const place = host(`Curve of gear ${gear.gear}`);
      element.append(panel(`Gear ${gear.gear}: ${gear.kind}`, place, table(gear)));
      const graph = new CurveGraph(place, ["acceleration"], { height: 280, xLabel: "rpm", yLabel: "°/s²", xName: "Speed" });
      graph.draw([gear.points.map(({ speed }) => speed), gear.points.map(({ acceleration }) => acceleration)]);
      graphs.push(graph);
    }
  }
  read();
  return { element, end: () => graphs.forEach((graph) => graph.end()) };
}

const MOST_ROWS = 12;

/** So many of the points. */
function table({ gear, points }) {
  const step = Math.ceil(points.length / MOST_ROWS);
  const shown = points.filter((_, i) => i % step === 0 || i === points.length - 1);
  const rows = shown.map(({ speed, acceleration }) => h("tr", {}, [speed, acceleration].map((value) => h("td", { class: "number" }, short(value)))));
  const head = h("thead", {}, h("tr", {}, ["Speed in rpm", "Acceleration in °/s²"].map((title) => h("th", { scope: "col" }, title))));
  return h("details", {}, h("summary", {}, `Points of gear ${gear}`), h("table", {}, head, h("tbody", {}, rows)));
}
