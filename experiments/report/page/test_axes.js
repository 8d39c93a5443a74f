// How the curve of a test is laid out: units, titles, log axis, and strain downwards where soil mechanics draws it so.
const { axisTitle, capital, displayScale, finite, list, logTicks, words } = require("page/format.js");

// Compression and settlement are positive and drawn downwards.
const downwards = new Set(["axial_strain", "volumetric_strain", "settlement", "settlement_strain"]);

// `curves` are further arrays of y that must fit in. Values are shown as SI × factor.
function testAxes(test, curves = []) {
  const shownX = (v) => finite(v) && (!test.x_log || v > 0);
  const xs = list(test.x).filter(shownX);
  const ys = [test.measured, test.simulated, test.band_lower, test.band_upper, ...list(test.replicates), ...curves]
    .flatMap(list)
    .filter(finite);
  const x = displayScale(test.x_unit, xs, test.x_name);
  const y = displayScale(test.y_unit, ys, test.channel);
  return {
    x,
    y,
    log: Boolean(test.x_log),
    reversed: downwards.has(test.channel),
    xTitle: axisTitle(capital(words(test.x_name)), x),
    yTitle: axisTitle(capital(words(test.channel)), y),
    xDomain: xDomain(
      xs.map((v) => v * x.factor),
      test.x_log,
    ),
    yDomain: yDomain(ys.map((v) => v * y.factor)),
    xShown: (v) => (shownX(v) ? v * x.factor : NaN),
    yShown: (v) => (finite(v) ? v * y.factor : NaN),
  };
}

// With zero; noise about zero does not stretch the axis to the other side.
function yDomain(ys) {
  const [low, high] = [Math.min(0, ...ys), Math.max(0, ...ys)];
  const noise = 0.03 * (high - low);
  return [low < -noise ? low : 0, high > noise ? high : 0];
}

function xDomain(xs, log) {
  if (xs.length === 0) return log ? [1, 10] : [0, 1];
  const low = Math.min(...xs);
  const high = Math.max(...xs);
  if (log) return [low / 1.15, high * 1.15];
  return [Math.min(0, low), high > 0 ? high * 1.02 : high + 1];
}

// The two scales, named x and y, for a plot of the given size in px.
function scales(axes, width, height) {
  return [
    { name: "x", type: axes.log ? "log" : "linear", domain: axes.xDomain, range: [0, width], nice: false, zero: false },
    {
      name: "y",
      type: "linear",
      domain: axes.yDomain,
      range: axes.reversed ? [0, height] : [height, 0],
      nice: true,
      zero: false,
    },
  ];
}

const gridAxis = { grid: true, domain: true, ticks: true };

function xAxis(axes, extra) {
  const ticks = axes.log ? { values: logTicks(...axes.xDomain), format: "~r" } : { tickCount: 6 };
  return { scale: "x", orient: "bottom", title: axes.xTitle, ...gridAxis, ...ticks, ...extra };
}

function yAxis(axes, extra) {
  return { scale: "y", orient: "left", title: axes.yTitle, tickCount: 6, ...gridAxis, ...extra };
}

Object.assign(exports, { testAxes, scales, xAxis, yAxis });
