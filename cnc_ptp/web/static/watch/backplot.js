// Backplot of the loaded program: the path coloured by feed or block, and the tool that moves through it.
import { button, h, panel, press, say, select, toggle } from "../dom.js";
import { fixed } from "../format.js";
import { PathScene } from "./scene.js";
import { measuredPath } from "./measured_path.js";
import { colours, geometry, pairsUpTo, readPath, scaleColour } from "./toolpath.js";

const TURN = 10; // degrees of a key
const NO_PROGRAM = 26242;
const PAUSE = 1000; // ms between two drawings of a program whose zero offsets change again and again
const CUT_OFF = 2; // flag: the program goes on

export function backplot(app) {
  const { store } = app;
  const canvas = h("canvas", { tabIndex: 0, role: "img", "aria-label": "Path of the program; arrow keys turn it, + and − zoom" });
  const host = h("div", { class: "view" }, canvas);
  const legend = h("div", { class: "legend" });
  const status = h("p", { class: "muted", role: "status" }, "No path yet.");
  const by = select([["feed", "Colour: feed"], ["block", "Colour: block"]], { "aria-label": "Colour of the path" });
  const views = select([["iso", "View: oblique"], ["top", "View: top (XY)"], ["front", "View: front (XZ)"], ["side", "View: side (YZ)"], ["turning", "View: turning (ZX)"]], { "aria-label": "View" });
  const done = toggle("Executed part only", (on) => (press(done, on), update()));
  const measured = toggle("Measured path", showMeasured);
  measured.hidden = !store.machine.recording;
  const element = panel(store.ofChannel("Backplot"), h("div", { class: "row" }, views, by, done, measured, button("Fit", () => scene?.look(views.value))), host, legend, status);
  element.classList.add("backplot");
  let [path, pairs, scene] = [null, null, null];
  try {
    scene = new PathScene(host, canvas);
  } catch {
    say(status, "This browser offers no WebGL, so there is no backplot.");
    return { element };
  }

  let loading = 0; // a later answer is not overwritten by an earlier one
  let [isOld, next] = [false, Infinity]; // the zero offsets have changed; when it may be drawn again for that

  async function load(keepsView = false) {
    const number = ++loading;
    [isOld, next] = [false, Infinity];
    const begin = performance.now();
    say(status, "The server draws the program …");
    let drawn;
    try {
      const bytes = await app.connection.http(`/api/backplot?channel=${encodeURIComponent(store.channel)}&page=${store.page}`, { as: "bytes" });
      drawn = readPath(bytes);
    } catch (error) {
      if (number !== loading) return;
      next = performance.now() + PAUSE;
      clear();
      say(status, error.number === NO_PROGRAM ? "No program is loaded." : error.message);
      return;
    }
    if (number !== loading) return;
    next = performance.now() + PAUSE;
    path = drawn;
    const shape = geometry(path);
    pairs = shape.pairs;
    scene.setPath(shape.positions, pairs, colour(), shape.box, keepsView);
    if (path.isTurning && !keepsView) turn("turning");
    scene.drawNow();
    element.dataset.ms = Math.round(performance.now() - begin);
    say(status, `${path.flags & CUT_OFF ? "Not to its end: " : ""}${(pairs.length / 2).toLocaleString("en")} segments · ${[0, 1, 2].map((k) => `${"XYZ"[k]} ${fixed(shape.box.min[k], 1)} … ${fixed(shape.box.max[k], 1)}`).join(" · ")} mm`);
  }

  /** No path: an old one would be taken for that of the program. */
  function clear() {
    [path, pairs] = [null, null];
    scene.setPath(new Float32Array(0), new Uint32Array(0), new Uint8Array(0), { min: [0, 0, 0], max: [1, 1, 1] });
    legend.replaceChildren();
    delete element.dataset.ms;
  }

  function colour() {
    const { bytes, fastest, last } = colours(path, by.value);
    const marks = by.value === "feed" ? [["rapid", null], ...[0.25, 0.5, 0.75, 1].map((share) => [`${Math.round(share * fastest)} mm/min`, share])] : [0, 0.5, 1].map((share) => [`line ${Math.max(1, Math.round(share * last))}`, share]);
    legend.replaceChildren(...marks.map(([text, share]) => h("span", {}, swatch(share), text)));
    return bytes;
  }

  function swatch(share) {
    const mark = h("span", { class: "swatch" });
    const rgb = share === null ? [0.55, 0.6, 0.66] : scaleColour(share);
    mark.style.background = `rgb(${rgb.map((value) => Math.round(value * 255)).join(" ")})`;
    return mark;
  }

  async function showMeasured(on) {
    press(measured, on);
    scene?.setTrail(on ? await app.attempt(measuredPath(app)) : null);
  }

  function turn(view) {
    views.value = view;
    scene.look(view);
  }

  /** The tool, and how far the path is done. */
  function update() {
    const axes = placesOf(store);
    scene.setTool(...axes);
    const { line, active } = store.state(store.channel);
    if (isOld && performance.now() > next) load(active);
    if (!path) return;
    const only = done.getAttribute("aria-pressed") === "true" && active;
    scene.setShown(only ? pairsUpTo(path, pairs, line) : pairs.length / 2);
  }

  views.addEventListener("change", () => scene.look(views.value));
  by.addEventListener("change", () => path && scene.setColours(colour()));
  canvas.addEventListener("keydown", (event) => {
    const act = { ArrowLeft: () => scene.rotate(-TURN), ArrowRight: () => scene.rotate(TURN), ArrowUp: () => scene.tilt(TURN), ArrowDown: () => scene.tilt(-TURN), "+": () => scene.zoom(1.2), "-": () => scene.zoom(1 / 1.2) }[event.key];
    if (!act) return;
    act();
    event.preventDefault();
  });
  const theme = () => scene.setTheme();
  window.addEventListener("theme", theme);
  const ends = [store.on("state", update), store.on("program", ({ channel }) => channel === store.channel && load()), store.on("zero_offsets", ({ channel }) => (isOld ||= channel === store.channel)), () => window.removeEventListener("theme", theme), () => (loading += 1), () => scene.end()];
  element.scene = scene;
  load();
  update();
  return { element, end: () => ends.forEach((end) => end()) };
}

/** X, Y, Z of the tool where the path is drawn: in machine coordinates, without offsets; of a lathe X is across. */
function placesOf(store) {
  const axes = store.unit(store.channel)?.axes || store.of("axis").map(({ name }) => ({ unit: name, name: name.toUpperCase() }));
  return ["X", "Y", "Z"].map((name) => {
    const axis = axes.find((one) => one.name === name);
    return axis ? store.state(axis.unit).set_position ?? 0 : 0;
  });
}
