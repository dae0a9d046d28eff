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
  const told = scan.axes.map(axis => `${axis.key} = ${cell(scan.column[axis.key], point)}`).join(", ");
  const parts = scan.scene.map(part => typeof part === "string" ? part : written(part, point));
  return `# Point ${point} of a scan: ${told}\n` + parts.join("");
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
