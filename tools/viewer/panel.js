// The panel beside the scene: what is known of the parts, as tables that screen readers read too.
//
// Names come from files and may be anything: they become text of nodes, never markup.

import { percent, short, whole } from "./numbers.js";

/** An element with attributes, properties and children; texts are children that stay text. */
export function make(tag, { className, ...attributes } = {}, ...children) {
  const node = document.createElement(tag);
  if (className) node.className = className;
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** A name that keeps its direction, and what is around it too, however it is written. */
export function nameOf(text) {
  return make("bdi", { className: "name", title: text }, text);
}

function swatch(color) {
  const node = make("span", { className: "swatch", "aria-hidden": "true" });
  node.style.background = color;
  return node;
}

/** A bar as long as a share of the largest; hidden from screen readers, which have the number. */
function bar(value, largest, color) {
  const length = make("span", { className: value < 0 ? "length negative" : "length" });
  length.style.width = `${largest > 0 ? (100 * Math.abs(value)) / largest : 0}%`;
  if (color) length.style.background = color;
  return make("span", { className: "bar", "aria-hidden": "true" }, length);
}

/** The name of the shape, what it is made of, and what its parts cost. */
export function fillHeader(page) {
  document.getElementById("name").append(nameOf(page.name));
  const facts = [
    `${whole(page.elements)} ${page.noun}${page.elements === 1 ? "" : "s"}`,
    `${page.parts.length} part${page.parts.length === 1 ? "" : "s"}`,
    `${page.measure} ${short(page.total)}`,
    page.view.said,
  ];
  document.getElementById("facts").append(...facts.map((fact) => make("span", {}, fact)));
  if (page.cost !== null) {
    document.getElementById("cost").append(make("small", {}, "cost "), short(page.cost));
  }
  const notes = document.getElementById("notes");
  for (const note of page.notes) notes.append(make("li", {}, note));
  notes.hidden = page.notes.length === 0;
}

/**
 * The table of parts.
 *
 * `choose(k)` is called for a click on a part, `hide(k, hidden)` for its checkbox. Returns
 * `mark({chosen, isolated, hovered})`, which shows the state.
 */
export function fillParts(page, { choose, hide }) {
  const body = document.getElementById("parts");
  const costly = page.cost !== null;
  document.getElementById("parts-cost").hidden = !costly;
  document.getElementById("parts-measure").textContent = page.measure;
  const largest = Math.max(...page.parts.map((part) => Math.abs(part.cost ?? 0)));
  const rows = page.order.map((k) => {
    const part = page.parts[k];
    const box = make("input", { type: "checkbox", "aria-label": `show ${part.name}` });
    box.checked = true;
    box.addEventListener("change", () => hide(k, !box.checked));
    const button = make(
      "button",
      { type: "button", className: "part", "aria-pressed": "false" },
      swatch(part.color),
      nameOf(part.name),
    );
    button.addEventListener("click", () => choose(k));
    const absent = part.elements === 0;
    const row = make(
      "tr",
      { className: absent ? "absent" : undefined, "data-part": k },
      make("td", { className: "box" }, box),
      make("th", { scope: "row" }, button),
      make(
        "td",
        { className: "number" },
        absent ? "none" : percent(part.share),
        make("span", { className: "faint" }, absent ? "" : short(part.area)),
      ),
      costly
        ? make(
            "td",
            { className: "number" },
            part.cost === null ? "" : short(part.cost),
            bar(part.cost ?? 0, largest, part.color),
          )
        : null,
    );
    const detail = detailRow(part, costly);
    body.append(row);
    if (detail) body.append(detail);
    return { k, row, detail, button };
  });
  return ({ chosen, isolated, hovered }) => {
    for (const { k, row, detail, button } of rows) {
      row.classList.toggle("chosen", k === chosen);
      row.classList.toggle("hovered", k === hovered);
      row.classList.toggle("dimmed", isolated !== null && k !== isolated);
      button.setAttribute("aria-pressed", String(k === chosen));
      if (detail) detail.hidden = k !== chosen;
    }
  };
}

/** What is known of one part, below its row: its terms, worst first. */
function detailRow(part, costly) {
  if (!costly || (part.terms.length === 0 && !part.detail)) return null;
  const terms = part.terms.map((term) =>
    make(
      "tr",
      {},
      make(
        "th",
        { scope: "row" },
        term.name,
        term.others.length > 0
          ? make("span", { className: "faint inline" }, " with ", nameOf(term.others.join(", ")))
          : null,
      ),
      make("td", { className: "number" }, term.value === null ? "left out" : short(term.value)),
      make("td", { className: "number" }, term.cost === null ? "" : short(term.cost)),
    ),
  );
  const table = make(
    "table",
    { className: "terms" },
    make("caption", { className: "unseen" }, `terms of ${part.name}`),
    make(
      "thead",
      {},
      make(
        "tr",
        {},
        make("th", { scope: "col" }, "term"),
        make("th", { scope: "col", className: "number" }, "value"),
        make("th", { scope: "col", className: "number" }, "cost"),
      ),
    ),
    make("tbody", {}, ...terms),
  );
  const detail = part.detail ? make("p", { className: "comment" }, part.detail) : null;
  const row = make("tr", { className: "detail" }, make("td", { colspan: "4" }, table, detail));
  row.hidden = true;
  return row;
}

/** The bars of what each term adds to the cost, most first. */
export function fillTerms(page) {
  const section = document.getElementById("terms-section");
  section.hidden = page.terms.length === 0;
  const largest = Math.max(0, ...page.terms.map((term) => Math.abs(term.cost)));
  for (const term of page.terms) {
    document.getElementById("terms").append(
      make(
        "tr",
        {},
        make(
          "th",
          { scope: "row" },
          term.weight === 1 ? null : make("span", { className: "faint inline" }, `${short(term.weight)} × `),
          make("bdi", {}, term.text),
          bar(term.cost, largest),
        ),
        make("td", { className: "number" }, short(term.cost)),
      ),
    );
  }
}
