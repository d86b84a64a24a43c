// Jog of the axes: buttons that are held, and keys when they are switched on.
import { button, field, h, panel, press, toggle } from "../dom.js";
import { homeAll } from "./homing.js";
import { axesOfKeys, jogKeys, PAIRS } from "./jog_keys.js";

export function jogPanel(app) {
  const { store, jogger } = app;
  const axes = store.of("axis");
  const ofKeys = axesOfKeys(axes);
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
    const keys = PAIRS[ofKeys.indexOf(axis)] || [];
    const held = [-1, 1].map((sign) => {
      const text = `${axis.name.toUpperCase()} ${sign < 0 ? "−" : "+"}`;
      const [key, label] = keys[sign < 0 ? 0 : 1] || [];
      const element = button(text, null, { class: "jog", "aria-label": `Jog ${text}`, "aria-keyshortcuts": key, dataset: { jog: axis.name, sign } });
      if (key) element.append(h("small", { class: "muted", title: key, "aria-hidden": "true" }, ` ${label}`));
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
  const ends = [jogKeys(jogger, ofKeys, velocity, () => on(keysOn)), jogger.onChange((axis, now) => mark(buttons.get(axis), now))];
  ends.push(() => (isShown = false));
  return { element, end: () => ends.forEach((end) => end()) };
}

function mark(held, velocity) {
  held?.forEach((element) => element.classList.toggle("held", velocity * Number(element.dataset.sign) > 0));
}
