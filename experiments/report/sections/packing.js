// The packing in oblique projection: spheres sorted by depth, contact forces as lines between their centres.
const { el } = require("page/dom.js");
const { chart, palette } = require("page/chart.js");
const { by, figure, linear, mark } = require("page/marks.js");
const { finite, list, quantile, quantity } = require("page/format.js");

const depth = { shift: 0.42, rise: 0.24 }; // how far one length unit into the picture moves right and up
const strong = "#8c1d04";
const tension = "#0b5fa5";
const shades = 5; // fog in a few steps, one gradient a step

const project = ([x, y, z]) => ({ u: x + depth.shift * y, v: z + depth.rise * y, w: y });

// Particles wrapped into the cell, far ones first.
function particles(packing) {
  const { cell } = packing;
  const rows = packing.x.map((p, i) => {
    const wrapped = p.map((c, k) => (finite(cell?.[k]) && cell[k] > 0 ? c - cell[k] * Math.floor(c / cell[k]) : c));
    return { ...project(wrapped), position: wrapped, radius: list(packing.radius)[i] };
  });
  return rows;
}

// Contact lines; one that leaves through a periodic face is drawn as a half on either side.
function forceLines(packing, rows) {
  const { cell } = packing;
  const lines = [];
  for (const [i, j, force] of list(packing.contacts)) {
    const [a, b] = [rows[i], rows[j]];
    if (!a || !b || !finite(force)) continue;
    const branch = a.position.map((c, k) => b.position[k] - c);
    const near = branch.map((d, k) => (finite(cell?.[k]) && cell[k] > 0 ? d - cell[k] * Math.round(d / cell[k]) : d));
    const crosses = near.some((d, k) => Math.abs(d - branch[k]) > 1e-9 * Math.abs(cell?.[k] ?? 1));
    const step = (from, sign, share) => project(from.position.map((c, k) => c + sign * share * near[k]));
    if (!crosses) lines.push({ from: a, to: b, force });
    else lines.push({ from: a, to: step(a, 1, 0.5), force }, { from: b, to: step(b, -1, 0.5), force });
  }
  return lines
    .map(({ from, to, force }) => ({ u: from.u, v: from.v, u2: to.u, v2: to.v, force }))
    .filter((r) => [r.u, r.v, r.u2, r.v2].every(finite))
    .sort((a, b) => a.force - b.force);
}

function cellEdges(cell) {
  if (!list(cell).length || !cell.every(finite)) return [];
  const corner = (bits) => project(cell.map((c, k) => ((bits >> k) & 1 ? c : 0)));
  const edges = [];
  for (let bits = 0; bits < 8; ++bits) {
    for (let k = 0; k < 3; ++k) {
      if ((bits >> k) & 1) continue;
      const [a, b] = [corner(bits), corner(bits | (1 << k))];
      const hidden = bits === 2 || (bits | (1 << k)) === 2; // those at the far lower left corner
      edges.push({ u: a.u, v: a.v, u2: b.u, v2: b.v, hidden });
    }
  }
  return edges;
}

// A sphere lit from the upper left, paler the farther away it is.
function shading(step) {
  const fog = step / (shades - 1);
  const grey = (value) => {
    const g = Math.round(value + (246 - value) * 0.75 * fog);
    return `rgb(${g},${g},${Math.min(255, g + 4)})`;
  };
  return {
    gradient: "radial",
    x1: 0.36,
    y1: 0.34,
    r1: 0,
    x2: 0.5,
    y2: 0.5,
    r2: 0.52,
    stops: [
      { offset: 0, color: grey(250) },
      { offset: 0.65, color: grey(205) },
      { offset: 1, color: grey(140) },
    ],
  };
}

function spheres(rows, deepest, scale) {
  const layers = [];
  for (let step = shades - 1; step >= 0; --step) {
    const inLayer = rows
      .filter((r) => Math.min(shades - 1, Math.floor((shades * r.w) / deepest)) === step)
      .sort((a, b) => b.w - a.w);
    layers.push({
      name: `layer${step}`,
      values: inLayer.map(({ u, v, radius }) => ({ u, v, size: Math.PI * (radius * scale) ** 2 })),
      step,
    });
  }
  return layers;
}

const ends = { x: by("u", "u"), y: by("v", "v"), x2: by("u", "u2"), y2: by("v", "v2") };
const thickness = { strokeWidth: { scale: "width", signal: "abs(datum.force)" } };
const forces = (data, style) => mark("rule", data, { ...ends, ...thickness }, { strokeCap: "round", ...style });

function drawing(layers) {
  const outline = { stroke: "#8a939c", strokeWidth: 0.5, fillOpacity: 0.5 };
  const dashes = { strokeDash: [{ test: "datum.hidden", value: [4, 4] }, { value: [] }] };
  return [
    ...layers.map(({ name, step }) =>
      mark(
        "symbol",
        name,
        { x: by("u", "u"), y: by("v", "v"), size: { field: "size" } },
        { ...outline, fill: shading(step), strokeOpacity: 0.55 - 0.09 * step },
      ),
    ),
    mark("rule", "edges", { ...ends, ...dashes }, { stroke: palette.muted, strokeWidth: 1.1 }),
    forces("weak", { stroke: palette.ink, strokeOpacity: 0.45 }),
    forces("tension", { stroke: tension, strokeDash: [3, 2], strokeOpacity: 0.9 }),
    forces("strong", { stroke: strong, strokeOpacity: 0.85 }),
  ];
}

// The force above which a pushing contact belongs to the strongest quarter.
const strongLimit = (values) =>
  quantile(
    values.filter((f) => f > 0),
    0.75,
  );

function makeSpec(packing, figureWidth) {
  const rows = particles(packing);
  const seen = rows.filter((r) => finite(r.u) && finite(r.v) && r.radius > 0);
  const reach = Math.max(...seen.map((r) => r.radius));
  const span = (values) => [Math.min(...values) - reach, Math.max(...values) + reach];
  const [u, v] = [span(seen.map((r) => r.u)), span(seen.map((r) => r.v))];
  const scale = Math.min(figureWidth - 10, 760) / (u[1] - u[0]);
  const [width, height] = [scale * (u[1] - u[0]), scale * (v[1] - v[0])];
  const layers = spheres(seen, Math.max(...seen.map((r) => r.w)) || 1, scale);
  const lines = forceLines(packing, rows);
  const limit = strongLimit(
    list(packing.contacts)
      .map((c) => c[2])
      .filter(finite),
  );
  const largest = Math.max(...lines.map((l) => Math.abs(l.force)), 1e-300);
  const thickest = Math.max(3, Math.min(9, 0.6 * reach * scale));
  return figure(width, height, {
    data: [
      ...layers.map(({ name, values }) => ({ name, values })),
      { name: "edges", values: cellEdges(packing.cell) },
      { name: "weak", values: lines.filter((l) => l.force >= 0 && !(l.force > limit)) },
      { name: "tension", values: lines.filter((l) => l.force < 0) },
      { name: "strong", values: lines.filter((l) => l.force > limit) },
    ],
    scales: [
      linear("u", u, [0, width]),
      linear("v", v, [height, 0]),
      { name: "width", type: "sqrt", domain: [0, largest], range: [0.3, thickest] },
    ],
    marks: drawing(layers),
  });
}

function describe(packing) {
  const normal = list(packing.contacts)
    .map((c) => c[2])
    .filter(finite);
  const parts = [
    packing.caption ? String(packing.caption) : null,
    `${packing.x.length} particles${finite(packing.stress) ? ` at ${quantity(packing.stress, "Pa")}` : ""}.`,
  ];
  if (normal.length > 0) {
    const pushing = normal.filter((f) => f > 0);
    const total = pushing.reduce((s, f) => s + f, 0);
    const limit = strongLimit(pushing);
    const share = pushing.filter((f) => f > limit).reduce((s, f) => s + f, 0) / total;
    const pulling = normal.filter((f) => f < 0).length;
    parts.push(
      `${normal.length} contacts; a line’s width grows with the root of the normal force, to ${quantity(Math.max(...normal), "N")}.`,
    );
    if (total > 0)
      parts.push(
        `Dark red: the strongest quarter, which carries ${Math.round(100 * share)} % of the sum of normal forces.`,
      );
    if (pulling > 0) parts.push(`Blue, dashed: ${pulling} contacts in tension.`);
  }
  return parts.filter(Boolean).join(" ");
}

function render(parent, data) {
  const packing = data.packing;
  const place = el("div");
  parent.append(place);
  chart(place, { caption: describe(packing), makeSpec: (width) => makeSpec(packing, width) });
}

exports.render = render;
