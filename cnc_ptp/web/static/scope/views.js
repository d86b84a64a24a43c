// Saved views of the scope, in this browser; and what a scope shows as CSV.

const KEY = "scope-views";
const KINDS = new Set(["edge", "level", "event", "error"]);

export function savedViews() {
  try {
    const kept = JSON.parse(localStorage.getItem(KEY) || "{}");
    return new Map(Object.entries(kept).filter(([, view]) => isView(view)));
  } catch {
    return new Map();
  }
}

/** What was stored may be of another version, or written by hand. */
function isView(view) {
  return Array.isArray(view?.channels) && view.channels.every((channel) => typeof channel.name === "string") && typeof view.window === "number" && (!view.trigger || KINDS.has(view.trigger.kind));
}

export function saveView(name, view) {
  const views = savedViews();
  views.set(name, view);
  store(views);
}

export function removeView(name) {
  const views = savedViews();
  views.delete(name);
  store(views);
}

function store(views) {
  try {
    localStorage.setItem(KEY, JSON.stringify(Object.fromEntries(views)));
  } catch {
    // storage is blocked or full: the view is not kept
  }
}

/** All samples of the picture, one row for each. */
export function csv(capture) {
  const lines = [["cycle", "time", ...capture.channels.map(({ name }) => quoted(name))].join(",")];
  for (const { cycle, time, values } of capture.rows()) lines.push([cycle, time.toFixed(6), ...values].join(","));
  return lines.join("\n") + "\n";
}

const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

export function download(name, text, type = "text/csv") {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
