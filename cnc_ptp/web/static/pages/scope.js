// Scope: signals of any unit at full rate, triggers, cursors, measures, spectrum, XY plot, math channels.
import { h, panel } from "../dom.js";
import { Capture } from "../scope/capture.js";
import { Picture } from "../scope/picture.js";
import { channelPanel, runPanel, triggerPanel, viewPanel } from "../scope/panels.js";

export function mount(root, app) {
  const capture = new Capture(app);
  const first = app.store.of("axis")[0]?.name;
  if (first) capture.channels = [{ name: `${first}.set_velocity`, graph: 1 }, { name: `${first}.following_error`, graph: 2 }];
  const picture = new Picture(app, capture);
  const changed = async () => {
    try {
      await capture.subscribe();
    } catch (error) {
      app.notices.show("error", error.message);
      return;
    }
    picture.rebuild();
    parts.forEach((part) => part.refresh?.());
    if (capture.isRecording) capture.read(Number(document.querySelector(".recording-bar input").value));
  };
  const parts = [runPanel(app, capture, picture), channelPanel(app, capture, changed), triggerPanel(app, capture), viewPanel(app, capture, picture, changed)];
  root.append(h("div", { class: "graphs" }, picture.element), h("div", { class: "stack" }, parts.map((part) => part.element)));
  const ends = [app.store.on("hello", changed), app.store.on("seek", (time) => capture.read(time))];
  changed();
  return {
    unmount() {
      ends.forEach((end) => end());
      picture.end();
      capture.end();
    },
  };
}
