// Colours of Okabe and Ito, which colour-blind people can tell apart.
const COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442"];
const OTHER = "#8c959f";
const MARK = "#d55e00";

function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  set(element, attributes);
  element.append(...children);
  return element;
}

/** A chart in a figure, in the place of the one before. What it shows is said in `label`. */
function drawChart(root, [width, height], label, children) {
  root.querySelector("svg")?.remove();
  root.querySelector(".legend")?.remove();
  root.append(svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label }, ...children));
}

/** Round numbers that span a range. */
function ticks(low, high, count = 5) {
  const rough = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((value) => value >= rough);
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, place) => (first + place) * step);
}

/** Lowest and highest of some numbers, a little apart where they are one. */
function span(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
  if (!(low <= high)) return [0, 1];
  return low === high ? [low - 1, high + 1] : [low, high];
}

const text = (x, y, words, more = {}) => svg("text", { x, y, fill: "#57606a", ...more }, words);
const tick = (value) => shownNumber(value, Number.isInteger(value) ? 0 : value < 0.1 && value > -0.1 ? 2 : 1);

/** Axes of a plot with their ticks; `x` and `y` map values to places. */
function axes({ left, right, top, bottom }, x, y, [xs, ys], [xName, yName]) {
  const lines = [];
  for (const value of xs) lines.push(svg("line", { x1: x(value), x2: x(value), y1: bottom, y2: bottom + 4, stroke: "#8c959f" }), text(x(value), bottom + 16, tick(value), { "text-anchor": "middle" }));
  for (const value of ys) lines.push(svg("line", { x1: left, x2: right, y1: y(value), y2: y(value), stroke: "#e5e8eb" }), text(left - 6, y(value) + 4, tick(value), { "text-anchor": "end" }));
  lines.push(svg("line", { x1: left, x2: right, y1: bottom, y2: bottom, stroke: "#8c959f" }));
  lines.push(text((left + right) / 2, bottom + 32, xName, { "text-anchor": "middle" }));
  lines.push(text(12, (top + bottom) / 2, yName, { "text-anchor": "middle", transform: `rotate(-90 12 ${(top + bottom) / 2})` }));
  return lines;
}

/** Points that can be chosen. `points`: x, y, row, rank. */
function scatter(root, points, [xName, yName], chosen, choose) {
  const box = { left: 58, right: 510, top: 10, bottom: 270 };
  const [left, xHigh] = span([0, ...points.map((point) => point.x)]);
  const [least, most] = span(points.map((point) => point.y));
  // No dot lies over an axis or beyond the chart: the largest has a radius of 6 of the 260 that the chart is high.
  const room = 0.03 * (most - least);
  const [yLow, yHigh] = [least - room, most + room];
  const xLow = left - 0.015 * (xHigh - left);
  const x = (value) => box.left + (value - xLow) / (xHigh - xLow) * (box.right - box.left);
  const y = (value) => box.bottom - (value - yLow) / (yHigh - yLow) * (box.bottom - box.top);
  const drawn = [...points].sort((one, other) => (one.row === chosen) - (other.row === chosen));
  const circles = drawn.map((point) => svg("circle", {
    cx: x(point.x).toFixed(1), cy: y(point.y).toFixed(1), r: point.row === chosen ? 6 : 3, class: "choice", "data-row": point.row,
    fill: point.row === chosen ? MARK : COLOURS[0], "fill-opacity": point.row === chosen ? 1 : 0.45, stroke: point.row === chosen ? "#000" : "none",
    click: () => choose(point.row),
  }, svg("title", {}, `rank ${point.rank}: ${xName} ${shownNumber(point.x, 2)}, score ${shownNumber(point.y, 1)}`)));
  const of = points.find((point) => point.row === chosen);
  const label = `${points.length} poses, ${yName} against ${xName}.` + (of ? ` The selected one: ${shownNumber(of.x, 2)}, ${shownNumber(of.y, 1)}.` : "");
  drawChart(root, [520, 310], label, [...axes(box, x, y, [ticks(xLow, xHigh), ticks(yLow, yHigh)], [xName, yName]), ...circles]);
}

/** How many values lie where, with one of them marked. */
function histogram(root, values, mark, name) {
  const box = { left: 58, right: 510, top: 10, bottom: 270 };
  const [low, high] = span(values);
  const bins = Math.min(40, Math.max(5, Math.round(Math.sqrt(values.length) * 1.5)));
  const counts = new Array(bins).fill(0);
  for (const value of values) counts[Math.min(bins - 1, Math.floor((value - low) / (high - low) * bins))] += 1;
  const most = Math.max(1, ...counts);
  const x = (value) => box.left + (value - low) / (high - low) * (box.right - box.left);
  const y = (value) => box.bottom - value / most * (box.bottom - box.top);
  const wide = (box.right - box.left) / bins;
  const bars = counts.map((count, bin) => svg("rect", { x: box.left + bin * wide + 0.5, width: Math.max(wide - 1, 1), y: y(count), height: box.bottom - y(count), fill: COLOURS[4] }));
  const line = svg("line", { x1: x(mark), x2: x(mark), y1: box.top, y2: box.bottom, stroke: MARK, "stroke-width": 2 });
  const below = values.filter((value) => value < mark).length;
  const label = `${values.length} values of ${name} from ${shownNumber(low, 1)} to ${shownNumber(high, 1)}. The selected one is ${shownNumber(mark, 1)}, above ${below} of them.`;
  drawChart(root, [520, 310], label, [...axes(box, x, y, [ticks(low, high), ticks(0, most).filter(Number.isInteger)], [name, "rows"]), ...bars, line]);
}

/** Bars made of parts, which may be negative. `bars`: label, chosen, parts (name to value), choose. */
function stackedBars(root, bars, names) {
  const box = { left: 62, right: 510, top: 4, bottom: 4 + 20 * bars.length };
  const sum = (bar, sign) => names.reduce((total, name) => total + Math.max(0, sign * (bar.parts[name] ?? 0)), 0);
  const [low, high] = span([0, ...bars.map((bar) => sum(bar, 1)), ...bars.map((bar) => -sum(bar, -1))]);
  const x = (value) => box.left + (value - low) / (high - low) * (box.right - box.left);
  const colour = (place) => COLOURS[place] ?? OTHER;
  const marks = ticks(low, high).flatMap((value) => [
    svg("line", { x1: x(value), x2: x(value), y1: box.top, y2: box.bottom, stroke: value === 0 ? "#57606a" : "#e5e8eb" }),
    text(x(value), box.bottom + 14, tick(value), { "text-anchor": "middle" })]);
  const drawn = bars.flatMap((bar, place) => {
    const y = box.top + 20 * place + 3;
    const ends = { 1: 0, "-1": 0 };
    const parts = names.map((name, index) => {
      const value = bar.parts[name] ?? 0;
      const sign = value < 0 ? -1 : 1;
      const from = ends[sign];
      ends[sign] += value;
      const [one, other] = [x(from), x(ends[sign])];
      return svg("rect", { x: Math.min(one, other), width: Math.abs(other - one), y, height: 14, fill: colour(index), stroke: bar.chosen ? "#000" : "none" },
        svg("title", {}, `${bar.label}, ${name}: ${shownNumber(value, 1)}`));
    });
    return [svg("g", { class: "choice", click: bar.choose }, text(box.left - 6, y + 11, bar.label, { "text-anchor": "end", "font-weight": bar.chosen ? 700 : 400 }), ...parts)];
  });
  const said = bars.filter((bar) => bar.chosen).map((bar) => `${bar.label}: ` + names.map((name) => `${name} ${shownNumber(bar.parts[name] ?? 0, 1)}`).join(", "));
  drawChart(root, [520, box.bottom + 20], `Score by term of ${bars.length} rows. ${said.join("")}`, [...marks, ...drawn]);
  root.append(legend(names.map((name, place) => [colour(place), name])));
}

/** A list of colours and what they stand for. */
function legend(entries) {
  return make("ul", { class: "legend" }, ...entries.map(([colour, name]) => make("li", {}, make("span", { style: `background:${colour}` }), name)));
}

/** Pairs as squares: `pairs` of [row, column, distance]; `names` of rows and of columns. */
function contactMap(root, pairs, names, sides) {
  const axis = (side) => [...new Set(pairs.map((pair) => pair[side]))].sort((one, other) => one - other);
  const [rows, columns] = [axis(0), axis(1)];
  const size = Math.max(4, Math.min(15, 380 / Math.max(rows.length, columns.length, 1)));
  const [left, top] = [90, 90];
  const [wide, high] = [columns.length * size, rows.length * size];
  // Where squares are small, only some names have room.
  const every = Math.ceil(11 / size);
  const labels = (places, side, place) => places.flatMap((residue, index) => index % every ? [] : [place(names[side][residue], index)]);
  const squares = pairs.map(([row, column, distance]) => svg("rect", {
    x: left + columns.indexOf(column) * size, y: top + rows.indexOf(row) * size, width: size - 0.5, height: size - 0.5,
    fill: "#0072b2", "fill-opacity": Math.max(0.15, Math.min(1, 1 - (distance - 2.5) / 3)).toFixed(2),
  }, svg("title", {}, `${names[0][row]} – ${names[1][column]}: ${shownNumber(distance, 2)} Å`)));
  drawChart(root, [Math.max(left + wide + 10, 520), top + high + 24], `Contact map: ${pairs.length} pairs of ${rows.length} residues of the ${sides[0]} and ${columns.length} of the ${sides[1]}; the table below lists them.`, [
    svg("rect", { x: left, y: top, width: wide, height: high, fill: "none", stroke: "#c8cdd3" }),
    ...labels(rows, 0, (name, index) => text(left - 4, top + (index + 0.5) * size + 4, name, { "text-anchor": "end" })),
    ...labels(columns, 1, (name, index) => text(0, 0, name, { transform: `translate(${left + (index + 0.5) * size + 4} ${top - 4}) rotate(-90)` })),
    ...squares,
    text(4, top + high + 16, `rows: ${sides[0]}, columns: ${sides[1]}`),
  ]);
}
