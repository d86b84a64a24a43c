// Overrides of channels, spindles and axes: a slider each, with keys.
import { button, h, newId, panel, say } from "../dom.js";
import { percent } from "../format.js";

const PERIOD = 100; // ms between two commands while a slider moves
const HELD = 800; // ms after which the slider shows the machine again

export function overrides(app) {
  const { store } = app;
  const rows = [
    ...store.of("channel").map((unit) => row(app, unit.name, store.hasSeveralChannels ? `Feed ${unit.name}` : "Feed", unit.limits?.override || 200)),
    ...store.of("spindle").map((unit) => row(app, unit.name, `Spindle ${unit.name}`, unit.limits?.override || 200)),
    ...store.of("axis").map((unit) => row(app, unit.name, `PTP ${unit.name.toUpperCase()}`, unit.limits?.override || 200)),
  ];
  const main = rows.filter((one) => !one.ofAxis(store));
  const axes = rows.filter((one) => one.ofAxis(store));
  const more = h("details", {}, h("summary", {}, "Axes (PTP)"), axes.map((one) => one.element));
  const element = panel("Override", h("fieldset", { class: "commands" }, main.map((one) => one.element), axes.length ? more : null));
  const update = () => rows.forEach((one) => one.update(store.state(one.name)));
  const end = store.on("state", update);
  update();
  return { element, end };
}

function row(app, name, title, largest) {
  const id = newId("override");
  const slider = h("input", { type: "range", id, min: 0, max: largest, step: 1, value: 100 });
  const shown = h("output", { class: "number", for: id });
  let touched = -Infinity;
  let timer = 0;
  const send = () => {
    timer = 0;
    app.command(name, "set_override", { percent: Number(slider.value) });
  };
  slider.addEventListener("input", () => {
    touched = performance.now();
    say(shown, percent(Number(slider.value)));
    timer ||= setTimeout(send, PERIOD);
  });
  const full = button("100 %", () => app.command(name, "set_override", { percent: 100 }), { class: "small", "aria-label": `${title} 100 %` });
  return {
    name,
    element: h("div", { class: "override", dataset: { unit: name } }, h("label", { htmlFor: id }, title), slider, shown, full),
    ofAxis: (store) => store.unit(name)?.kind === "axis",
    update(state) {
      if (performance.now() - touched < HELD || typeof state.override !== "number") return;
      if (Number(slider.value) !== state.override) slider.value = state.override;
      say(shown, percent(state.override));
    },
  };
}
