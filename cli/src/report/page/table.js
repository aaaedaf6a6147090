const PAGE_ROWS = 25;

/**
 * A table that sorts, filters and turns pages, and in which a row can be chosen by mouse and keyboard.
 * `columns`: name, help, digits (null of text), main. `rows`: arrays of fields in that order.
 * `choose(row)` is called with the place of a chosen row; without it rows cannot be chosen.
 * `link(row)` is the address behind the first cell, where there is one.
 */
function makeTable(root, { caption, columns, rows, choose, link, empty }) {
  const state = { sort: -1, descending: false, page: 0, all: false, chosen: -1, passes: () => true };
  const head = make("tr");
  const body = make("tbody");
  const words = make("span", { role: "status", "aria-live": "polite" });
  const turn = (by) => { state.page += by; draw(); };
  const before = make("button", { type: "button", click: () => turn(-1) }, "Previous");
  const after = make("button", { type: "button", click: () => turn(1) }, "Next");
  const table = make("table", choose ? { role: "grid" } : {}, make("caption", {}, caption), make("thead", {}, head), body);
  root.replaceChildren(make("div", { class: "scroll" }, table), make("div", { class: "pager" }, before, after, words));

  function order() {
    const places = rows.map((_, place) => place).filter((place) => state.passes(place));
    if (state.sort < 0) return places;
    const sign = state.descending ? -1 : 1;
    const missing = (value) => value === null || value === undefined;
    return places.sort((one, other) => {
      const [a, b] = [rows[one][state.sort], rows[other][state.sort]];
      // What is missing comes last, whichever way.
      if (missing(a) || missing(b)) return missing(a) - missing(b) || one - other;
      const by = typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
      return sign * by || one - other;
    });
  }

  function sortBy(column) {
    // Numbers begin with the largest, but for the first column, which counts.
    const first = columns[column].digits !== null && column > 0;
    state.descending = state.sort === column ? !state.descending : first;
    state.sort = column;
    state.page = 0;
    draw();
    head.querySelector(`[data-column="${column}"]`)?.focus();
  }

  function cell(row, column) {
    const { digits } = columns[column];
    const text = digits === null ? rows[row][column] ?? "–" : shownNumber(rows[row][column], digits);
    const address = column === 0 && link ? link(row) : null;
    const content = address ? make("a", { href: address }, text) : text;
    return make("td", { class: digits === null ? null : "number", role: choose ? "gridcell" : null }, content);
  }

  function draw() {
    const shown = columns.map((_, place) => place).filter((place) => state.all || columns[place].main);
    head.replaceChildren(...shown.map((place) => {
      const { name, help, digits } = columns[place];
      const sorted = state.sort !== place ? "none" : state.descending ? "descending" : "ascending";
      const arrow = { none: "", ascending: " ▲", descending: " ▼" }[sorted];
      const button = make("button", { type: "button", "data-column": place, title: help || null, click: () => sortBy(place) }, name + arrow);
      return make("th", { scope: "col", class: digits === null ? null : "number", "aria-sort": sorted }, button);
    }));
    const places = order();
    const pages = Math.max(1, Math.ceil(places.length / PAGE_ROWS));
    state.page = Math.min(Math.max(state.page, 0), pages - 1);
    const from = state.page * PAGE_ROWS;
    const page = places.slice(from, from + PAGE_ROWS);
    const focused = body.contains(document.activeElement);
    const stop = page.includes(state.chosen) ? state.chosen : page[0];
    body.replaceChildren(...page.map((row) => make("tr", choose ? {
      class: "choice",
      "data-row": row,
      tabindex: row === stop ? 0 : -1,
      "aria-selected": String(row === state.chosen),
      click: () => choose(row),
    } : { "data-row": row }, ...shown.map((column) => cell(row, column)))));
    if (focused) body.querySelector(`[data-row="${stop}"]`)?.focus({ preventScroll: true });
    before.disabled = state.page === 0;
    after.disabled = state.page === pages - 1;
    before.hidden = after.hidden = pages === 1;
    const some = places.length === rows.length ? "" : ` that pass the filters, of ${rows.length}`;
    words.textContent = places.length === 0
      ? (rows.length === 0 ? empty ?? "No rows" : `No row passes the filters, of ${rows.length}`)
      : `Rows ${from + 1}–${from + page.length} of ${places.length}${some}`;
  }

  /** Chooses the row so many places from the chosen one, in the order shown. */
  function step(by) {
    const places = order();
    const at = places.indexOf(state.chosen);
    const next = places[Math.min(Math.max(at < 0 ? 0 : at + by, 0), places.length - 1)];
    if (next !== undefined) choose(next);
  }

  if (choose) {
    body.addEventListener("keydown", (event) => {
      const by = { ArrowDown: 1, ArrowUp: -1, PageDown: PAGE_ROWS, PageUp: -PAGE_ROWS, Home: -Infinity, End: Infinity }[event.key];
      const row = event.target.closest("tr");
      if (by !== undefined) step(by);
      else if ((event.key === "Enter" || event.key === " ") && row) choose(Number(row.dataset.row));
      else return;
      event.preventDefault();
    });
  }
  draw();
  return {
    /** Marks a row, and turns to its page. */
    mark(row) {
      state.chosen = row;
      const at = order().indexOf(row);
      if (at >= 0) state.page = Math.floor(at / PAGE_ROWS);
      draw();
    },
    filter(passes) { state.passes = passes; state.page = 0; draw(); },
    showAll(all) { state.all = all; draw(); },
    replace(newRows) { rows = newRows; state.page = 0; draw(); },
  };
}
