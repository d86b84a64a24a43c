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
  const lines = new Map(); // name of a parameter -> its line, which stays: what somebody types in it must outlive the writing of another

  let asked = 0;

  async function read() {
    const number = ++asked;
    try {
      const answer = await app.connection.http(`/api/parameters?unit=${encodeURIComponent(unit.name)}`);
      if (number === asked) take(answer.parameters.filter(wanted)); // an answer that was overtaken is old
    } catch (error) {
      say(status, error.message);
    }
  }

  function take(rows) {
    const known = lines.size;
    for (const row of rows) {
      if (!lines.has(row.name)) lines.set(row.name, new Line(app, unit, row));
      lines.get(row.name).take(row.value);
    }
    if (lines.size > known || !known) show();
  }

  function show() {
    const text = find.value.trim().toLowerCase();
    const found = [...lines.values()].filter((line) => (!change.value || line.row.change === change.value) && line.text.includes(text));
    body.replaceChildren(...found.slice(0, DRAWN).map((line) => line.element));
    say(status, found.length > DRAWN ? `${found.length} parameters; the first ${DRAWN} are shown` : `${found.length} parameters`);
  }
  find.addEventListener("input", show);
  change.addEventListener("change", show);
  read();
  return { element, end: app.store.on("parameters", (message) => message.unit === unit.name && read()) };
}

const known = (value) => (value === null || value === undefined ? "" : typeof value === "number" ? short(value, 10) : String(value));

/** A parameter: an input where the value may be changed while the machine runs. */
class Line {
  constructor(app, unit, row) {
    this.row = row;
    this.text = `${row.id} ${row.name} ${row.text} ${row.topic}`.toLowerCase(); // what Find looks in
    const isChangeable = (row.change === "now" || row.change === "standstill") && unit.kind === "axis" && ["number", "boolean"].includes(typeof row.value);
    this._value = isChangeable ? new Input(app, unit, row) : new Text();
    const range = row.range ? row.range : row.min !== undefined && row.min !== null ? `${known(row.min)} … ${known(row.max)}` : "";
    this.element = h(
      "tr", {}, h("th", { scope: "row" }, row.id, h("br"), h("small", { class: "muted" }, row.name)), h("td", { class: "number" }, this._value.element), h("td", {}, row.unit || ""), h("td", { class: "number" }, range),
      h("td", { class: "number" }, known(row.default)), h("td", {}, CHANGES[row.change] || CHANGES.start), h("td", {}, row.text || ""),
    );
  }

  take(value) {
    this._value.take(value);
  }
}

class Text {
  element = h("span", {});

  take(value) {
    say(this.element, known(value));
  }
}

/** Follows the value of the machine until somebody enters another. */
class Input {
  constructor(app, unit, row) {
    this._machine = ""; // the value of the machine
    const label = { "aria-label": `${row.id} ${row.name}` };
    const isSwitch = typeof row.value === "boolean";
    this._input = isSwitch ? select([["1", "true"], ["0", "false"]], label) : h("input", { type: "number", step: "any", value: "", min: row.min ?? null, max: row.max ?? null, ...label });
    this._input.value = "";
    const write = button("Write", () => this._write(app, unit, row), { class: "small", "aria-label": `Write ${row.id}` });
    this.element = h("span", { class: "row" }, this._input, write);
  }

  take(value) {
    const isEntered = this._input.value !== this._machine;
    this._machine = String(Number(value));
    if (!isEntered) this._input.value = this._machine;
  }

  async _write(app, unit, row) {
    const { value } = this._input;
    if (value === "") return;
    const isWritten = await app.command(unit.name, "write_parameter", { parameter: row.name || row.id, value: Number(value) });
    if (isWritten) {
      this._machine = String(Number(value));
      app.notices.show("info", `${row.id} = ${value} until the end of the run.`);
    }
    if (this._input.value === value) this._input.value = this._machine; // nobody has entered another meanwhile
  }
}
