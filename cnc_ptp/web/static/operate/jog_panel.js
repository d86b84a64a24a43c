// Jog of the axes: buttons that are held, and keys when they are switched on.
import { button, field, h, panel, press, toggle } from "../dom.js";
import { homeAll } from "./homing.js";

const KEYS = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1] };
const CONTROLS = "input, select, textarea, [role=listbox], [role=tab]";

export function jogPanel(app) {
  const { store, jogger } = app;
  const axes = store.of("axis");
  const share = h("input", { type: "range", min: 1, max: 100, value: 10 });
  const rapid = toggle("Rapid", (on) => press(rapid, on));
  const keysOn = toggle("Jog keys", (on) => press(keysOn, on));
  const on = (element) => element.getAttribute("aria-pressed") === "true";
  const shown = h("output", { class: "number" }, "10 %");
  share.addEventListener("input", () => (shown.textContent = `${share.value} %`));
  const velocity = (axis, sign, fast = false) => () => {
    const { rapid: fastest, velocity: largest, reference_velocity: reference } = axis.limits || {};
    const full = fastest || largest || reference || 10;
    return sign * full * (fast || on(rapid) ? 1 : Number(share.value) / 100);
  };
  const buttons = new Map();
  const rows = axes.map((axis) => {
    const held = [-1, 1].map((sign) => {
      const text = `${axis.name.toUpperCase()} ${sign < 0 ? "−" : "+"}`;
      const element = button(text, null, { class: "jog", "aria-label": `Jog ${text}`, dataset: { jog: axis.name, sign } });
      jogger.bind(element, axis.name, velocity(axis, sign));
      return element;
    });
    buttons.set(axis.name, held);
    return h("div", { class: "jog-row" }, held);
  });
  const power = (enabled) => async () => {
    for (const { name } of axes) await app.command(name, "power", { enabled });
  };
  let isShown = true;
  const home = () => homeAll(app, () => isShown);
  const element = panel(
    "Jog",
    h("fieldset", { class: "commands" },
      h("div", { class: "jogs" }, rows), field("Velocity, share of rapid", share), h("div", { class: "row" }, shown, rapid, keysOn),
      h("details", {}, h("summary", {}, "Enable, home"), h("div", { class: "row" }, button("Enable axes", power(true)), button("Disable axes", power(false)), button("Home axes", home))),
    ),
  );
  const ends = [jogKeys(jogger, axes, velocity, () => on(keysOn)), jogger.onChange((axis, now) => mark(buttons.get(axis), now))];
  ends.push(() => (isShown = false));
  return { element, end: () => ends.forEach((end) => end()) };
}

function mark(held, velocity) {
  held?.forEach((element) => element.classList.toggle("held", velocity * Number(element.dataset.sign) > 0));
}

function jogKeys(jogger, axes, velocity, isOn) {
  const rapid = new Set(); // axes that Shift has made rapid
  function down(event) {
    const key = KEYS[event.key];
    if (!key || !isOn() || document.querySelector("dialog[open]") || event.ctrlKey || event.altKey || event.metaKey || event.target.closest?.(CONTROLS)) return;
    event.preventDefault();
    const axis = axes[key[0]];
    if (!axis || event.repeat) return;
    if (event.shiftKey) rapid.add(axis.name);
    else rapid.delete(axis.name);
    jogger.start(axis.name, velocity(axis, key[1], event.shiftKey)());
  }
  function up(event) {
    if (event.key === "Shift") rapid.forEach((name) => jogger.stop(name));
    const key = KEYS[event.key];
    if (key && axes[key[0]]) jogger.stop(axes[key[0]].name);
  }
  document.addEventListener("keydown", down);
  document.addEventListener("keyup", up);
  return () => {
    jogger.stopAll();
    document.removeEventListener("keydown", down);
    document.removeEventListener("keyup", up);
  };
}
