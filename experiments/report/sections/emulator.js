// Can the emulator be trusted? Each run is predicted by an emulator that has not seen it (leave one out).
const { el, table } = require("page/dom.js");
const { chart } = require("page/chart.js");
const { finite, list, mean, number, percent } = require("page/format.js");
const { agreementSpec, outputSpec, residualHistogramSpec } = require("sections/emulator_charts.js");

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
    rows.push(
      ...group.map((r) => ({ output, predicted: (r.predicted - centre) / sd, actual: (r.actual - centre) / sd })),
    );
  }
  return { rows, q2 };
}

// The quantile of the standard normal distribution, by bisection of its distribution function; p in (0, 1).
// The function: Abramowitz & Stegun 26.2.17, error below 1e-7.
function normalQuantile(p) {
  const density = (x) => Math.exp(-0.5 * x * x) / Math.sqrt(2 * Math.PI);
  const upperTail = (x) => {
    const t = 1 / (1 + 0.2316419 * x);
    return (
      density(x) * t * (0.31938153 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))))
    );
  };
  if (p > 0.5) return -normalQuantile(1 - p);
  let [low, high] = [0, 9];
  for (let i = 0; i < 40; ++i) {
    const middle = 0.5 * (low + high);
    if (upperTail(middle) > p) low = middle;
    else high = middle;
  }
  return -0.5 * (low + high);
}

const thin = (rows, most) => rows.filter((_, i) => i % Math.ceil(rows.length / most) === 0);
function agreementChart(grid, rows) {
  const overall = 1 - mean(rows.map((r) => (r.predicted - r.actual) ** 2));
  const every = Math.ceil(rows.length / mostSymbols);
  chart(grid, {
    title: "Predicted and actual",
    caption:
      `${rows.length} left-out values in standard deviations of their output; explained share of variance ` +
      `${number(overall)}.${every > 1 ? ` One in ${every} is drawn.` : ""}`,
    makeSpec: (width) => {
      const points = thin(rows, mostSymbols).map((r) => ({ x: r.predicted, y: r.actual }));
      return agreementSpec(points, "Predicted", "Actual", width);
    },
  });
}

function residualCharts(grid, zs, coverage) {
  const quantiles = zs.map((z, i) => ({ x: normalQuantile((i + 0.5) / zs.length), y: z }));
  chart(grid, {
    title: "Quantiles of the residuals",
    caption:
      "Residuals over their predicted standard deviation. On the line: the emulator’s intervals are right; " +
      "steeper: too narrow; flatter: too wide.",
    makeSpec: (width) => agreementSpec(thin(quantiles, 300), "Standard normal", "Standardised residual z", width),
  });
  const share = finite(coverage) ? coverage : zs.filter((z) => Math.abs(z) <= 1.645).length / zs.length;
  chart(grid, {
    title: "Distribution of the residuals",
    caption: `Dashed: standard normal. ${percent(share)} of the left-out values lie in their 90 % interval.`,
    makeSpec: (width) => residualHistogramSpec(zs, width),
  });
}

function outputChart(parent, emulator, q2) {
  const names = list(emulator.outputs);
  const rows = q2.map((q, i) => ({ index: i, name: String(names[i]), value: Math.sqrt(Math.max(0, 1 - q)) }));
  const known = rows.filter((r) => finite(r.value));
  if (known.length < 2) return;
  const rmse = list(emulator.rmse).filter(finite);
  const own =
    rmse.length > 0
      ? ` As RMSE on the emulator’s own scale: ${number(Math.min(...rmse))} to ${number(Math.max(...rmse))}.`
      : "";
  chart(parent, {
    title: "Error by output",
    caption:
      "Leave-one-out error of each output, over the output’s standard deviation among the runs: " +
      `0 is perfect, 1 is no better than the mean.${own}`,
    makeSpec: (width) => outputSpec(known, "Error / spread", width),
  });
}

function looCharts(parent, emulator) {
  const loo = list(emulator.loo);
  const { rows, q2 } = standardise(loo, list(emulator.outputs).length);
  const zs = loo
    .map((r) => r.z)
    .filter(finite)
    .sort((a, b) => a - b);
  const grid = el("div", "grid narrow");
  parent.append(grid);
  if (rows.length > 0) agreementChart(grid, rows);
  if (zs.length > 0) residualCharts(grid, zs, emulator.coverage90);
  outputChart(parent, emulator, q2);
}

function rounds(rows) {
  return el(
    "div",
    "",
    el("h3", "", "Rounds of checking against DEM"),
    el(
      "p",
      "note",
      "After each fit the emulator is compared with new DEM runs at the estimate; runs are added where the difference is more than tolerable or would shift the parameters.",
    ),
    table(
      [
        { head: "Round", cell: (r) => String(rows.indexOf(r) + 1) },
        { head: "DEM runs", number: true, cell: (r) => String(r.runs ?? "–") },
        { head: "Difference / tolerable", number: true, cell: (r) => number(r.difference) },
        { head: "Shift / sd", number: true, cell: (r) => number(r.shift) },
        { head: "Limit", number: true, cell: (r) => number(r.limit) },
        { head: "What was concluded", cell: (r) => String(r.text ?? "") },
      ],
      rows,
      "compact",
    ),
  );
}

function render(parent, data) {
  const emulator = data.emulator;
  parent.append(
    el(
      "p",
      "note",
      "The emulator stands in for the DEM between its runs. Here each run in turn is left out and predicted from the others.",
    ),
  );
  if (list(emulator.loo).length > 0) looCharts(parent, emulator);
  else if (finite(emulator.coverage90))
    parent.append(el("p", "", `${percent(emulator.coverage90)} of left-out runs lie in the emulator’s 90 % interval.`));
  if (list(emulator.rounds).length > 0) parent.append(rounds(list(emulator.rounds)));
}

exports.render = render;
