// The time of a recording: where it is shown, and playing it.
import { button, h, press, say, select } from "./dom.js";
import { fixed } from "./format.js";

const PERIOD = 50; // ms

export function recordingBar(app) {
  const { store, connection } = app;
  const slider = h("input", { type: "range", step: "0.001", "aria-label": "Time of the recording in s" });
  const shown = h("output", { class: "number" });
  const speed = select([["0.1", "× 0.1"], ["0.5", "× 0.5"], ["1", "× 1"], ["5", "× 5"], ["20", "× 20"]], { "aria-label": "Speed of playing" });
  speed.value = "1";
  const play = button("Play", () => (timer ? stop() : start()), { "aria-pressed": "false" });
  const bar = h("footer", { class: "recording-bar", hidden: true, "aria-label": "Recording" }, play, speed, slider, shown);
  let timer = 0;
  let before = 0;
  let asked = 0;

  function seek(time) {
    const { start: first, end } = store.machine;
    const wanted = Math.min(Math.max(time, first || 0), end || 0);
    slider.value = wanted;
    say(shown, `${fixed(wanted, 3)} s of ${fixed(end, 1)} s`);
    if (wanted === asked) return;
    asked = wanted;
    connection.send({ type: "seek", time: wanted });
    store.tell("seek", wanted);
  }

  function step() {
    const now = performance.now();
    const time = Number(slider.value) + ((now - before) / 1000) * Number(speed.value);
    before = now;
    seek(time);
    if (time >= (store.machine?.end ?? 0)) stop();
  }

  function start() {
    if (Number(slider.value) >= store.machine.end) slider.value = store.machine.start || 0;
    before = performance.now();
    timer = setInterval(step, PERIOD);
    press(play, true);
    say(play, "Pause");
  }

  function stop() {
    clearInterval(timer);
    timer = 0;
    press(play, false);
    say(play, "Play");
  }

  slider.addEventListener("input", () => seek(Number(slider.value)));
  store.on("hello", () => {
    const recording = store.machine?.recording;
    bar.hidden = !recording;
    if (!recording) return;
    slider.min = store.machine.start ?? 0;
    slider.max = store.machine.end ?? 0;
    asked = -1;
    seek(store.machine.start ?? 0);
  });
  store.on("gone", stop);
  return bar;
}
