// Homing of all axes, one after the other: Z first, so that the tool is out of the way of the others.
import { arrived } from "../motion.js";

/** Asks, and homes until an axis does not arrive or `goesOn` says no. */
export async function homeAll(app, goesOn) {
  const order = homingOrder(app.store);
  const names = order.map((name) => name.toUpperCase()).join(", ");
  if (!window.confirm(`Home all axes, one after the other: ${names}? Look whether their ways are free.`)) return;
  for (const name of order) {
    if (!goesOn() || !(await app.command(name, "home"))) return;
    if (await arrived(app.store, name, () => goesOn() && app.store.holds)) continue;
    app.notices.show("warning", `Axis ${name} has not ended its homing; the axes behind it are not homed.`);
    return;
  }
}

/** All axes, that of Z first, of each channel. */
export function homingOrder(store) {
  const down = new Set(store.of("channel").flatMap(({ axes }) => axes.filter(({ name }) => name === "Z").map(({ unit }) => unit)));
  const names = store.of("axis").map(({ name }) => name);
  return [...names.filter((name) => down.has(name)), ...names.filter((name) => !down.has(name))];
}
