// Spindle panel: speed, direction, gear, mode, orientation, coupling.
import { button, field, h, numberOf, panel, reading, select } from "../dom.js";
import { fixed } from "../format.js";

export function spindles(app) {
  const { store } = app;
  const views = store.of("spindle").map((unit) => view(app, unit));
  const tools = tool(app);
  const element = h("div", { class: "stack" }, views.map((one) => one.element), tools.element);
  const update = () => views.forEach((one) => one.update(store.state(one.name)));
  const end = store.on("state", update);
  update();
  return { element, end: () => [end, tools.end].forEach((one) => one()) };
}

function number(value, attributes = {}) {
  return h("input", { type: "number", value, step: "any", ...attributes });
}

function view(app, { name, limits }) {
  const list = h("div", { class: "readings" });
  const [set, actual, programmed, gear, mode, state] = [
    reading(list, "Set", "rpm"), reading(list, "Actual", "rpm"), reading(list, "Programmed", "rpm"), reading(list, "Gear"), reading(list, "Mode"), reading(list, "State"),
  ];
  const [position, master] = [reading(list, "Position", "°"), reading(list, "Coupled to")];
  const speed = number(1000, { min: 0 });
  const angle = number(0);
  const stage = select((limits?.gears || []).map(String));
  const others = app.store.of("spindle").filter((one) => one.name !== name).map((one) => one.name);
  const partner = select(others);
  const give = (command, args = {}) => () => app.command(name, command, args);
  /** A command with the number of a field; an empty one is not 0. */
  const giveNumber = (command, argument, input, args = {}) => () => {
    const value = numberOf(input);
    if (value !== null) app.command(name, command, { ...args, [argument]: value });
  };
  const start = (direction) => giveNumber("start", "speed_rpm", speed, { direction });
  const element = panel(
    `Spindle ${name}`, list,
    h("div", { class: "row" }, button("Stop", give("stop"))),
    h("fieldset", { class: "commands" },
      h("div", { class: "row end" }, field("Speed in rpm", speed), button("↻ cw", start("cw")), button("↺ ccw", start("ccw")), button("Set speed", giveNumber("set_speed", "speed_rpm", speed))),
      h("details", {}, h("summary", {}, "Orient, gear, coupling"),
        h("div", { class: "row end" }, field("Angle in °", angle), button("Orient", giveNumber("orient", "position_deg", angle)), button("Home", give("home"))),
        h("div", { class: "row end" }, field("Gear", stage), button("Select gear", () => app.command(name, "select_gear", { stage: Number(stage.value) })), button("Gear changed", give("gear_changed"))),
        others.length > 0 && h("div", { class: "row end" }, field("Master", partner), button("Couple", () => app.command(name, "couple", { master: partner.value })), button("Decouple", give("decouple"))),
        h("div", { class: "row" }, button("Enable", give("power", { enabled: true })), button("Disable", give("power", { enabled: false }))),
      ),
    ),
  );
  return {
    name,
    element,
    update(now) {
      set(fixed(now.set_speed, 1));
      actual(fixed(now.speed, 1));
      programmed(fixed(now.programmed_speed, 1));
      gear(now.gear || "–");
      mode((now.modes || []).join(", ") || "–");
      state(now.state || "–");
      position(fixed(modulo(now.actual_position), 2));
      master(now.master || "–");
    },
  };
}

const modulo = (angle) => (typeof angle === "number" ? ((angle % 360) + 360) % 360 : angle);

function tool(app) {
  const list = h("div", { class: "readings" });
  const [t, d] = [reading(list, "Tool (T)"), reading(list, "Compensation (D)")];
  const numbers = { T: "–", D: "–" };
  const noted = app.store.on("handshake", (request) => {
    if (request.channel === app.store.channel && request.kind in numbers) numbers[request.kind] = request.number;
  });
  const update = () => {
    const state = app.store.state(app.store.channel);
    t(state.tool ?? numbers.T);
    d(state.tool_data ?? numbers.D);
  };
  const ends = [noted, app.store.on("state", update)];
  update();
  return { element: panel(app.store.ofChannel("Tool"), list), end: () => ends.forEach((end) => end()) };
}
