// The diagnosis: where the model fails, which effects were considered, which of them the tests cannot tell apart, and
// what adding the named one does to the curves that were left out.
const { el, table } = require("page/dom.js");
const { chart } = require("page/chart.js");
const { capital, list, number, short, words } = require("page/format.js");
const { makeSpec } = require("sections/test_chart.js");

const regionOrder = [
  "low stress",
  "middle stress",
  "high stress",
  "unloading",
  "reloading",
  "initial",
  "peak",
  "softening",
  "residual",
  "contraction",
  "dilation",
];

// Blue where the measurement lies below the model, red where above; pale below the threshold.
function zColour(z, threshold) {
  const strength = Math.min(1, Math.abs(z) / (2 * threshold));
  const alpha = (0.08 + 0.72 * strength).toFixed(2);
  return z > 0 ? `rgba(178, 24, 43, ${alpha})` : `rgba(33, 102, 172, ${alpha})`;
}

function zCell(region, threshold) {
  if (!region) return "";
  const cell = el("span", "z", `${region.z > 0 ? "+" : "−"}${Math.abs(region.z).toFixed(1)}`);
  cell.style.background = zColour(region.z, threshold);
  if (Math.abs(region.z) > threshold) cell.style.fontWeight = "bold";
  return cell;
}

// Tests by regions.
function map(regions, threshold) {
  const names = regionOrder.filter((name) => regions.some((r) => r.region === name));
  const rows = new Map();
  for (const region of regions) {
    const key = `${region.test}, ${words(region.channel)}`;
    rows.set(key, { key, ...rows.get(key), [region.region]: region });
  }
  return table(
    [
      { head: "Curve", cell: (row) => row.key },
      ...names.map((name) => ({ head: capital(name), number: true, cell: (row) => zCell(row[name], threshold) })),
    ],
    [...rows.values()],
    "regions",
  );
}

const yesNo = (value) => (value === undefined ? "" : value ? "yes" : "no");

function candidates(rows) {
  const led = (row, text) => (row.stage === "ensemble" ? text(row) : "–");
  return table(
    [
      { head: "Effect", cell: (c) => words(c.effect) },
      { head: "Judged by", cell: (c) => (c.stage === "ensemble" ? "its own ensemble" : "its fingerprint") },
      { head: "Log evidence over base", number: true, cell: (c) => number(c.log_score, 3) },
      { head: "Probability", number: true, cell: (c) => led(c, (r) => r.probability.toFixed(2)) },
      { head: "Held-out gain", number: true, cell: (c) => led(c, (r) => number(r.held_out_gain, 3)) },
      { head: "Fits (p)", number: true, cell: (c) => led(c, (r) => number(r.fit_p, 2)) },
      { head: "Strength (SI)", number: true, cell: (c) => led(c, (r) => number(r.strength, 3)) },
      { head: "Physical", cell: (c) => led(c, (r) => yesNo(r.physical && r.present)) },
      {
        head: "Would have shown from",
        number: true,
        cell: (c) => (c.never_detectable ? "never" : number(c.detectable_strength, 2)),
      },
    ],
    rows,
  );
}

function cosines(prints) {
  const names = list(prints.names);
  return table(
    [
      { head: "Effect", cell: (row) => words(row.name) },
      { head: "Size (noises)", number: true, cell: (row) => number(row.size, 2) },
      ...names.map((name, k) => ({ head: words(name), number: true, cell: (row) => row.cosines[k].toFixed(2) })),
    ],
    names.map((name, k) => ({ name, size: prints.size[k], cosines: prints.cosines[k] })),
  );
}

function heldOut(before, after) {
  return table(
    [
      { head: "Test left out", cell: (row) => row.test },
      { head: "Error of the base model", number: true, cell: (row) => number(row.gap, 3) },
      { head: "Error with the effect", number: true, cell: (row) => number(row.after, 3) },
    ],
    before.map((row) => ({ ...row, after: list(after).find((a) => a.test === row.test)?.gap ?? NaN })),
  );
}

// What each kind of test asks for, fitted alone: one row for each parameter of each pair of kinds.
function sets(pairs) {
  const rows = [];
  for (const pair of pairs) {
    const [first, second] = pair.kinds;
    const after = pair.after?.parameters;
    const names = Object.keys((after ?? pair.before.parameters)[first]);
    const verdict = (at) => (at ? `p = ${number(at.p_value, 2)} (χ² ${number(at.statistic, 3)} on ${at.degrees})` : "–");
    rows.push({ head: `${words(first)} and ${words(second)}`, before: verdict(pair.before), after: verdict(pair.after) });
    for (const name of names) {
      const both = (of) =>
        of?.[first][name] === undefined ? "–" : `${number(of[first][name], 3)} and ${number(of[second][name], 3)}`;
      rows.push({ head: `· ${words(name)} (SI)`, before: both(pair.before.parameters), after: both(after) });
    }
  }
  return table(
    [
      { head: "Sets by each kind of test alone", cell: (row) => row.head },
      { head: "Base model", number: true, cell: (row) => row.before },
      { head: "With the effect", number: true, cell: (row) => row.after },
    ],
    rows,
    "sets",
  );
}

function extendedTests(parent, tests) {
  const grid = el("div", "grid wide");
  parent.append(el("h3", "", "The model with the effect"), grid);
  for (const test of tests)
    chart(grid, {
      title: [test.file, words(test.channel)].join(" · "),
      caption: "Simulated: mean of direct DEM runs with the effect, refitted.",
      makeSpec: (width) => makeSpec(test, width),
    });
}

function render(parent, data) {
  const d = data.diagnosis;
  const say = (text) => parent.append(el("p", "", text));
  say(
    `Each number says how far the measured curve lies above (+) or below (−) the calibrated model in a region, in ` +
      `standard deviations, after all that the parameters can absorb. Beyond ±${short(d.threshold, 2)} (bold) it is no chance. ` +
      `For all regions together p = ${number(d.p_value, 2)}.`,
  );
  parent.append(map(list(d.regions), d.threshold));
  if (d.next_test) say(`What to measure next: ${d.next_test}.`);
  parent.append(el("h3", "", "Effects considered"), candidates(list(d.candidates)));
  say("Held-out gain: log score of curves predicted from the other tests, above that of the base model.");
  if (list(d.fingerprints?.names).length > 0) {
    parent.append(el("h3", "", "What these tests can tell apart"), cosines(d.fingerprints));
    say("Cosines of the effects’ fingerprints after all that parameters can absorb; 1: the tests cannot tell them apart.");
  }
  if (list(d.held_out_before).length > 0) {
    parent.append(el("h3", "", "Curves left out"), heldOut(list(d.held_out_before), d.held_out_after));
    say("Root of the mean square error of the prediction over the noise; 1: noise alone.");
  }
  if (list(d.sets).length > 0) {
    parent.append(el("h3", "", "Do the kinds of test ask for the same parameters?"), sets(list(d.sets)));
    say("A small p says no: what the model lacks is then taken out of its parameters, by each kind of test in its own way.");
  }
  if (list(d.tests_after).length > 0) extendedTests(parent, list(d.tests_after));
}

exports.render = render;
