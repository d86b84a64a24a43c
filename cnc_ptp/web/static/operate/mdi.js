// Manual data input, with history (arrow keys) and completion (Tab).
import { h, newId, panel } from "../dom.js";
import { unitSign } from "../format.js";

const [KEY, KEPT, OFFERED] = ["mdi", 100, 8];

export function mdi(app) {
  let history = read();
  let place = history.length;
  const offers = h("ul", { role: "listbox", class: "offers", id: newId("offers"), "aria-label": "Completions", hidden: true });
  const input = h("input", { class: "mdi number", autocomplete: "off", spellcheck: "false", role: "combobox", "aria-autocomplete": "list", "aria-expanded": "false", "aria-controls": offers.id, "aria-label": "NC text to execute", placeholder: "G0 X10" });
  const form = h("form", { class: "row" }, input, h("button", { type: "submit" }, "Execute"));
  const element = panel(app.store.ofChannel("MDI"), h("fieldset", { class: "commands" }, form, offers));
  let words = axisWords(app.store);
  input.addEventListener("focus", learn, { once: true });

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
      take(offers.firstChild.dataset.text);
      event.preventDefault();
    } else if (event.key === "Escape") close();
  });

  async function learn() {
    words = [...words, ...(await ofLanguage(app))];
    if (document.activeElement === input) offer(); // of what was typed meanwhile
  }

  function offer() {
    const found = completions(input.value, history, words);
    offers.replaceChildren(...found.map(({ text, meaning }) => h("li", { role: "option", "aria-selected": "false", dataset: { text }, onpointerdown: (event) => (event.preventDefault(), take(text)) }, text, h("small", { class: "muted" }, meaning))));
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

/** The axes of the channel by their names in programs. */
function axisWords(store) {
  return (store.unit(store.channel)?.axes || []).map(({ unit, name }) => ({ name, meaning: `axis ${unit}, ${unitSign(store.unit(unit)?.unit)}` }));
}

/** Codes and commands that the channel knows; none where the server cannot say. */
async function ofLanguage(app) {
  const answer = await app.attempt(app.connection.http(`/api/words?channel=${encodeURIComponent(app.store.channel)}`));
  return answer?.words || [];
}

/** Whole lines of the history that begin so, and `words` that the last one may become: text and meaning of each. */
export function completions(text, history, words) {
  if (!text) return [];
  const upper = text.toUpperCase();
  const lines = [...history].reverse().filter((line) => line.toUpperCase().startsWith(upper) && line.length > text.length);
  const begins = new Set([text.lastIndexOf("#"), text.lastIndexOf(" ") + 1].filter((begin) => begin >= 0)); // commands have blanks
  const found = [...begins].flatMap((begin) => thatBegin(upper.slice(begin), words).map(({ name, meaning }) => ({ text: text.slice(0, begin) + name, meaning })));
  return [...lines.map((line) => ({ text: line, meaning: "" })), ...found].slice(0, OFFERED);
}

/** G1 is G01; G0 may become G09. */
function thatBegin(word, words) {
  const plain = (name) => name.replace(/^([GM])0(?=\d)/, "$1");
  return word ? words.filter(({ name }) => name.startsWith(word) || plain(name).startsWith(word)) : [];
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
