// The matrix of pairs: scatter of posterior draws below the diagonal, correlation above it.
const { palette } = require("page/chart.js");
const { at, by, figure, linear, mark } = require("page/marks.js");
const { finite, mean, quantile } = require("page/format.js");

const gap = 8;
const mostSymbols = 5000; // in the whole figure, so that it opens at once

function domainOf(view) {
  const coordinate = view.log ? Math.log10 : (v) => v;
  const ts = view.values.filter(finite).map(coordinate);
  const [low, high] = [quantile(ts, 0.003), quantile(ts, 0.997)];
  const pad = 0.06 * (high - low) || 1e-3 * (Math.abs(low) || 1);
  return [low - pad, high + pad].map((t) => (view.log ? 10 ** t : t));
}

function correlation(a, b) {
  const pairs = a.values
    .map((v, i) => [v, b.values[i]])
    .filter((p) => p.every(finite))
    .map(([v, w]) => [a.log ? Math.log(v) : v, b.log ? Math.log(w) : w]);
  const [ma, mb] = [mean(pairs.map((p) => p[0])), mean(pairs.map((p) => p[1]))];
  const sum = (f) => pairs.reduce((s, p) => s + f(p[0] - ma, p[1] - mb), 0);
  return sum((x, y) => x * y) / Math.sqrt(sum((x) => x * x) * sum((_, y) => y * y));
}

function scaleOf(view, k, orient, cell) {
  const range = orient === "x" ? [0, cell] : [cell, 0];
  return linear(`${orient}${k}`, domainOf(view), range, { type: view.log ? "log" : "linear", nice: false });
}

function cellGroup(row, column, cell, content) {
  const corner = { x: column * (cell + gap), y: row * (cell + gap), width: cell, height: cell };
  return mark("group", null, {}, { ...corner, stroke: palette.grid }, content);
}

// An axis for a small cell; Vega leaves out ticks until no more than tickCount remain.
function smallAxis(axisOf, view, scale, orient) {
  const small = { tickCount: 4, labelFontSize: 10, labelBound: 2, labelOverlap: "greedy", encode: {} };
  return { scale, orient, ...axisOf(view, domainOf(view), small) };
}

function scatter(views, axisOf, row, column, cell) {
  const axes = [];
  if (row === views.length - 1) axes.push(smallAxis(axisOf, views[column], `x${column}`, "bottom"));
  if (column === 0) axes.push(smallAxis(axisOf, views[row], `y${row}`, "left"));
  const [x, y] = [`x${column}`, `y${row}`];
  const cloud = { x: by(x, `v${column}`), y: by(y, `v${row}`) };
  const marks = [
    mark("symbol", "draws", cloud, { size: 9, fill: palette.simulated, fillOpacity: 0.35 }, { clip: true }),
  ];
  const estimate = [column, row].map((k) => views[k].shown(views[k].row.estimate));
  if (estimate.every(finite)) {
    const cross = { shape: "cross", size: 70, fill: palette.ink, stroke: "#ffffff", strokeWidth: 1 };
    marks.push(mark("symbol", null, { x: at(x, estimate[0]), y: at(y, estimate[1]) }, cross, { clip: true }));
  }
  return cellGroup(row, column, cell, { axes, marks });
}

function label(text, size, cell) {
  const middle = { x: cell / 2, y: cell / 2, align: "center", baseline: "middle", limit: cell - 6 };
  return mark("text", null, {}, { ...middle, text, fontSize: size, fill: palette.ink });
}

function coefficient(views, row, column, cell) {
  const r = correlation(views[row], views[column]);
  const text = finite(r)
    ? r
        .toFixed(2)
        .replace(/^-(?=0\.00)/, "")
        .replace("-", "−")
    : "–";
  const strength = finite(r) ? 0.9 * Math.abs(r) : 0;
  const shade = mark("rect", null, {}, { width: cell, height: cell, fill: palette.band, fillOpacity: strength });
  return cellGroup(row, column, cell, { marks: [shade, label(text, 13, cell)] });
}

// views: from sections/posterior.js; axisOf(view, domain, extra) gives an axis' look.
function makePairsSpec(views, axisOf, figureWidth) {
  const n = views.length;
  const cell = Math.floor(Math.min(125, (figureWidth - 80) / n - gap));
  const pairs = (n * (n - 1)) / 2;
  const every = Math.max(1, Math.ceil((views[0].values.length * pairs) / mostSymbols));
  const draws = views[0].values
    .map((_, i) => Object.fromEntries(views.map((view, k) => [`v${k}`, view.values[i]])))
    .filter((draw, i) => i % every === 0 && Object.values(draw).every(finite));
  const marks = [];
  for (let row = 0; row < n; ++row) {
    for (let column = 0; column < n; ++column) {
      if (column < row) marks.push(scatter(views, axisOf, row, column, cell));
      else if (column > row) marks.push(coefficient(views, row, column, cell));
      else marks.push(cellGroup(row, column, cell, { marks: [label(views[row].symbol, 18, cell)] }));
    }
  }
  const side = n * (cell + gap) - gap;
  const scales = views.flatMap((view, k) => [scaleOf(view, k, "x", cell), scaleOf(view, k, "y", cell)]);
  return figure(side, side, { data: [{ name: "draws", values: draws }], scales, marks });
}

exports.makePairsSpec = makePairsSpec;
