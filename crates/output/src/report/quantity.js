// Numbers with units: stresses in MPa, lengths in mm, other units with a power of ten where needed.

const TAKES_PREFIX = ["Pa", "J", "N", "s", "m", "W", "Hz", "J/m", "N/m"];
const PREFIXES = ["p", "n", "\u00b5", "m", "", "k", "M", "G", "T"];

/** Decimal exponent of a magnitude; a little above, so that 1000 counts as such in spite of rounding. */
function exponentOf(magnitude) {
  return magnitude > 0 ? Math.floor(Math.log10(magnitude) + 1e-9) : 0;
}

function superscript(number) {
  return String(number).replace(/[-0-9]/g, (c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c]));
}

/** Factor from SI to what is shown, and the unit shown, for values up to `largest`. */
function scaleFor(unit, largest) {
  const exponent = exponentOf(largest);
  if (TAKES_PREFIX.includes(unit)) {
    const thousands = Math.max(-4, Math.min(4, Math.floor(exponent / 3)));
    return { factor: 10 ** (-3 * thousands), unit: PREFIXES[thousands + 4] + unit };
  }
  if (exponent >= -2 && exponent <= 3) return { factor: 1, unit };
  return { factor: 10 ** -exponent, unit: `10${superscript(exponent)} ${unit}`.trim() };
}

/** A number with so many significant digits, without an exponent where that stays short. */
function digits(value, count = 5) {
  if (value === null || !Number.isFinite(value)) return "\u2013";
  if (value === 0) return "0";
  const exponent = exponentOf(Math.abs(value));
  const text = exponent < -4 || exponent > 8
    ? value.toExponential(count - 1)
    : value.toFixed(Math.max(0, count - 1 - exponent));
  return text.replace("-", "\u2212").replace("e+", "e");
}

/** A single value in the unit that suits it: `[number, unit]`. */
function shownValue(value, unit, count = 5) {
  const scale = scaleFor(unit, Math.abs(value));
  return [digits(value * scale.factor, count), scale.unit];
}

/** `12.3 ms` */
function withUnit(value, unit, count = 5) {
  return shownValue(value, unit, count).join(" ").trim();
}

/** Label of an axis. */
function labelled(name, unit) {
  return unit ? `${name} (${unit})` : name;
}

/** Round values between two others, about `count` of them, and the decimals they need. */
function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0)) return { values: [low], decimals: 0 };
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= raw * (1 - 1e-9));
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) values.push(i * step);
  let decimals = 0;
  while (decimals < 12 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals += 1;
  return { values, decimals };
}

function tickText(value, decimals) {
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}
