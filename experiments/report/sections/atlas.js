// The atlas: what each effect does to every curve. A table of the largest changes, then each effect's curves.
const { el, table } = require("page/dom.js");
const { chart } = require("page/chart.js");
const { capital, finite, list, number, words } = require("page/format.js");
const { makeSpec } = require("sections/test_chart.js");

const percent = (ratio) => `${ratio > 0 ? "+" : "−"}${Math.abs(100 * ratio).toFixed(0)} %`;

// Red where the effect lifts the curve, blue where it lowers it; pale where chance might have done it.
function changeCell(curve) {
  const cell = el("span", "z", percent(curve.largest));
  const alpha = curve.certain ? Math.min(0.8, 0.1 + 1.2 * Math.abs(curve.largest)).toFixed(2) : 0;
  cell.style.background = curve.largest > 0 ? `rgba(178, 24, 43, ${alpha})` : `rgba(33, 102, 172, ${alpha})`;
  return cell;
}

const curveName = (curve) => `${curve.file.replace(/\.csv$/, "").replace(/_/g, " ")}: ${words(curve.channel)}`;

const strengthText = (row) =>
  finite(row.strength)
    ? `${words(row.parameter)} ${number(row.strength, 2)} ${row.unit === "1" ? "" : row.unit}`.trim()
    : "there or not";

function overview(rows) {
  return table(
    [
      { head: "Effect", cell: (row) => words(row.effect) },
      { head: "Strength", cell: strengthText },
      ...list(rows[0].curves).map((curve, k) => ({
        head: curveName(curve),
        number: true,
        cell: (row) => changeCell(row.curves[k]),
      })),
    ],
    rows,
    "regions",
  );
}

function render(parent, data) {
  const rows = list(data.atlas);
  parent.append(
    overview(rows),
    el(
      "p",
      "",
      "Largest change of each curve, in percent of the range of the curve without the effect; coloured where it stands " +
        "more than three standard errors above the scatter of the packings.",
    ),
  );
  for (const row of rows) {
    const grid = el("div", "grid");
    parent.append(
      el("h3", "", capital(words(row.effect))),
      el("p", "", `${capital(row.meaning)}. Here: ${strengthText(row)}, added to a model whose rotation is ${row.rotation}.`),
      grid,
    );
    for (const curve of list(row.curves))
      chart(grid, { title: curveName(curve), caption: "Simulated: with the effect.", makeSpec: (width) => makeSpec(curve, width) });
  }
}

exports.render = render;
