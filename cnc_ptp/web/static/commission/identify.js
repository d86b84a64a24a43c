// Identification of friction and dynamics: progress, result, accepting it into a machine file beside.
import { button, field, h, panel, say, select } from "../dom.js";
import { short } from "../format.js";

export function identifyView(app, unit) {
  const { store } = app;
  const what = select([["friction", "Friction"], ["dynamics", "Dynamics"]]);
  const bar = h("progress", { max: 100, value: 0, "aria-label": "Progress of the identification" });
  const status = h("p", { class: "muted", role: "status" }, "The axis moves over its whole range.");
  const body = h("tbody", {});
  const head = h("thead", {}, h("tr", {}, ["Parameter", "Name", "Before", "Identified", "Unit"].map((title) => h("th", { scope: "col" }, title))));
  const file = h("input", { placeholder: "mill_identified.yaml" });
  const result = h("div", { class: "stack", hidden: true }, h("table", {}, head, body), h("div", { class: "row end" }, field("New machine file", file, "Beside the present one, which stays."), button("Accept", accept)));
  let task = null;

  async function start() {
    result.hidden = true;
    const answer = await app.request("identify", { axis: unit.name, what: what.value, options: {} });
    task = answer?.task ?? null;
    if (answer) say(status, "Started.");
  }
  async function accept() {
    const answer = await app.request("accept", { task, file: file.value });
    if (answer) app.notices.show("info", `${answer.file ?? file.value} is written.`);
  }
  const cancel = async () => {
    if (task !== null) await app.request("cancel_task", { task });
  };
  const ends = [
    store.on("progress", (message) => {
      if (message.task !== task) return;
      bar.value = message.percent;
      say(status, message.text || "");
    }),
    store.on("result", (message) => {
      if (message.task !== task) return;
      bar.value = 100;
      say(status, message.text || "Finished.");
      file.value = message.file || file.value;
      body.replaceChildren(...(message.values || []).map((one) => h("tr", {}, [one.id, one.name, short(one.before), short(one.value), one.unit].map((text) => h("td", {}, text ?? "")))));
      result.hidden = false;
    }),
  ];
  const element = panel("Identify", h("fieldset", { class: "commands", dataset: { role: "commissioner" } }, h("div", { class: "row end" }, field("What", what), button("Start", start, { class: "primary" }))), h("div", { class: "row" }, button("Cancel", cancel)), bar, status, result);
  return { element, end: () => ends.forEach((end) => end()) };
}
