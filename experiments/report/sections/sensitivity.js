// Which part of the curve each parameter moves: shares of variance along the curve, and the curve with each
// parameter low and high.
const { el } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { finite, list, quantity, short, words } = require("page/format.js");
const { segments } = require("page/phases.js");
const { scales, testAxes, xAxis, yAxis } = require("page/test_axes.js");

const dark = "#08306b";

// The test whose curve the indices follow, cut to the fields that the axes need.
function subject(data) {
  const s = data.sensitivity;
  const test = list(data.tests)[s.test ?? 0] ?? {};
  const x = list(s.x).length > 0 ? s.x : list(test.x);
  const phase = list(test.phase).length === x.length ? test.phase : [];
  return { test, along: { x, phase, x_name: test.x_name ?? "position", x_unit: test.x_unit, x_log: test.x_log,
    y_unit: test.y_unit, channel: test.channel ?? "output" } };
}

// The runs of equal phase, as [{first, last, phase}].
function phaseRuns(phases) {
  const runs = [];
  phases.forEach((phase, i) => {
    if (i > 0 && phases[i - 1] === phase) runs[runs.length - 1].last = i;
    else runs.push({ first: i, last: i, phase: String(phase) });
  });
  return runs;
}

function cells(s, indices) {
  return indices.flatMap((row, k) => list(row).map((value, i) => ({ row: k, i, value })))
    .filter((cell) => finite(cell.value) && cell.row < s.names.length);
}

function heatSpec(s, symbols, indices, along, figureWidth) {
  const axes = testAxes(along);
  const m = along.x.length;
  const width = figureWidth - 24 - Math.min(110, 8 * Math.max(...symbols.map((text) => text.length)));
  const height = 30 * symbols.length;
  const names = (name, range) => ({ name, type: "ordinal", domain: range.map((_, i) => i), range });
  const runs = phaseRuns(along.phase);
  const at = (i, edge) => ({ scale: "column", value: i, ...(edge ? { band: 1 } : {}) });
  const phaseMarks = runs.length < 2 ? [] : runs.flatMap((run) => [
    { type: "rule", encode: { update: { x: { ...at(run.first), offset: 2 }, x2: { ...at(run.last, true), offset: -2 }, y: { value: height + 26 }, stroke: { value: palette.rule } } } },
    { type: "text", encode: { update: { x: at(run.first), dx: { value: 2 }, y: { value: height + 31 }, baseline: { value: "top" },
      text: { value: run.phase }, fontSize: { value: 11 }, fill: { value: palette.muted } } } }]);
  const numbers = width / m >= 27 ? [{ type: "text", from: { data: "cells" }, encode: { update: { x: { scale: "column", field: "i", band: 0.5 }, y: { scale: "row", field: "row", band: 0.5 },
    align: { value: "center" }, baseline: { value: "middle" }, fontSize: { value: 10 }, text: { signal: "format(datum.value, '.2f')" },
    fill: [{ test: "datum.value > 0.55", value: "#ffffff" }, { value: palette.ink }] } } }] : [];
  return {
    width, height, padding: 3,
    data: [{ name: "cells", values: cells(s, indices) }],
    scales: [
      { name: "column", type: "band", domain: along.x.map((_, i) => i), range: [0, width], padding: 0 },
      { name: "row", type: "band", domain: symbols.map((_, k) => k), range: [0, height], padding: 0 },
      { name: "shade", type: "linear", domain: [0, 1], range: ["#f5f8fb", dark], clamp: true },
      names("columnName", along.x.map((x) => short(axes.xShown(x), 3))), names("rowName", symbols),
    ],
    axes: [
      { scale: "column", orient: "bottom", title: axes.xTitle, titlePadding: runs.length < 2 ? 7 : 26, ticks: false, labelFontSize: 10,
        encode: { labels: { update: { text: { signal: "scale('columnName', datum.value)" } } } } },
      { scale: "row", orient: "left", ticks: false, domain: false, labelFontSize: 13, labelLimit: 105, encode: { labels: { update: { text: { signal: "scale('rowName', datum.value)" } } } } },
    ],
    marks: [{ type: "rect", from: { data: "cells" }, encode: { update: { x: { scale: "column", field: "i" }, width: { scale: "column", band: 1 },
      y: { scale: "row", field: "row" }, height: { scale: "row", band: 1 }, fill: { scale: "shade", field: "value" },
      stroke: m > 40 ? { scale: "shade", field: "value" } : { value: "#ffffff" }, strokeWidth: { value: m > 40 ? 0.5 : 1 } } } }, ...numbers, ...phaseMarks],
  };
}

function lowHighSpec(along, test, low, high, figureWidth) {
  const axes = testAxes({ ...along, measured: test.measured }, [low, high]);
  const [width, height] = [figureWidth - 70, 190];
  const rows = (curve) => segments(along.x.map((x, i) => ({ x: axes.xShown(x), y: axes.yShown(curve[i]), phase: String(along.phase[i] ?? "") })), ["x", "y"]);
  const measured = list(test.x).map((x, i) => ({ x: axes.xShown(x), y: axes.yShown(list(test.measured)[i]) })).filter((r) => finite(r.x) && finite(r.y));
  const line = (name, dash) => ({
    type: "group", from: { facet: { name: `${name}_segment`, data: name, groupby: "segment" } },
    marks: [{ type: "line", from: { data: `${name}_segment` }, encode: { update: { x: { scale: "x", field: "x" }, y: { scale: "y", field: "y" },
      stroke: { value: palette.simulated }, strokeWidth: { value: 2 }, strokeDash: { value: dash } } } }],
  });
  return {
    width, height, padding: 3,
    data: [{ name: "low", values: rows(low) }, { name: "high", values: rows(high) }, { name: "measured", values: measured }],
    scales: scales(axes, width, height),
    axes: [xAxis(axes), yAxis(axes)],
    marks: [{ type: "symbol", from: { data: "measured" }, encode: { update: { x: { scale: "x", field: "x" }, y: { scale: "y", field: "y" },
      size: { value: measured.length > 60 ? 8 : 22 }, fill: { value: palette.rule } } } }, line("low", [5, 3]), line("high", [])],
  };
}

function render(parent, data) {
  const s = data.sensitivity;
  const { test, along } = subject(data);
  const row = (name) => list(data.parameters).find((p) => p.name === name) ?? {};
  const symbols = s.names.map((name) => String(row(name).symbol ?? name));
  parent.append(el("p", "note", ["Along the curve", test.file, words(test.channel)].filter(Boolean).join(" · ")
    + ", by the emulator, with the parameters varied over the prior."));
  const grid = el("div", "grid wide");
  parent.append(grid);
  const maps = [[s.total, "Total share of variance", "What each parameter moves, alone or together with others; columns may sum to more than one."],
    [s.first_order, "Share of variance alone", "What each parameter moves by itself. What is missing to the total acts together with others."]];
  for (const [indices, title, caption] of maps) {
    if (list(indices).length > 0) chart(grid, { title, caption, makeSpec: (width) => heatSpec(s, symbols, indices, along, width) });
  }
  const curves = el("div", "grid narrow");
  s.names.forEach((name, k) => {
    const [low, high] = [list(list(s.low)[k]), list(list(s.high)[k])];
    if (!low.some(finite) || !high.some(finite)) return;
    const p = row(name);
    const ends = finite(p.prior_q05) && finite(p.prior_q95) ? `Dashed: ${quantity(p.prior_q05, p.unit)}. Solid: ${quantity(p.prior_q95, p.unit)}.` : "Dashed: low. Solid: high.";
    chart(curves, { title: `${symbols[k]}, ${words(name)}`, caption: ends, makeSpec: (width) => lowHighSpec(along, test, low, high, width) });
  });
  if (curves.children.length > 0) {
    parent.append(el("h3", "", "The curve with each parameter low and high"),
      el("p", "note", "At the ends of the prior’s 90 % interval, the other parameters at the estimate. Grey points: measured."), curves);
  }
}

exports.render = render;
