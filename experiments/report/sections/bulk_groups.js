// Do parameters differ between groups of samples? Medians with letters, and the distributions as boxes.
const { chart, palette } = require("page/chart.js");
const { el, table } = require("page/dom.js");
const { capital, finite, list, number, quantile, quantity, words } = require("page/format.js");
const { by, figure, leftAxis, mark } = require("page/marks.js");

const significant = 0.05;

function medians(results, grouping) {
  const columns = [
    { head: capital(words(grouping.covariate)), cell: (row) => `${row.group.label} (${row.group.members.length})` },
    ...results.map((q, k) => ({
      head: words(q.name),
      number: true,
      cell: (row) => `${quantity(grouping.medians[k][row.index], q.unit)} ${grouping.letters[k][row.index]}`,
    })),
  ];
  return table(
    columns,
    grouping.groups.map((group, index) => ({ group, index })),
  );
}

// A box (quartiles), a line (median) and whiskers (extremes) for each group.
function boxSpec(q, grouping, figureWidth) {
  const [width, height] = [figureWidth - leftAxis, 150];
  const rows = grouping.groups.map((group, index) => {
    const values = group.members.map((m) => q.values[m]).filter(finite);
    const [low, q1, middle, q3, high] = [0, 0.25, 0.5, 0.75, 1].map((p) => quantile(values, p));
    return { index, low, q1, middle, q3, high };
  });
  const shown = rows.filter((row) => finite(row.middle));
  const indices = rows.map((row) => row.index);
  const centre = { scale: "x", field: "index", band: 0.5 };
  const box = { x: by("x", "index"), width: { scale: "x", band: 1 }, y: by("y", "q1"), y2: by("y", "q3") };
  const middle = { x: by("x", "index"), x2: { ...by("x", "index"), band: 1 }, y: by("y", "middle") };
  const values = shown.flatMap((row) => [row.low, row.high]);
  return figure(width, height, {
    data: [{ name: "groups", values: shown }],
    scales: [
      { name: "x", type: "band", domain: indices, range: [0, width], padding: 0.4 },
      { name: "names", type: "ordinal", domain: indices, range: grouping.groups.map((group) => String(group.label)) },
      {
        name: "y",
        type: q.log ? "log" : "linear",
        domain: [Math.min(...values), Math.max(...values)],
        range: [height, 0],
        zero: false,
        nice: true,
      },
    ],
    axes: [
      {
        scale: "x",
        orient: "bottom",
        encode: { labels: { update: { text: { signal: "scale('names', datum.value)" } } } },
      },
      { scale: "y", orient: "left", title: q.unit && q.unit !== "1" ? q.unit : "", grid: true, tickCount: 4, format: ".2~g" },
    ],
    marks: [
      mark("rule", "groups", { x: centre, y: by("y", "low"), y2: by("y", "high") }, { stroke: palette.rule }),
      mark("rect", "groups", box, { fill: palette.band, stroke: palette.simulated, strokeWidth: 0.6 }),
      mark("rule", "groups", middle, { stroke: palette.alarm, strokeWidth: 2 }),
    ],
  });
}

function render(parent, data) {
  const { quantities, groupings } = data.bulk.statistics;
  const results = quantities.filter((q) => q.result);
  parent.append(
    el(
      "p",
      "",
      "Medians of the calibrated samples. Groups with a common letter do not differ at 5 % after Bonferroni's correction (Mann–Whitney, or Wilcoxon's signed ranks where samples are paired). Boxes: quartiles and median, whiskers: extremes.",
    ),
  );
  for (const grouping of groupings) {
    parent.append(el("h3", "", capital(words(grouping.covariate))));
    if (grouping.paired) parent.append(el("p", "", "Compared by pairs (signed ranks)."));
    parent.append(medians(results, grouping));
    const row = el("div", "box-charts");
    parent.append(row);
    results.forEach((q, k) => {
      const p = grouping.kruskal_p[k];
      if (list(q.values).filter(finite).length === 0) return;
      const title = `${capital(words(q.name))}: Kruskal–Wallis p = ${finite(p) ? number(p, 2) : "–"}${finite(p) && p < significant ? " *" : ""}`;
      chart(row, { title, makeSpec: (width) => boxSpec(q, grouping, width) });
    });
  }
}

exports.render = render;
