// The path that the axes of a recording have really gone.
import { readRecorded } from "../scope/samples.js";

const POINTS = 50000;

/** x, y, z of actual positions in machine coordinates, as the path is drawn; a missing axis is 0. Rejects with a Refusal. */
export async function measuredPath({ store, connection }) {
  const axes = store.unit(store.channel)?.axes || [];
  const units = ["X", "Y", "Z"].map((name) => axes.find((axis) => axis.name === name)?.unit);
  const known = units.filter(Boolean);
  const { start, end } = store.machine;
  const signals = known.map((unit) => `${unit}.actual_position`).join(",");
  const bytes = await connection.http(`/api/recorded?signals=${encodeURIComponent(signals)}&from=${start}&to=${end}&points=${POINTS}&bits=32`, { as: "bytes" });
  const { columns, count } = readRecorded(bytes);
  const positions = new Float32Array(3 * count);
  units.forEach((unit, k) => {
    if (!unit) return;
    const column = columns[known.indexOf(unit)];
    for (let i = 0; i < count; i++) positions[3 * i + k] = column[i];
  });
  return positions;
}
