// Which part of the curve each parameter moves: shares of variance along the curve, and the curve with each
// parameter low and high.
const { el } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { by, figure, mark } = require("page/marks.js");
const { finite, list, quantity, symbolText, words } = require("page/format.js");
const { segments } = require("page/phases.js");
const { scales, testAxes, xAxis, yAxis } = require("page/test_axes.js");
const { heatMapSpec } = require("sections/heat_map.js");

// The test whose curve the indices follow, cut to the fields that the axes need.
function subject(data) {
  const s = data.sensitivity;
  const test = list(data.tests)[s.test ?? 0] ?? {};
  const x = list(s.x).length > 0 ? s.x : list(test.x);
  const phase = list(test.phase).length === x.length ? test.phase : [];
  return {
    test,
    along: {
      x,
      phase,
      x_name: test.x_name ?? "position",
      x_unit: test.x_unit,
      x_log: test.x_log,
      y_unit: test.y_unit,
      channel: test.channel ?? "output",
    },
  };
}

function curveRows(along, axes, curve) {
  const rows = along.x.map((x, i) => ({
    x: axes.xShown(x),
    y: axes.yShown(curve[i]),
    phase: String(along.phase[i] ?? ""),
  }));
  return segments(rows, ["x", "y"]);
}

function lowHighSpec(along, test, low, high, figureWidth) {
  const axes = testAxes({ ...along, measured: test.measured }, [low, high]);
  const [width, height] = [figureWidth - 70, 190];
  const place = { x: by("x", "x"), y: by("y", "y") };
  const measured = list(test.x)
    .map((x, i) => ({ x: axes.xShown(x), y: axes.yShown(list(test.measured)[i]) }))
    .filter((r) => finite(r.x) && finite(r.y));
  const line = (name, strokeDash) => ({
    type: "group",
    from: { facet: { name: `${name}_segment`, data: name, groupby: "segment" } },
    marks: [mark("line", `${name}_segment`, place, { stroke: palette.simulated, strokeWidth: 2, strokeDash })],
  });
  return figure(width, height, {
    data: [
      { name: "low", values: curveRows(along, axes, low) },
      { name: "high", values: curveRows(along, axes, high) },
      { name: "measured", values: measured },
    ],
    scales: scales(axes, width, height),
    axes: [xAxis(axes), yAxis(axes)],
    marks: [
      mark("symbol", "measured", place, { size: measured.length > 60 ? 8 : 22, fill: palette.rule }),
      line("low", [5, 3]),
      line("high", []),
    ],
  });
}

const maps = [
  {
    key: "total",
    title: "Total share of variance",
    caption: "What each parameter moves, alone or together with others; columns may sum to more than one.",
  },
  {
    key: "first_order",
    title: "Share of variance alone",
    caption: "What each parameter moves by itself. What is missing to the total acts together with others.",
  },
];

// A chart for each parameter whose low and high curve are known. rows: the parameters as in the document's table.
function lowHighCharts(s, rows, symbols, along, test) {
  const grid = el("div", "grid narrow");
  rows.forEach((p, k) => {
    const [low, high] = [list(list(s.low)[k]), list(list(s.high)[k])];
    if (!low.some(finite) || !high.some(finite)) return;
    const known = finite(p.prior_q05) && finite(p.prior_q95);
    const [from, to] = known ? [quantity(p.prior_q05, p.unit), quantity(p.prior_q95, p.unit)] : ["low", "high"];
    chart(grid, {
      title: `${symbols[k]}, ${words(p.name)}`,
      caption: `Dashed: ${from}. Solid: ${to}.`,
      makeSpec: (width) => lowHighSpec(along, test, low, high, width),
    });
  });
  return grid;
}

function render(parent, data) {
  const s = data.sensitivity;
  const { test, along } = subject(data);
  const rows = s.names.map((name) => list(data.parameters).find((p) => p.name === name) ?? { name });
  const symbols = rows.map((p) => symbolText(p.symbol ?? p.name));
  const where = ["Along the curve", test.file, words(test.channel)].filter(Boolean).join(" · ");
  parent.append(el("p", "note", `${where}, by the emulator, with the parameters varied over the prior.`));
  const grid = el("div", "grid wide");
  parent.append(grid);
  for (const { key, title, caption } of maps) {
    if (list(s[key]).length === 0) continue;
    chart(grid, { title, caption, makeSpec: (width) => heatMapSpec(symbols, s[key], along, width) });
  }
  const curves = lowHighCharts(s, rows, symbols, along, test);
  if (curves.children.length === 0) return;
  parent.append(
    el("h3", "", "The curve with each parameter low and high"),
    el(
      "p",
      "note",
      "At the ends of the prior’s 90 % interval, the other parameters at the estimate. Grey points: measured.",
    ),
    curves,
  );
}

exports.render = render;
