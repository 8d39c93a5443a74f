// The charts by which an emulator is judged: agreement of pairs with the line y = x, distribution of standardised
// residuals, error of each output.
const { palette } = require("page/chart.js");
const {
  at,
  by,
  dashedLine,
  figure,
  histogramBars,
  histogramData,
  leftAxis,
  linear,
  mark,
  upwards,
} = require("page/marks.js");

const squareSide = (figureWidth) => Math.min(figureWidth - leftAxis, 300);

// rows = [{x, y}] on a square plot.
function agreementSpec(rows, xTitle, yTitle, figureWidth) {
  const side = squareSide(figureWidth);
  const ends = rows.flatMap((r) => [r.x, r.y]);
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const diagonal = { x: at("x", low), y: at("y", low), x2: at("x", high), y2: at("y", high) };
  return figure(side, side, {
    data: [{ name: "points", values: rows }],
    scales: [linear("x", [low, high], [0, side], { nice: true }), linear("y", [low, high], [side, 0], { nice: true })],
    axes: [
      { scale: "x", orient: "bottom", title: xTitle, grid: true, tickCount: 6 },
      { scale: "y", orient: "left", title: yTitle, grid: true, tickCount: 6 },
    ],
    marks: [
      mark(
        "symbol",
        "points",
        { x: by("x", "x"), y: by("y", "y") },
        { size: 16, fill: palette.simulated, fillOpacity: 0.45 },
      ),
      mark("rule", null, diagonal, { stroke: palette.ink, strokeWidth: 1.2 }),
    ],
  });
}

const reach = 4; // standard deviations; what is beyond counts in the outermost bar

const normalCurve = Array.from({ length: 81 }, (_, i) => {
  const x = -reach + (i * reach) / 40;
  return { x, density: Math.exp(-0.5 * x * x) / Math.sqrt(2 * Math.PI) };
});

// Histogram of standardised residuals with the standard normal density.
function residualHistogramSpec(zs, figureWidth) {
  const [width, height] = [figureWidth - 24, squareSide(figureWidth)];
  const inside = zs.map((z) => Math.max(-reach, Math.min(reach - 1e-9, z)));
  const densities = ["bins", "normal"].map((data) => ({ data, field: "density" }));
  return figure(width, height, {
    data: [histogramData("bins", inside, -reach, reach, 20), { name: "normal", values: normalCurve }],
    scales: [linear("x", [-reach, reach], [0, width]), upwards(densities, height)],
    axes: [{ scale: "x", orient: "bottom", title: "Standardised residual z", tickCount: 8 }],
    marks: [histogramBars("bins", height, (end) => by("x", end)), dashedLine("normal", "x", "density", palette.ink)],
  });
}

// rows = [{index, name, value}], a bar each; beyond 40 the names are left out.
function outputSpec(rows, title, figureWidth) {
  const [width, height] = [figureWidth - leftAxis, 150];
  const many = rows.length > 40;
  const names = { labelAngle: -40, labelAlign: "right", labelLimit: 130, labelBaseline: "middle", labelOverlap: false };
  const axis = many ? { labels: false, ticks: false, title: "Outputs, in the order of the curves" } : names;
  const indices = rows.map((r) => r.index);
  const place = { x: by("x", "index"), width: { scale: "x", band: 1 }, y: by("y", "value") };
  const look = { y2: height, fill: palette.band, stroke: palette.simulated, strokeWidth: many ? 0 : 0.6 };
  return figure(width, height, {
    data: [{ name: "outputs", values: rows }],
    scales: [
      { name: "x", type: "band", domain: indices, range: [0, width], padding: many ? 0 : 0.35 },
      { name: "names", type: "ordinal", domain: indices, range: rows.map((r) => r.name) },
      { ...upwards([{ data: "outputs", field: "value" }], height), nice: true },
    ],
    axes: [
      {
        scale: "x",
        orient: "bottom",
        ...axis,
        encode: { labels: { update: { text: { signal: "scale('names', datum.value)" } } } },
      },
      { scale: "y", orient: "left", title, grid: true, tickCount: 4 },
    ],
    marks: [mark("rect", "outputs", place, look)],
  });
}

Object.assign(exports, { agreementSpec, residualHistogramSpec, outputSpec });
