// The chart of one test: measured points, simulated curve, credible band, replicates; below it the residuals
// against the scatter that is expected of them.
const { palette } = require("page/chart.js");
const { at, by, mark } = require("page/marks.js");
const { finite, list } = require("page/format.js");
const { phaseStyles, segments } = require("page/phases.js");
const { scales, testAxes, xAxis, yAxis } = require("page/test_axes.js");

const normal90 = 1.645; // half width of a normal distribution's 90 % interval, in standard deviations

const phaseAt = (test, i) => String(list(test.phase)[i] ?? "loading");

// The points of a test's curves in the order of the test, in shown units.
function curveRows(test, axes, value) {
  return list(test.x).map((x, i) => ({ x: axes.xShown(x), phase: phaseAt(test, i), ...value(i) }));
}

// SI: [{x, phase, residual (measured − simulated), scatter (half width of its 90 % interval) or NaN, outside}].
function residualRows(test) {
  return list(test.x)
    .map((x, i) => {
      const given = list(test.residual)[i];
      const [m, s, sd] = [list(test.measured)[i], list(test.simulated)[i], list(test.residual_sd)[i]];
      const residual = finite(given) ? given : finite(m) && finite(s) ? m - s : NaN;
      const scatter = finite(sd) ? normal90 * sd : NaN;
      return {
        x,
        phase: phaseAt(test, i),
        residual,
        scatter,
        outside: finite(scatter) && Math.abs(residual) > scatter,
      };
    })
    .filter((row) => finite(row.x) && finite(row.residual));
}

// The points of one curve of `test`, split into lines.
function curveSegments(test, axes, curve) {
  return segments(
    curveRows(test, axes, (i) => ({ y: axes.yShown(list(curve)[i]) })),
    ["x", "y"],
  );
}

function chartData(test, axes) {
  const { yShown } = axes;
  const shown = (v) => v * axes.y.factor;
  const measured = curveRows(test, axes, (i) => ({ y: yShown(list(test.measured)[i]) }));
  const band = curveRows(test, axes, (i) => ({
    low: yShown(list(test.band_lower)[i]),
    high: yShown(list(test.band_upper)[i]),
  }));
  const residuals = residualRows(test)
    .map((row) => ({
      ...row,
      x: axes.xShown(row.x),
      residual: shown(row.residual),
      low: -shown(row.scatter),
      high: shown(row.scatter),
    }))
    .filter((row) => finite(row.x));
  const replicates = list(test.replicates).flatMap((curve, k) =>
    curveSegments(test, axes, curve).map((row) => ({ ...row, segment: `${k}/${row.segment}` })),
  );
  return [
    { name: "measured", values: measured.filter((r) => finite(r.x) && finite(r.y)) },
    { name: "simulated", values: curveSegments(test, axes, test.simulated) },
    { name: "band", values: segments(band, ["x", "low", "high"]) },
    { name: "replicates", values: replicates },
    { name: "residuals", values: residuals },
    { name: "scatter", values: segments(residuals, ["x", "low", "high"]) },
  ];
}

// The legend's entries for what the data holds.
function legendEntries(data, styles, points, bandName) {
  const holds = (name) => data.find((d) => d.name === name).values.length > 0;
  const several = styles.length > 1;
  const entries = [];
  const add = (label, fill, stroke, shape, dash) =>
    entries.push({ label, fill, stroke, shape, dash, size: shape === "stroke" ? 420 : 65 });
  if (holds("measured")) {
    for (const s of styles)
      add(several ? `measured, ${s.phase}` : "measured", s.filled ? palette.ink : "#ffffff", palette.ink, s.shape, []);
  }
  if (holds("simulated")) {
    for (const s of styles)
      add(several ? `simulated, ${s.phase}` : "simulated", "transparent", palette.simulated, "stroke", s.dash);
  }
  if (holds("band")) add(bandName, palette.band, palette.band, "square", []);
  if (holds("replicates")) add("single packings", "transparent", palette.replicate, "stroke", []);
  if (points.some((row) => row.outside))
    add("outside the expected scatter", palette.alarm, palette.alarm, "circle", []);
  return entries;
}

function legend(entries, width) {
  const domain = entries.map((e) => e.label);
  const scale = (name, key) => ({ name, type: "ordinal", domain, range: entries.map((e) => e[key]) });
  return {
    scales: [
      scale("legendFill", "fill"),
      scale("legendStroke", "stroke"),
      scale("legendShape", "shape"),
      scale("legendDash", "dash"),
      scale("legendSize", "size"),
    ],
    legends: [
      {
        fill: "legendFill",
        stroke: "legendStroke",
        shape: "legendShape",
        strokeDash: "legendDash",
        size: "legendSize",
        orient: "top",
        direction: "horizontal",
        columns: Math.max(2, Math.floor(width / 170)),
        symbolStrokeWidth: 1.8,
        offset: 8,
        columnPadding: 14,
        clipHeight: 17,
        rowPadding: 0,
      },
    ],
  };
}

// Lines or areas, one for each segment of `name`.
function bySegment(name, mark) {
  return {
    type: "group",
    from: { facet: { name: `${name}_segment`, data: name, groupby: "segment" } },
    marks: [{ ...mark, from: { data: `${name}_segment` }, interactive: false }],
  };
}

function line(strokeWidth, stroke, strokeOpacity, phaseDash) {
  const place = { x: by("x", "x"), y: by("y", "y"), ...(phaseDash ? { strokeDash: by("phaseDash", "phase") } : {}) };
  return mark("line", null, place, { stroke, strokeWidth, strokeOpacity, strokeJoin: "round" });
}

const area = (fill, fillOpacity) =>
  mark("area", null, { x: by("x", "x"), y: by("y", "low"), y2: by("y", "high") }, { fill, fillOpacity });

function points(data, y, size, tip) {
  const outside = (value, otherwise) => [{ test: "datum.outside === true", value }, otherwise];
  const filled = "datum.outside === true && scale('phaseFill', datum.phase) !== '#ffffff'";
  const looks = {
    shape: by("phaseShape", "phase"),
    size: outside(1.8 * size, { value: size }),
    fill: [{ test: filled, value: palette.alarm }, by("phaseFill", "phase")],
    stroke: outside(palette.alarm, { value: palette.ink }),
    tooltip: { signal: tip },
  };
  return mark("symbol", data, { x: by("x", "x"), y: by("y", y), ...looks }, { strokeWidth: 1.2 });
}

function phaseScales(styles) {
  const domain = styles.map((s) => s.phase);
  const scale = (name, values) => ({ name, type: "ordinal", domain, range: values });
  return [
    scale(
      "phaseDash",
      styles.map((s) => s.dash),
    ),
    scale(
      "phaseShape",
      styles.map((s) => s.shape),
    ),
    scale(
      "phaseFill",
      styles.map((s) => (s.filled ? palette.ink : "#ffffff")),
    ),
  ];
}

// A panel: its own height and width, which the gridlines of its axes take.
const panel = (y, width, height) => ({
  type: "group",
  encode: { update: { y: { value: y }, width: { value: width }, height: { value: height } } },
  signals: [
    { name: "width", value: width },
    { name: "height", value: height },
  ],
});

function residualPanel(axes, rows, top, width, height, size) {
  const reach = 1.1 * Math.max(...rows.map((r) => Math.max(Math.abs(r.residual), finite(r.high) ? r.high : 0)), 1e-12);
  const y = { name: "y", type: "linear", domain: [-reach, reach], range: [height, 0], zero: false };
  const origin = at("y", 0);
  const stem = mark(
    "rule",
    "residuals",
    { x: by("x", "x"), y: origin, y2: by("y", "residual") },
    { stroke: palette.rule },
  );
  const zero = mark("rule", null, { y: origin }, { x: 0, x2: width, stroke: palette.ink });
  const title = ["Measured −", `simulated${axes.y.unit ? ` (${axes.y.unit})` : ""}`];
  return {
    ...panel(top, width, height),
    scales: [y],
    axes: [
      xAxis(axes, { format: axes.log ? "~r" : undefined }),
      { scale: "y", orient: "left", grid: true, tickCount: 4, title },
    ],
    marks: [
      bySegment("scatter", area(palette.scatter, 0.8)),
      zero,
      ...(rows.length <= 60 ? [stem] : []),
      points("residuals", "residual", size, "format(datum.x, '.3~g') + ': ' + format(datum.residual, '+.2~g')"),
    ],
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
  const key = legend(legendEntries(data, styles, rows, test.band_name ?? "90 % credible band"), width);
  const main = {
    ...panel(0, width, height),
    scales: scales(axes, width, height).slice(1),
    axes: [xAxis(axes, rows.length > 0 ? { title: null, labels: false } : {}), yAxis(axes)],
    marks: [
      bySegment("band", area(palette.band, 0.55)),
      bySegment("replicates", line(0.9, palette.replicate, 0.7)),
      bySegment("simulated", line(2.4, palette.simulated, 1, true)),
      points("measured", "y", size, "format(datum.x, '.3~g') + ', ' + format(datum.y, '.3~g')"),
    ],
  };
  return {
    width,
    height: rows.length > 0 ? height + 130 : height,
    padding: 3,
    data,
    scales: [scales(axes, width, height)[0], ...phaseScales(styles), ...key.scales],
    legends: key.legends,
    marks: rows.length > 0 ? [main, residualPanel(axes, rows, height + 20, width, 110, size)] : [main],
  };
}

exports.makeSpec = makeSpec;
exports.residualRows = residualRows;
