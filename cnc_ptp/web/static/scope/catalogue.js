// Which signals there are.

/** Unit -> its fields, as the server tells them. */
export function signalsOf(store) {
  return new Map(Object.entries(store.machine?.signals || {}).map(([unit, fields]) => [unit, fields.map(({ field }) => field)]));
}
