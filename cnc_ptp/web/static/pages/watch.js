// Watch: backplot with the tool, progress, alarms, diagnostics.
import { h, panel, say } from "../dom.js";
import { duration } from "../format.js";
import { backplot } from "../watch/backplot.js";
import { alarmList } from "../watch/alarm_list.js";
import { diagnostics } from "../watch/diagnostics.js";
import { followChannel } from "./follow_channel.js";

export function mount(root, app) {
  return { unmount: followChannel(app, root, () => fill(root, app)) };
}

function fill(root, app) {
  const views = [backplot(app), progress(app), alarmList(app, { most: 5, title: "Alarms" }), diagnostics(app)];
  root.append(views[0].element, h("div", { class: "stack" }, views.slice(1).map((view) => view.element)));
  return () => views.forEach((view) => view.end?.());
}

function progress(app) {
  const { store } = app;
  const bar = h("progress", { max: 1, "aria-label": "Progress of the program" });
  const [text, block] = [h("p", {}), h("code", { class: "active-block" })];
  const update = () => {
    const state = store.state(store.channel);
    bar.value = state.progress || 0;
    say(text, state.active ? `${Math.round((state.progress || 0) * 100)} % · ${state.time_left >= 0 ? duration(state.time_left) : "not known"} left · line ${state.line}` : "No program runs.");
    say(block, state.active ? state.text || "" : "");
  };
  const end = store.on("state", update);
  update();
  return { element: panel(store.ofChannel("Progress"), bar, text, block), end };
}
