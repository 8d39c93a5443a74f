// Can the emulator be trusted? Each run is predicted by an emulator that has not seen it (leave one out).
const { el, table } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { finite, list, mean, number, percent } = require("page/format.js");

const mostSymbols = 1500;

// Outputs have units and spreads of their own, so predictions are compared in standard deviations of each output
// over the runs. Gives {rows: [{output, predicted, actual, z}], q2: predictive coefficient by output}.
function standardise(loo, outputCount) {
  const byOutput = new Map();
  for (const row of loo) {
    if (![row.predicted, row.actual].every(finite)) continue;
    if (!byOutput.has(row.output)) byOutput.set(row.output, []);
    byOutput.get(row.output).push(row);
  }
  const rows = [];
  const q2 = Array(outputCount).fill(NaN);
  for (const [output, group] of byOutput) {
    const centre = mean(group.map((r) => r.actual));
    const variance = mean(group.map((r) => (r.actual - centre) ** 2));
    if (!(variance > 0)) continue;
    const sd = Math.sqrt(variance);
    q2[output] = 1 - mean(group.map((r) => (r.predicted - r.actual) ** 2)) / variance;
    rows.push(...group.map((r) => ({ output, predicted: (r.predicted - centre) / sd, actual: (r.actual - centre) / sd })));
  }
  return { rows, q2 };
}

// The quantile of the standard normal distribution, by bisection of its distribution function; p in (0, 1).
// The function: Abramowitz & Stegun 26.2.17, error below 1e-7.
function normalQuantile(p) {
  const density = (x) => Math.exp(-0.5 * x * x) / Math.sqrt(2 * Math.PI);
  const upperTail = (x) => {
    const t = 1 / (1 + 0.2316419 * x);
    return density(x) * t * (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  };
  if (p > 0.5) return -normalQuantile(1 - p);
  let [low, high] = [0, 9];
  for (let i = 0; i < 40; ++i) {
    const middle = 0.5 * (low + high);
    if (upperTail(middle) > p) low = middle; else high = middle;
  }
  return -0.5 * (low + high);
}

const thin = (rows, most) => rows.filter((_, i) => i % Math.ceil(rows.length / most) === 0);
const linear = (name, domain, range, extra) => ({ name, type: "linear", domain, range, zero: false, ...extra });

// Square plot of points against the line y = x.
function agreementSpec(rows, xTitle, yTitle, figureWidth) {
  const side = Math.min(figureWidth - 62, 300);
  const ends = rows.flatMap((r) => [r.x, r.y]);
  const domain = [Math.min(...ends), Math.max(...ends)];
  return {
    width: side, height: side, padding: 3,
    data: [{ name: "points", values: rows }],
    scales: [linear("x", domain, [0, side], { nice: true }), linear("y", domain, [side, 0], { nice: true })],
    axes: [{ scale: "x", orient: "bottom", title: xTitle, grid: true, tickCount: 6 }, { scale: "y", orient: "left", title: yTitle, grid: true, tickCount: 6 }],
    marks: [
      { type: "symbol", from: { data: "points" }, encode: { update: { x: { scale: "x", field: "x" }, y: { scale: "y", field: "y" }, size: { value: 16 },
        fill: { value: palette.simulated }, fillOpacity: { value: 0.45 } } } },
      { type: "rule", encode: { update: { x: { scale: "x", value: domain[0] }, y: { scale: "y", value: domain[0] }, x2: { scale: "x", value: domain[1] },
        y2: { scale: "y", value: domain[1] }, stroke: { value: palette.ink }, strokeWidth: { value: 1.2 } } } },
    ],
  };
}

function residualHistogramSpec(zs, figureWidth) {
  const [width, height, step, reach] = [figureWidth - 24, Math.min(figureWidth - 62, 300), 0.4, 4];
  const normal = Array.from({ length: 81 }, (_, i) => { const x = -reach + i * 0.1; return { x, density: Math.exp(-0.5 * x * x) / Math.sqrt(2 * Math.PI) }; });
  return {
    width, height, padding: 3,
    data: [
      { name: "bins", values: zs.map((z) => ({ z: Math.max(-reach, Math.min(reach - 1e-9, z)) })), transform: [
        { type: "bin", field: "z", extent: [-reach, reach], step, nice: false, as: ["low", "high"] },
        { type: "aggregate", groupby: ["low", "high"], ops: ["count"], as: ["count"] },
        { type: "formula", as: "density", expr: `datum.count / ${zs.length * step}` }] },
      { name: "normal", values: normal },
    ],
    scales: [linear("x", [-reach, reach], [0, width]),
      { name: "y", type: "linear", zero: true, range: [height, 0], domain: { fields: [{ data: "bins", field: "density" }, { data: "normal", field: "density" }] } }],
    axes: [{ scale: "x", orient: "bottom", title: "Standardised residual z", tickCount: 8 }],
    marks: [
      { type: "rect", from: { data: "bins" }, encode: { update: { x: { scale: "x", field: "low" }, x2: { scale: "x", field: "high" },
        y: { scale: "y", field: "density" }, y2: { value: height }, fill: { value: palette.band }, stroke: { value: palette.simulated }, strokeWidth: { value: 0.6 } } } },
      { type: "line", from: { data: "normal" }, encode: { update: { x: { scale: "x", field: "x" }, y: { scale: "y", field: "density" },
        stroke: { value: palette.ink }, strokeWidth: { value: 1.6 }, strokeDash: { value: [6, 4] } } } },
    ],
  };
}

function outputSpec(rows, title, figureWidth) {
  const width = figureWidth - 62;
  const height = 150;
  const many = rows.length > 40;
  const axis = many ? { labels: false, ticks: false, title: "Outputs, in the order of the curves" } : { labelAngle: -40, labelAlign: "right", labelLimit: 130, labelBaseline: "middle", labelOverlap: false };
  return {
    width, height, padding: 3,
    data: [{ name: "outputs", values: rows }],
    scales: [{ name: "x", type: "band", domain: { data: "outputs", field: "index" }, range: [0, width], padding: many ? 0 : 0.35 },
      { name: "names", type: "ordinal", domain: rows.map((r) => r.index), range: rows.map((r) => r.name) },
      { name: "y", type: "linear", domain: { data: "outputs", field: "value" }, range: [height, 0], zero: true, nice: true }],
    axes: [{ scale: "x", orient: "bottom", ...axis, encode: { labels: { update: { text: { signal: "scale('names', datum.value)" } } } } },
      { scale: "y", orient: "left", title, grid: true, tickCount: 4 }],
    marks: [{ type: "rect", from: { data: "outputs" }, encode: { update: { x: { scale: "x", field: "index" }, width: { scale: "x", band: 1 },
      y: { scale: "y", field: "value" }, y2: { value: height }, fill: { value: palette.band }, stroke: { value: palette.simulated }, strokeWidth: { value: many ? 0 : 0.6 } } } }],
  };
}

function looCharts(parent, emulator) {
  const loo = list(emulator.loo);
  const outputs = list(emulator.outputs);
  const { rows, q2 } = standardise(loo, outputs.length);
  const zs = loo.map((r) => r.z).filter(finite).sort((a, b) => a - b);
  const grid = el("div", "grid narrow");
  parent.append(grid);
  if (rows.length > 0) {
    const overall = 1 - mean(rows.map((r) => (r.predicted - r.actual) ** 2));
    chart(grid, { title: "Predicted and actual", caption: `${rows.length} left-out values in standard deviations of their output; explained share of variance ${number(overall)}.`
      + (rows.length > mostSymbols ? ` Every ${Math.ceil(rows.length / mostSymbols)}th is drawn.` : ""),
      makeSpec: (width) => agreementSpec(thin(rows, mostSymbols).map((r) => ({ x: r.predicted, y: r.actual })), "Predicted", "Actual", width) });
  }
  if (zs.length > 0) {
    const qq = zs.map((z, i) => ({ x: normalQuantile((i + 0.5) / zs.length), y: z }));
    chart(grid, { title: "Quantiles of the residuals", caption: "Residuals over their predicted standard deviation. On the line: the emulator’s intervals are right; steeper: too narrow; flatter: too wide.",
      makeSpec: (width) => agreementSpec(thin(qq, 300), "Standard normal", "Standardised residual z", width) });
    const share = zs.filter((z) => Math.abs(z) <= 1.645).length / zs.length;
    chart(grid, { title: "Distribution of the residuals", caption: `Dashed: standard normal. ${percent(finite(emulator.coverage90) ? emulator.coverage90 : share)} of the left-out `
      + "values lie in their 90 % interval.", makeSpec: (width) => residualHistogramSpec(zs, width) });
  }
  const error = q2.map((q, i) => ({ index: i, name: String(outputs[i]), value: Math.sqrt(Math.max(0, 1 - q)), rmse: list(emulator.rmse)[i] })).filter((r) => finite(r.value));
  if (error.length > 1) {
    const rmse = list(emulator.rmse).filter(finite);
    const caption = "Leave-one-out error of each output, over the output’s standard deviation among the runs: 0 is perfect, 1 is no better than the mean."
      + (rmse.length > 0 ? ` As RMSE on the emulator’s own scale: ${number(Math.min(...rmse))} to ${number(Math.max(...rmse))}.` : "");
    chart(parent, { title: "Error by output", caption, makeSpec: (width) => outputSpec(error, "Error / spread", width) });
  }
}

function rounds(rows) {
  return el("div", "", el("h3", "", "Rounds of checking against DEM"),
    el("p", "note", "After each fit the emulator is compared with new DEM runs at the estimate; runs are added where they disagree by more than their noise."),
    table([
      { head: "Round", cell: (r) => String(rows.indexOf(r) + 1) },
      { head: "DEM runs", number: true, cell: (r) => String(r.runs ?? "–") },
      { head: "Disagreement", number: true, cell: (r) => number(r.disagreement) },
      { head: "Noise", number: true, cell: (r) => number(r.noise) },
      { head: "What was concluded", cell: (r) => String(r.text ?? "") },
    ], rows, "compact"));
}

function render(parent, data) {
  const emulator = data.emulator;
  parent.append(el("p", "note", "The emulator stands in for the DEM between its runs. Here each run in turn is left out and predicted from the others."));
  if (list(emulator.loo).length > 0) looCharts(parent, emulator);
  else if (finite(emulator.coverage90)) parent.append(el("p", "", `${percent(emulator.coverage90)} of left-out runs lie in the emulator’s 90 % interval.`));
  if (list(emulator.rounds).length > 0) parent.append(rounds(list(emulator.rounds)));
}

exports.render = render;
