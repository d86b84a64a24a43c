// Start, feed hold, resume, single block, skip, optional stop, reset; and their keys.
import { button, h, panel, press, say, toggle } from "../dom.js";
import { duration } from "../format.js";

const SWITCHES = [["single_block", "Single block"], ["block_skip", "Block skip"], ["optional_stop", "Optional stop"]];

export function controls(app) {
  const { store } = app;
  const channel = () => store.channel;
  const start = button("Start", () => startOrResume(app), { class: "primary" });
  const hold = toggle(store.ofChannel("Feed hold"), (on) => app.command(channel(), "feed_hold", { enabled: on }));
  const resets = store.hasSeveralChannels ? `Resets ${channel()} and what is in error, except axes and spindles that only other channels have` : null;
  const reset = button(store.ofChannel("Reset"), () => resetAll(app), { title: resets });
  const switches = SWITCHES.map(([name, text]) => toggle(text, (on) => setSwitch(app, name, on), { dataset: { switch: name } }));
  const progress = h("progress", { max: 1, "aria-label": "Progress of the program" });
  const line = h("p", { class: "muted", role: "status" });
  const element = panel(
    store.ofChannel("Control"),
    h("div", { class: "row" }, h("fieldset", { class: "commands" }, h("div", { class: "row" }, start)), hold, reset, h("fieldset", { class: "commands" }, h("div", { class: "row" }, switches))),
    progress, line,
  );

  function update() {
    const state = store.state(channel());
    say(start, store.ofChannel(isHeld(state) || state.state === "stopped" ? "Resume" : "Start"));
    press(hold, isHeld(state));
    for (const one of switches) if (state[one.dataset.switch] !== undefined) press(one, state[one.dataset.switch]);
    progress.value = (state.state !== "ready" && state.progress) || 0; // of the program before
    const left = state.time_left >= 0 ? `${duration(state.time_left)} left` : "time left not known";
    say(line, state.active ? `${state.state} · line ${state.line} · ${Math.round((state.progress || 0) * 100)} % · ${left}` : state.state || "no channel");
  }
  const end = store.on("state", update);
  update();
  return { element, end };
}

const isHeld = (state) => state.feed_hold ?? state.state === "hold";

function startOrResume(app) {
  const { channel } = app.store;
  return isHeld(app.store.state(channel)) ? app.command(channel, "feed_hold", { enabled: false }) : app.command(channel, "start");
}

/** The server may not report it; then the button shows what was commanded. */
async function setSwitch(app, name, enabled) {
  const { channel } = app.store;
  const answer = await app.command(channel, name, { enabled });
  const element = document.querySelector(`[data-switch="${name}"]`);
  if (answer && element && channel === app.store.channel) press(element, enabled);
}

/** The channel, and every axis and spindle that is in error, except those that only other channels have. */
async function resetAll(app) {
  const { store } = app;
  const { channel } = store;
  const foreign = unitsOfOthers(store, channel);
  if (channel) await app.command(channel, "reset");
  for (const { name } of [...store.of("axis"), ...store.of("spindle")]) {
    if (!foreign.has(name) && store.state(name).state === "ErrorStop") await app.command(name, "reset");
  }
}

/** Axes and spindles that only other channels have. */
function unitsOfOthers(store, channel) {
  const members = (wanted) => store.of("channel").filter(wanted).flatMap(({ axes, spindles }) => [...axes.map(({ unit }) => unit), ...spindles]);
  const foreign = new Set(members(({ name }) => name !== channel));
  for (const own of members(({ name }) => name === channel)) foreign.delete(own);
  return foreign;
}

/** F7, F8, F9, Ctrl+↑, Ctrl+↓. */
export function keys(app) {
  const { store } = app;
  const acts = {
    F7: () => toggleSwitch("single_block"),
    F8: () => app.command(store.channel, "feed_hold", { enabled: !isHeld(store.state(store.channel)) }),
    F9: () => startOrResume(app),
  };
  const toggleSwitch = (name) => document.querySelector(`[data-switch="${name}"]`)?.click();

  function act(event) {
    if (event.repeat || document.querySelector("dialog[open]")) return;
    const step = event.ctrlKey && { ArrowUp: 5, ArrowDown: -5 }[event.key];
    if (step) {
      const [now, largest] = [store.state(store.channel).override ?? 100, store.unit(store.channel)?.limits?.override ?? 200];
      app.command(store.channel, "set_override", { percent: Math.min(Math.max(0, now + step), largest) });
    } else if (acts[event.key]) acts[event.key]();
    else return;
    event.preventDefault();
  }
  document.addEventListener("keydown", act);
  return () => document.removeEventListener("keydown", act);
}
