// Operate: positions, program, MDI, overrides, spindle, offsets, handshakes, jog.
import { h } from "../dom.js";
import { controls, keys } from "../operate/controls.js";
import { handshakes } from "../operate/handshakes.js";
import { jogPanel } from "../operate/jog_panel.js";
import { mdi } from "../operate/mdi.js";
import { offsets } from "../operate/offsets.js";
import { overrides } from "../operate/overrides.js";
import { positions } from "../operate/positions.js";
import { programPanel } from "../operate/program_panel.js";
import { spindles } from "../operate/spindles.js";
import { followChannel } from "./follow_channel.js";

export function mount(root, app) {
  return { unmount: followChannel(app, root, () => fill(root, app)) };
}

function fill(root, app) {
  const ends = [];
  const views = { positions, jogPanel, controls, programPanel, mdi, overrides, spindles, handshakes, offsets };
  const made = {};
  for (const [name, view] of Object.entries(views)) {
    const { element, end } = view(app);
    made[name] = element;
    if (end) ends.push(end);
  }
  ends.push(keys(app));
  root.append(
    h("div", { class: "column" }, made.positions, made.jogPanel),
    h("div", { class: "column wide" }, made.controls, made.handshakes, made.programPanel, made.mdi),
    h("div", { class: "column" }, made.overrides, made.spindles, made.offsets),
  );
  return () => ends.forEach((end) => end());
}
