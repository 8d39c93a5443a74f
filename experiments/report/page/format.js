// Numbers as a reader wants them: SI in, sensible prefixes and digits out. A missing number is a dash.

const prefixes = {
  Pa: [
    [1e9, "GPa"],
    [1e6, "MPa"],
    [1e3, "kPa"],
    [1, "Pa"],
  ],
  "N/m": [
    [1e9, "GN/m"],
    [1e6, "MN/m"],
    [1e3, "kN/m"],
    [1, "N/m"],
  ],
  N: [
    [1e3, "kN"],
    [1, "N"],
    [1e-3, "mN"],
    [1e-6, "µN"],
  ],
  m: [
    [1, "m"],
    [1e-3, "mm"],
    [1e-6, "µm"],
  ],
};
const ratios = new Set(["", "1", "-", "ratio", "m/m"]);
const missing = "–";

const finite = (v) => typeof v === "number" && Number.isFinite(v);
const isRatio = (unit) => unit === undefined || unit === null || ratios.has(unit);
const isStrain = (name) => /strain/.test(String(name));
const list = (value) => (Array.isArray(value) ? value : []);

const greek = {
  alpha: "α",
  beta: "β",
  gamma: "γ",
  delta: "δ",
  eta: "η",
  theta: "θ",
  lambda: "λ",
  mu: "µ",
  nu: "ν",
  rho: "ρ",
  sigma: "σ",
  tau: "τ",
  phi: "φ",
  psi: "ψ",
};
const subscripts = {
  a: "ₐ",
  e: "ₑ",
  h: "ₕ",
  i: "ᵢ",
  j: "ⱼ",
  k: "ₖ",
  l: "ₗ",
  m: "ₘ",
  n: "ₙ",
  o: "ₒ",
  p: "ₚ",
  r: "ᵣ",
  s: "ₛ",
  t: "ₜ",
  u: "ᵤ",
  v: "ᵥ",
  x: "ₓ",
};

// A symbol written in ASCII as it is set in print: "phi" -> "φ", "k_t/k_n" -> "kₜ/kₙ".
const symbolText = (symbol) =>
  String(symbol)
    .replace(/[a-z]+/g, (word) => (Object.hasOwn(greek, word) ? greek[word] : word))
    .replace(/_([a-z])(?![a-z])/g, (whole, letter) => subscripts[letter] ?? whole);

// Words for a name: "axial_strain" -> "axial strain".
const words = (name) => String(name ?? "").replace(/_/g, " ");
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

function superscript(exponent) {
  return String(exponent).replace(/[-\d]/g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]));
}

// `digits` significant digits, with a power of ten when the number is very large or small.
function number(value, digits = 3) {
  if (!finite(value)) return missing;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${minus(mantissa)} × 10${superscript(Number(exponent))}`;
  }
  const rounded = Number(value.toPrecision(digits));
  return minus(Math.abs(rounded) >= 10 ** (digits - 1) ? String(Math.round(value)) : rounded.toPrecision(digits));
}

// The same without trailing zeros, for labels of ticks and cells.
const short = (value, digits = 3) =>
  finite(value)
    ? number(value, digits)
        .replace(/(\.\d*?)0+($| )/, "$1$2")
        .replace(/\.($| )/, "$1")
    : missing;

const minus = (text) => String(text).replace("-", "−");

// The prefix in which `size` reads as at least `least`, as [factor, unit]; null if the unit takes none.
function prefixFor(unit, size, least) {
  const steps = Object.hasOwn(prefixes, unit) ? prefixes[unit] : null;
  if (!steps) return null;
  return steps.find(([step]) => size >= least * step * (1 - 1e-9)) ?? steps[steps.length - 1];
}

// How to show many numbers on one axis: {factor, unit}; shown = SI value × factor. Strains become percent; the largest
// number reads as at least `least` in its unit: 6 mm of displacement are not 6,000 µm, while few kPa read better in Pa.
function displayScale(unit, values, name, least = unit === "m" ? 1 : 10) {
  if (isRatio(unit)) return isStrain(name) ? { factor: 100, unit: "%" } : { factor: 1, unit: "" };
  const largest = values.reduce((m, v) => (finite(v) ? Math.max(m, Math.abs(v)) : m), 0);
  const prefix = prefixFor(unit, largest || 1, least);
  return prefix ? { factor: 1 / prefix[0], unit: prefix[1] } : { factor: 1, unit: String(unit) };
}

const axisTitle = (name, scale) => (scale.unit ? `${name} (${scale.unit})` : name);
const degrees = (rad) => `${number((rad * 180) / Math.PI, 3)}°`;

// A number with its unit; an angle also in degrees.
function quantity(value, unit, digits = 3) {
  if (!finite(value)) return missing;
  if (isRatio(unit)) return number(value, digits);
  if (unit === "rad") return `${number(value, digits)} rad (${degrees(value)})`;
  const prefix = value === 0 ? null : prefixFor(unit, Math.abs(value), 1);
  return prefix ? `${number(value / prefix[0], digits)} ${prefix[1]}` : `${number(value, digits)} ${unit}`;
}

// An interval; both ends share a unit when they can. For an angle, intervalNote gives the degrees.
function interval(low, high, unit, digits = 3) {
  if (!finite(low) || !finite(high)) return missing;
  if (isRatio(unit)) return `${number(low, digits)} to ${number(high, digits)}`;
  if (unit === "rad") return `${number(low, digits)} to ${number(high, digits)} rad`;
  const ends = [low, high].map((v) => (v === 0 ? null : prefixFor(unit, Math.abs(v), 1)));
  const step = ends[1];
  if (step && (!ends[0] || ends[0][1] === step[1] || Math.abs(low) >= 0.01 * step[0])) {
    return `${number(low / step[0], digits)} to ${number(high / step[0], digits)} ${step[1]}`;
  }
  return `${quantity(low, unit, digits)} to ${quantity(high, unit, digits)}`;
}

const intervalNote = (low, high, unit) =>
  unit === "rad" && finite(low) && finite(high) ? `(${degrees(low)} to ${degrees(high)})` : "";

// An error of a curve. A strain is written as 0.0067 m/m, the way errors of compression curves are compared.
function curveError(value, unit, channel) {
  if (!finite(value)) return missing;
  if (!isRatio(unit)) return quantity(value, unit);
  const text = value >= 1e-5 ? String(Number(value.toPrecision(3)).toFixed(5)).replace(/0$/, "") : number(value);
  return isStrain(channel) ? `${text} m/m` : text;
}

function duration(seconds) {
  if (!finite(seconds)) return missing;
  if (seconds < 10) return `${number(seconds, 2)} s`;
  const whole = Math.round(seconds);
  const parts = [
    [Math.floor(whole / 3600), "h"],
    [Math.floor(whole / 60) % 60, "min"],
    [whole % 60, "s"],
  ];
  return parts
    .filter(([n], i) => n > 0 || (i === 2 && whole === 0))
    .slice(0, 2)
    .map(([n, u]) => `${n} ${u}`)
    .join(" ");
}

const percent = (share, digits = 2) => (finite(share) ? `${number(100 * share, digits)} %` : missing);

// Tick positions for a logarithmic axis between two positive numbers: decades when there are many, then 1-2-5, then
// every digit, and round numbers as on a linear axis when the ends are close.
function logTicks(low, high) {
  const within = (v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9);
  const kinds = [[1], [1, 2, 5], [1, 2, 3, 4, 5, 6, 7, 8, 9]];
  for (const mantissas of kinds.slice(Math.log10(high / low) > 3.5 ? 0 : 1)) {
    const ticks = [];
    for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); ++k) {
      ticks.push(...mantissas.map((m) => Number(`${m}e${k}`)).filter(within));
    }
    if (ticks.length >= 3) return ticks;
  }
  const exponent = Math.floor(Math.log10((high - low) / 3));
  const digit = [5, 2, 1].find((m) => m * 10 ** exponent * 3 <= high - low) ?? 1;
  const first = Math.ceil(low / (digit * 10 ** exponent));
  return Array.from({ length: 8 }, (_, i) => Number(`${(first + i) * digit}e${exponent}`)).filter(within);
}

// Linear interpolation quantile of finite numbers, p in [0, 1].
function quantile(values, p) {
  const sorted = values.filter(finite).sort((a, b) => a - b);
  if (sorted.length === 0) return NaN;
  const at = p * (sorted.length - 1);
  const below = Math.floor(at);
  const above = Math.min(below + 1, sorted.length - 1);
  return sorted[below] + (at - below) * (sorted[above] - sorted[below]);
}

const mean = (values) => values.reduce((s, v) => s + v, 0) / values.length;

Object.assign(exports, {
  finite,
  isRatio,
  isStrain,
  list,
  symbolText,
  words,
  capital,
  number,
  short,
  displayScale,
  axisTitle,
  degrees,
  quantity,
  interval,
  intervalNote,
  curveError,
  duration,
  percent,
  logTicks,
  quantile,
  mean,
  missing,
});
