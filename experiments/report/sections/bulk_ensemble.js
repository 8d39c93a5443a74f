// How far the shared ensemble reaches beside the measurements, the semivariograms of the parameters over the strain
// at each stage, and where the time of the study went.
const { chart, palette } = require("page/chart.js");
const { el, table } = require("page/dom.js");
const { capital, duration, finite, list, short, words } = require("page/format.js");
const { by, figure, leftAxis, linear, mark } = require("page/marks.js");

// Boxes of measured (left) and simulated (right) strain at each stage.
function coverageSpec(stages, figureWidth) {
  const [width, height] = [figureWidth - leftAxis, 240];
  const rows = stages.flatMap((stage, index) =>
    ["measured", "simulated"]
      .filter((kind) => list(stage[kind]).length === 5)
      .map((kind) => {
        const [low, q1, middle, q3, high] = stage[kind];
        return { index, kind, low, q1, middle, q3, high };
      }),
  );
  const indices = stages.map((_, i) => i);
  const half = { measured: 0, simulated: 0.5 };
  const left = { signal: `scale('x', datum.index) + bandwidth('x') * (datum.kind === 'measured' ? ${half.measured} : ${half.simulated})` };
  const right = { signal: `scale('x', datum.index) + bandwidth('x') * (datum.kind === 'measured' ? 0.45 : 0.95)` };
  const centre = { signal: `scale('x', datum.index) + bandwidth('x') * (datum.kind === 'measured' ? 0.225 : 0.725)` };
  const box = { x: left, x2: right, y: by("y", "q1"), y2: by("y", "q3"), fill: by("fill", "kind") };
  return figure(width, height, {
    data: [{ name: "stages", values: rows }],
    scales: [
      { name: "x", type: "band", domain: indices, range: [0, width], padding: 0.15 },
      { name: "names", type: "ordinal", domain: indices, range: stages.map((s) => short(s.stress / 1000, 3)) },
      { name: "y", type: "linear", domain: { data: "stages", fields: ["low", "high"] }, range: [height, 0], nice: true },
      { name: "fill", type: "ordinal", domain: ["measured", "simulated"], range: [palette.scatter, palette.band] },
    ],
    legends: [{ fill: "fill", orient: "top", direction: "horizontal" }],
    axes: [
      {
        scale: "x",
        orient: "bottom",
        title: "Axial stress (kPa)",
        encode: { labels: { update: { text: { signal: "scale('names', datum.value)" } } } },
      },
      { scale: "y", orient: "left", title: "Axial strain (m/m)", grid: true },
    ],
    marks: [
      mark("rule", "stages", { x: centre, y: by("y", "low"), y2: by("y", "high") }, { stroke: palette.rule }),
      mark("rect", "stages", box, { stroke: palette.ink, strokeWidth: 0.6 }),
      mark("rule", "stages", { x: left, x2: right, y: by("y", "middle") }, { stroke: palette.alarm, strokeWidth: 2 }),
    ],
  });
}

const gaussian = (s, h) => s.nugget + s.sill * (1 - Math.exp(-((h / s.range) ** 2)));

// Distances are shown over the longest of each stage, so that all stages share one axis.
function semivariogramSpec(stages, figureWidth) {
  const [width, height] = [figureWidth - leftAxis, 220];
  const name = (s) => `${short(s.stress / 1000, 3)} kPa`;
  const longest = (s) => Math.max(...s.distance);
  const dots = stages.flatMap((s) => s.distance.map((h, i) => ({ stage: name(s), h: h / longest(s), value: s.value[i] })));
  const curves = stages.flatMap((s) =>
    Array.from({ length: 41 }, (_, i) => ({ stage: name(s), h: i / 40, value: gaussian(s, (i / 40) * longest(s)) })),
  );
  const place = { x: by("x", "h"), y: by("y", "value") };
  const line = mark("line", "part", { ...place, stroke: by("colour", "stage") }, { strokeWidth: 1.5 });
  const facet = { facet: { name: "part", data: "curves", groupby: "stage" } };
  return figure(width, height, {
    data: [
      { name: "dots", values: dots },
      { name: "curves", values: curves },
    ],
    scales: [
      linear("x", [0, 1], [0, width]),
      { name: "y", type: "linear", domain: [0, Math.max(...dots.map((d) => d.value))], range: [height, 0], nice: true },
      { name: "colour", type: "ordinal", domain: stages.map(name), range: stageColours(stages.length) },
    ],
    legends: [{ stroke: "colour", symbolType: "stroke", orient: "right", title: "Strain at" }],
    axes: [
      { scale: "x", orient: "bottom", title: "Distance in strain, over the longest" },
      { scale: "y", orient: "left", title: "Semivariance", grid: true, tickCount: 5 },
    ],
    marks: [
      mark("symbol", "dots", { ...place, fill: by("colour", "stage") }, { size: 14 }),
      { type: "group", from: facet, marks: [line] },
    ],
  });
}

// From light to dark with the stage.
const stageColours = (n) =>
  Array.from({ length: n }, (_, i) => {
    const share = n > 1 ? i / (n - 1) : 0;
    const mix = (a, b) => Math.round(a + share * (b - a));
    return `rgb(${mix(158, 8)}, ${mix(202, 48)}, ${mix(225, 107)})`;
  });

function render(parent, data) {
  const { coverage, semivariograms, parts, emulators } = data.bulk;
  const caption = "Measured strains and those of the training ensemble: extremes, quartiles, median.";
  chart(parent, { caption, makeSpec: (width) => coverageSpec(coverage, width) });
  for (const text of list(emulators)) parent.append(el("p", "", `${capital(text)}.`));
  for (const { parameter, stages } of list(semivariograms)) {
    const title = `Semivariograms of ${words(parameter)} (in the prior's unit coordinate)`;
    chart(parent, { title, makeSpec: (width) => semivariogramSpec(stages.filter((s) => finite(s.range)), width) });
  }
  const columns = [
    { head: "Part of the work", cell: ([name]) => name },
    { head: "Time", number: true, cell: ([, seconds]) => duration(seconds) },
  ];
  parent.append(el("h3", "", "Where the time went"), table(columns, Object.entries(parts ?? {})));
}

exports.render = render;
