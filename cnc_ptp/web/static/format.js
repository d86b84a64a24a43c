// Numbers and times as pages show them.

const MISSING = "–";

/** A fixed number of decimals with a true minus sign; no number is a dash. */
export function fixed(value, decimals = 3) {
  if (typeof value !== "number" || !Number.isFinite(value)) return MISSING;
  const text = value.toFixed(decimals);
  const zero = Number(text) === 0;
  return (zero ? text.replace("-", "") : text).replace("-", "−");
}

/** As short as it may be with so many digits. */
export function short(value, digits = 5) {
  if (typeof value !== "number" || !Number.isFinite(value)) return MISSING;
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e6 || size < 1e-4 ? value.toExponential(2) : String(Number(value.toPrecision(digits)));
  return text.replace("-", "−");
}

/** Seconds as 1:02:03, or 12.3 s. */
export function duration(seconds) {
  if (typeof seconds !== "number" || seconds < 0) return MISSING;
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const two = (number) => String(number).padStart(2, "0");
  return hours ? `${hours}:${two(minutes)}:${two(rest)}` : `${minutes}:${two(rest)}`;
}

export function bytes(size) {
  if (size < 1000) return `${size} B`;
  return size < 1e6 ? `${(size / 1e3).toFixed(1)} kB` : `${(size / 1e6).toFixed(1)} MB`;
}

export const percent = (value, decimals = 0) => (typeof value === "number" ? `${fixed(value, decimals)} %` : MISSING);

/** Unit of an argument of a command for an axis of mm or of degrees: the texts of the server have both. */
export function argumentUnit({ unit }, { unit: length }) {
  const both = (unit || "").split(", ");
  const [straight, turns] = [both.find((one) => one.startsWith("mm")), both.find((one) => one.startsWith("°"))];
  return both.length === 2 && straight && turns ? (length === "deg" ? turns : straight) : unit || "";
}

/** deg is what the server says, ° what people read. */
export const unitSign = (unit) => ({ deg: "°", "deg/s": "°/s", "deg/s^2": "°/s²", "mm/s^2": "mm/s²", "mm/s^3": "mm/s³", "deg/s^3": "°/s³" })[unit] || unit || "";
