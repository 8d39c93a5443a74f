// Drawing of charts by Vega, and the account of it: <html> carries data-charts-expected, data-charts-drawn and
// data-chart-errors, so that it can be seen from outside that every chart is there. A chart that cannot be drawn
// leaves its reason in its place.
const vega = require("page/vega.js");
const { el } = require("page/dom.js");

// Colours that differ in lightness, so that they hold without colour vision and on a grey printer;
// shapes and dashes repeat what they say.
const palette = {
  ink: "#16191d",
  muted: "#59626c",
  grid: "#e4e7ea",
  rule: "#9aa3ad",
  simulated: "#0b5fa5",
  band: "#a9cbe8",
  replicate: "#5f97c7",
  alarm: "#b3400a",
  scatter: "#dfe2e6",
  prior: "#59626c",
};

const config = {
  background: null,
  font: "system-ui, 'Segoe UI', 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif",
  axis: {
    labelColor: palette.ink,
    titleColor: palette.ink,
    labelFontSize: 11,
    titleFontSize: 12,
    titleFontWeight: "normal",
    gridColor: palette.grid,
    domainColor: palette.rule,
    tickColor: palette.rule,
    labelOverlap: true,
    titlePadding: 7,
  },
  legend: { labelFontSize: 11, labelColor: palette.ink, titleFontSize: 11, titleFontWeight: "normal", symbolSize: 70 },
  title: { fontSize: 12, fontWeight: "normal", color: palette.ink },
};

const root = document.documentElement.dataset;
const pending = [];
root.chartsExpected = root.chartsDrawn = root.chartErrors = "0";

const count = (name) => {
  root[name] = String(Number(root[name]) + 1);
};

function fail(place, what, error) {
  count("chartErrors");
  place.replaceChildren(
    el("p", "failure", `${what} could not be drawn: ${error && error.message ? error.message : error}`),
  );
}

// Vega reports a failing expression or transform to its logger and goes on; here it is an error.
function strictLogger(report) {
  const logger = { level: () => logger, info: () => logger, debug: () => logger };
  logger.warn = (...messages) => {
    report(new Error(messages.join(" ")));
    return logger;
  };
  logger.error = (...messages) => {
    report(messages[0] instanceof Error ? messages[0] : new Error(messages.join(" ")));
    return logger;
  };
  return logger;
}

const places = ["x", "y", "x2", "y2", "width", "height", "size"];
const placed = new Set(["symbol", "line", "area"]); // marks that stand at an x and a y; Vega would draw a missing one at 0

// The number of drawn data items, over all groups of a scene. Throws if one has no place to stand.
function itemCount(group) {
  let n = 0;
  for (const mark of group.items ?? []) {
    if (mark.role && mark.role !== "mark" && mark.role !== "scope") continue;
    for (const item of mark.items) {
      const wanted = placed.has(mark.marktype) ? ["x", "y"] : [];
      if (
        places.some((key) => item[key] !== undefined && !Number.isFinite(item[key])) ||
        wanted.some((key) => item[key] === undefined)
      ) {
        throw new Error(`a ${mark.marktype} has a value that is not a number`);
      }
      n += mark.marktype === "group" ? itemCount(item) : 1;
    }
  }
  return n;
}

async function draw(place, title, spec) {
  let problem = null;
  const logger = strictLogger((error) => {
    problem = problem ?? error;
  });
  const view = new vega.View(vega.parse({ ...spec, config }), { renderer: "svg", logger });
  await view.initialize(place).runAsync();
  if (problem) throw problem;
  if (view.scenegraph().root.items.reduce((sum, item) => sum + itemCount(item), 0) === 0)
    throw new Error("it has no data");
  const image = place.querySelector("svg");
  image.setAttribute("role", "img");
  image.setAttribute("aria-label", title);
}

// Adds a figure to `parent`: makeSpec(width) gives the Vega spec for the width in px that the figure has.
function chart(parent, { title, caption, makeSpec, className = "" }) {
  count("chartsExpected");
  const place = el("div", "drawing");
  parent.append(
    el("figure", className, title ? el("h4", "", title) : null, place, caption ? el("figcaption", "", caption) : null),
  );
  pending.push(async () => {
    try {
      await draw(place, title ?? "chart", makeSpec(Math.max(240, place.clientWidth)));
      count("chartsDrawn");
    } catch (error) {
      fail(place, title ?? "The chart", error);
    }
  });
}

// Draws what was added; the page is laid out by then, so that widths are known.
async function drawAll() {
  for (const task of pending.splice(0)) await task();
}

Object.assign(exports, { chart, drawAll, fail, palette });
