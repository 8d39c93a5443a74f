// Elements and tables. Text from the document enters the page here, always as text and never as markup.

// An element with a class, a text or children (elements or texts).
function el(tag, className, ...children) {
  const element = document.createElement(tag);
  if (className) element.className = className;
  for (const child of children) {
    if (child !== null && child !== undefined) element.append(child);
  }
  return element;
}

// A table: columns = [{head, cell(row) -> text or element, number: right-aligned}].
function table(columns, rows, className) {
  const head = el("tr", "", ...columns.map((c) => el("th", c.number ? "number" : "", c.head)));
  const body = rows.map((row) => el("tr", "", ...columns.map((c) => el("td", c.number ? "number" : "", c.cell(row)))));
  return el("div", "table", el("table", className, el("thead", "", head), el("tbody", "", ...body)));
}

exports.el = el;
exports.table = table;
