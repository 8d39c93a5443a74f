// The top of the page: what was done, the verdict in a sentence, warnings, the numbers that matter; and its foot.
const { el } = require("page/dom.js");
const { curveError, duration, finite, list, number, percent, words } = require("page/format.js");

function tile(value, label, note) {
  return el("div", "tile", el("div", "value", value), el("div", "label", label), note ? el("div", "note", note) : null);
}

// The errors of a group of tests, as one tile each channel; a channel of several files is averaged by its points.
function errorTiles(tests, label) {
  const channels = new Map();
  for (const test of tests) {
    if (!finite(test.rmse)) continue;
    const key = `${test.channel}`;
    const sum = channels.get(key) ?? { test, squares: 0, points: 0, files: 0 };
    const points = finite(test.points) ? test.points : list(test.x).length;
    channels.set(key, {
      test,
      squares: sum.squares + test.rmse ** 2 * points,
      points: sum.points + points,
      files: sum.files + 1,
    });
  }
  return [...channels.values()].map(({ test, squares, points, files }) =>
    tile(
      curveError(Math.sqrt(squares / points), test.unit ?? test.y_unit, test.channel),
      `RMSE of ${words(test.channel)}, ${label}`,
      `${points} points${files > 1 ? ` of ${files} tests` : ""}`,
    ),
  );
}

function tiles(data) {
  const tests = list(data.tests);
  const parameters = list(data.parameters).filter((p) => !p.fixed && typeof p.identified === "boolean");
  const out = [
    ...errorTiles(
      tests.filter((t) => !t.held_out),
      data.verb === "simulate" ? "simulated" : "fitted",
    ),
    ...errorTiles(
      tests.filter((t) => t.held_out),
      "held out",
    ),
  ];
  if (parameters.length > 0) {
    const identified = parameters.filter((p) => p.identified).length;
    out.push(tile(`${identified} of ${parameters.length}`, "fitted parameters identified"));
  }
  if (finite(data.emulator?.coverage90)) {
    out.push(tile(percent(data.emulator.coverage90), "of left-out runs in the emulator’s 90 % interval"));
  }
  if (finite(data.dem_runs)) {
    out.push(tile(String(data.dem_runs), "DEM runs", finite(data.dem_failed) ? `${data.dem_failed} failed` : null));
  }
  if (finite(data.seconds)) out.push(tile(duration(data.seconds), "computing"));
  return out;
}

function model(data) {
  if (!data.model) return null;
  const effects = list(data.model.effects);
  return el(
    "p",
    "model",
    `Contact law ${data.model.law ?? "?"}, rotations ${data.model.rotation ?? "?"}, ` +
      (effects.length > 0 ? `with ${effects.map(words).join(", ")}.` : "no further effects."),
  );
}

function warnings(data) {
  const texts = list(data.warnings);
  if (texts.length === 0) return null;
  return el(
    "div",
    "warnings",
    el("strong", "", texts.length === 1 ? "Warning" : `${texts.length} warnings`),
    el("ul", "", ...texts.map((text) => el("li", "", String(text)))),
  );
}

function render(parent, data, sections) {
  const links = sections.map((section) => {
    const link = el("a", "", section.title);
    link.href = `#${section.id}`;
    return link;
  });
  parent.append(
    el(
      "header",
      "",
      el("p", "kicker", `loam ${data.verb}`),
      el("h1", "", data.name),
      data.description ? el("p", "description", String(data.description)) : null,
      data.verdict ? el("p", "verdict", String(data.verdict)) : null,
      warnings(data),
      el("div", "tiles", ...tiles(data)),
      model(data),
      el("nav", "", ...links),
    ),
  );
}

function footer(parent, data) {
  const made = [data.version ? `loam ${data.version}` : "loam", data.seed !== undefined ? `seed ${data.seed}` : null];
  parent.append(
    el(
      "footer",
      "",
      `${made.filter(Boolean).join(", ")}. Charts: Vega 5 (BSD-3-Clause, University of Washington ` +
        "Interactive Data Lab) with D3 (ISC, Mike Bostock).",
    ),
  );
}

exports.render = render;
exports.footer = footer;
