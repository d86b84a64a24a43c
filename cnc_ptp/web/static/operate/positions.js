// The position display: big digits of set or actual position, of the work or of the machine, and the distance to go.
import { h, panel, press, say, toggle } from "../dom.js";
import { fixed, unitSign } from "../format.js";

const DECIMALS = 3;

export function positions(app) {
  const { store } = app;
  let work = true;
  let actual = false;
  const show = () => {
    press(coordinates, !work);
    press(kind, actual);
    say(shown, `${work ? "Work" : "Machine"} coordinates, ${actual ? "actual" : "set"} values`);
    update();
  };
  const coordinates = toggle("Machine", () => ((work = !work), show()));
  const kind = toggle("Actual", () => ((actual = !actual), show()));
  const shown = h("span", { class: "muted" });
  const rows = store.of("axis").map((axis) => row(axis));
  const body = h("tbody", {}, rows.map((one) => one.element));
  const head = h("thead", {}, h("tr", {}, ["Axis", "Position", "To go", "Set", "Actual"].map((name) => h("th", { scope: "col" }, name))));
  const element = panel("Position", h("div", { class: "row" }, coordinates, kind, shown), h("div", { class: "scroll" }, h("table", { class: "positions" }, head, body)));

  function update() {
    for (const one of rows) one.update(store.state(one.name), work, actual);
  }
  const end = store.on("state", update);
  show();
  return { element, end };
}

function row(axis) {
  const [big, set, actual, rest, name] = [h("td", { class: "big number" }), h("td", { class: "number" }), h("td", { class: "number" }), h("td", { class: "number" }), h("th", { scope: "row" }, axis.name.toUpperCase(), h("small", {}, ` ${unitSign(axis.unit)}`))];
  const element = h("tr", { dataset: { axis: axis.name } }, name, big, rest, set, actual);
  return {
    name: axis.name,
    element,
    update(state, work, wantsActual) {
      const shift = work && typeof state.work_position === "number" ? state.work_position - state.set_position : 0;
      say(big, fixed((wantsActual ? state.actual_position : state.set_position) + shift, DECIMALS));
      say(set, fixed(state.set_position, DECIMALS));
      say(actual, fixed(state.actual_position, DECIMALS));
      say(rest, fixed(state.distance_to_go === undefined ? 0 : state.distance_to_go, DECIMALS));
      const mark = state.state === "ErrorStop" ? "bad" : state.state === "Disabled" ? "off" : "";
      if (element.dataset.mark !== mark) element.dataset.mark = mark;
      element.title = state.state || "";
    },
  };
}
