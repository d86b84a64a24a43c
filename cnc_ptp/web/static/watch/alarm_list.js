// Alarms with number, cause and remedy.
import { button, h, oncePerFrame, panel } from "../dom.js";
import { fixed } from "../format.js";

const SHOWN = 200; // of so many alarms

/** `most`: how many are shown, the newest first; `history`: acknowledged ones too. */
export function alarmList(app, { most = SHOWN, history = false, title = "Alarms" } = {}) {
  const { store } = app;
  const list = h("div", { class: "alarm-list" });
  const all = button("Acknowledge all", () => app.request("acknowledge"));
  const element = panel(title, history ? null : h("div", { class: "row" }, all), list);
  function show() {
    const wanted = store.alarms.filter((alarm) => Boolean(alarm.acknowledged) === history);
    const shown = wanted.slice(-most).reverse();
    all.hidden = shown.length === 0 || store.role === "viewer";
    list.replaceChildren(...(shown.length ? shown.map((alarm) => card(app, alarm)) : [h("p", { class: "muted" }, history ? "None yet." : "No alarms.")]));
    const more = `${wanted.length - shown.length} older`;
    if (wanted.length > shown.length) list.append(most < SHOWN ? h("a", { href: "#alarms" }, more) : h("p", { class: "muted" }, more));
  }
  const end = store.on("alarms", oncePerFrame(show));
  show();
  return { element, end };
}

function card(app, alarm) {
  const name = `P-${alarm.severity === "error" ? "ERR" : "WARN"}-${String(alarm.number).padStart(5, "0")}`;
  const head = h("p", {}, h("strong", {}, alarm.number ? name : alarm.severity), ` ${alarm.source} · ${fixed(alarm.time, 3)} s${alarm.line ? ` · line ${alarm.line}` : ""}`);
  return h(
    "article", { class: `alarm ${alarm.severity} ${alarm.acknowledged ? "known" : ""}` },
    head, h("p", {}, alarm.text), alarm.cause && h("p", { class: "muted" }, "Cause: ", alarm.cause), alarm.remedy && h("p", { class: "muted" }, "Remedy: ", alarm.remedy),
    alarm.acknowledged ? h("p", { class: "muted" }, `Acknowledged by ${alarm.acknowledged_by}`) : app.store.role !== "viewer" && button("Acknowledge", () => app.request("acknowledge", { alarm: alarm.alarm }), { class: "small", "aria-label": `Acknowledge alarm ${alarm.number || alarm.alarm}` }),
  );
}
