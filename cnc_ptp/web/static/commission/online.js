// The Online view of an axis (TX1250 4.3) and of a spindle.
import { button, h, panel, reading } from "../dom.js";
import { fixed, percent, short, unitSign } from "../format.js";

const bit = (number) => (state) => Boolean(state.status_bits & (1 << number)) || (number === 31 && state.status_bits >= 2 ** 31);
/** Within the position window of the target, at rest or not. */
const inRange = (state, unit) => typeof state.target === "number" && Math.abs(state.actual_position - state.target) <= unit.limits.position_window;
const moves = (sign) => (state) => (state.set_velocity || 0) * sign > 1e-9;
/** Group -> [word, whether it is on, whether on is bad]. */
const BITS = {
  "Status, logical": [["Ready", (state) => !["Disabled", "ErrorStop", undefined].includes(state.state)], ["Referenced", (state) => !bit(18)(state)], ["Has job", bit(8)], ["Protected", bit(5)], ["Stopped", bit(7)], ["Coordinates shifted", bit(19)], ["Error", bit(31), true], ["Error delayed", bit(6), true]],
  "Status, physical": [["Not moving", (state) => Math.abs(state.set_velocity || 0) < 1e-9], ["Moving forward", moves(1)], ["Moving backward", moves(-1)], ["Constant velocity", bit(12)], ["In target position", bit(4)], ["In position range", inRange], ["Coupled", (state) => Boolean(state.master)], ["Compensating", bit(13)], ["External setpoints", bit(14)], ["Friction compensation", bit(16)]],
  Enabling: [["Controller", (state) => state.state !== "Disabled"], ["Feed forward", (state) => !bit(20)(state)], ["Feed backward", (state) => !bit(21)(state)], ["Waits for feed", bit(17), true]],
};

export function onlineAxis(app, unit) {
  const { store } = app;
  const length = unitSign(unit.unit);
  const [velocity, acceleration] = [unitSign(`${unit.unit}/s`), unitSign(`${unit.unit}/s^2`)];
  const lag = { min: Infinity, max: -Infinity };
  const list = h("div", { class: "readings" });
  const show = (name, sign, value) => {
    const write = reading(list, name, sign);
    return (state) => write(value(state));
  };
  const rows = [
    show("Set position", length, (state) => fixed(state.set_position, 4)),
    show("Actual position", length, (state) => fixed(state.actual_position, 4)),
    show("Target position", length, (state) => fixed(state.target, 4)),
    show("Distance to go", length, (state) => fixed(state.distance_to_go, 4)),
    show("Lag (following error)", length, (state) => fixed(state.following_error, 5)),
    show("Lag, smallest", length, () => fixed(lag.min, 5)),
    show("Lag, largest", length, () => fixed(lag.max, 5)),
    show("Set velocity", velocity, (state) => fixed(state.set_velocity, 3)),
    show("Actual velocity", velocity, (state) => fixed(state.velocity, 3)),
    show("Target velocity", velocity, (state) => fixed(state.target_velocity, 3)),
    show("Set acceleration", acceleration, (state) => fixed(state.set_acceleration, 1)),
    show("Override", "", (state) => percent(state.override, 1)),
    show("Control output", "", (state) => percent((100 * state.command_velocity) / (unit.limits?.reference_velocity || NaN), 2)),
    show("Velocity command", velocity, (state) => fixed(state.command_velocity, 3)),
    show("Torque", "Nm, N", (state) => short(state.torque)),
    show("Feedforward", "", (state) => percent(state.feedforward)),
    show("Kv", "1/s", () => short(unit.limits?.kv)),
    show("Kv, from lag", "1/s", (state) => (Math.abs(state.following_error) > 1e-6 ? short(state.set_velocity / state.following_error, 4) : "–")),
    show("Reference velocity", velocity, () => fixed(unit.limits?.reference_velocity, 2)),
    show("Largest velocity", velocity, () => fixed(unit.limits?.velocity, 2)),
    show("State", "", (state) => state.state || "–"),
    show("Coupled to", "", (state) => state.master || "–"),
    show("Error", "", (state) => (state.error ? `P-ERR-${String(state.error).padStart(5, "0")}` : "none")),
  ];
  const bits = Object.entries(BITS).map(([title, words]) => bitList(title, words));
  const resetLag = () => {
    [lag.min, lag.max] = [Infinity, -Infinity];
  };
  const act = (command, args) => () => app.command(unit.name, command, args);
  const commands = h("fieldset", { class: "commands" }, h("div", { class: "row" }, button("Enable", act("power", { enabled: true })), button("Disable", act("power", { enabled: false })), button("Reset", act("reset")), button("Home", act("home"))));
  const element = h(
    "div", { class: "cards" },
    panel(`Axis ${unit.name}`, list, h("div", { class: "row" }, button("Reset lag", resetLag), button("Halt", act("halt"))), commands),
    h("div", { class: "stack" }, bits.map((one) => one.element)),
  );
  function update() {
    const state = store.state(unit.name);
    if (typeof state.following_error === "number") {
      lag.min = Math.min(lag.min, state.following_error, state.lag_low ?? Infinity);
      lag.max = Math.max(lag.max, state.following_error, state.lag_high ?? -Infinity);
    }
    rows.forEach((row) => row(state));
    bits.forEach((one) => one.update(state, unit));
  }
  const end = store.on("state", update);
  update();
  return { element, end };
}

function bitList(title, words) {
  const items = words.map(([word, , isBad]) => h("li", { class: isBad ? "bad" : "" }, word, h("span", { class: "visually-hidden" })));
  return {
    element: panel(title, h("ul", { class: "bits" }, items)),
    update(state, unit) {
      words.forEach(([, isOn], i) => {
        const on = Boolean(isOn(state, unit));
        if (items[i].classList.contains("on") === on && items[i].lastChild.textContent) return;
        items[i].classList.toggle("on", on);
        items[i].lastChild.textContent = on ? ": on" : ": off";
      });
    },
  };
}

export function onlineSpindle(app, unit) {
  const { store } = app;
  const list = h("div", { class: "readings" });
  const show = (name, sign, value) => {
    const write = reading(list, name, sign);
    return (state) => write(value(state));
  };
  const yes = (value) => (value ? "yes" : "no");
  const rows = [
    show("Set speed", "rpm", (state) => fixed(state.set_speed, 2)),
    show("Actual speed", "rpm", (state) => fixed(state.speed, 2)),
    show("Programmed speed", "rpm", (state) => fixed(state.programmed_speed, 1)),
    show("Set position", "°", (state) => fixed(state.set_position, 3)),
    show("Actual position", "°", (state) => fixed(state.actual_position, 3)),
    show("Distance to go", "°", (state) => fixed(state.distance_to_go, 3)),
    show("Following error", "°", (state) => fixed(state.following_error, 4)),
    show("Override", "", (state) => percent(state.override, 1)),
    show("Gear", "", (state) => state.gear ?? "–"),
    show("Mode", "", (state) => (state.modes || []).join(", ") || "–"),
    show("Speed reached", "", (state) => yes(state.speed_reached)),
    show("At a standstill", "", (state) => yes(state.speed_zero)),
    show("In position", "", (state) => yes(state.in_position)),
    show("Referenced", "", (state) => yes(state.referenced)),
    show("Coupled to", "", (state) => state.master || "–"),
    show("State", "", (state) => state.state || "–"),
    show("Error", "", (state) => (state.error ? `P-ERR-${String(state.error).padStart(5, "0")}` : "none")),
  ];
  const update = () => rows.forEach((row) => row(store.state(unit.name)));
  const end = store.on("state", update);
  update();
  return { element: h("div", { class: "cards" }, panel(`Spindle ${unit.name}`, list)), end };
}
