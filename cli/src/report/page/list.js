/** A report that is a table of results, each perhaps with a page of its own. */
function showList(data) {
  const link = (row) => data.links[row] ?? null;
  const table = makeTable(byId("list-table"), { caption: data.caption, columns: data.columns, rows: data.rows, link, empty: "No results" });
  filterByText(table, data);
  window.knotdock = {};
}

/** Connects the filter by text and the choice of columns with a table. */
function filterByText(table, data) {
  const filter = () => {
    const wanted = byId("filter-text").value.trim().toLowerCase();
    table.filter((row) => wanted === "" || data.rows[row].some((field) => field !== null && String(field).toLowerCase().includes(wanted)));
  };
  const filters = byId("filters");
  filters.addEventListener("input", filter);
  filters.addEventListener("submit", (event) => event.preventDefault());
  filters.addEventListener("reset", () => setTimeout(() => { filter(); table.showAll(false); }));
  byId("all-columns").addEventListener("change", (event) => table.showAll(event.target.checked));
}
