// The matrix of pairs: scatter of posterior draws below the diagonal, correlation above it.
const { palette } = require("page/chart.js");
const { finite, mean, quantile } = require("page/format.js");

const gap = 8;
const mostSymbols = 5000;  // in the whole figure, so that it opens at once

function domainOf(view) {
  const coordinate = view.log ? Math.log10 : (v) => v;
  const ts = view.values.filter(finite).map(coordinate);
  const [low, high] = [quantile(ts, 0.003), quantile(ts, 0.997)];
  const pad = 0.06 * (high - low) || 1e-3 * (Math.abs(low) || 1);
  return [low - pad, high + pad].map((t) => (view.log ? 10 ** t : t));
}

function correlation(a, b) {
  const pairs = a.values.map((v, i) => [v, b.values[i]]).filter((p) => p.every(finite))
    .map(([v, w]) => [a.log ? Math.log(v) : v, b.log ? Math.log(w) : w]);
  const [ma, mb] = [mean(pairs.map((p) => p[0])), mean(pairs.map((p) => p[1]))];
  const sum = (f) => pairs.reduce((s, p) => s + f(p[0] - ma, p[1] - mb), 0);
  return sum((x, y) => x * y) / Math.sqrt(sum((x) => x * x) * sum((_, y) => y * y));
}

const scaleOf = (view, k, orient, cell) => ({ name: `${orient}${k}`, type: view.log ? "log" : "linear", domain: domainOf(view),
  range: orient === "x" ? [0, cell] : [cell, 0], zero: false, nice: false });

function cellGroup(row, column, cell, content) {
  return {
    type: "group",
    encode: { update: { x: { value: column * (cell + gap) }, y: { value: row * (cell + gap) }, width: { value: cell }, height: { value: cell },
      stroke: { value: palette.grid } } },
    ...content,
  };
}

function scatter(views, axisOf, row, column, cell) {
  const axes = [];
  const small = { tickCount: 3, labelFontSize: 10, titleFontSize: 12, grid: false, labelBound: 2, encode: {} };
  if (row === views.length - 1) axes.push({ scale: `x${column}`, orient: "bottom", ...axisOf(views[column], domainOf(views[column]), small) });
  if (column === 0) axes.push({ scale: `y${row}`, orient: "left", ...axisOf(views[row], domainOf(views[row]), small) });
  const at = (x, y) => ({ x: { scale: `x${column}`, ...x }, y: { scale: `y${row}`, ...y } });
  const marks = [{ type: "symbol", from: { data: "draws" }, clip: true, encode: { update: { ...at({ field: `v${column}` }, { field: `v${row}` }),
    size: { value: 9 }, fill: { value: palette.simulated }, fillOpacity: { value: 0.35 } } } }];
  const estimate = [column, row].map((k) => views[k].shown(views[k].row.estimate));
  if (estimate.every(finite)) {
    marks.push({ type: "symbol", clip: true, encode: { update: { ...at({ value: estimate[0] }, { value: estimate[1] }), shape: { value: "cross" },
      size: { value: 70 }, fill: { value: palette.ink }, stroke: { value: "#ffffff" }, strokeWidth: { value: 1 } } } });
  }
  return cellGroup(row, column, cell, { axes, marks });
}

function label(text, size, cell, color) {
  return { type: "text", encode: { update: { x: { value: cell / 2 }, y: { value: cell / 2 }, align: { value: "center" }, baseline: { value: "middle" },
    text: { value: text }, fontSize: { value: size }, fill: { value: color }, limit: { value: cell - 6 } } } };
}

function coefficient(views, row, column, cell) {
  const r = correlation(views[row], views[column]);
  const text = finite(r) ? r.toFixed(2).replace(/^-(?=0\.00)/, "").replace("-", "−") : "–";
  const shade = { type: "rect", encode: { update: { width: { value: cell }, height: { value: cell }, fill: { value: palette.band },
    fillOpacity: { value: finite(r) ? 0.9 * Math.abs(r) : 0 } } } };
  return cellGroup(row, column, cell, { marks: [shade, label(text, 13, cell, palette.ink)] });
}

// views: from sections/posterior.js; axisOf(view, domain, extra) gives an axis' look.
function makePairsSpec(views, axisOf, figureWidth) {
  const n = views.length;
  const cell = Math.floor(Math.min(125, (figureWidth - 80) / n - gap));
  const pairs = (n * (n - 1)) / 2;
  const every = Math.max(1, Math.ceil((views[0].values.length * pairs) / mostSymbols));
  const draws = views[0].values.map((_, i) => Object.fromEntries(views.map((view, k) => [`v${k}`, view.values[i]])))
    .filter((draw, i) => i % every === 0 && Object.values(draw).every(finite));
  const marks = [];
  for (let row = 0; row < n; ++row) {
    for (let column = 0; column < n; ++column) {
      if (column < row) marks.push(scatter(views, axisOf, row, column, cell));
      else if (column > row) marks.push(coefficient(views, row, column, cell));
      else marks.push(cellGroup(row, column, cell, { marks: [label(views[row].symbol, 18, cell, palette.ink)] }));
    }
  }
  const side = n * (cell + gap) - gap;
  return {
    width: side, height: side, padding: 3, data: [{ name: "draws", values: draws }],
    scales: views.flatMap((view, k) => [scaleOf(view, k, "x", cell), scaleOf(view, k, "y", cell)]), marks,
  };
}

exports.makePairsSpec = makePairsSpec;
