// Circle test: two axes go round by MDI; the deviation of the radius as a polar plot.
import { button, field, h, numberOf, panel, reading, say, select } from "../dom.js";
import { pause } from "../motion.js";
import { short } from "../format.js";
import { host, PlaneGraph } from "../scope/graphs.js";
import { Capture } from "../scope/capture.js";
import { fitCircle, polar } from "./circle.js";
import { followTask } from "./task.js";

const PLANES = { XY: ["G17", "I"], XZ: ["G18", "I"], YZ: ["G19", "J"] };
const LONGEST = 100; // s, so that the ring has all of it

export function circleTest(app) {
  const { store } = app;
  const { channel } = store; // also when another one is chosen meanwhile
  const names = Object.fromEntries((store.unit(channel)?.axes || []).map(({ unit, name }) => [name, unit]));
  const planes = Object.keys(PLANES).filter((plane) => [...plane].every((axis) => names[axis]));
  if (planes.length === 0) return { element: h("p", { class: "muted" }, "The channel has no two of the axes X, Y, Z.") };
  const plane = select(planes);
  const usual = store.unit(channel).turning ? "G18" : "G17"; // the plane is the one of the machine afterwards
  const radius = h("input", { type: "number", min: 0.1, step: "any", value: 20 });
  const feed = h("input", { type: "number", min: 1, step: "any", value: 2000 });
  const direction = select([["G3", "counter-clockwise (G3)"], ["G2", "clockwise (G2)"]]);
  const factor = h("input", { type: "number", min: 1, step: "any", value: 500 });
  const status = h("p", { class: "muted", role: "status" }, "The circle begins and ends where the axes are; its centre lies beside.");
  const list = h("div", { class: "readings" });
  const [r, least, most, round] = [reading(list, "Radius (least squares)", "mm"), reading(list, "Smallest deviation", "µm"), reading(list, "Largest deviation", "µm"), reading(list, "Roundness, peak to peak", "µm")];
  const place = host("Polar plot of the deviations");
  const graph = new PlaneGraph(place, ["actual", "circle"], { height: 460, equal: true, xLabel: "mm" });
  const capture = new Capture(app);
  let points = null;

  let isEnded = false;

  async function start() {
    const [size, velocity] = [numberOf(radius), numberOf(feed)];
    if (size === null || velocity === null) return null;
    const time = (2 * 2 * Math.PI * size * 60) / velocity;
    if (time > LONGEST) return say(status, `Two turns take ${Math.round(time)} s, longer than ${LONGEST} s.`);
    const units = [...plane.value].map((axis) => names[axis]);
    capture.channels = [...units.map((unit) => ({ name: `${unit}.actual_position` })), { name: `${channel}.path_velocity` }];
    await capture.subscribe();
    const [word, centre] = PLANES[plane.value];
    const turn = `${direction.value} ${centre}${size} F${velocity}`; // a full circle: no target, so G90 or G91 does not matter
    const text = `${word}\n${turn}\n${turn}\n${usual}`;
    if (!(await app.command(channel, "mdi", { text }))) return null;
    say(status, "Measuring …");
    await pause(300);
    while (!isEnded && store.state(channel).active) await pause(100);
    await pause(200);
    if (!isEnded) evaluate();
    return null;
  }

  /** The middle of two turns: without start and end. */
  function evaluate() {
    const { ring } = capture;
    const speeds = ring.slice(2, ring.begin, ring.end);
    const moving = [...speeds.keys()].filter((i) => speeds[i] > 0);
    if (moving.length < 10) return say(status, "No motion was seen.");
    const [first, last] = [moving[0], moving.at(-1)];
    const [from, to] = [first + Math.round((last - first) * 0.25), first + Math.round((last - first) * 0.75)];
    points = [0, 1].map((i) => Array.from(ring.slice(i, ring.begin + from, ring.begin + to)));
    return show();
  }

  function show() {
    if (!points) return;
    const circle = fitCircle(...points);
    if (!circle) return say(status, "The points are on no circle.");
    const found = polar(...points, circle, Number(factor.value));
    const angles = Array.from({ length: 181 }, (_, i) => (i * Math.PI) / 90);
    graph.draw([found.points, [angles.map((angle) => circle.radius * Math.cos(angle)), angles.map((angle) => circle.radius * Math.sin(angle))]]);
    r(short(circle.radius, 7));
    least(short(found.least * 1000, 4));
    most(short(found.most * 1000, 4));
    round(short((found.most - found.least) * 1000, 4));
    return say(status, `Deviations are drawn ${factor.value} times as large.`);
  }
  factor.addEventListener("change", show);
  const offline = simulated(app, () => ({ plane: plane.value === "XZ" ? "ZX" : plane.value, radius: numberOf(radius), feed: numberOf(feed) }));
  const element = h(
    "div", { class: "cards" },
    panel("Circle test", h("fieldset", { class: "commands" }, h("div", { class: "row end" }, field("Plane", plane), field("Direction", direction), field("Radius in mm", radius), field("Feed in mm/min", feed), button("Start", start, { class: "primary" }))), field("Deviations drawn so many times as large", factor), status, list),
    panel("Polar plot", place),
    offline.element,
  );
  return {
    element,
    end() {
      isEnded = true;
      offline.end();
      capture.end();
      graph.end();
    },
  };
}

/** The same test on a simulation with the machine file; its picture has both directions and the criteria of ISO 230-4. */
function simulated(app, options) {
  const picture = h("img", { alt: "Polar plot of the simulated circle test", class: "picture", hidden: true });
  const report = h("pre", { tabIndex: 0, "aria-label": "Report", hidden: true });
  const task = followTask(app, (message) => {
    URL.revokeObjectURL(picture.src);
    picture.src = URL.createObjectURL(new Blob([message.picture || ""], { type: "image/svg+xml" }));
    picture.hidden = !message.picture;
    say(report, message.output || "");
    report.hidden = !message.output;
  });
  const start = h("fieldset", { class: "commands", dataset: { role: "commissioner" } }, button("Simulate", () => {
    const given = options();
    if (given.radius !== null && given.feed !== null) task.begin("circle", given);
  }));
  return {
    element: panel("On a simulation", start, task.element, picture, report),
    end() {
      task.end();
      URL.revokeObjectURL(picture.src);
    },
  };
}
