// The time of a recording: where it is shown, and playing it. The server keeps the time of this page; others have their own.
import { button, h, press, say, select } from "./dom.js";
import { fixed } from "./format.js";

const PERIOD = 250; // ms between two looks of the scope while it plays
const HELD = 400; // ms after which the slider follows the server again
const STEP = 0.001; // s of the slider, and of the times that the server tells

export function recordingBar(app) {
  const { store } = app;
  const slider = h("input", { type: "range", step: String(STEP), "aria-label": "Time of the recording in s" });
  const shown = h("output", { class: "number" });
  const speed = select([["0.1", "× 0.1"], ["0.5", "× 0.5"], ["1", "× 1"], ["5", "× 5"], ["20", "× 20"]], { "aria-label": "Speed of playing" });
  speed.value = "1";
  const play = button("Play", () => setSpeed(isPlaying ? 0 : Number(speed.value)), { "aria-pressed": "false" });
  const bar = h("footer", { class: "recording-bar", hidden: true, "aria-label": "Recording" }, play, speed, slider, shown);
  let [isPlaying, touched, told, followed, asked] = [false, -Infinity, -Infinity, NaN, 0]; // asked: seeks without an answer

  const isEnd = (time) => time > store.machine.end - STEP; // it may end between two steps

  async function seek() {
    touched = performance.now();
    followed = Number(slider.value);
    const time = isEnd(followed) ? store.machine.end : followed;
    say(shown, `${fixed(time, 3)} s is read …`);
    asked += 1;
    const isThere = await app.request("seek", { time });
    asked -= 1;
    if (asked > 0) return; // another one came meanwhile
    touched = performance.now();
    show(isThere ? time : store.time);
    if (isThere) store.tell("seek", time);
  }

  async function setSpeed(wanted) {
    if (!(await app.request("play", { speed: wanted }))) return;
    showPlaying(wanted > 0);
  }

  function showPlaying(on) {
    isPlaying = on;
    press(play, on);
    say(play, on ? "Pause" : "Play");
  }

  function show(time) {
    say(shown, `${fixed(time, 3)} s of ${fixed(store.machine.end, 1)} s`);
  }

  function follow() {
    if (bar.hidden || asked > 0 || performance.now() - touched < HELD || followed === store.time) return;
    followed = store.time;
    slider.value = store.time;
    show(store.time);
    const now = performance.now();
    if (now - told > PERIOD) {
      told = now;
      store.tell("seek", store.time);
    }
    if (isPlaying && isEnd(store.time)) showPlaying(false); // the server stops at its end
  }

  /** What the server knows of another time takes the place of all that was told before. */
  function replacePast({ events, alarms, offsets, nodes }) {
    Object.assign(store, { events, alarms, offsets, nodes: new Map(nodes.map((node) => [node.name, node])) });
    store.tell("alarms");
    store.tell("diagnostics");
  }

  slider.addEventListener("change", seek);
  slider.addEventListener("input", () => performance.now() - touched > PERIOD && seek());
  speed.addEventListener("change", () => isPlaying && setSpeed(Number(speed.value)));
  store.on("state", follow);
  store.on("past", replacePast);
  store.on("hello", () => {
    bar.hidden = !store.machine?.recording;
    if (bar.hidden) return;
    slider.min = store.machine.start ?? 0;
    slider.max = store.machine.end ?? 0;
    slider.value = slider.min; // a page that connects again begins anew
    followed = Number(slider.min);
    showPlaying(false);
    show(Number(slider.min));
  });
  return bar;
}
