// Several tests fitted at once: which test identifies which parameter, and what one kind gives up for another.
const { el, table } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { capital, list, number, words } = require("page/format.js");
const { by, figure, leftAxis, linear, mark } = require("page/marks.js");

function identification(parent, data) {
  const { names, files, sd_over_prior: ratios } = data.identification;
  parent.append(
    table(
      [
        { head: "Test alone", cell: (row) => String(files[row]) },
        ...names.map((name, k) => ({
          head: words(name),
          number: true,
          cell: (row) => {
            const text = number(ratios[row][k], 2);
            return Math.min(...ratios.map((r) => r[k])) === ratios[row][k] ? el("strong", "", text) : text;
          },
        })),
      ],
      files.map((_, row) => row),
    ),
    el(
      "p",
      "remark",
      "Standard deviation of each parameter if this test alone were fitted, over that of its prior (linearised at the " +
        "estimate): 1 means that the test says nothing of it. The test that says most is set in bold.",
    ),
  );
}

function frontSpec(pair, figureWidth) {
  const width = figureWidth - leftAxis - 16;
  const height = Math.round(Math.min(280, 0.6 * width));
  // Sets far worse than the estimate in one kind are of no interest.
  const reach = (k) => Math.max(3 * pair.estimate[k], 1.2 * Math.min(...pair.front.map((p) => p[k])));
  const inside = pair.front.filter((p) => p[0] <= reach(0) && p[1] <= reach(1)).map(([x, y]) => ({ x, y }));
  const place = { x: by("x", "x"), y: by("y", "y") };
  const axis = (k) => `${capital(words(pair.kinds[k]))}: error over what is tolerable`;
  return figure(width, height, {
    data: [
      { name: "front", values: inside },
      { name: "estimate", values: [{ x: pair.estimate[0], y: pair.estimate[1] }] },
    ],
    scales: [linear("x", [0, reach(0)], [0, width]), linear("y", [0, reach(1)], [height, 0])],
    axes: [
      { scale: "x", orient: "bottom", grid: true, tickCount: 6, title: axis(0) },
      { scale: "y", orient: "left", grid: true, tickCount: 6, title: axis(1) },
    ],
    marks: [
      mark("line", "front", place, { stroke: palette.simulated, strokeWidth: 2, interpolate: "step-after" }),
      mark("symbol", "estimate", place, { size: 90, fill: palette.alarm, stroke: "#ffffff", shape: "diamond" }),
    ],
  });
}

function render(parent, data) {
  if (list(data.identification?.files).length > 0) identification(parent, data);
  const grid = el("div", "grid wide");
  parent.append(grid);
  for (const pair of list(data.trade_off)) {
    chart(grid, {
      title: `Trade-off between ${pair.kinds.map(words).join(" and ")}`,
      caption:
        "Line: the least error of one kind of test for each error of the other, over all parameters, by the emulator. " +
        "Diamond: the estimate. A line far from the lower left corner says that no parameters fit both.",
      makeSpec: (width) => frontSpec(pair, width),
    });
  }
}

exports.render = render;
