// The chart of one test: measured points, simulated curve, credible band, replicates; below it the residuals
// against the scatter that is expected of them.
const { palette } = require("page/chart.js");
const { finite, list } = require("page/format.js");
const { phaseStyles, segments } = require("page/phases.js");
const { scales, testAxes, xAxis, yAxis } = require("page/test_axes.js");

const normal90 = 1.645;  // half width of a normal distribution's 90 % interval, in standard deviations

const phaseAt = (test, i) => String(list(test.phase)[i] ?? "loading");

// The points of a test's curves in the order of the test, in shown units.
function curveRows(test, axes, value) {
  return list(test.x).map((x, i) => ({ x: axes.xShown(x), phase: phaseAt(test, i), ...value(i) }));
}

// SI: [{x, phase, residual (measured − simulated), scatter (half width of its 90 % interval) or NaN, outside}].
function residualRows(test) {
  return list(test.x).map((x, i) => {
    const given = list(test.residual)[i];
    const [m, s, sd] = [list(test.measured)[i], list(test.simulated)[i], list(test.residual_sd)[i]];
    const residual = finite(given) ? given : finite(m) && finite(s) ? m - s : NaN;
    const scatter = finite(sd) ? normal90 * sd : NaN;
    return { x, phase: phaseAt(test, i), residual, scatter, outside: finite(scatter) && Math.abs(residual) > scatter };
  }).filter((row) => finite(row.x) && finite(row.residual));
}

function chartData(test, axes) {
  const { yShown } = axes;
  const measured = curveRows(test, axes, (i) => ({ y: yShown(list(test.measured)[i]) })).filter((r) => finite(r.x) && finite(r.y));
  const residuals = residualRows(test).map((row) => ({ ...row, x: axes.xShown(row.x), residual: row.residual * axes.y.factor,
    low: -row.scatter * axes.y.factor, high: row.scatter * axes.y.factor })).filter((row) => finite(row.x));
  const replicates = list(test.replicates).flatMap((curve, k) =>
    segments(curveRows(test, axes, (i) => ({ y: yShown(list(curve)[i]) })), ["x", "y"]).map((r) => ({ ...r, segment: `${k}/${r.segment}` })));
  return [
    { name: "measured", values: measured },
    { name: "simulated", values: segments(curveRows(test, axes, (i) => ({ y: yShown(list(test.simulated)[i]) })), ["x", "y"]) },
    { name: "band", values: segments(curveRows(test, axes, (i) => (
      { low: yShown(list(test.band_lower)[i]), high: yShown(list(test.band_upper)[i]) })), ["x", "low", "high"]) },
    { name: "replicates", values: replicates },
    { name: "residuals", values: residuals },
    { name: "scatter", values: segments(residuals, ["x", "low", "high"]) },
  ];
}

// The legend's entries for what the data holds.
function legendEntries(data, styles, points) {
  const holds = (name) => data.find((d) => d.name === name).values.length > 0;
  const several = styles.length > 1;
  const entries = [];
  const add = (label, fill, stroke, shape, dash) => entries.push({ label, fill, stroke, shape, dash, size: shape === "stroke" ? 420 : 65 });
  if (holds("measured")) {
    for (const s of styles) add(several ? `measured, ${s.phase}` : "measured", s.filled ? palette.ink : "#ffffff", palette.ink, s.shape, []);
  }
  if (holds("simulated")) {
    for (const s of styles) add(several ? `simulated, ${s.phase}` : "simulated", "transparent", palette.simulated, "stroke", s.dash);
  }
  if (holds("band")) add("90 % credible band", palette.band, palette.band, "square", []);
  if (holds("replicates")) add("single packings", "transparent", palette.replicate, "stroke", []);
  if (points.some((row) => row.outside)) add("outside the expected scatter", palette.alarm, palette.alarm, "circle", []);
  return entries;
}

function legend(entries, width) {
  const domain = entries.map((e) => e.label);
  const scale = (name, key) => ({ name, type: "ordinal", domain, range: entries.map((e) => e[key]) });
  return {
    scales: [scale("legendFill", "fill"), scale("legendStroke", "stroke"), scale("legendShape", "shape"), scale("legendDash", "dash"),
      scale("legendSize", "size")],
    legends: [{ fill: "legendFill", stroke: "legendStroke", shape: "legendShape", strokeDash: "legendDash", size: "legendSize", orient: "top",
      direction: "horizontal", columns: Math.max(2, Math.floor(width / 170)), symbolStrokeWidth: 1.8, offset: 8, columnPadding: 14, clipHeight: 17, rowPadding: 0 }],
  };
}

const field = (name, scale) => ({ field: name, scale });

// Lines or areas, one for each segment of `name`.
function bySegment(name, mark) {
  return {
    type: "group", from: { facet: { name: `${name}_segment`, data: name, groupby: "segment" } },
    marks: [{ ...mark, from: { data: `${name}_segment` }, interactive: false }],
  };
}

const line = (width, color, opacity, phaseDash) => ({
  type: "line",
  encode: { update: { x: field("x", "x"), y: field("y", "y"), stroke: { value: color }, strokeWidth: { value: width },
    strokeOpacity: { value: opacity }, strokeJoin: { value: "round" }, ...(phaseDash ? { strokeDash: field("phase", "phaseDash") } : {}) } },
});

const area = (color, opacity) => ({
  type: "area",
  encode: { update: { x: field("x", "x"), y: field("low", "y"), y2: field("high", "y"), fill: { value: color }, fillOpacity: { value: opacity } } },
});

function points(data, y, size, tip) {
  return {
    type: "symbol", from: { data },
    encode: { update: { x: field("x", "x"), y: field(y, "y"), shape: field("phase", "phaseShape"), size: [{ test: "datum.outside === true", value: 1.8 * size }, { value: size }],
      fill: [{ test: "datum.outside === true && scale('phaseFill', datum.phase) !== '#ffffff'", value: palette.alarm }, field("phase", "phaseFill")],
      stroke: [{ test: "datum.outside === true", value: palette.alarm }, { value: palette.ink }],
      strokeWidth: { value: 1.2 }, tooltip: { signal: tip } } },
  };
}

function phaseScales(styles) {
  const domain = styles.map((s) => s.phase);
  const scale = (name, values) => ({ name, type: "ordinal", domain, range: values });
  return [scale("phaseDash", styles.map((s) => s.dash)), scale("phaseShape", styles.map((s) => s.shape)),
    scale("phaseFill", styles.map((s) => (s.filled ? palette.ink : "#ffffff")))];
}

// A panel: its own height and width, which the gridlines of its axes take.
const panel = (y, width, height) => ({
  type: "group", encode: { update: { y: { value: y }, width: { value: width }, height: { value: height } } },
  signals: [{ name: "width", value: width }, { name: "height", value: height }],
});

function residualPanel(axes, rows, top, width, height, size) {
  const reach = 1.1 * Math.max(...rows.map((r) => Math.max(Math.abs(r.residual), finite(r.high) ? r.high : 0)), 1e-12);
  const y = { name: "y", type: "linear", domain: [-reach, reach], range: [height, 0], zero: false };
  const stem = { type: "rule", from: { data: "residuals" }, encode: { update: {
    x: field("x", "x"), y: { scale: "y", value: 0 }, y2: field("residual", "y"), stroke: { value: palette.rule } } } };
  const zero = { type: "rule", encode: { update: { x: { value: 0 }, x2: { value: width }, y: { scale: "y", value: 0 }, stroke: { value: palette.ink } } } };
  return {
    ...panel(top, width, height), scales: [y],
    axes: [xAxis(axes, { format: axes.log ? "~r" : undefined }),
      { scale: "y", orient: "left", grid: true, tickCount: 4, title: ["Measured −", `simulated${axes.y.unit ? ` (${axes.y.unit})` : ""}`] }],
    marks: [bySegment("scatter", area(palette.scatter, 0.8)), zero, ...(rows.length <= 60 ? [stem] : []),
      points("residuals", "residual", size, "format(datum.x, '.3~g') + ': ' + format(datum.residual, '+.2~g')")],
  };
}

// The Vega spec for a figure of `figureWidth` px.
function makeSpec(test, figureWidth) {
  const axes = testAxes(test);
  const data = chartData(test, axes);
  const styles = phaseStyles(list(test.x).map((_, i) => phaseAt(test, i)));
  const rows = data.find((d) => d.name === "residuals").values;
  const width = figureWidth - 78;
  const height = Math.round(Math.min(380, Math.max(240, 0.6 * width)));
  const size = list(test.x).length > 60 ? 14 : 48;
  const key = legend(legendEntries(data, styles, rows), width);
  const main = {
    ...panel(0, width, height), scales: scales(axes, width, height).slice(1),
    axes: [xAxis(axes, rows.length > 0 ? { title: null, labels: false } : {}), yAxis(axes)],
    marks: [bySegment("band", area(palette.band, 0.55)), bySegment("replicates", line(0.9, palette.replicate, 0.7)),
      bySegment("simulated", line(2.4, palette.simulated, 1, true)),
      points("measured", "y", size, "format(datum.x, '.3~g') + ', ' + format(datum.y, '.3~g')")],
  };
  return {
    width, height: rows.length > 0 ? height + 130 : height, padding: 3, data,
    scales: [scales(axes, width, height)[0], ...phaseScales(styles), ...key.scales], legends: key.legends,
    marks: rows.length > 0 ? [main, residualPanel(axes, rows, height + 20, width, 110, size)] : [main],
  };
}

exports.makeSpec = makeSpec;
exports.residualRows = residualRows;
