// The curve of a spindle: the acceleration that each of its gears gives over the speed, with its break points.
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
    if (gears.length) status.remove();
    else say(status, "This spindle has no curve.");
    for (const gear of gears) {
      const place = host(`Curve of gear ${gear.gear}`);
      element.append(panel(`Gear ${gear.gear}: ${gear.kind}`, place, table(gear)));
      const dots = gear.points.some((point) => point.break) ? "break points" : "";
      const graph = new CurveGraph(place, ["acceleration"], { height: 280, xLabel: "rpm", yLabel: "°/s²", xName: "Speed", dots });
      const columns = [gear.points.map(({ speed }) => speed), gear.points.map(({ acceleration }) => acceleration)];
      graph.draw(dots ? [...columns, gear.points.map((point) => (point.break ? point.acceleration : null))] : columns);
      graphs.push(graph);
    }
  }
  read();
  return { element, end: () => graphs.forEach((graph) => graph.end()) };
}

const MOST_ROWS = 12;

/** The break points, and so many of the others. */
function table({ gear, points }) {
  const step = Math.ceil(points.length / MOST_ROWS);
  const shown = points.filter((point, i) => point.break || i % step === 0 || i === points.length - 1);
  const rows = shown.map((point) => h("tr", {}, [point.speed, point.acceleration].map((value) => h("td", { class: "number" }, short(value, 7))), h("td", {}, point.break ? "break point" : "")));
  const head = h("thead", {}, h("tr", {}, ["Speed in rpm", "Acceleration in °/s²", "Kind"].map((title) => h("th", { scope: "col" }, title))));
  return h("details", {}, h("summary", {}, `Points of gear ${gear}`), h("table", {}, head, h("tbody", {}, rows)));
}
