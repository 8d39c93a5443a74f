// The branches of a test's curve (loading, unloading, reloading …): how each is drawn, and the splitting of a curve
// into lines that break at a missing value and start where the branch before ended.
const { finite } = require("page/format.js");

const styles = {
  loading: { shape: "circle", filled: true, dash: [] },
  unloading: { shape: "circle", filled: false, dash: [5, 3] },
  reloading: { shape: "triangle-up", filled: false, dash: [2, 2] },
};
const others = [
  styles.loading,
  styles.unloading,
  styles.reloading,
  { shape: "square", filled: false, dash: [8, 3, 2, 3] },
  { shape: "diamond", filled: false, dash: [1, 3] },
];

// The style of each phase of a test, in order of appearance: [{phase, shape, filled, dash}].
function phaseStyles(phases) {
  const names = [...new Set(phases)];
  const known = names.every((name) => Object.hasOwn(styles, name));
  return names.map((phase, i) => ({ phase, ...(known ? styles[phase] : others[i % others.length]) }));
}

// rows = [{phase, …}] in the order of the test. Gives the rows again with `segment`, to be drawn as one line a segment;
// the columns in `keys` must be finite.
function segments(rows, keys) {
  const out = [];
  let segment = 0;
  let last = null;
  for (const row of rows) {
    if (!keys.every((key) => finite(row[key]))) {
      last = null;
      continue;
    }
    if (last === null || last.phase !== row.phase) {
      ++segment;
      if (last !== null) out.push({ ...last, phase: row.phase, segment });
    }
    out.push({ ...row, segment });
    last = row;
  }
  return out;
}

exports.phaseStyles = phaseStyles;
exports.segments = segments;
