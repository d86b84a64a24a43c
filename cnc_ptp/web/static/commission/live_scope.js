// A scope beside a test: fixed signals, one graph for each group.
import { Capture } from "../scope/capture.js";
import { Picture } from "../scope/picture.js";

/** `signals`: [name, graph]. Gives the capture, the element and what ends it. */
export function liveScope(app, signals, { window = 5, height = 190 } = {}) {
  const capture = new Capture(app);
  capture.window = window;
  capture.channels = signals.map(([name, graph]) => ({ name, graph }));
  const picture = new Picture(app, capture, { height, extras: false });
  let isEnded = false;
  capture.subscribe().then(() => isEnded || picture.rebuild());
  return {
    capture,
    picture,
    element: picture.element,
    end() {
      isEnded = true;
      picture.end();
      capture.end();
    },
  };
}
