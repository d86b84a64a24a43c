// A form for each command of a unit, made of what the server says about its arguments.
import { field, h, panel, select } from "../dom.js";
import { argumentUnit } from "../format.js";

/** `names` that the server knows and pages may give. */
export function commandForms(app, unit, names) {
  const known = app.store.machine.commands?.[unit.kind] || {};
  const forms = names.filter((name) => name in known).map((name) => form(app, unit, name, known[name]));
  const none = h("p", { class: "muted" }, "The server offers none of these functions.");
  return { element: forms.length ? h("div", { class: "cards" }, forms) : none };
}

function form(app, unit, command, specification) {
  const inputs = Object.entries(specification).map(([name, argument]) => [name, argument, control(argument)]);
  const element = h(
    "form", {},
    inputs.map(([name, argument, input]) => field(label(name, argument, unit), input, argument.meaning + (argument.left_out ? `; empty: ${argument.left_out}` : ""))),
    h("button", { type: "submit" }, words(command)),
  );
  element.addEventListener("submit", async (event) => {
    event.preventDefault();
    let args;
    try {
      args = collect(inputs);
    } catch (error) {
      app.notices.show("error", error.message);
      return;
    }
    const answer = await app.command(unit.name, command, args);
    if (answer) app.notices.show("info", `${unit.name}: ${words(command)} acts at cycle ${answer.cycle ?? "–"}.`);
  });
  return panel(words(command), h("fieldset", { class: "commands" }, element));
}

function label(name, argument, unit) {
  const sign = argumentUnit(argument, unit);
  return words(name) + (sign ? ` in ${sign}` : "") + (argument.required ? "" : " (optional)");
}

const words = (name) => name.replaceAll("_", " ");

function control({ kind, required, choices }) {
  if (choices?.length) return select([...(required ? [] : [["", "–"]]), ...choices.map((one) => [String(one), String(one)])]);
  if (kind === "switch") return select([...(required ? [] : [["", "–"]]), ["on", "on"], ["off", "off"]]);
  if (kind === "number" || kind === "integer") return h("input", { type: "number", step: kind === "integer" ? 1 : "any", required });
  if (kind === "rows" || kind === "list") return h("textarea", { rows: 3, required, placeholder: "[[0, 0], [90, 25], [180, 0]]", spellcheck: "false" });
  return h("input", { required, spellcheck: "false" });
}

/** What was filled in. Throws Error for rows that are no JSON. */
function collect(inputs) {
  const args = {};
  for (const [name, { kind }, input] of inputs) {
    if (input.value === "") continue;
    if (kind === "switch") args[name] = input.value === "on";
    else if (kind === "number" || kind === "integer") args[name] = Number(input.value);
    else if (kind === "rows" || kind === "list") args[name] = rows(name, input.value);
    else args[name] = input.value;
  }
  return args;
}

function rows(name, text) {
  try {
    return JSON.parse(text);
  } catch {
    throw new Error(`${words(name)} is not a list such as [[0, 0], [90, 25]].`);
  }
}
