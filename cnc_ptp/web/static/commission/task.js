// A task of the server that takes a while: beginning, cancelling, its progress and result.
import { button, h, say } from "../dom.js";

/** `show(message)` gets the result of the task of this page. */
export function followTask(app, show) {
  const { store } = app;
  const bar = h("progress", { "aria-label": "Progress of the task", max: 100, value: 0 });
  const status = h("p", { class: "muted", role: "status" }, "Not started.");
  const cancel = button("Cancel", () => app.request("cancel_task", { task: task.number }), { disabled: true });
  const run = (on) => {
    cancel.disabled = !on;
    if (on) bar.removeAttribute("value"); // how far it is is not known
    else bar.value = 100;
  };
  const ends = [
    store.on("progress", (message) => {
      if (message.task !== task.number) return;
      say(status, message.text || "");
      if (message.percent !== undefined) bar.value = message.percent;
    }),
    store.on("result", (message) => {
      if (message.task !== task.number) return;
      run(false);
      say(status, message.ok ? "Finished." : `${message.text} ${message.output || ""}`);
      if (message.ok) show(message);
    }),
  ];
  const task = {
    number: null,
    element: h("div", { class: "stack" }, h("div", { class: "row" }, cancel), bar, status),
    async begin(type, fields) {
      const answer = await app.request(type, fields);
      if (!answer) return;
      task.number = answer.task;
      run(true);
      say(status, "Started.");
    },
    end: () => ends.forEach((end) => end()),
  };
  return task;
}
