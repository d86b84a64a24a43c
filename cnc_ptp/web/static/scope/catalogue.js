// Which signals there are.
import { unitSign } from "../format.js";

/** Unit -> its fields, as the server tells them. */
export function signalsOf(store) {
  return new Map(Object.entries(store.machine?.signals || {}).map(([unit, fields]) => [unit, fields.map(({ field }) => field)]));
}

/** Of a signal, as people read it; "" of one that is computed. */
export function unitOfSignal(store, name) {
  const [unit, field] = name.split(".");
  return unitSign(store.machine?.signals?.[unit]?.find((one) => one.field === field)?.unit);
}
