// The drive of an axis: parameters of the simulated one, and those of a SERCOS drive by number.
import { button, field, h, panel, say } from "../dom.js";
import { browser } from "./parameters.js";

export function driveView(app, unit) {
  const idn = h("input", { value: "S-0-0403", pattern: "S-0-[0-9]{4}", spellcheck: "false" });
  const value = h("input", { type: "number", step: 1 });
  const shown = h("output", { class: "number" });
  const read = async () => {
    const answer = await app.command(unit.name, "read_drive_parameter", { idn: idn.value });
    if (answer) say(shown, Object.entries(answer.values || {}).map(([name, one]) => `${name} = ${one}`).join(", ") || answer.warning || "read");
  };
  const write = () => value.value !== "" && app.command(unit.name, "write_drive_parameter", { idn: idn.value, value: Number(value.value) });
  const channel = panel("Service channel (SERCOS)", h("fieldset", { class: "commands", dataset: { role: "commissioner" } }, h("div", { class: "row end" }, field("IDN", idn), button("Read", read), field("Value", value), button("Write", write))), shown);
  const simulation = browser(app, unit, (row) => row.id.startsWith("P-SIM"), "Simulated drive");
  return { element: h("div", { class: "stack" }, simulation.element, channel), end: simulation.end };
}
