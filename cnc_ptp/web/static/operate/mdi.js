// Manual data input, with history (arrow keys) and completion (Tab).
import { h, newId, panel } from "../dom.js";

const [KEY, KEPT, OFFERED] = ["mdi", 100, 8];
const WORDS = ["G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G40", "G41", "G42", "G53", "G54", "G55", "G56", "G57", "G58", "G59", "G74", "G90", "G91", "G94", "G95", "G96", "G97", "M3", "M4", "M5", "M6", "M7", "M8", "M9", "M19", "M30", "#SET", "#CS ON", "#CS OFF", "#HSC", "#TRAFO"];

export function mdi(app) {
  let history = read();
  let place = history.length;
  const offers = h("ul", { role: "listbox", class: "offers", id: newId("offers"), "aria-label": "Completions", hidden: true });
  const input = h("input", { class: "mdi number", autocomplete: "off", spellcheck: "false", role: "combobox", "aria-autocomplete": "list", "aria-expanded": "false", "aria-controls": offers.id, "aria-label": "NC text to execute", placeholder: "G0 X10" });
  const form = h("form", { class: "row" }, input, h("button", { type: "submit" }, "Execute"));
  const element = panel(app.store.ofChannel("MDI"), h("fieldset", { class: "commands" }, form, offers));

  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const text = input.value.trim();
    if (!text) return;
    const answer = await app.command(app.store.channel, "mdi", { text });
    if (!answer) return;
    history = [...history.filter((line) => line !== text), text].slice(-KEPT);
    place = history.length;
    write(history);
    input.value = "";
    offer();
  });
  input.addEventListener("input", offer);
  input.addEventListener("blur", () => setTimeout(close, 150));
  input.addEventListener("keydown", (event) => {
    const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (step && !event.ctrlKey) {
      place = Math.min(Math.max(place + step, 0), history.length);
      input.value = history[place] ?? "";
      event.preventDefault();
    } else if (event.key === "Tab" && !offers.hidden) {
      take(offers.firstChild.textContent);
      event.preventDefault();
    } else if (event.key === "Escape") close();
  });

  function offer() {
    const found = completions(input.value, history);
    offers.replaceChildren(...found.map((text) => h("li", { role: "option", "aria-selected": "false", onpointerdown: (event) => (event.preventDefault(), take(text)) }, text)));
    offers.hidden = found.length === 0;
    input.setAttribute("aria-expanded", String(!offers.hidden));
  }

  function take(text) {
    input.value = text;
    close();
    input.focus();
  }

  function close() {
    offers.hidden = true;
    input.setAttribute("aria-expanded", "false");
  }
  return { element };
}

/** Whole lines of the history that begin so, and words that the last one may become. */
export function completions(text, history) {
  if (!text) return [];
  const upper = text.toUpperCase();
  const lines = [...history].reverse().filter((line) => line.toUpperCase().startsWith(upper) && line.length > text.length);
  const begin = text.lastIndexOf(" ") + 1;
  const word = upper.slice(begin);
  const words = word ? WORDS.filter((one) => one.startsWith(word) && one !== word).map((one) => text.slice(0, begin) + one) : [];
  return [...new Set([...lines, ...words])].slice(0, OFFERED);
}

function read() {
  try {
    const kept = JSON.parse(localStorage.getItem(KEY) || "[]");
    return Array.isArray(kept) ? kept.filter((line) => typeof line === "string") : [];
  } catch {
    return [];
  }
}

function write(history) {
  try {
    localStorage.setItem(KEY, JSON.stringify(history));
  } catch {
    // storage is blocked: the history lasts as long as the page
  }
}
