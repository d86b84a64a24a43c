// Keys that jog: those of X, Y and Z belong to the axes with these names.

/** Of the first, second and third axis: the key in the negative, and the one in the positive direction; its sign, and its name. */
export const PAIRS = [
  [["ArrowLeft", "←"], ["ArrowRight", "→"]],
  [["ArrowDown", "↓"], ["ArrowUp", "↑"]],
  [["PageDown", "⇟", "Page down"], ["PageUp", "⇞", "Page up"]],
];
const NAMES = ["x", "y", "z"];
const KEYS = Object.fromEntries(PAIRS.flatMap(([[negative], [positive]], i) => [[negative, [i, -1]], [positive, [i, 1]]]));
const CONTROLS = "input, select, textarea, [role=listbox], [role=tab]";

/** The axis of each pair of keys; undefined: these keys move nothing. Axes that all have other names count in their order. */
export function axesOfKeys(axes) {
  const named = NAMES.map((wanted) => axes.find(({ name }) => name.toLowerCase() === wanted));
  return named.some(Boolean) ? named : NAMES.map((_, i) => axes[i]);
}

/** Jogs `axesOfKeys` while `isOn()`; `velocity(axis, sign, fast)` gives a function that says how fast. Returns what ends it. */
export function jogKeys(jogger, ofKeys, velocity, isOn) {
  const rapid = new Set(); // axes that Shift has made rapid
  function down(event) {
    const key = KEYS[event.key];
    if (!key || !isOn() || document.querySelector("dialog[open]") || event.ctrlKey || event.altKey || event.metaKey || event.target.closest?.(CONTROLS)) return;
    event.preventDefault();
    const axis = ofKeys[key[0]];
    if (!axis || event.repeat) return;
    if (event.shiftKey) rapid.add(axis.name);
    else rapid.delete(axis.name);
    jogger.start(axis.name, velocity(axis, key[1], event.shiftKey)());
  }
  function up(event) {
    if (event.key === "Shift") rapid.forEach((name) => jogger.stop(name));
    const key = KEYS[event.key];
    const axis = key && ofKeys[key[0]];
    if (axis) jogger.stop(axis.name);
  }
  document.addEventListener("keydown", down);
  document.addEventListener("keyup", up);
  return () => {
    jogger.stopAll();
    document.removeEventListener("keydown", down);
    document.removeEventListener("keyup", up);
  };
}
