// Zero offsets of the channel, with teach-in.
import { button, h, panel, say } from "../dom.js";
import { fixed, unitSign } from "../format.js";

const NAMES = ["G54", "G55", "G56", "G57", "G58", "G59"];
const nameOf = (index) => (index === 0 ? "G53" : NAMES[index - 1] || `G159=${index}`);

export function offsets(app) {
  const { store } = app;
  const axes = store.unit(store.channel)?.axes?.map((axis) => axis.name ?? axis) || store.of("axis").map((axis) => axis.name.toUpperCase());
  const rows = NAMES.map((name, i) => row(app, i + 1, name, axes));
  const head = h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Offset"), axes.map((axis) => h("th", { scope: "col" }, axis, " ", h("small", { class: "muted" }, unitOf(store, axis))))));
  const table = h("table", { class: "offsets" }, head, h("tbody", {}, rows.map((one) => one.element)));
  const [active, atStart] = [h("p", { class: "muted" }), h("p", { class: "muted" })];
  const element = panel(store.ofChannel("Zero offsets"), active, atStart, h("fieldset", { class: "commands" }, h("div", { class: "scroll" }, table)));

  const fill = (table) => {
    for (const { index, values, inactive } of table?.offsets || []) rows[index - 1]?.fill(values, inactive);
    if (table) say(atStart, `Programs start with ${nameOf(table.default)}.`);
  };
  const update = () => {
    const now = store.offsets[store.channel];
    const name = now && (now.zero_name || nameOf(now.zero_index));
    say(active, now ? `Active: ${name}. A new value counts when the offset is selected next.` : "A value counts when the offset is selected next.");
    rows.forEach((one, i) => one.element.classList.toggle("active", now?.zero_index === i + 1));
  };
  const ends = [store.on("offsets", update), store.on("zero_offsets", (table) => table.channel === store.channel && fill(table))];
  update();
  if (store.channel) app.request("offsets", { channel: store.channel }).then(fill);
  return { element, end: () => ends.forEach((end) => end()) };
}

/** mm or ° of an axis by its name in programs. */
function unitOf(store, name) {
  const axis = store.unit(store.channel)?.axes?.find((one) => one.name === name);
  return unitSign(store.unit(axis?.unit ?? name.toLowerCase())?.unit);
}

function row(app, index, name, axes) {
  const { channel } = app.store;
  const cells = axes.map((axis) => cell(app, index, name, axis));
  const teach = (axis) => app.command(channel, "teach_zero_offset", { index, ...(axis ? { axis } : {}), value: 0 }).then((answer) => answer && app.notices.show("info", `${name}: the present position is taught; it counts when ${name} is selected next.`));
  const all = button("Teach all", () => teach(), { class: "small", "aria-label": `Teach all axes of ${name}` });
  const one = (axis) => button("Teach", () => teach(axis), { class: "small", "aria-label": `Teach ${name} ${axis}` });
  return {
    element: h("tr", {}, h("th", { scope: "row" }, name, all), cells.map(({ element }, i) => h("td", {}, element, one(axes[i])))),
    fill: (values, inactive) => axes.forEach((axis, i) => axis in values && cells[i].take(values[axis], inactive.includes(axis))),
  };
}

/** Shows the value of the machine, but for what somebody is entering; what was refused is gone. */
function cell(app, index, name, axis) {
  const { channel } = app.store;
  const input = h("input", { type: "number", step: "any", "aria-label": `${name} ${axis}`, dataset: { axis } });
  let [known, asked] = [undefined, 0]; // of the machine; commands without an answer
  const show = () => (input.value = known === undefined ? "" : Number(known.toFixed(6)));
  input.addEventListener("change", async () => {
    const entered = input.value;
    asked += 1;
    const isSet = entered !== "" && (await app.command(channel, "set_zero_offset", { index, axis, value: Number(entered) }));
    asked -= 1;
    if (isSet) {
      known = Number(entered);
      app.notices.show("info", `${name} ${axis} = ${fixed(known, 3)}`);
    } else if (input.value === entered) show();
  });
  input.addEventListener("blur", () => asked || show());
  return {
    element: input,
    take(value, isInactive) {
      known = value;
      input.classList.toggle("inactive", isInactive);
      input.title = isInactive ? "does not count for this axis (G160)" : "";
      if (document.activeElement !== input) show();
    },
  };
}
