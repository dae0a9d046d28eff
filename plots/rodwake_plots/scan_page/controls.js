// What the reader takes away: the selected rows of scan.csv, and the scene of a point.

function save(name, text, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** The columns of scan.csv; before them the number of the point, from 0. */
function csvOf(points) {
  const lines = [["point", ...scan.columns.map(column => column.name)].join(",")];
  for (const point of points) lines.push([point, ...scan.columns.map(column => cell(column, point))].join(","));
  return lines.join("\n") + "\n";
}

/** A complete scene: that of the run, without the scan, with this point's values of the axes. */
function sceneOf(point) {
  const position = scan.axes.map(axis => `${axis.key} = ${cell(scan.column[axis.key], point)}`).join(", ");
  const parts = scan.scene.map(part => typeof part === "string" ? part : written(part, point));
  return `# Point ${point} of a scan: ${position}\n` + parts.join("");
}

/** The value of an axis as TOML. */
function written({ axis, factor, kind }, point) {
  const column = scan.column[scan.axes[axis].key];
  if (kind === "word") return JSON.stringify(cell(column, point));
  if (kind === "flag") return cell(column, point);
  const value = column.data[point] * factor;
  if (kind === "integer") return String(Math.round(value));
  const text = Object.is(value, -0) ? "-0.0" : String(value);
  return /[.e]/.test(text) ? text : text + ".0";
}

// The controls around the diagram: choices, slices, legend.

const option = (value, text) => node("option", { value }, text);

function fillChoices(view, changed) {
  const scales = Object.values(scaleOf);
  for (const [id, chosen] of [["across", view.across.name], ["up", view.up.name]]) {
    element(id).append(...scales.map(scale => option(scale.name, scale.text)));
    element(id).value = chosen;
  }
  element("colour").append(option("outcome", "outcome"), ...scan.columns.filter(column => column.norm)
    .map(column => option(column.name, column.label)));
  for (const id of ["across", "up", "colour"])
    element(id).addEventListener("change", () => changed(id, element(id).value));
}

/** For each axis that is neither across nor up, a choice of its values. */
function fillSlices(view, changed) {
  const holder = element("slices");
  holder.replaceChildren();
  scan.axes.forEach((axis, index) => {
    const scale = scaleOf[axis.key];
    if (index === view.across.axis || index === view.up.axis) return;
    const select = node("select", { "aria-label": "Slice of " + axis.key }, option("", "all"),
      ...sliceValues(scale).map(even => option(even, read(scale, even))));
    select.value = view.slices[index] ?? "";
    select.addEventListener("change", () => changed(index, select.value === "" ? null : +select.value));
    holder.append(node("label", {}, node("span", {}, ...marked(scale.marked)), select));
  });
}

const MOST_SLICES = 60;

/** Values of an axis; of very many so many, evenly over it. */
function sliceValues(scale) {
  if (scale.words) return scale.words.map((_, index) => index);
  const { places } = gridOf(scale);
  if (places.length <= MOST_SLICES) return places;
  const step = (scale.high - scale.low) / MOST_SLICES;
  return Array.from({ length: MOST_SLICES }, (_, index) => scale.low + (index + 0.5) * step);
}

/** Where a scan of many axes is cut at first: planes of grids and refinements in their middle, others not at all. */
function firstSlices(view) {
  const cut = view.across.axis >= 0 && view.up.axis >= 0 && ["grid", "adaptive"].includes(scan.design);
  return scan.axes.map((axis, index) => {
    if (!cut || index === view.across.axis || index === view.up.axis) return null;
    const values = sliceValues(scaleOf[axis.key]);
    return values[Math.floor(values.length / 2)];
  });
}

/** Points of a slice: those at its value, where points share values; else those nearer to it than to its neighbours. */
function passesSlices(view) {
  const cuts = scan.axes.map((axis, index) => ({ scale: scaleOf[axis.key], at: view.slices[index] ?? null }))
    .filter(({ at }) => at !== null);
  const tests = cuts.map(({ scale, at }) => {
    const values = sliceValues(scale), shared = scale.words || gridOf(scale).places.length <= MOST_SLICES;
    const half = shared ? 1e-9 * (scale.high - scale.low || 1) : (values[1] - values[0]) / 2;
    return point => Math.abs(scale.even[point] - at) <= half;
  });
  return point => tests.every(test => test(point));
}

/** Outcomes with their numbers, which hide and show them; of numbers a ramp. */
function fillLegend(view, toggled) {
  const holder = element("legend"), counts = new Uint32Array(256);
  for (const point of view.all) ++counts[scan.outcome[point]];
  const family = node("span", { class: "family" }, "capture");
  holder.replaceChildren();
  scan.outcomes.forEach((one, code) => {
    if (!counts[code]) return;
    const button = legendButton(one, code, counts[code], view.hidden.has(code), toggled);
    if (!isCapture(code)) return holder.append(button);
    family.append(button);
    if (!family.parentElement) holder.append(family);
  });
  const failed = view.all.reduce((sum, point) => sum + scan.failed[point], 0);
  if (failed) holder.append(node("span", {}, node("b", { class: "cross" }, "×"), ` failed ${grouped(failed)}`));
  if (paint.number) holder.append(ramp(scan.column[view.colour]));
}

function legendButton(one, code, count, hidden, toggled) {
  const asItself = !paint.number || (code === PURSUIT && !means(scan.column[view.colour], code));
  const button = node("button", { type: "button", "aria-pressed": !hidden }, asItself ? swatch(one.colour) : "",
    `${one.name} ${grouped(count)}`);
  button.addEventListener("click", () => toggled(code));
  return button;
}

/** Whether points other than those of pursuit and failed ones have no number. */
function lacksNumbers(column) {
  const lacks = point => Number.isNaN(paint.number.places[point]) && scan.outcome[point] !== PURSUIT;
  return view.all.some(point => !scan.failed[point] && lacks(point));
}

function ramp(column) {
  const bytes = scan.maps[column.map], stops = [];
  for (let index = 0; index < 256; index += 15)
    stops.push(`rgb(${bytes.subarray(3 * index, 3 * index + 3).join(" ")})`);
  const none = [" ", node("span", { class: "note" }, swatch(nothing()), column.of ? "not captured" : "no value")];
  return node("span", { id: "ramp" }, node("span", {}, shown(column.norm[0], 3)),
    node("i", { class: "scale", style: `background:linear-gradient(90deg,${stops})` }),
    node("span", {}, shown(column.norm[1], 3), ...unitOf(column), ...lacksNumbers(column) ? none : []));
}

/** `x = 3 f/mu` */
function valueNode(scale, point) {
  return node("span", { class: "eq" }, ...marked(scale.marked), ` = ${read(scale, scale.even[point])}`, ...unitOf(scale));
}

const row = (attributes, name, value) => node("tr", attributes, node("td", {}, ...name), node("td", {}, ...value));

/** Parameters and results of a point as a table; `all`: every column. */
function pointTable(point, all) {
  const rows = scan.axes.map(axis => {
    const scale = scaleOf[axis.key];
    return row({ class: "of-axis" }, marked(scale.marked), [read(scale, scale.even[point]), ...unitOf(scale)]);
  });
  for (const column of scan.columns) {
    if (column.words || !column.label || (!all && !BRIEF.has(column.name))) continue;
    const value = column.data[point];
    const name = means(column, scan.outcome[point]) ? marked(column.marked) : ["time reached"];
    if (Number.isFinite(value)) rows.push(row({}, name, [shown(value, all ? 7 : 4), ...unitOf(column)]));
  }
  return node("table", {}, ...rows);
}

const BRIEF = new Set(["time", "min_separation", "final_separation", "non_reciprocity", "delta_y", "psi6"]);
