// Parameter sets fitted to different tests: their numbers beside each other, and every curve under every set.
const { el, table } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { capital, curveError, finite, interval, list, number, quantity, symbolText, words } = require("page/format.js");
const { scales, testAxes, xAxis, yAxis } = require("page/test_axes.js");
const { by, leftAxis, mark } = require("page/marks.js");

// One look for each set, by colour and dash.
const looks = [
  { stroke: palette.simulated, dash: [] },
  { stroke: palette.alarm, dash: [7, 4] },
  { stroke: palette.muted, dash: [2, 3] },
];

function parameterTable(sets) {
  const rows = list(sets[0].parameters).map((_, k) => sets.map((set) => set.parameters[k]));
  const cell = (s) => (row) =>
    el(
      "div",
      "",
      el("strong", "", quantity(row[s].estimate, row[s].unit)),
      el("div", "note", interval(row[s].q05, row[s].q95, row[s].unit)),
    );
  return table(
    [
      {
        head: "Parameter",
        cell: (row) => el("div", "", el("span", "symbol", symbolText(row[0].symbol)), " ", words(row[0].name)),
      },
      ...sets.map((set, s) => ({ head: capital(set.name), number: true, cell: cell(s) })),
    ],
    rows,
    "parameters",
  );
}

function differenceTable(differences) {
  return table(
    [
      { head: "Shift from triaxial to direct shear", cell: (d) => words(d.parameter) },
      { head: "Triaxial", number: true, cell: (d) => quantity(d.triaxial, d.unit) },
      { head: "Direct shear", number: true, cell: (d) => quantity(d.direct_shear, d.unit) },
      { head: "In standard deviations", number: true, cell: (d) => number(d.z, 2) },
      { head: "Probability by chance", number: true, cell: (d) => number(d.p_value, 2) },
    ],
    differences,
  );
}

function errorTable(tests, data) {
  return table(
    [
      { head: "Error of direct DEM runs", cell: (row) => `${tests[row].file} · ${words(tests[row].channel)}` },
      ...data.sets.map((set, s) => ({
        head: capital(set.name),
        number: true,
        cell: (row) => curveError(data.curves[s].rmse[row], tests[row].unit ?? tests[row].y_unit, tests[row].channel),
      })),
    ],
    tests.map((_, k) => k),
  );
}

function makeSpec(test, names, simulated, figureWidth) {
  const axes = testAxes(test, simulated);
  const width = figureWidth - leftAxis - 16;
  const height = Math.round(Math.min(300, Math.max(200, 0.55 * width)));
  const points = (ys) =>
    list(test.x)
      .map((x, k) => ({ x: axes.xShown(x), y: axes.yShown(ys[k]) }))
      .filter((p) => finite(p.x) && finite(p.y));
  const lines = simulated.map((ys, s) => ({ name: `set${s}`, values: points(ys) }));
  const place = { x: by("x", "x"), y: by("y", "y") };
  return {
    width,
    height,
    padding: 3,
    data: [{ name: "measured", values: points(list(test.measured)) }, ...lines],
    scales: [
      ...scales(axes, width, height),
      { name: "stroke", type: "ordinal", domain: names, range: names.map((_, s) => looks[s].stroke) },
      { name: "dash", type: "ordinal", domain: names, range: names.map((_, s) => looks[s].dash) },
    ],
    axes: [xAxis(axes), yAxis(axes)],
    legends: [
      {
        stroke: "stroke",
        strokeDash: "dash",
        orient: "top",
        direction: "horizontal",
        symbolType: "stroke",
        symbolSize: 260,
        symbolStrokeWidth: 2.2,
      },
    ],
    marks: [
      ...lines.map((line, s) =>
        mark("line", line.name, place, { stroke: looks[s].stroke, strokeDash: looks[s].dash, strokeWidth: 2.2 }),
      ),
      mark("symbol", "measured", place, { size: 34, fill: palette.ink, stroke: "#ffffff", strokeWidth: 0.6 }),
    ],
  };
}

function render(parent, data) {
  const cross = data.crosstest;
  const tests = list(data.tests);
  parent.append(parameterTable(cross.sets));
  if (list(cross.differences).length > 0) parent.append(differenceTable(cross.differences));
  if (cross.test) parent.append(el("p", "remark", `Tested by the ${cross.test}.`));
  parent.append(errorTable(tests, cross));
  const grid = el("div", "grid wide");
  parent.append(grid);
  const names = cross.sets.map((set) => `fitted to ${set.name === "joint" ? "all" : set.name}`);
  tests.forEach((test, k) => {
    if (list(test.x).length === 0) return;
    chart(grid, {
      title: `${test.file} · ${words(test.channel)}`,
      caption: "Points: measured. Lines: mean of direct DEM runs with each of the parameter sets.",
      makeSpec: (width) =>
        makeSpec(
          test,
          names,
          cross.curves.map((c) => c.simulated[k]),
          width,
        ),
    });
  });
}

exports.render = render;
