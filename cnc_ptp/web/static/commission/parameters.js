// Parameters of a unit: values, ranges, and which may be changed while the machine runs.
import { button, field, h, panel, say, select } from "../dom.js";
import { short } from "../format.js";

const CHANGES = { now: "now", standstill: "at a standstill", start: "at start-up" };
const DRAWN = 300; // rows at once

export function parameterBrowser(app, unit) {
  return browser(app, unit, () => true, "Parameters");
}

/** `wanted`: which parameters are shown. */
export function browser(app, unit, wanted, title) {
  const find = h("input", { type: "search", placeholder: "Kv, P-AXIS-00099, limit …" });
  const change = select([["", "all"], ["now", "now"], ["standstill", "at a standstill"], ["start", "at start-up"]]);
  const body = h("tbody", {});
  const head = h("thead", {}, h("tr", {}, ["Parameter", "Value", "Unit", "Range", "Default", "Changes", "Meaning"].map((text) => h("th", { scope: "col" }, text))));
  const status = h("p", { class: "muted", role: "status" }, "Reading …");
  const table = h("div", { class: "scroll", tabIndex: 0, role: "region", "aria-label": `Table of ${title.toLowerCase()} of ${unit.name}` }, h("table", { class: "parameters" }, head, body));
  const element = panel(title, h("div", { class: "row end" }, field("Find", find), field("Changes", change)), status, h("fieldset", { class: "commands", dataset: { role: "commissioner" } }, table));
  let rows = [];

  async function read() {
    try {
      const answer = await app.connection.http(`/api/parameters?unit=${encodeURIComponent(unit.name)}`);
      rows = answer.parameters.filter(wanted);
    } catch (error) {
      say(status, error.message);
      return;
    }
    show();
  }

  function show() {
    const text = find.value.trim().toLowerCase();
    const found = rows.filter((row) => (!change.value || row.change === change.value) && (!text || `${row.id} ${row.name} ${row.text} ${row.topic}`.toLowerCase().includes(text)));
    body.replaceChildren(...found.slice(0, DRAWN).map((row) => line(app, unit, row)));
    say(status, found.length > DRAWN ? `${found.length} parameters; the first ${DRAWN} are shown` : `${found.length} parameters`);
  }
  find.addEventListener("input", show);
  change.addEventListener("change", show);
  read();
  return { element, end: app.store.on("parameters", (message) => message.unit === unit.name && read()) };
}

function line(app, unit, row) {
  const known = (value) => (value === null || value === undefined ? "" : typeof value === "number" ? short(value, 10) : String(value));
  const range = row.range ? row.range : row.min !== undefined && row.min !== null ? `${known(row.min)} … ${known(row.max)}` : "";
  return h(
    "tr", {}, h("th", { scope: "row" }, row.id, h("br"), h("small", { class: "muted" }, row.name)), h("td", { class: "number" }, value(app, unit, row, known)), h("td", {}, row.unit || ""), h("td", { class: "number" }, range),
    h("td", { class: "number" }, known(row.default)), h("td", {}, CHANGES[row.change] || CHANGES.start), h("td", {}, row.text || ""),
  );
}

/** An input where the value may be changed while the machine runs. */
function value(app, unit, row, known) {
  const isChangeable = (row.change === "now" || row.change === "standstill") && unit.kind === "axis" && ["number", "boolean"].includes(typeof row.value);
  if (!isChangeable) return known(row.value);
  const isSwitch = typeof row.value === "boolean";
  const label = `${row.id} ${row.name}`;
  const input = isSwitch ? select([["1", "true"], ["0", "false"]], { "aria-label": label }) : h("input", { type: "number", step: "any", value: row.value, min: row.min ?? null, max: row.max ?? null, "aria-label": label });
  if (isSwitch) input.value = String(Number(row.value));
  const write = async () => {
    if (input.value === "") return;
    const answer = await app.command(unit.name, "write_parameter", { parameter: row.name || row.id, value: Number(input.value) });
    if (!answer) input.value = String(Number(row.value));
    else {
      app.notices.show("info", `${row.id} = ${input.value} until the end of the run.`);
    }
  };
  return h("span", { class: "row" }, input, button("Write", write, { class: "small", "aria-label": `Write ${row.id}` }));
}
