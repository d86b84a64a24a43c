// What shows the chosen channel is made anew when another one is chosen.

/** Calls `fill(root)`, which fills an element and gives what ends that, now and for each other channel; returns what ends all. */
export function followChannel({ store }, root, fill) {
  let end = fill(root);
  const stop = store.on("channel", () => {
    end?.();
    root.replaceChildren();
    end = fill(root);
  });
  return () => {
    stop();
    end?.();
  };
}
