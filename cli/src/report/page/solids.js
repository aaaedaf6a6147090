/** A report of two solids: a row says where the second one is. */
async function showSolids(data) {
  let scene = null;
  let chosen = 0;
  const first = data.columns.findIndex((column) => column.main);
  const table = makeTable(byId("list-table"), { caption: data.caption, columns: data.columns, rows: data.rows, choose, empty: "No results" });
  filterByText(table, data);

  function choose(row) {
    chosen = row;
    table.mark(row);
    scene?.show(row);
    const said = data.columns.map((column, place) => [column, data.rows[row][place]]).filter(([column, value]) => column.main && value !== null);
    byId("selected").textContent = `Selected: ${said.map(([column, value]) => `${column.name} ${shownNumber(value, column.digits)}`).join(", ")}.`;
    byId("scene").setAttribute("aria-label", `${data.sides[0]} and ${data.sides[1]}, row ${data.rows[row][first]}, turned with the mouse or the arrow keys`);
  }

  await withLibrary(["scene", "legend", "zoom-all"], () => {
    if (data.rows.length === 0) return;
    scene = makeScene(byId("scene"), data);
    if (chosen > 0) scene.show(chosen);
    byId("zoom-all").addEventListener("click", () => scene.whole());
    turnByKeys(byId("scene"), scene);
    byId("legend").replaceChildren(...legend([[RECEPTOR, data.sides[0]], [LIGANDS[0], data.sides[1]]]).children);
  });
  if (data.rows.length > 0) choose(0);
  window.knotdock = { choose, picture: () => scene?.picture() };
}
