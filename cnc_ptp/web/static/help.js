// Keys of the pages.
import { button, h } from "./dom.js";

const KEYS = [
  ["Alt+1 … Alt+6", "the pages, from Operate to Program"],
  ["F7", "single block on and off"],
  ["F8", "feed hold on and off"],
  ["F9", "start or resume the program"],
  ["Ctrl+↑, Ctrl+↓", "override 5 % more, 5 % less"],
  ["← → ↑ ↓, Page up, Page down", "jog X, Y, Z while the key is held, if the jog keys are on; with Shift at rapid"],
  ["Escape", "ends all jogs"],
  ["Click, Shift+click in the scope", "cursor A, cursor B; wheel and drag zoom in time"],
  ["F1", "this list"],
];

export function showHelp() {
  if (document.querySelector("dialog.help")) return;
  const rows = KEYS.map(([key, text]) => h("tr", {}, h("th", { scope: "row" }, h("kbd", {}, key)), h("td", {}, text)));
  const dialog = h("dialog", { "aria-label": "Keys", class: "help" }, h("h2", {}, "Keys"), h("table", {}, h("tbody", {}, rows)), button("Close", () => dialog.close()));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
