// A module loader of a few lines, so that every script of the page, Vega's included, keeps its own scope
// and states what it needs.
"use strict";
const loam = (function () {
  const definitions = new Map();
  const loaded = new Map();

  function define(name, body) {
    definitions.set(name, body);
  }

  function require(name) {
    if (!loaded.has(name)) {
      if (!definitions.has(name)) throw new Error("no module named " + name);
      const module = { exports: {} };
      loaded.set(name, module);
      definitions.get(name)(module.exports, require, module);
    }
    return loaded.get(name).exports;
  }

  return { define, require };
})();
