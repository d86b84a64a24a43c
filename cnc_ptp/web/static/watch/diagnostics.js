// How the nodes of the machine do: lateness, buffers, CPU; following errors of the axes.
import { h, panel, say } from "../dom.js";
import { fixed } from "../format.js";

const COLUMNS = [
  ["lateness p99 [ms]", "Late p99 ms"], ["lateness, largest [ms]", "max ms"], ["lost blocks", "Lost blocks"],
  ["buffer of interpreted blocks, least [%]", "Buffer %"], ["cpu [%]", "CPU %"],
];
const LEVELS = ["", "warn", "bad", "off"];

export function diagnostics(app) {
  const { store } = app;
  const nodes = h("tbody", {});
  const none = h("p", { class: "muted" }, "No figures of nodes yet.");
  const head = h("thead", {}, h("tr", {}, [["", "Node"], ...COLUMNS, ["", "State"]].map(([, title]) => h("th", { scope: "col" }, title))));
  const table = h("div", { class: "scroll", tabIndex: 0, role: "region", "aria-label": "Figures of the nodes" }, h("table", {}, head, nodes));
  const errors = store.of("axis").map((axis) => follower(axis));
  const headOfAxes = h("thead", {}, h("tr", {}, ["Axis", "Following error", "Largest since the page is open"].map((title) => h("th", { scope: "col" }, title))));
  const element = panel("Diagnostics", none, table, h("table", {}, headOfAxes, h("tbody", {}, errors.map((one) => one.element))));

  function show() {
    const rows = [...store.nodes.values()];
    none.hidden = rows.length > 0;
    table.hidden = rows.length === 0;
    nodes.replaceChildren(...rows.map(({ name, level = 0, text = "", values = {} }) => {
      const state = h("span", { dataset: { kind: LEVELS[level] ?? "bad" } }, text);
      return h("tr", {}, h("th", { scope: "row" }, name), COLUMNS.map(([key]) => h("td", { class: "number" }, values[key] ?? "–")), h("td", {}, state));
    }));
  }
  const update = () => errors.forEach((one) => one.update(store.state(one.name)));
  const ends = [store.on("diagnostics", show), store.on("state", update)];
  show();
  return { element, end: () => ends.forEach((end) => end()) };
}

function follower({ name, unit }) {
  const [now, most] = [h("td", { class: "number" }), h("td", { class: "number" })];
  let largest = 0;
  return {
    name,
    element: h("tr", {}, h("th", { scope: "row" }, name.toUpperCase()), now, most),
    update({ following_error: error }) {
      if (typeof error !== "number") return;
      largest = Math.max(largest, Math.abs(error));
      say(now, `${fixed(error, 4)} ${unit}`);
      say(most, `${fixed(largest, 4)} ${unit}`);
    },
  };
}
