// The page: a table of sections, each shown when the document holds what it needs.
const { el } = require("page/dom.js");
const { drawAll, fail } = require("page/chart.js");
const { list } = require("page/format.js");

const has = (value) => Boolean(value) && typeof value === "object" && Object.keys(value).length > 0;

// To add a section: a file in sections/ with `render(parent, document)`, and a line here.
const sections = [
  { id: "diagnosis", title: "Diagnosis", module: "sections/diagnosis.js", wanted: (d) => has(d.diagnosis) },
  {
    id: "atlas",
    title: "Signatures of the effects",
    module: "sections/atlas.js",
    wanted: (d) => list(d.atlas).length > 0,
  },
  {
    id: "samples",
    title: "Samples",
    module: "sections/bulk_samples.js",
    wanted: (d) => list(d.bulk?.samples).length > 0,
  },
  {
    id: "groups",
    title: "Groups of samples",
    module: "sections/bulk_groups.js",
    wanted: (d) => list(d.bulk?.statistics?.groupings).length > 0,
  },
  {
    id: "correlations",
    title: "Rank correlations",
    module: "sections/bulk_correlations.js",
    wanted: (d) => list(d.bulk?.statistics?.correlation).length > 1,
  },
  {
    id: "ensemble",
    title: "Ensemble and measurements",
    module: "sections/bulk_ensemble.js",
    wanted: (d) => list(d.bulk?.coverage).length > 0,
  },
  {
    id: "parameters",
    title: "Parameters",
    module: "sections/parameters.js",
    wanted: (d) => list(d.parameters).length > 0,
  },
  {
    id: "tests",
    title: "Measured and simulated",
    module: "sections/tests.js",
    wanted: (d) => list(d.tests).length > 0,
  },
  {
    id: "crosstest",
    title: "Every set on every test",
    module: "sections/crosstest.js",
    wanted: (d) => list(d.crosstest?.curves).length > 0,
  },
  {
    id: "joint",
    title: "What each test says",
    module: "sections/joint.js",
    wanted: (d) => list(d.identification?.files).length > 1,
  },
  {
    id: "posterior",
    title: "Posterior",
    module: "sections/posterior.js",
    wanted: (d) => list(d.posterior?.draws).length > 0,
  },
  {
    id: "sensitivity",
    title: "Sensitivity",
    module: "sections/sensitivity.js",
    wanted: (d) => list(d.sensitivity?.names).length > 0,
  },
  { id: "emulator", title: "Emulator", module: "sections/emulator.js", wanted: (d) => has(d.emulator) },
  {
    id: "packing",
    title: "Packing and force chains",
    module: "sections/packing.js",
    wanted: (d) => list(d.packing?.x).length > 0,
  },
  {
    id: "quasi-static",
    title: "Quasi-static loading",
    module: "sections/quasi_static.js",
    wanted: (d) => has(d.quasi_static),
  },
  { id: "settings", title: "Settings", module: "sections/settings.js", wanted: (d) => Boolean(d.settings) },
];

// Vega's expressions cannot hold the line separators of Unicode, which look like a space anyway.
const read = (json) =>
  JSON.parse(json, (_, value) => (typeof value === "string" ? value.replace(/[\u2028\u2029]/g, " ") : value));

async function start() {
  const report = document.getElementById("report");
  const data = read(document.getElementById("document").textContent);
  document.title = `loam ${data.verb}: ${data.name}`;
  const shown = sections.filter((section) => section.wanted(data));
  require("sections/header.js").render(report, data, shown);
  for (const section of shown) {
    const body = el("div");
    const part = el("section", "", el("h2", "", section.title), body);
    part.id = section.id;
    report.append(part);
    try {
      require(section.module).render(body, data);
    } catch (error) {
      fail(body, `The section “${section.title}”`, error);
    }
  }
  require("sections/header.js").footer(report, data);
  await drawAll();
  document.documentElement.dataset.report = "complete";
}

exports.start = start;
