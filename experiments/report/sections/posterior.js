// What the measurements leave open: each parameter's posterior beside its prior, pairs of parameters, and
// whether the sampler can be trusted.
const { el, table } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { at, dashedLine, figure, histogramBars, histogramData, linear, mark, upwards } = require("page/marks.js");
const {
  axisTitle,
  displayScale,
  finite,
  list,
  logTicks,
  number,
  quantile,
  symbolText,
  words,
} = require("page/format.js");
const { makePairsSpec } = require("sections/pairs.js");

// The fitted parameters with their draws in shown units: [{name, symbol, unit, log, factor, values, title, …}].
function parameterViews(data) {
  const posterior = data.posterior;
  return list(posterior.names).map((name, k) => {
    const row = list(data.parameters).find((p) => p.name === name) ?? {};
    const draws = list(posterior.draws).map((draw) => draw[k]);
    const log = Boolean(list(posterior.log)[k]);
    const scale = displayScale(row.unit, [quantile(draws, 0.5)], "", 1);
    const shown = (v) => (finite(v) && (!log || v > 0) ? v * scale.factor : NaN);
    const symbol = symbolText(list(posterior.symbols)[k] ?? name);
    return {
      name,
      symbol,
      log,
      angle: row.unit === "rad",
      row,
      shown,
      values: draws.map(shown),
      prior: list(posterior.prior_density)[k],
      title: axisTitle(symbol, scale),
    };
  });
}

// An axis of a parameter; an angle has its degrees under the number.
function parameterAxis(view, domain, extra) {
  const text = view.angle
    ? {
        labels: {
          update: { text: { signal: "[format(datum.value, '~r'), format(datum.value * 180 / PI, '.3~r') + '°']" } },
        },
      }
    : {};
  const ticks = view.log ? { values: logTicks(...domain), format: "~r" } : { tickCount: 5 };
  return { title: view.title, ...ticks, encode: text, ...extra };
}

// The prior as a density over the shown coordinate (log10 for logarithmic parameters), area 1.
function priorRows(view) {
  const x = list(view.prior?.x).map(view.shown);
  const rows = x
    .map((v, i) => ({ x: v, t: view.log ? Math.log10(v) : v, density: list(view.prior?.density)[i] }))
    .filter((r) => finite(r.t) && finite(r.density));
  const area = rows.slice(1).reduce((sum, r, i) => sum + 0.5 * (r.density + rows[i].density) * (r.t - rows[i].t), 0);
  return area > 0 ? rows.map((r) => ({ x: r.x, density: r.density / area })) : [];
}

// What a marginal shows besides its bars: prior, 90 % interval, estimate.
function marginalMarks(view, height) {
  const { row, shown } = view;
  const [low, high, estimate] = [row.q05, row.q95, row.estimate].map(shown);
  const marks = [dashedLine("prior", "x", "density", palette.prior)];
  if (finite(low) && finite(high)) {
    const style = { y: height + 4, stroke: palette.simulated, strokeWidth: 5 };
    marks.push(mark("rule", null, { x: at("x", low), x2: at("x", high) }, style));
  }
  if (finite(estimate)) {
    const style = { y: 0, y2: height + 8, stroke: palette.ink, strokeWidth: 1.6 };
    marks.push(mark("rule", null, { x: at("x", estimate) }, style));
  }
  return marks;
}

// The span of the axis: all draws, and the prior's 90 % interval at least.
function marginalDomain(view, values) {
  const all = [...values, view.shown(view.row.prior_q05), view.shown(view.row.prior_q95)].filter(finite);
  const domain = [Math.min(...all), Math.max(...all)];
  return domain[0] === domain[1] ? [domain[0] * 0.9, domain[1] * 1.1 || 1] : domain;
}

function marginalSpec(view, figureWidth) {
  const values = view.values.filter(finite);
  const domain = marginalDomain(view, values);
  const ts = view.log ? values.map(Math.log10) : values;
  const low = Math.min(...ts);
  const span = Math.max(...ts) - low || 1e-3 * (Math.abs(low) || 1);
  const [width, height] = [figureWidth - 24, 150];
  const edge = (end) => ({ scale: "x", signal: view.log ? `pow(10, datum.${end})` : `datum.${end}` });
  const densities = ["bins", "prior"].map((data) => ({ data, field: "density" }));
  return figure(width, height, {
    data: [histogramData("bins", ts, low, low + span, 24), { name: "prior", values: priorRows(view) }],
    scales: [
      linear("x", domain, [0, width], { type: view.log ? "log" : "linear", nice: false }),
      upwards(densities, height),
    ],
    axes: [{ scale: "x", orient: "bottom", offset: 9, domain: false, ...parameterAxis(view, domain) }],
    marks: [histogramBars("bins", height, edge), ...marginalMarks(view, height)],
  });
}

function sampler(data, views) {
  const { r_hat: rHat, ess } = data.posterior;
  if (list(rHat).length === 0 && list(ess).length === 0) return null;
  const good = (k) => !(rHat?.[k] > 1.05) && !(ess?.[k] < 100);
  const known = (k) => finite(rHat?.[k]) || finite(ess?.[k]);
  return el(
    "div",
    "",
    el("h3", "", "Sampler"),
    table(
      [
        { head: "Parameter", cell: (k) => words(views[k].name) },
        { head: "R-hat", number: true, cell: (k) => number(rHat?.[k], 4) },
        { head: "Effective sample size", number: true, cell: (k) => number(ess?.[k], 4) },
        {
          head: "",
          cell: (k) =>
            known(k) ? el("span", `mark ${good(k) ? "yes" : "no"}`, good(k) ? "converged" : "not converged") : "",
        },
      ],
      views.map((_, k) => k),
      "compact",
    ),
  );
}

function render(parent, data) {
  const views = parameterViews(data);
  parent.append(
    el("h3", "", "One parameter at a time"),
    el(
      "p",
      "note",
      "Bars: posterior. Dashed line: prior, drawn to the same area. Vertical line: estimate. Thick line below: 90 % interval. " +
        "The axis spans the prior’s 90 % interval at least.",
    ),
  );
  const grid = el("div", "grid narrow");
  parent.append(grid);
  for (const view of views) {
    chart(grid, { title: words(view.name), makeSpec: (width) => marginalSpec(view, width) });
  }
  if (views.length > 1) {
    parent.append(el("h3", "", "Two parameters at a time"));
    chart(parent, {
      caption:
        "Below the diagonal: draws from the posterior, with the estimate as a cross. Above: correlation (of logarithms, where an axis is logarithmic). " +
        "A narrow slanting cloud means that the measurements fix a combination of the two better than either.",
      makeSpec: (width) => makePairsSpec(views, parameterAxis, width),
    });
  }
  const trust = sampler(data, views);
  if (trust) parent.append(trust);
}

exports.render = render;
