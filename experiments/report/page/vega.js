// Vega put together from its modules: the transforms that charts may name, the parser, the view.
const { extend } = require("vega-util");
const { transforms } = require("vega-dataflow");
extend(transforms, require("vega-transforms"), require("vega-view-transforms"), require("vega-encode"));

exports.parse = require("vega-parser").parse;
exports.View = require("vega-view").View;
