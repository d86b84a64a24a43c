// The loaded program with its active block: load, upload, drag, start at a block.
import { button, h, panel, press, say, select, toggle } from "../dom.js";
import { LineList } from "./line_list.js";
import { followProgram, listPrograms, loadProgram, programName, takeDrops, upload } from "./programs.js";

export function programPanel(app) {
  const { store } = app;
  const startHere = button("Start at line", () => app.command(store.channel, "start", { line: list.selected }), { disabled: true });
  const list = new LineList((line) => {
    startHere.disabled = !line;
    say(startHere, `Start at line ${line}`);
  });
  const follow = toggle("Follow", (on) => {
    list.follows = on;
    press(follow, on);
  });
  press(follow, true);
  const names = select([["", "Load a program …"]], { "aria-label": "Load a program" });
  const file = h("input", { type: "file", "aria-label": "Upload a program", class: "visually-hidden", tabIndex: -1 });
  const find = h("input", { type: "search", placeholder: "Find, or a line number", "aria-label": "Find in the program" });
  const title = h("span", { class: "program-name" });
  const active = h("code", { class: "active-block" });
  const element = panel(
    store.ofChannel("Program"),
    h("div", { class: "row" }, title, active),
    h("fieldset", { class: "commands" }, h("div", { class: "row" }, names, button("Upload …", () => file.click()), file, startHere)),
    h("div", { class: "row" }, find, follow), list.element,
  );
  element.classList.add("program-panel");

  async function fill() {
    const { programs, endings } = await listPrograms(app);
    file.accept = endings.join(",");
    names.replaceChildren(h("option", { value: "" }, "Load a program …"), ...programs.map(({ name }) => h("option", { value: name }, name)));
  }
  names.addEventListener("focus", fill, { once: true });
  names.addEventListener("change", async () => {
    const name = names.value;
    names.value = "";
    if (name) await loadProgram(app, name);
  });
  file.addEventListener("change", async () => {
    if (file.files[0] && (await upload(app, file.files[0]))) fill();
    file.value = "";
  });
  takeDrops(element, async (dropped) => (await upload(app, dropped)) && fill());
  find.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || !find.value) return;
    const line = /^\d+$/.test(find.value) ? Number(find.value) : list.find(find.value);
    if (line) list.select(line);
    else app.notices.show("info", `No line has '${find.value}'.`);
  });

  function update() {
    const state = store.state(store.channel);
    say(title, programName(store) || "No program is loaded");
    say(active, state.active ? state.text || list.lines[state.line - 1] || "" : "");
    list.setActive(state.active && !state.manual ? state.line : 0);
  }
  const ends = [store.on("programs", fill), followProgram(app, (text) => list.setText(text)), store.on("state", update)];
  fill();
  update();
  return { element, end: () => ends.forEach((end) => end()) };
}
