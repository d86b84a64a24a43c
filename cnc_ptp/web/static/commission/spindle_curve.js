// The curve of a spindle: what its motor gives over the speed, with its points.
import { h, panel, say } from "../dom.js";
import { short } from "../format.js";
import { CurveGraph, host } from "../scope/graphs.js";

export function spindleCurve(app, unit) {
  const place = host(`Curve of spindle ${unit.name}`);
  const status = h("p", { class: "muted", role: "status" }, "Reading …");
  const table = h("div", { class: "scroll", tabIndex: 0, role: "region", "aria-label": "Points of the curve" });
  const element = panel("Curve", status, place, table);
  let graph = null;

  async function read() {
    let answer;
    try {
      answer = await app.connection.http(`/api/curve?spindle=${encodeURIComponent(unit.name)}`);
    } catch (error) {
      say(status, error.message);
      return;
    }
    const points = answer.points || [];
    if (points.length === 0) {
      say(status, "This spindle has no curve.");
      return;
    }
    const names = Object.keys(points[0]).filter((name) => name !== "speed" && typeof points[0][name] === "number");
    graph = new CurveGraph(place, names, { height: 320, xLabel: "rpm", xName: "Speed" });
    graph.draw([points.map((point) => point.speed), ...names.map((name) => points.map((point) => point[name]))]);
    say(status, `${points.length} points`);
    const rows = points.map((point) => h("tr", {}, ["speed", ...names].map((name) => h("td", { class: "number" }, short(point[name])))));
    table.append(h("table", {}, h("thead", {}, h("tr", {}, ["Speed in rpm", ...names].map((name) => h("th", { scope: "col" }, name)))), h("tbody", {}, rows)));
  }
  read();
  return { element, end: () => graph?.end() };
}
