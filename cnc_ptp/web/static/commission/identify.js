// Identification of friction and dynamics on the machine file: its report, and accepting it into a file beside.
import { button, field, h, panel, say, select } from "../dom.js";
import { followTask } from "./task.js";

export function identifyView(app, unit) {
  const what = select([["friction", "Friction"], ["dynamics", "Dynamics"]]);
  const file = h("input", { value: `${unit.name}_identified.yaml`, spellcheck: "false" });
  const [report, values] = [h("pre", { tabIndex: 0, "aria-label": "Report" }), h("pre", { tabIndex: 0, "aria-label": "Identified values" })];
  const result = panel("Result", report, values, h("div", { class: "row end" }, field("New machine file", file, "Written beside the present one, which stays."), button("Accept", accept)));
  result.hidden = true;
  const task = followTask(app, (message) => {
    result.hidden = false;
    say(report, message.output || "");
    say(values, message.values || "");
  });

  function start() {
    result.hidden = true;
    task.begin("identify", { axis: unit.name, what: what.value });
  }
  async function accept() {
    const answer = await app.request("accept", { task: task.number, file: file.value });
    if (answer) app.notices.show("info", `${answer.file} is written.`);
  }
  const commands = h("fieldset", { class: "commands", dataset: { role: "commissioner" } }, h("div", { class: "row end" }, field("What", what), button("Start", start, { class: "primary" })));
  const element = h("div", { class: "stack" }, panel("Identify", h("p", { class: "muted" }, "On a simulation with the machine file of this machine, in a process of its own; the machine itself does not move."), commands, task.element), result);
  return { element, end: task.end };
}
