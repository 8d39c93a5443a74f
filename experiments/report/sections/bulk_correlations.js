// Spearman's rank correlations of parameters and covariates as a map; an asterisk marks p < 0.05.
const { chart, palette } = require("page/chart.js");
const { by, figure, mark } = require("page/marks.js");
const { finite, words } = require("page/format.js");

const cellHeight = 26;
const labelWidth = 170;

function spec(statistics, figureWidth) {
  const names = statistics.quantities.map((q) => words(q.name));
  const indices = names.map((_, i) => i);
  const width = figureWidth - labelWidth - 10;
  const height = cellHeight * names.length;
  const cells = statistics.correlation.flatMap((row, i) =>
    row.map((r, j) => ({ i, j, r, text: `${r.toFixed(2)}${statistics.significance[i][j] < 0.05 ? "*" : ""}` })),
  );
  const named = { labels: { update: { text: { signal: "scale('names', datum.value)" } } } };
  const place = {
    x: by("column", "j"),
    width: { scale: "column", band: 1 },
    y: by("row", "i"),
    height: { scale: "row", band: 1 },
    fill: by("shade", "r"),
  };
  const middle = { x: { ...by("column", "j"), band: 0.5 }, y: { ...by("row", "i"), band: 0.5 } };
  const ink = [{ test: "abs(datum.r) > 0.6", value: "#ffffff" }, { value: palette.ink }];
  const look = { align: "center", baseline: "middle", fontSize: width / names.length < 40 ? 8 : 10 };
  return figure(width, height, {
    data: [{ name: "cells", values: cells.filter((cell) => finite(cell.r) && cell.j <= cell.i) }],
    scales: [
      { name: "column", type: "band", domain: indices, range: [0, width] },
      { name: "row", type: "band", domain: indices, range: [0, height] },
      { name: "names", type: "ordinal", domain: indices, range: names },
      { name: "shade", type: "linear", domain: [-1, 0, 1], range: ["#8c2d04", "#f7f7f7", "#08306b"], clamp: true },
    ],
    axes: [
      { scale: "column", orient: "bottom", ticks: false, labelAngle: -40, labelAlign: "right", labelOverlap: false, encode: named },
      { scale: "row", orient: "left", ticks: false, labelLimit: labelWidth, labelOverlap: false, encode: named },
    ],
    marks: [
      mark("rect", "cells", place, { stroke: "#ffffff" }),
      mark("text", "cells", { ...middle, text: { field: "text" }, fill: ink }, look),
    ],
  });
}

function render(parent, data) {
  const { statistics } = data.bulk;
  const caption = "Spearman's rank correlation of calibrated samples; an asterisk marks significance at 5 %.";
  chart(parent, { caption, makeSpec: (width) => spec(statistics, width) });
}

exports.render = render;
