// Jogs: one message each 50 ms while a key or button is held. Every way in which a key may be lost ends them.
import { LONGEST_FOR_JOGS } from "./round_trip.js";

const PERIOD = 50; // ms
const LATEST = 170; // ms between two messages; the axis ends its jog by itself after 200
const REFUSED = /^axis (\S+): jog refused/;

export class Jogger {
  constructor(app) {
    this.app = app;
    this._held = new Map();
    this._listeners = new Set();
    const stop = () => this.stopAll();
    for (const name of ["blur", "pagehide", "beforeunload", "freeze"]) window.addEventListener(name, stop);
    document.addEventListener("visibilitychange", stop);
    // macOS tells of no key that comes up while Meta is held
    for (const name of ["keydown", "keyup"]) document.addEventListener(name, (event) => event.key === "Meta" && this.stopAll(), true);
    app.store.on("link", stop);
    app.store.on("operator", () => app.store.holds || this.stopAll());
    app.store.on("jog_ended", (message) => this._ended(message));
    for (const topic of ["event", "error"]) app.store.on(topic, (message) => this._refused(message));
  }

  /** Notified with an axis and its velocity, 0 at the end. */
  onChange(listener) {
    this._listeners.add(listener);
    return () => this._listeners.delete(listener);
  }

  /** Begins a jog (mm/s, deg/s), and gives it, or null. Without the command nothing is sent. */
  start(axis, velocity) {
    const { store, notices } = this.app;
    if (this._held.has(axis) || velocity === 0 || document.hidden) return null;
    if (!store.holds) {
      notices.show("warning", "This page does not hold the command.", "Take the command first.");
      return null;
    }
    const { time } = this.app.roundTrip;
    if (time > LONGEST_FOR_JOGS) {
      notices.show("warning", slow(time), "Jog from a computer that is nearer to the machine, or where less runs.");
      return null;
    }
    const jog = { velocity, sequence: 0, sent: performance.now(), timer: 0 };
    jog.timer = setInterval(() => this._beat(axis, jog), PERIOD); // before the first message, whose failure ends it
    this._held.set(axis, jog);
    this._tell(axis, velocity);
    this._beat(axis, jog);
    return jog;
  }

  _beat(axis, jog) {
    if (this._held.get(axis) !== jog) {
      clearInterval(jog.timer);
      return;
    }
    const now = performance.now();
    const late = now - jog.sent > LATEST;
    jog.sent = now;
    jog.sequence += 1;
    const sent = !late && this.app.connection.send({ type: "jog", axis, velocity: jog.velocity, sequence: jog.sequence, time: now });
    if (!sent) this.stop(axis);
  }

  stop(axis) {
    const jog = this._held.get(axis);
    if (!jog) return;
    this._forget(axis, jog);
    this.app.connection.send({ type: "jog", axis, velocity: 0, sequence: jog.sequence + 1, time: performance.now() });
    this.app.connection.send({ type: "jog_stop", axis });
  }

  stopAll() {
    for (const axis of [...this._held.keys()]) this.stop(axis);
  }

  _ended(message) {
    const jog = this._held.get(message.axis);
    if (jog) this._forget(message.axis, jog);
    this.app.notices.show("warning", message.text, message.remedy);
  }

  /** Jogs have no answer: the axis tells of a refusal as an event, the server as an error, which is shown in any case. */
  _refused({ type, text, remedy }) {
    const axis = REFUSED.exec(text)?.[1];
    if (!axis || !this._held.has(axis)) return; // that of somebody else
    this.stop(axis);
    if (type === "event") this.app.notices.show("error", text, remedy);
  }

  _forget(axis, jog) {
    clearInterval(jog.timer);
    this._held.delete(axis);
    this._tell(axis, 0);
  }

  _tell(axis, velocity) {
    for (const listener of this._listeners) listener(axis, velocity);
  }

  /** Makes a button one that is held; `velocity` is asked when it is pressed. */
  bind(element, axis, velocity) {
    let jog = null;
    const begin = () => {
      jog = this.start(axis, velocity()) ?? jog; // a second press (a key beside the pointer) begins nothing
    };
    // not that of another button: when one is pressed, the one that was pressed before loses the focus
    const end = () => jog && this._held.get(axis) === jog && this.stop(axis);
    element.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      element.setPointerCapture(event.pointerId);
      begin();
    });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) element.addEventListener(name, end);
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("keydown", (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      if (!event.repeat) begin();
    });
    element.addEventListener("keyup", (event) => {
      if (event.key === " " || event.key === "Enter") end();
    });
  }
}

function slow(time) {
  if (time === Infinity) return "How long messages take is not known yet. There is no jog before.";
  return `Messages to the server and back take ${Math.round(time)} ms, more than ${LONGEST_FOR_JOGS} ms. There is no jog then.`;
}
