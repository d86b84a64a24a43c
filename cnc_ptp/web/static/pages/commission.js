// Commission: the pages of an axis, a spindle, a channel, or the machine.
import { field, h, select, tabs } from "../dom.js";
import { onlineAxis, onlineSpindle } from "../commission/online.js";
import { commandForms } from "../commission/command_forms.js";
import { circleTest } from "../commission/circle_test.js";
import { driveView } from "../commission/drive.js";
import { identifyView } from "../commission/identify.js";
import { parameterBrowser } from "../commission/parameters.js";
import { ptpTest } from "../commission/ptp_test.js";
import { spindleCurve } from "../commission/spindle_curve.js";
import { followChannel } from "./follow_channel.js";

const AXIS = {
  Functions: ["power", "reset", "move_absolute", "move_relative", "move_modulo", "move_additive", "move_velocity", "move_superimposed", "halt_superimposed", "halt", "stop", "hold_stop", "feed_hold", "home", "emergency_stop", "new_target", "new_velocity_and_target", "set_position", "external_enable", "external_disable"],
  Dynamics: ["set_override", "set_override_type", "set_feedforward", "reset_feedforward", "set_friction_compensation", "set_feed_release"],
  Coupling: ["couple", "couple_gantry", "couple_cyclic", "couple_flying_saw", "couple_cam", "change_cam", "set_coupling_factor", "set_cyclic_factor", "decouple"],
  Compensation: ["compensation_start", "compensation_stop", "set_friction_compensation"],
};
const KINDS = { axis: "Axis", spindle: "Spindle", channel: "Channel", plc: "Machine" };

export function mount(root, app) {
  const { store } = app;
  const units = [...store.machine.units];
  units.sort((a, b) => Object.keys(KINDS).indexOf(a.kind) - Object.keys(KINDS).indexOf(b.kind));
  const choice = select(units.map(({ name, kind }) => [name, kind === "plc" ? KINDS.plc : `${KINDS[kind]} ${name}`]));
  const body = h("div", {});
  let shown = null;
  function show() {
    shown?.end();
    const unit = store.unit(choice.value);
    shown = tabs(`Pages of ${unit.name}`, pagesOf(app, unit));
    body.replaceChildren(shown.element);
  }
  choice.addEventListener("change", show);
  root.append(h("div", { class: "row" }, field("Unit", choice)), body);
  if (units.length) show();
  return { unmount: () => shown?.end() };
}

/** Page -> function that fills it. */
function pagesOf(app, unit) {
  const place = (view) => (body) => {
    const { element, end } = view(app, unit);
    body.append(element);
    return end;
  };
  const forms = (names) => place(() => commandForms(app, unit, names));
  const known = Object.keys(app.store.machine.commands?.[unit.kind] || {});
  const parameters = { Parameters: place(parameterBrowser) };
  if (unit.kind === "axis") {
    const functions = Object.fromEntries(Object.entries(AXIS).map(([name, commands]) => [name, forms(commands)]));
    return { Online: place(onlineAxis), "PTP test": place(ptpTest), ...functions, Identify: place(identifyView), "Circle test": (body) => followChannel(app, body, place(circleTest)), ...parameters, Drive: place(driveView) };
  }
  if (unit.kind === "spindle") return { Online: place(onlineSpindle), Functions: forms(known), Curve: place(spindleCurve), ...parameters };
  if (unit.kind === "plc") return parameters; // the plc has those of the machine
  return { Functions: forms(known), ...parameters };
}
