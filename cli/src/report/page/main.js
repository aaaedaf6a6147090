const PAGES = { run: showRun, list: showList, solids: showSolids, models: showModels };

unpacked("data").then((text) => {
  const data = JSON.parse(text);
  return PAGES[data.kind](data);
}).catch((error) => {
  document.querySelector("main").prepend(make("p", { class: "warnings", role: "alert" }, `This browser cannot show the report (${error.message}). Firefox from 113, Chrome from 80 and Safari from 16.4 can.`));
  throw error;
});
