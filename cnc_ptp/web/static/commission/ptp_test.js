// PTP test: an axis goes to and fro between two positions, with the scope beside.
import { button, field, h, numberOf, panel, press, say, toggle } from "../dom.js";
import { argumentUnit, unitSign } from "../format.js";
import { arrived } from "../motion.js";
import { liveScope } from "./live_scope.js";

export function ptpTest(app, unit) {
  const { store } = app;
  const [low, high] = unit.limits?.positions || [];
  const known = store.machine.commands?.axis?.move_absolute || {};
  const about = (name) => known[name === "first" || name === "second" ? "target" : name] || {};
  const numbers = {
    first: ["Position 1", clamp(0, low, high)], second: ["Position 2", clamp(50, low, high)], velocity: ["Velocity", ""], acceleration: ["Acceleration", ""], deceleration: ["Deceleration", ""], jerk: ["Jerk", ""],
  };
  const inputs = Object.fromEntries(Object.entries(numbers).map(([name, [, value]]) => [name, h("input", { type: "number", step: "any", value })]));
  const override = h("input", { type: "number", min: 0, max: unit.limits?.override || 200, step: 1, value: 100 });
  override.addEventListener("change", () => {
    const percent = numberOf(override);
    if (percent !== null) app.command(unit.name, "set_override", { percent });
  });
  const status = h("p", { class: "muted", role: "status" }, "Not started.");
  const repeat = toggle("Repeat", (on) => press(repeat, on));
  const scope = liveScope(app, [[`${unit.name}.set_position`, 1], [`${unit.name}.actual_position`, 1], [`${unit.name}.set_velocity`, 2], [`${unit.name}.following_error`, 3]]);
  const label = (text, name) => `${text} in ${argumentUnit(about(name), unit) || unitSign(unit.unit)}`;
  let active = false;

  async function start() {
    const ends = [numberOf(inputs.first), numberOf(inputs.second)];
    if (active || ends.includes(null)) return;
    active = true;
    let strokes = 0;
    const repeats = () => repeat.getAttribute("aria-pressed") === "true";
    do {
      for (const target of ends) {
        if (!active || !(await stroke(target))) return finish();
        strokes += 1;
        say(status, `${strokes} stroke${strokes === 1 ? "" : "s"}`);
      }
    } while (active && repeats());
    finish();
  }

  /** Whether the axis has arrived. */
  async function stroke(target) {
    const given = ["velocity", "acceleration", "deceleration", "jerk"].filter((name) => inputs[name].value !== "");
    const args = { target, ...Object.fromEntries(given.map((name) => [name, Number(inputs[name].value)])) };
    if (!(await app.command(unit.name, "move_absolute", args))) return false;
    return arrived(store, unit.name, () => active);
  }

  function finish() {
    active = false;
  }
  const stop = () => {
    finish();
    app.command(unit.name, "halt");
  };
  const element = h(
    "div", { class: "beside" },
    panel(
      "To and fro",
      h("fieldset", { class: "commands" }, h("div", { class: "row end" }, Object.entries(numbers).map(([name, [text]]) => field(label(text, name), inputs[name], about(name).left_out ? `empty: ${about(name).left_out}` : "")), field("Override in %", override)), h("div", { class: "row" }, button("Start", start, { class: "primary" }), repeat)),
      h("div", { class: "row" }, button("Stop", stop)), status,
    ),
    scope.element,
  );
  return {
    element,
    end() {
      if (active) stop();
      scope.end();
    },
  };
}

const clamp = (value, low, high) => Math.min(Math.max(value, low ?? -Infinity), high ?? Infinity);
