// Whether the simulated loading was slow enough to be called quasi-static, by its own measurements.
const { el, table } = require("page/dom.js");
const { finite, number, percent } = require("page/format.js");

const measures = [
  {
    key: "inertial_number",
    name: "Largest inertial number",
    meaning: "strain rate times grain size over √(stress/density); flow is quasi-static well below 10⁻³",
  },
  {
    key: "unbalanced_ratio",
    name: "Largest unbalanced-force ratio",
    meaning: "mean resultant force on a grain over the mean contact force",
  },
  {
    key: "servo_error",
    name: "Largest error of the stress servo",
    meaning: "difference between wanted and reached stress, over the wanted stress",
    share: true,
  },
];

function render(parent, data) {
  const q = data.quasi_static;
  if (q.text) parent.append(el("p", "", String(q.text)));
  const rows = measures.filter((m) => finite(q[m.key]));
  if (rows.length === 0) return;
  parent.append(
    table(
      [
        { head: "Measure", cell: (m) => el("div", "", m.name, el("div", "note", m.meaning)) },
        { head: "Value", number: true, cell: (m) => (m.share ? percent(q[m.key]) : number(q[m.key])) },
      ],
      rows,
      "compact",
    ),
  );
}

exports.render = render;
