// Short forms of what Vega specs repeat: encodings, scales, marks, a figure of one panel, a histogram.
const { palette } = require("page/chart.js");

const by = (scale, field) => ({ scale, field });
const at = (scale, value) => ({ scale, value });

// A mark; `style` holds plain values by channel, `place` the encodings that depend on data or scales.
function mark(type, data, place, style, extra) {
  const constants = Object.fromEntries(Object.entries(style ?? {}).map(([key, value]) => [key, { value }]));
  return { type, ...(data ? { from: { data } } : {}), encode: { update: { ...constants, ...place } }, ...extra };
}

const linear = (name, domain, range, extra) => ({ name, type: "linear", domain, range, zero: false, ...extra });

// A y scale from zero to the largest of [{data, field}].
const upwards = (fields, height) => ({ name: "y", type: "linear", domain: { fields }, range: [height, 0], zero: true });

// The width of numbers, ticks and title of a left axis.
const leftAxis = 62;

const figure = (width, height, parts) => ({ width, height, padding: 3, ...parts });

// The data of a histogram of `values` with `count` bars between `low` and `high`, as a density (area 1).
function histogramData(name, values, low, high, count) {
  // Longer by a hair: Vega puts what lies above low + count * step, by rounding alone, into a bin at infinity.
  const step = ((high - low) / count) * (1 + 1e-12);
  const bins = { type: "bin", field: "value", extent: [low, high], step, nice: false, as: ["low", "high"] };
  const totals = { type: "aggregate", groupby: ["low", "high"], ops: ["count"], as: ["count"] };
  const density = { type: "formula", as: "density", expr: `datum.count / ${values.length * step}` };
  return { name, values: values.map((value) => ({ value })), transform: [bins, totals, density] };
}

// Its bars on the scales x and y; `edge(end)` encodes the ends "low" and "high".
function histogramBars(name, height, edge) {
  const place = { x: edge("low"), x2: edge("high"), y: by("y", "density") };
  return mark("rect", name, place, { y2: height, fill: palette.band, stroke: palette.simulated, strokeWidth: 0.6 });
}

const dashedLine = (data, x, y, stroke) =>
  mark(
    "line",
    data,
    { x: by("x", x), y: by("y", y) },
    { stroke, strokeWidth: 1.8, strokeDash: [6, 4] },
    { clip: true },
  );

Object.assign(exports, {
  at,
  by,
  dashedLine,
  figure,
  histogramBars,
  histogramData,
  leftAxis,
  linear,
  mark,
  upwards,
});
