// A map of one number for each parameter and each reading of a curve: darker is more; the numbers are written in
// where there is room.
const { palette } = require("page/chart.js");
const { at, by, figure, mark } = require("page/marks.js");
const { finite, list, short } = require("page/format.js");
const { testAxes } = require("page/test_axes.js");

const shades = ["#f5f8fb", "#08306b"];
const rowHeight = 30;

// The runs of equal phase, as [{first, last, phase}].
function phaseRuns(phases) {
  const runs = [];
  phases.forEach((phase, i) => {
    if (i > 0 && phases[i - 1] === phase) runs[runs.length - 1].last = i;
    else runs.push({ first: i, last: i, phase: String(phase) });
  });
  return runs;
}

// A bracket with the name under the readings of each phase; none if there is one phase.
function phaseMarks(runs, height) {
  if (runs.length < 2) return [];
  return runs.flatMap((run) => {
    const ends = {
      x: { ...at("column", run.first), offset: 2 },
      x2: { ...at("column", run.last), band: 1, offset: -2 },
    };
    const name = { y: height + 31, dx: 2, baseline: "top", text: run.phase, fontSize: 11, fill: palette.muted };
    return [
      mark("rule", null, ends, { y: height + 26, stroke: palette.rule }),
      mark("text", null, { x: at("column", run.first) }, name),
    ];
  });
}

function cellMarks(count, width) {
  const bar = {
    x: by("column", "i"),
    width: { scale: "column", band: 1 },
    y: by("row", "row"),
    height: { scale: "row", band: 1 },
  };
  const shade = by("shade", "value");
  const seams = count > 40 ? { stroke: shade } : {}; // between many narrow cells the background would shine through
  const marks = [
    mark("rect", "cells", { ...bar, fill: shade, ...seams }, { stroke: "#ffffff", strokeWidth: count > 40 ? 0.5 : 1 }),
  ];
  if (width / count >= 27) {
    const middle = { x: { ...by("column", "i"), band: 0.5 }, y: { ...by("row", "row"), band: 0.5 } };
    const color = [{ test: "datum.value > 0.55", value: "#ffffff" }, { value: palette.ink }];
    const text = { signal: "format(datum.value, '.2f')" };
    marks.push(
      mark("text", "cells", { ...middle, text, fill: color }, { align: "center", baseline: "middle", fontSize: 10 }),
    );
  }
  return marks;
}

// Labels of a band axis whose domain are positions, taken from the ordinal scale `names`.
const named = (names) => ({ labels: { update: { text: { signal: `scale('${names}', datum.value)` } } } });
const positions = (values) => values.map((_, i) => i);

function mapAxes(title, phases) {
  const plain = { ticks: false };
  const bottom = { title, titlePadding: phases ? 26 : 7, labelFontSize: 10, encode: named("columnName") };
  const left = { domain: false, labelFontSize: 13, labelLimit: 105, encode: named("rowName") };
  return [
    { scale: "column", orient: "bottom", ...plain, ...bottom },
    { scale: "row", orient: "left", ...plain, ...left },
  ];
}

// rows: an array for each of `labels`, parallel to along.x, values 0 to 1; along: the test as testAxes takes it.
function heatMapSpec(labels, rows, along, figureWidth) {
  const axes = testAxes(along);
  const width = figureWidth - 24 - Math.min(110, 8 * Math.max(...labels.map((text) => text.length)));
  const height = rowHeight * labels.length;
  const runs = phaseRuns(along.phase);
  const cells = rows.flatMap((row, k) => list(row).map((value, i) => ({ row: k, i, value })));
  const band = (name, values, size) => ({
    name,
    type: "band",
    domain: positions(values),
    range: [0, size],
    padding: 0,
  });
  const names = (name, range) => ({ name, type: "ordinal", domain: positions(range), range });
  return figure(width, height, {
    data: [{ name: "cells", values: cells.filter((cell) => finite(cell.value) && cell.row < labels.length) }],
    scales: [
      band("column", along.x, width),
      band("row", labels, height),
      { name: "shade", type: "linear", domain: [0, 1], range: shades, clamp: true },
      names(
        "columnName",
        along.x.map((x) => short(axes.xShown(x), 3)),
      ),
      names("rowName", labels),
    ],
    axes: mapAxes(axes.xTitle, runs.length > 1),
    marks: [...cellMarks(along.x.length, width), ...phaseMarks(runs, height)],
  });
}

exports.heatMapSpec = heatMapSpec;
