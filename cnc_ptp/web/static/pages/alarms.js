// Alarms, their history, and all events.
import { h, panel } from "../dom.js";
import { fixed } from "../format.js";
import { alarmList } from "../watch/alarm_list.js";

export function mount(root, app) {
  const open = alarmList(app, { title: "Open alarms" });
  const history = alarmList(app, { title: "Acknowledged", history: true });
  const list = events(app);
  root.append(open.element, history.element, list.element);
  return { unmount: () => [open, history, list].forEach((view) => view.end()) };
}

function events(app) {
  const { store } = app;
  const body = h("tbody", {});
  const head = h("thead", {}, h("tr", {}, ["Time", "Source", "Event"].map((title) => h("th", { scope: "col" }, title))));
  const table = h("div", { class: "scroll events", tabIndex: 0, role: "region", "aria-label": "List of events" }, h("table", {}, head, body));
  const row = (event) => h("tr", {}, h("td", { class: "number" }, `${fixed(event.time, 3)} s`), h("td", {}, event.source), h("td", {}, event.text));
  const fill = () => body.replaceChildren(...[...store.events].reverse().map(row));
  const add = (event) => {
    body.prepend(row(event));
    while (body.children.length > 500) body.lastChild.remove();
  };
  const ends = [store.on("event", add), store.on("past", fill)];
  fill();
  return { element: panel("Events", table), end: () => ends.forEach((end) => end()) };
}
