// Program: the folder of the server, and the loaded program in full.
import { button, h, panel } from "../dom.js";
import { bytes } from "../format.js";
import { programPanel } from "../operate/program_panel.js";
import { listPrograms, loadProgram, takeDrops, upload } from "../operate/programs.js";
import { followChannel } from "./follow_channel.js";

export function mount(root, app) {
  return { unmount: followChannel(app, root, () => fillPage(root, app)) };
}

function fillPage(root, app) {
  const { element, end } = programPanel(app);
  const list = h("ul", { class: "programs" });
  const folder = panel("Program folder", h("p", { class: "muted" }, "Drop a file here to upload and load it."), h("fieldset", { class: "commands" }, list));

  async function fill() {
    const { programs } = await listPrograms(app);
    list.replaceChildren(...programs.map(({ name, size }) => h("li", {}, h("span", {}, name, h("small", { class: "muted" }, ` ${bytes(size)}`)), button("Load", () => loadProgram(app, name), { class: "small", "aria-label": `Load ${name}` }))));
    if (programs.length === 0) list.append(h("li", {}, "No programs."));
  }
  takeDrops(folder, async (file) => (await upload(app, file)) && fill());
  root.append(folder, element);
  fill();
  const ends = [end, app.store.on("programs", fill)];
  return () => ends.forEach((one) => one());
}
