// Motions of an axis that a page has begun, and their ends.

const [BEGIN, STEP] = [300, 50]; // ms until the state tells of an accepted motion; between two looks

/** Whether the axis stands without an error once its motion has ended; false as well when `goesOn` says no before. */
export async function arrived(store, axis, goesOn = () => true) {
  await pause(BEGIN);
  while (goesOn() && /Motion|Homing|Stopping/.test(store.state(axis).state || "")) await pause(STEP);
  return goesOn() && store.state(axis).state === "Standstill";
}

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
