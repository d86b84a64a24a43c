// Which signals there are.

const OF_KIND = {
  axis: ["set_position", "actual_position", "set_velocity", "actual_velocity", "set_acceleration", "set_jerk", "following_error", "command_velocity", "feedforward_velocity", "actual_torque", "override_percent", "state", "status_bits", "error_id"],
  spindle: ["set_speed_rpm", "actual_speed_rpm", "programmed_speed_rpm", "set_position_deg", "actual_position_deg", "following_error_deg", "override_percent", "gear", "state", "error_id"],
  channel: ["path_velocity", "programmed_feed", "override_percent", "distance_to_go", "line", "block_number", "state", "error_id"],
};

/** Unit -> its fields, as the server tells them or as the blocks of its kind have them. */
export function signalsOf(store) {
  const told = store.machine?.signals;
  if (told) return new Map(Object.entries(told).map(([unit, fields]) => [unit, fields.map((field) => field.field ?? field)]));
  return new Map((store.machine?.units || []).filter((unit) => OF_KIND[unit.kind]).map((unit) => [unit.name, OF_KIND[unit.kind]]));
}
