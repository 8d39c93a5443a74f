// The table of parameters: estimate, intervals, and in plain words whether the measurements say anything about each.
const { el, table } = require("page/dom.js");
const {
  finite,
  interval,
  intervalNote,
  list,
  missing,
  percent,
  quantity,
  symbolText,
  words,
} = require("page/format.js");

// Width of the posterior interval as a share of the prior's, on the scale (linear or logarithmic) of the prior.
function widthShare(p) {
  const ends = [p.q05, p.q95, p.prior_q05, p.prior_q95];
  if (!ends.every(finite)) return NaN;
  const [a, b, c, d] = p.log ? ends.map(Math.log) : ends;
  return (b - a) / (d - c);
}

function intervalCell(low, high, unit, note) {
  const notes = [intervalNote(low, high, unit), note].filter(Boolean);
  return el("div", "", interval(low, high, unit), ...notes.map((text) => el("div", "note", text)));
}

function standing(p) {
  if (p.fixed) return el("span", "mark fixed", "fixed by the user");
  if (typeof p.identified !== "boolean") return "";
  const share = widthShare(p);
  const width = finite(share) ? `interval is ${percent(share)} of the prior’s${p.log ? ", in logarithms" : ""}` : "";
  if (p.identified) return el("div", "", el("span", "mark yes", "identified"), el("div", "note", width));
  const outside = finite(p.estimate) && (p.estimate < p.q05 || p.estimate > p.q95);
  const why = outside
    ? "the emulator, for want of runs, gives an interval that does not hold the estimate"
    : `posterior no narrower than prior${width ? `: ${width}` : ""}`;
  return el("div", "", el("span", "mark no", "not identified"), el("div", "note", why));
}

function nameCell(p) {
  const meaning = p.meaning ? el("div", "note", String(p.meaning)) : null;
  return el("div", "", el("span", "symbol", symbolText(p.symbol ?? "")), " ", words(p.name), meaning);
}

const median = (p) => (finite(p.q50) ? `median ${quantity(p.q50, p.unit)}` : "");
const unlessFixed = (cell) => (p) => (p.fixed ? missing : cell(p));

const intervalColumns = [
  { head: "90 % interval", number: true, cell: unlessFixed((p) => intervalCell(p.q05, p.q95, p.unit, median(p))) },
  {
    head: "Prior’s 90 % interval",
    number: true,
    cell: unlessFixed((p) => intervalCell(p.prior_q05, p.prior_q95, p.unit)),
  },
  { head: "Identified?", cell: standing },
];

function render(parent, data) {
  const parameters = list(data.parameters);
  const fitted = parameters.some((p) => !p.fixed && (finite(p.q05) || typeof p.identified === "boolean"));
  const value = (p) => el("strong", "", quantity(p.estimate, p.unit));
  const columns = [
    { head: "Parameter", cell: nameCell },
    { head: fitted ? "Estimate" : "Value", number: true, cell: value },
  ];
  parent.append(table([...columns, ...(fitted ? intervalColumns : [])], parameters, "parameters"));
  const unknown = parameters.filter((p) => p.identified === false && !p.fixed).map((p) => words(p.name));
  if (unknown.length > 0) {
    parent.append(
      el(
        "p",
        "remark",
        `The measurements do not determine ${unknown.join(", ")}: the values given there come ` +
          "from the prior, and others would fit as well.",
      ),
    );
  }
}

exports.render = render;
