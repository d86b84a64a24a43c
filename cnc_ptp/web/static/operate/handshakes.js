// Functions of programs that wait for somebody to acknowledge them, and whether the PLC does that automatically.
import { button, h, panel } from "../dom.js";

export function handshakes(app) {
  const { store } = app;
  const list = h("ul", { class: "handshakes" });
  const byHand = h("input", { type: "checkbox", onchange: change });
  const choice = h("label", { class: "row", title: "Otherwise the PLC acknowledges them automatically, also those that wait now" }, byHand, "Acknowledge functions by hand");
  const element = panel("To acknowledge", h("fieldset", { class: "commands" }, choice, list));
  element.hidden = store.of("channel").length + store.of("spindle").length === 0; // nothing asks for an acknowledgement

  /** The box changes when the PLC has accepted it. */
  async function change() {
    const wanted = byHand.checked;
    showChoice();
    if (await app.command("plc", "auto_acknowledge", { enabled: !wanted })) store.byHand = wanted;
    showChoice();
  }
  function showChoice() {
    byHand.checked = store.acknowledgesByHand;
  }
  async function acknowledge(request) {
    const answer = await app.command("plc", "acknowledge", { id: request.id });
    if (answer) store.handshakes.delete(request.id);
    show();
  }
  function show() {
    const waiting = [...store.handshakes.values()];
    list.hidden = waiting.length === 0;
    list.replaceChildren(...waiting.map((request) => h("li", { class: "row" }, h("strong", {}, words(request)), h("span", { class: "muted" }, place(request)), button("Acknowledge", () => acknowledge(request)))));
  }
  const place = ({ channel, line }) => (store.hasSeveralChannels ? `${channel}, line ${line}` : `line ${line}`);
  const ends = [store.on("handshakes", show), store.on("hello", show), store.on("state", showChoice)];
  show();
  showChoice();
  return { element, end: () => ends.forEach((end) => end()) };
}

function words({ kind, number, value, spindle }) {
  const speed = kind === "S" || value ? ` ${value}` : "";
  return `${kind}${kind === "S" ? "" : number}${speed}${spindle ? ` (${spindle})` : ""}`;
}
