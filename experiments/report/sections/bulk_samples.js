// A bulk study's samples: measured against simulated strains of all of them, the ones that fit worst, and a page for
// each sample, shown when its name is chosen.
const { chart, drawAll } = require("page/chart.js");
const { el, table } = require("page/dom.js");
const { curveError, finite, interval, list, number, quantity, words } = require("page/format.js");
const { agreementSpec } = require("sections/emulator_charts.js");
const { makeSpec } = require("sections/test_chart.js");

const anchor = (sample) => `sample-${encodeURIComponent(sample.sample)}`;
const link = (sample) => {
  const a = el("a", "", sample.sample);
  a.href = `#${anchor(sample)}`;
  return a;
};
const error = (value) => (finite(value) ? curveError(Math.abs(value), "m/m", "axial_strain") : "");
const signed = (value) => (finite(value) ? (value < 0 ? "−" : "") + error(value) : "");

const columns = [
  { head: "Sample", cell: link },
  { head: "Status", cell: (s) => (s.followed === false ? `${s.status}, not followed` : s.status) },
  { head: "Error", number: true, cell: (s) => error(s.rmse) },
  { head: "Mean error", number: true, cell: (s) => signed(s.me) },
  { head: "Scatter of packings", number: true, cell: (s) => error(s.packing_sd) },
  { head: "Reason", cell: (s) => s.reason ?? "" },
];

// The samples of equal reason together, most frequent reason first.
function reasons(samples) {
  const groups = new Map();
  for (const s of samples.filter((sample) => sample.reason)) {
    const kind = s.reason.replace(/[−-]?\d[\d.e+-]*/g, "…");
    groups.set(kind, [...(groups.get(kind) ?? []), s]);
  }
  return [...groups.entries()].sort((a, b) => b[1].length - a[1].length);
}

// What the test charts of a single calibration want.
const asTest = (s) => ({
  kind: "oedometer",
  file: s.sample,
  channel: "axial_strain",
  x_name: "axial_stress",
  x_unit: "Pa",
  x_log: true,
  y_unit: "m/m",
  x: s.stress,
  phase: list(s.stress).map(() => "loading"),
  measured: s.measured,
  simulated: s.simulated ?? s.predicted,
  replicates: s.replicates,
  rmse: s.rmse,
  unit: "m/m",
  points: list(s.stress).length,
});

const parameterColumns = [
  { head: "Parameter", cell: ([name]) => words(name) },
  { head: "Estimate", number: true, cell: ([, p]) => quantity(p.estimate, p.unit) },
  { head: "90 % interval", number: true, cell: ([, p]) => (p.fixed ? "fixed" : interval(p.q05, p.q95, p.unit)) },
  { head: "Identified", cell: ([, p]) => (p.identified ? "yes" : "no") },
];

function samplePage(place, sample) {
  place.replaceChildren(el("h3", "", `Sample ${sample.sample}`));
  place.append(el("p", "", sample.reason ? `${sample.status}: ${sample.reason}` : sample.status));
  if (sample.parameters) place.append(table(parameterColumns, Object.entries(sample.parameters)));
  const test = asTest(sample);
  if (list(test.x).length > 1 && list(test.simulated).length > 0) chart(place, { makeSpec: (width) => makeSpec(test, width) });
}

// Follows the address: report.html#sample-NAME shows that sample's page.
function followAddress(place, samples) {
  const show = (event) => {
    const sample = samples.find((s) => `#${anchor(s)}` === location.hash);
    if (!sample) return;
    samplePage(place, sample);
    if (event) drawAll(); // at first the page draws all charts itself
    place.scrollIntoView();
  };
  addEventListener("hashchange", show);
  show();
}

const shownAtMost = 200;

const methodColumns = [
  { head: "Method, and whose curves", cell: (m) => m.name },
  { head: "Error", number: true, cell: (m) => error(m.rmse) },
  { head: "Mean error", number: true, cell: (m) => signed(m.me) },
  { head: "r", number: true, cell: (m) => number(m.pearson_r, 4) },
];

// The two methods beside each other, and beside the paper that the study repeats.
function methodsTable(bulk) {
  const rows = [];
  if (finite(bulk.overall.rmse)) rows.push({ name: `${bulk.method}: direct runs at its estimates`, ...bulk.overall });
  if (bulk.methods) {
    rows.push({ name: "emulator: its own curves", ...bulk.methods.emulator });
    rows.push({ name: "inverse kriging from the same runs: the emulator's curves", ...bulk.methods["inverse-kriging"] });
  }
  rows.push({ name: "De Pue et al. (2019), inverse kriging of 125 other samples: direct runs", rmse: 0.0067, me: 0.00297, pearson_r: 0.99 });
  return table(methodColumns, rows);
}

function render(parent, data) {
  const { samples, overall } = data.bulk;
  parent.append(el("h3", "", "Methods beside each other"), methodsTable(data.bulk));
  const points = samples.flatMap((s) => list(s.simulated).map((y, k) => ({ x: s.measured[k], y })));
  if (points.length > 0) {
    const text = `Error ${curveError(overall.rmse, "m/m", "axial_strain")}, mean error ${signed(overall.me)}, r = ${number(overall.pearson_r, 4)}, ${overall.readings} readings. De Pue et al. (2019): 0.0067 m/m, 0.00297 m/m, r = 0.99.`;
    chart(parent, {
      title: "Measured and simulated strain",
      caption: text,
      makeSpec: (width) => agreementSpec(points, "Measured strain (m/m)", "Simulated strain (m/m)", width),
    });
  }
  const page = el("div", "sample-page");
  parent.append(page);
  const worst = samples.filter((s) => finite(s.rmse)).sort((a, b) => b.rmse - a.rmse);
  if (worst.length > 0) parent.append(el("h3", "", "The samples that fit worst"), table(columns, worst.slice(0, 10)));
  const why = reasons(samples);
  if (why.length > 0) {
    parent.append(el("h3", "", "What could not be calibrated or is not followed, and why"));
    for (const [kind, group] of why)
      parent.append(el("p", "", `${group.length}: ${kind} (`, ...group.flatMap((s, i) => [i ? ", " : "", link(s)]), ")"));
  }
  const shown = samples.slice(0, shownAtMost);
  parent.append(el("h3", "", "All samples"), table(columns, shown));
  if (shown.length < samples.length)
    parent.append(el("p", "", `${samples.length - shown.length} more are in parameters.csv and result.json.`));
  followAddress(page, samples);
}

exports.render = render;
