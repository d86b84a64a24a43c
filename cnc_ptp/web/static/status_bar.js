// The bar above all pages: state of the machine, who commands, alarms, emergency stop.
import { button, h, say, select } from "./dom.js";
import { fixed } from "./format.js";
import { showHelp } from "./help.js";
import { LONGEST_FOR_JOGS } from "./round_trip.js";

const [LOOK, SILENT] = [500, 1500]; // ms from one look to the next; without a new time of a machine that moves
const WORDS = { running: "Running", hold: "Feed hold", waiting: "Waiting", stopping: "Stopping", stopped: "Stopped" };

export function statusBar(app) {
  return h("div", { class: "status" }, machine(app), channels(app), command(app), alarms(app), look(), logout(app), emergency(app));
}

function machine(app) {
  const { store } = app;
  const [name, state, time] = [h("span", { class: "machine-name" }), h("span", { class: "pill", role: "status" }), h("span", { class: "machine-time number" })];
  const way = h("span", { class: "round-trip", title: "Time of a message to the server and back" });
  let [newest, since] = [NaN, 0];
  const show = () => {
    let [kind, text] = machineState(store);
    if (store.time !== newest) [newest, since] = [store.time, performance.now()];
    // it is told to be gone after 5 s; what it does is not known before
    if (kind === "good" && performance.now() - since > SILENT) [kind, text] = ["warn", "No news"];
    state.dataset.kind = kind;
    say(state, text);
    say(name, store.machine?.name || "");
    say(time, store.machine ? `${fixed(store.time, 1)} s` : "");
  };
  for (const topic of ["state", "link", "gone", "hello", "channel"]) store.on(topic, show);
  store.on("round_trip", (ms) => {
    say(way, Number.isFinite(ms) ? `${Math.round(ms)} ms` : "");
    way.dataset.kind = Number.isFinite(ms) && ms > LONGEST_FOR_JOGS ? "warn" : "";
  });
  setInterval(show, LOOK);
  show();
  return h("div", { class: "group" }, name, state, time, way);
}

/** Kind (colour) and word for the state of the whole machine. */
export function machineState(store) {
  if (store.link !== "open") return ["bad", store.link === "connecting" ? "Connecting" : store.link === "login" ? "Login" : "No connection"];
  if (!store.machine) return ["off", "No machine"];
  if (store.inEmergency) return ["bad", "Emergency stop"];
  const states = Object.values(store.units);
  if (states.some((unit) => unit.state === "ErrorStop" || unit.state === "error")) return ["bad", "Error"];
  if (store.machine.recording) return ["info", "Recording"];
  const { channel } = store;
  const others = store.of("channel").map(({ name }) => name).filter((name) => name !== channel);
  for (const name of [channel, ...others]) {
    const { state } = store.state(name);
    const word = WORDS[state];
    if (word) return [state === "running" ? "good" : "warn", store.hasSeveralChannels ? `${name}: ${word}` : word];
  }
  const moving = states.some((unit) => /Motion|Homing|Stopping/.test(unit.state || ""));
  return moving ? ["good", "Moving"] : ["off", store.state(channel).state === "ready" ? "Ready" : "Idle"];
}

/** Which channel the pages show and operate, where the machine has several. */
function channels(app) {
  const { store } = app;
  const choice = select([], { "aria-label": "Channel", onchange: () => store.choose(choice.value) });
  const element = h("label", { class: "group channel-choice" }, "Channel", choice);
  const show = () => {
    element.hidden = !store.hasSeveralChannels;
    choice.replaceChildren(...store.of("channel").map(({ name }) => h("option", { value: name }, name)));
    choice.value = store.channel;
  };
  for (const topic of ["hello", "gone"]) store.on(topic, show);
  show();
  return element;
}

function command(app) {
  const { store } = app;
  const who = h("span", { class: "operator" });
  const act = button("Take command", () => app.request(next()));
  const give = button("Give command", () => app.request("give_command"));
  const force = button("Take over", () => {
    if (window.confirm(`Take the command from ${store.operator.holder.user}? The jogs of that page end.`)) app.request("take_command", { force: true });
  });
  const next = () => (store.operator.holder ? "ask_command" : "take_command");
  const show = () => {
    const { holder, asking } = store.operator;
    say(who, store.holds ? (asking ? `${asking.user} asks for the command` : "You are the operator") : holder ? `Operator: ${holder.user}` : "No operator");
    say(act, holder ? "Ask for command" : "Take command");
    const offered = store.link === "open" && store.role !== "viewer" && Boolean(store.machine) && !store.machine.recording;
    act.hidden = !offered || store.holds;
    give.hidden = !offered || !store.holds;
    force.hidden = !offered || !holder || store.holds || store.role !== "commissioner";
    who.hidden = !offered;
    who.classList.toggle("asked", Boolean(store.holds && asking));
  };
  for (const topic of ["operator", "hello", "link", "gone"]) store.on(topic, show);
  show();
  return h("div", { class: "group command", "aria-live": "polite" }, who, act, force, give);
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

/** Where users log in. The server ends the socket of a login that has ended; the page asks for the next login then. */
function logout(app) {
  const { store } = app;
  const leave = button("Log out", () => app.attempt(app.connection.http("/api/logout", { method: "POST" })));
  const show = () => {
    leave.hidden = store.link !== "open" || !store.hasLogin;
    leave.title = `Logged in as ${store.user} (${store.role})`;
  };
  for (const topic of ["hello", "link"]) store.on(topic, show);
  show();
  return leave;
}

/** Stops also for who does not hold the command, operator or not; its release is a button of its own, which asks. */
function emergency(app) {
  const { store } = app;
  const stop = button("Emergency stop", () => {
    app.jogger.stopAll();
    app.command("plc", "emergency_stop", { enabled: true });
  }, { class: "emergency" });
  const release = button("Release stop", () => {
    const what = store.hasSeveralChannels ? "the emergency stop of all channels" : "the emergency stop";
    if (window.confirm(`Release ${what}? Each unit in error needs a reset afterwards.`)) app.command("plc", "emergency_stop", { enabled: false });
  });
  const show = () => {
    say(stop, store.hasSeveralChannels ? "Emergency stop, all channels" : "Emergency stop");
    stop.hidden = Boolean(store.machine?.recording);
    stop.disabled = store.link !== "open" || !store.machine || store.role === "viewer";
    release.hidden = stop.hidden || stop.disabled || !store.inEmergency;
  };
  for (const topic of ["state", "link", "hello", "gone"]) store.on(topic, show);
  show();
  return h("div", { class: "group stops" }, release, stop);
}
