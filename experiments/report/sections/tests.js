// Every lab test: the measured curve with what the model makes of it, the residuals, and what is left over and where.
const { el, table } = require("page/dom.js");
const { chart } = require("page/chart.js");
const {
  capital,
  curveError,
  displayScale,
  finite,
  isRatio,
  isStrain,
  list,
  mean,
  number,
  quantity,
  short,
  words,
} = require("page/format.js");
const { makeSpec, residualRows } = require("sections/test_chart.js");

const unitOf = (test) => test.unit ?? test.y_unit;
const kind = (test) => capital(words(test.kind));

function overview(tests) {
  return table(
    [
      { head: "Test", cell: (t) => kind(t) },
      { head: "File", cell: (t) => String(t.file ?? "") },
      { head: "Channel", cell: (t) => words(t.channel) },
      { head: "Role", cell: (t) => (t.held_out ? "held out" : "used") },
      { head: "Points", number: true, cell: (t) => String(t.points ?? list(t.x).length) },
      { head: "RMSE", number: true, cell: (t) => curveError(t.rmse, unitOf(t), t.channel) },
      { head: "Correlation r", number: true, cell: (t) => number(t.r, 4) },
    ],
    tests,
  );
}

// A difference with its sign, in percent of strain or in the unit of the channel.
function difference(value, test) {
  const sign = value > 0 ? "+" : "";
  if (isRatio(test.y_unit)) {
    const shown = displayScale(test.y_unit, [value], test.channel);
    return `${sign}${number(value * shown.factor, 2)}${shown.unit ? ` ${shown.unit} strain` : ""}`;
  }
  return sign + quantity(value, test.y_unit, 2);
}

const place = (row, test) => {
  const x = isRatio(test.x_unit) && isStrain(test.x_name) ? `${short(100 * row.x)} %` : quantity(row.x, test.x_unit);
  return `${words(test.x_name)} ${x}${row.phase && row.several ? ` (${row.phase})` : ""}`;
};

// What the model leaves over, in words; empty when nothing was measured.
function leftOver(test) {
  const several = new Set(list(test.phase)).size > 1;
  const rows = residualRows(test).map((row) => ({ ...row, several }));
  if (rows.length === 0) return "";
  const worst = rows.reduce((a, b) => (Math.abs(b.residual) > Math.abs(a.residual) ? b : a));
  const judged = rows.filter((row) => finite(row.scatter));
  const outside = judged.filter((row) => row.outside).length;
  const parts = [
    `Left over, measured − simulated: ${difference(mean(rows.map((r) => r.residual)), test)} on average, ` +
      `at most ${difference(worst.residual, test)}, at ${place(worst, test)}.`,
  ];
  if (judged.length > 0) {
    parts.push(
      `${outside} of ${judged.length} readings lie outside the scatter that measurement, packing and emulator ` +
        `explain in 90 % of cases (about ${Math.round(0.1 * judged.length)} would by chance).`,
    );
  }
  return parts.join(" ");
}

function how(test) {
  const parts = [];
  const replicates = list(test.replicates).length;
  if (list(test.simulated).some(finite)) {
    parts.push(
      `Simulated: ${replicates > 1 ? `mean of ${replicates} DEM runs on different packings (thin lines)` : "by DEM"}.`,
    );
  }
  if (list(test.band_lower).some(finite)) parts.push("Band: 90 % credible for the simulated curve.");
  const hidden = test.x_log ? list(test.x).filter((x) => finite(x) && x <= 0).length : 0;
  if (hidden > 0)
    parts.push(
      `${hidden} ${hidden > 1 ? "readings" : "reading"} at zero or below cannot be shown on a logarithmic axis.`,
    );
  return parts.join(" ");
}

function render(parent, data) {
  const tests = list(data.tests);
  parent.append(overview(tests));
  const drawn = tests.filter((t) => list(t.x).length > 0);
  const grid = el("div", drawn.length > 1 ? "grid wide" : "grid");
  parent.append(grid);
  for (const test of drawn) {
    chart(grid, {
      title: [kind(test), test.file, words(test.channel) + (test.held_out ? " (held out)" : "")]
        .filter(Boolean)
        .join(" · "),
      caption: [how(test), leftOver(test)].filter(Boolean).join(" "),
      makeSpec: (width) => makeSpec(test, width),
    });
  }
}

exports.render = render;
