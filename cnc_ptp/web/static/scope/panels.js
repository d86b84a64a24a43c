// The panels beside the graphs: run and freeze, channels, trigger, saved views.
import { button, field, h, panel, press, say, select, toggle } from "../dom.js";
import { fixed } from "../format.js";
import { colourOf } from "./graphs.js";
import { signalsOf } from "./catalogue.js";
import { formula } from "./expression.js";
import { csv, download, removeView, saveView, savedViews } from "./views.js";

const WINDOWS = ["0.1", "0.2", "0.5", "1", "2", "5", "10", "20", "60"];
const SLOPES = [["rising", "rising, above"], ["falling", "falling, below"], ["both", "both edges"]];

export function runPanel(app, capture, picture) {
  const length = select(WINDOWS.map((text) => [text, `${text} s`]));
  length.value = String(capture.window);
  length.addEventListener("change", () => {
    capture.window = Number(length.value);
    capture.version += 1;
    if (capture.isRecording) app.store.tell("seek", Number(document.querySelector(".recording-bar input").value));
  });
  const freeze = toggle("Freeze", (on) => capture.freeze(on));
  const unzoom = button("Whole window", () => picture._graphs.forEach((graph) => (graph.zoom = null)));
  const status = h("p", { class: "muted", role: "status" });
  const timer = setInterval(() => {
    if (!status.isConnected) return clearInterval(timer);
    press(freeze, capture.isFrozen);
    const state = capture.isFrozen ? "Frozen" : capture.mode === "off" ? "Running" : capture.trigger.cycle === null ? "Waiting for the trigger" : "Triggered";
    return say(status, `${state} · ${samplesOf(capture.shown())}`);
  }, 200);
  /** The window that is held, or the last seconds. */
  const snapshot = async () => {
    const { begin, behind, cycleTime } = capture;
    const isHeld = capture.held && behind > begin;
    const seconds = isHeld ? (behind - begin) * cycleTime : Math.max(1, capture.window);
    const until = isHeld ? `&until=${rounded(behind * cycleTime)}` : "";
    const answer = await app.attempt(app.connection.http(`/api/snapshot.mcap?seconds=${rounded(seconds)}${until}`, { as: "response" }));
    if (!answer) return;
    const bytes = await app.attempt(answer.arrayBuffer());
    if (!bytes) return;
    const first = Number(answer.headers.get("X-First-Cycle"));
    download("snapshot.mcap", bytes, "application/octet-stream");
    if (!isHeld) return; // what runs has gone on meanwhile
    const [from, to, shown] = [first, behind, begin].map((cycle) => `${fixed(cycle * cycleTime, 3)} s`);
    if (first > begin) app.notices.show("warning", `The snapshot has ${from} to ${to}; the picture begins at ${shown}, which the recorder no longer has.`);
    else app.notices.show("info", `The snapshot has ${from} to ${to}, the whole picture.`);
  };
  const element = panel(
    "Scope", h("div", { class: "row end" }, field("Window", length), freeze, unzoom), status,
    h("div", { class: "row" }, button("Export CSV", () => download("scope.csv", csv(capture))), !capture.isRecording && app.store.role !== "viewer" && button("MCAP snapshot", snapshot)),
  );
  return { element, refresh: () => (length.value = String(capture.window)) };
}

/** A time (s) to the microsecond. */
function rounded(time) {
  return Number(time.toFixed(6));
}

/** How many samples there are, whether they are of every cycle, and how many are missing. */
function samplesOf({ ring, step }) {
  const some = step > 1 ? `, one of every ${step} cycles` : "";
  return `${ring.length} samples${some}${ring.lost ? ` · ${ring.lost} samples lost` : ""}`;
}

export function channelPanel(app, capture, changed) {
  const signal = select([]);
  for (const [unit, fields] of signalsOf(app.store)) signal.append(groupOf(unit, fields));
  const [name, text] = [h("input", { placeholder: "power" }), h("input", { placeholder: "x.actual_torque * x.actual_velocity", spellcheck: "false" })];
  const list = h("ul", { class: "channels" });
  const add = (channel) => {
    if (capture.channels.some((one) => one.name === channel.name)) return;
    capture.channels.push(channel);
    changed();
  };
  const lastGraph = () => Math.max(1, ...capture.channels.map((one) => one.graph || 1));
  const addMath = () => {
    try {
      formula(text.value);
    } catch (error) {
      app.notices.show("error", `Formula: ${error.message}.`);
      return;
    }
    add({ name: name.value.trim() || text.value.trim(), graph: lastGraph(), formula: text.value.trim() });
  };

  function refresh() {
    list.replaceChildren(...capture.channels.map((channel, index) => row(channel, index)));
  }
  function row(channel, index) {
    const mark = h("span", { class: "swatch" });
    mark.style.background = colourOf(index);
    const graph = select(["1", "2", "3", "4"], { "aria-label": `Graph of ${channel.name}` });
    graph.value = String(channel.graph || 1);
    graph.addEventListener("change", () => ((channel.graph = Number(graph.value)), changed()));
    const remove = button("×", () => (capture.channels.splice(capture.channels.indexOf(channel), 1), changed()), { class: "plain", "aria-label": `Remove ${channel.name}` });
    return h("li", {}, mark, h("span", { class: "channel-name" }, channel.name, channel.formula ? ` = ${channel.formula}` : ""), graph, remove);
  }
  const element = panel(
    "Signals", list,
    h("div", { class: "row end" }, field("Signal", signal), button("Add", () => add({ name: signal.value, graph: lastGraph() })), button("In a new graph", () => add({ name: signal.value, graph: Math.min(4, lastGraph() + 1) }))),
    h("details", {}, h("summary", {}, "Math channel"), field("Name", name), field("Formula", text, "+ − * / ^, sin, cos, sqrt, abs, min, max, hypot, diff, integral, delay"), button("Add channel", addMath)),
  );
  return { element, refresh };
}

function groupOf(unit, fields) {
  const group = h("optgroup", { label: unit });
  group.append(...fields.map((one) => h("option", { value: `${unit}.${one}` }, `${unit}.${one}`)));
  return group;
}

export function triggerPanel(app, capture) {
  const kind = select([["edge", "Edge"], ["level", "Level"], ["event", "Event"], ["error", "Error"]]);
  const mode = select([["off", "Off"], ["normal", "Normal"], ["single", "Single"]]);
  const source = select([]);
  const slope = select(SLOPES);
  const level = h("input", { type: "number", step: "any", value: 0 });
  const text = h("input", { placeholder: "source, number or text" });
  const pre = h("input", { type: "number", min: 0, max: 100, step: 5, value: 20 });
  const ofSamples = h("div", { class: "row end" }, field("Signal", source), field("Slope", slope), field("Level", level));
  const ofEvents = h("div", {}, field("Event has", text));

  function arm() {
    Object.assign(capture, { mode: mode.value, source: source.value, pre: Math.min(100, Math.max(0, Number(pre.value))) / 100 });
    const samples = kind.value === "edge" || kind.value === "level";
    ofSamples.hidden = !samples;
    ofEvents.hidden = kind.value !== "event";
    capture.arm(options());
  }
  const options = () => ({ kind: kind.value, direction: slope.value, level: Number(level.value), text: text.value });
  for (const control of [kind, mode, source, slope, level, text, pre]) control.addEventListener("change", arm);

  function refresh() {
    const names = capture.channels.map(({ name }) => name);
    source.replaceChildren(...names.map((name) => h("option", { value: name }, name)));
    if (names.includes(capture.source)) source.value = capture.source;
    capture.source = source.value;
    const { trigger } = capture;
    [kind.value, slope.value, level.value, text.value, mode.value, pre.value] = [trigger.kind, trigger.direction, trigger.level, trigger.text, capture.mode, Math.round(capture.pre * 100)];
    ofSamples.hidden = trigger.kind === "event" || trigger.kind === "error";
    ofEvents.hidden = trigger.kind !== "event";
  }
  const element = panel("Trigger", h("div", { class: "row end" }, field("Mode", mode), field("Kind", kind), field("Before it in %", pre)), ofSamples, ofEvents, h("div", { class: "row" }, button("Arm", arm)));
  element.hidden = capture.isRecording;
  return { element, refresh };
}

export function viewPanel(app, capture, picture, changed) {
  const names = select([["", "Saved views …"]], { "aria-label": "Saved views" });
  const name = h("input", { placeholder: "Name", "aria-label": "Name of the view" });
  const fill = () => names.replaceChildren(h("option", { value: "" }, "Saved views …"), ...[...savedViews().keys()].map((one) => h("option", { value: one }, one)));
  const save = () => {
    if (!name.value.trim()) return;
    const { kind, direction, level, text } = capture.trigger;
    saveView(name.value.trim(), { channels: capture.channels, window: capture.window, pre: capture.pre, mode: capture.mode, source: capture.source, trigger: { kind, direction, level, text }, ...picture.extras });
    fill();
  };
  names.addEventListener("change", async () => {
    const view = savedViews().get(names.value);
    if (!view) return;
    name.value = names.value;
    Object.assign(capture, { channels: view.channels.map((channel) => ({ ...channel })), window: view.window, pre: view.pre ?? 0.2, mode: capture.isRecording ? "off" : view.mode || "off", source: view.source || "" });
    capture.arm(view.trigger || {});
    await changed();
    picture.show(view);
  });
  const remove = button("Remove", () => (removeView(name.value.trim()), fill()));
  fill();
  return { element: panel("Views", h("div", { class: "row" }, names), h("div", { class: "row" }, name, button("Save", save), remove)) };
}
