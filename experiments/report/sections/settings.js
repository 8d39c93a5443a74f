// Every effective setting, folded away on the screen and unfolded on paper.
const { el } = require("page/dom.js");

function render(parent, data) {
  const block = el(
    "details",
    "",
    el("summary", "", "All settings of this run (TOML)"),
    el("pre", "", String(data.settings)),
  );
  parent.append(block);
  window.addEventListener("beforeprint", () => {
    block.open = true;
  });
}

exports.render = render;
