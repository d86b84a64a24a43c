// Functions of the program that wait for somebody to acknowledge them.
import { button, h, panel } from "../dom.js";

export function handshakes(app) {
  const { store } = app;
  const list = h("ul", { class: "handshakes" });
  const element = panel("To acknowledge", h("fieldset", { class: "commands" }, list));

  async function acknowledge(request) {
    const answer = await app.command("plc", "acknowledge", { id: request.id });
    if (answer) store.handshakes.delete(request.id);
    show();
  }
  function show() {
    element.hidden = store.handshakes.size === 0;
    list.replaceChildren(...[...store.handshakes.values()].map((request) => h("li", { class: "row" }, h("strong", {}, words(request)), h("span", { class: "muted" }, `line ${request.line}`), button("Acknowledge", () => acknowledge(request)))));
  }
  const ends = [store.on("handshakes", show), store.on("hello", show)];
  show();
  return { element, end: () => ends.forEach((end) => end()) };
}

function words({ kind, number, value, spindle }) {
  const speed = kind === "S" || value ? ` ${value}` : "";
  return `${kind}${kind === "S" ? "" : number}${speed}${spindle ? ` (${spindle})` : ""}`;
}
