// Keys of the pages.
import { button, h } from "./dom.js";
import { axesOfKeys, PAIRS } from "./operate/jog_keys.js";

const OF_PAGES = [
  ["Alt+1 … Alt+6", "the pages, from Operate to Program"],
  ["F7", "single block on and off"],
  ["F8", "feed hold on and off"],
  ["F9", "start or resume the program"],
  ["Ctrl+↑, Ctrl+↓", "override 5 % more, 5 % less"],
];
const OF_ALL = [
  ["Escape", "ends all jogs"],
  ["Click, Shift+click in the scope", "cursor A, cursor B; wheel and drag zoom in time"],
  ["F1", "this list"],
];

export function showHelp() {
  if (document.querySelector("dialog.help")) return;
  const rows = [...OF_PAGES, ...ofJogs(window.app.store.of("axis")), ...OF_ALL].map(([key, text]) => h("tr", {}, h("th", { scope: "row" }, h("kbd", {}, key)), h("td", {}, text)));
  const dialog = h("dialog", { "aria-label": "Keys", class: "help" }, h("h2", {}, "Keys"), h("table", {}, h("tbody", {}, rows)), button("Close", () => dialog.close()));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/** Which keys move which axis of this machine. */
function ofJogs(axes) {
  return axesOfKeys(axes).flatMap((axis, i) => {
    const keys = PAIRS[i].map(([, sign, name]) => name || sign).join(", ");
    return axis ? [[keys, `jog ${axis.name.toUpperCase()} while the key is held, if the jog keys are on; with Shift at rapid`]] : [];
  });
}
