// Elements. Text goes in as text nodes only, so that nothing that a program or a machine file says becomes markup.

const PROPERTIES = new Set(["checked", "disabled", "value", "selected", "htmlFor", "hidden", "readOnly", "tabIndex", "open", "indeterminate"]);

/** An element: attributes, listeners (`onclick`), properties, and children (nodes and texts; null and false are left out). */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) set(element, name, value);
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

function set(element, name, value) {
  if (value === null || value === undefined) return;
  if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
  else if (name === "dataset") Object.assign(element.dataset, value);
  else if (PROPERTIES.has(name)) element[name] = value;
  else if (value === true) element.setAttribute(name, "");
  else if (value !== false) element.setAttribute(name, value);
}

/** The text of an element, written only when it differs. */
export function say(element, text) {
  const shown = String(text);
  if (element.textContent !== shown) element.textContent = shown;
}

/** `draw`, called once before the next frame however often it is asked for: a flood of messages draws a list once. */
export function oncePerFrame(draw) {
  let asked = 0;
  return () => {
    asked ||= requestAnimationFrame(() => {
      asked = 0;
      draw();
    });
  };
}

let last = 0;
export const newId = (stem = "f") => `${stem}${++last}`;

/** A label above its control. */
export function field(label, control, hint = "") {
  control.id ||= newId();
  const parts = [h("label", { htmlFor: control.id }, label), control];
  if (hint) {
    const text = h("small", { id: newId("hint") }, hint);
    control.setAttribute("aria-describedby", text.id);
    parts.push(text);
  }
  return h("div", { class: "field" }, parts);
}

/** The number in a field; null when it is empty or out of range, which the browser says beside it. */
export function numberOf(input) {
  input.required = true;
  return input.reportValidity() ? input.valueAsNumber : null;
}

export function panel(title, ...children) {
  const heading = h("h2", { id: newId("p") }, title);
  return h("section", { class: "panel", "aria-labelledby": heading.id }, heading, ...children);
}

export function button(text, onclick, attributes = {}) {
  return h("button", { type: "button", onclick, ...attributes }, text);
}

export function select(options, attributes = {}) {
  const rows = options.map((option) => (typeof option === "string" ? [option, option] : option));
  return h("select", attributes, rows.map(([value, text]) => h("option", { value }, text)));
}

/** A button that is on or off. */
export function toggle(text, onchange, attributes = {}) {
  const element = button(text, () => onchange(!isOn(element)), { "aria-pressed": "false", class: "toggle", ...attributes });
  return element;
}

const isOn = (element) => element.getAttribute("aria-pressed") === "true";

export function press(element, on) {
  const shown = String(Boolean(on));
  if (element.getAttribute("aria-pressed") !== shown) element.setAttribute("aria-pressed", shown);
}

/** Tabs of pages: `pages` is name -> function that fills an element and may return what ends it. */
export function tabs(label, pages, first = Object.keys(pages)[0]) {
  const list = h("div", { role: "tablist", "aria-label": label, class: "tabs" });
  const body = h("div", { role: "tabpanel", class: "tab-body", tabIndex: 0, id: newId("tab") });
  let end = null;
  const buttons = Object.keys(pages).map((name) =>
    h("button", { type: "button", role: "tab", id: newId("t"), "aria-controls": body.id, dataset: { name }, onclick: () => show(name) }, name),
  );
  list.append(...buttons);
  list.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const index = (buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length;
    buttons[index].focus();
    buttons[index].click();
    event.preventDefault();
  });

  function show(name) {
    end?.();
    for (const one of buttons) {
      const selected = one.dataset.name === name;
      one.setAttribute("aria-selected", String(selected));
      one.tabIndex = selected ? 0 : -1;
      if (selected) body.setAttribute("aria-labelledby", one.id);
    }
    body.replaceChildren();
    end = pages[name](body) || null;
  }
  show(first);
  return { element: h("div", { class: "tabbed" }, list, body), end: () => end?.(), show };
}

/** A value in a row: name, number, unit. Gives a function that shows another value. */
export function reading(parent, name, unit = "") {
  const value = h("output", { class: "number" }, "–");
  parent.append(h("div", { class: "reading" }, h("span", {}, name), value, h("span", { class: "unit" }, unit)));
  return (text) => say(value, text);
}
