// The bar above all pages: state of the machine, who commands, alarms, emergency stop.
import { button, h, say, select } from "./dom.js";
import { fixed } from "./format.js";
import { showHelp } from "./help.js";

export function statusBar(app) {
  return h("div", { class: "status" }, machine(app), command(app), alarms(app), look(), emergency(app));
}

function machine(app) {
  const { store } = app;
  const [name, state, time] = [h("span", { class: "machine-name" }), h("span", { class: "pill", role: "status" }), h("span", { class: "machine-time number" })];
  const show = () => {
    const [kind, text] = machineState(store);
    state.dataset.kind = kind;
    say(state, text);
    say(name, store.machine?.name || "");
    say(time, store.machine ? `${fixed(store.time, 1)} s` : "");
  };
  for (const topic of ["state", "link", "gone", "hello"]) store.on(topic, show);
  show();
  return h("div", { class: "group" }, name, state, time);
}

/** Kind (colour) and word for the state of the whole machine. */
export function machineState(store) {
  if (store.link !== "open") return ["bad", store.link === "connecting" ? "Connecting" : store.link === "login" ? "Login" : "No connection"];
  if (!store.machine) return ["off", "No machine"];
  if (store.inEmergency) return ["bad", "Emergency stop"];
  const states = Object.values(store.units);
  if (states.some((unit) => unit.state === "ErrorStop" || unit.state === "error")) return ["bad", "Error"];
  if (store.machine.recording) return ["info", "Recording"];
  const channel = store.state(store.channel).state;
  const word = { running: "Running", hold: "Feed hold", waiting: "Waiting", stopping: "Stopping", stopped: "Stopped" }[channel];
  if (word) return [channel === "running" ? "good" : "warn", word];
  const moving = states.some((unit) => /Motion|Homing|Stopping/.test(unit.state || ""));
  return moving ? ["good", "Moving"] : ["off", channel === "ready" ? "Ready" : "Idle"];
}

function command(app) {
  const { store } = app;
  const who = h("span", { class: "operator" });
  const act = button("Take command", () => app.request(next()));
  const give = button("Give command", () => app.request("give_command"));
  const next = () => (store.operator.holder ? "ask_command" : "take_command");
  const show = () => {
    const { holder, asking } = store.operator;
    say(who, store.holds ? (asking ? `${asking.user} asks for the command` : "You command") : holder ? `${holder.user} commands` : "Nobody commands");
    say(act, holder ? "Ask for command" : "Take command");
    const offered = store.link === "open" && store.role !== "viewer" && Boolean(store.machine) && !store.machine.recording;
    act.hidden = !offered || store.holds;
    give.hidden = !offered || !store.holds;
    who.hidden = !offered;
    who.classList.toggle("asked", Boolean(store.holds && asking));
  };
  for (const topic of ["operator", "hello", "link", "gone"]) store.on(topic, show);
  show();
  return h("div", { class: "group command", "aria-live": "polite" }, who, act, give);
}

function alarms(app) {
  const { store } = app;
  const link = h("a", { href: "#alarms", class: "alarm-count" });
  const show = () => {
    const open = store.alarms.filter((alarm) => !alarm.acknowledged);
    const errors = open.filter((alarm) => alarm.severity === "error").length;
    say(link, open.length === 0 ? "No alarms" : `${open.length} alarm${open.length === 1 ? "" : "s"}`);
    link.dataset.kind = errors ? "bad" : open.length ? "warn" : "off";
  };
  store.on("alarms", show);
  show();
  return link;
}

function look() {
  const choice = select([["system", "Auto"], ["light", "Light"], ["dark", "Dark"]], { "aria-label": "Light or dark", class: "theme" });
  choice.value = window.theme.read();
  choice.addEventListener("change", () => window.theme.choose(choice.value));
  return h("div", { class: "group look" }, choice, button("?", showHelp, { "aria-label": "Keys and help (F1)" }));
}

/** Stops also for who does not hold the command, and always; its release is a button of its own, which asks. */
function emergency(app) {
  const { store } = app;
  const stop = button("Emergency stop", () => {
    app.jogger.stopAll();
    app.command("plc", "emergency_stop", { enabled: true });
  }, { class: "emergency" });
  const release = button("Release stop", () => {
    if (window.confirm("Release the emergency stop? Each unit in error needs a reset afterwards.")) app.command("plc", "emergency_stop", { enabled: false });
  });
  const show = () => {
    stop.hidden = Boolean(store.machine?.recording);
    stop.disabled = store.link !== "open" || !store.machine || store.role === "viewer";
    release.hidden = stop.hidden || stop.disabled || !store.inEmergency;
  };
  for (const topic of ["state", "link", "hello", "gone"]) store.on(topic, show);
  show();
  return h("div", { class: "group stops" }, release, stop);
}
