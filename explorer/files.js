// What can be taken away: tables, pictures, the scene, the address.

function download(name, content, type) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = make("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** The columns of the program's rods.csv, a row a step of the integrator. */
function pathTable({ path }) {
  return "t,x0,y0,theta0,x1,y1,theta1\n" + path.map(row => row.join(",")).join("\n") + "\n";
}

/** The field on a grid: columns of the program's field, as far as the kernels give them. */
function wakeTable(wake) {
  const { state } = wake.store, { x, y } = middles(state, 64), n = x.length, of = wake.ask(x, y, true);
  const rows = ["x,y,Ux,Uy,exx,exy,eyy,lapx,lapy,gradx_tr,grady_tr"];
  for (let i = 0; i < n; ++i) rows.push([x[i], y[i], ...[7, 8, 0, 1, 2, 3, 4, 5, 6].map(column => of[column * n + i])].join(","));
  return rows.join("\n") + "\n";
}

/** The cells that were computed, as rows of the program's scan.csv: both keys and the outcome. */
function diagramTable(diagram) {
  const [across, up] = diagram.axes, rows = [`${across.name},${up.name},outcome`];
  diagram.known.forEach((known, cell) => {
    if (!known) return;
    const places = [(cell % CELLS) + 0.5, Math.floor(cell / CELLS) + 0.5].map(k => k / CELLS);
    rows.push(`${valueAt(across, places[0])},${valueAt(up, places[1])},${OUTCOMES[diagram.shown[cell]]}`);
  });
  return rows.join("\n") + "\n";
}

/** The encounter as a drawing whose lines stay lines. */
function pathDrawing(paths) {
  const { size } = paths.stage, round = number => Number(number.toFixed(2));
  const trace = rod => paths.trace(rod, Infinity).map(([x, y], index) => `${index ? "L" : "M"}${round(x)} ${round(y)}`).join("");
  const rod = ([x, y, theta], index, strength) => {
    const [px, py] = paths.stage.toPixel(x, y);
    return `<path transform="translate(${round(px)} ${round(py)}) rotate(${round(-theta / DEGREE)})" fill="${ink.rods[index]}" `
      + `fill-opacity="${strength}" d="M-13 -7L11 -3.5A3.5 3.5 0 0 1 11 3.5L-13 7A7 7 0 0 1 -13 -7Z"/>`;
  };
  const starts = problemOf(paths.store.state).rods, ends = posesAt(paths.run, paths.run.time);
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${size}" height="${size}" viewBox="0 0 ${size} ${size}">\n`
    + `<title>${paths.run.outcome} at t = ${numeral(paths.run.time)}</title>\n<rect width="100%" height="100%" fill="${ink.sheet}"/>\n`
    + [0, 1].map(index => `<path fill="none" stroke="${ink.rods[index]}" stroke-width="2" stroke-linejoin="round" d="${trace(index)}"/>\n`
      + rod(ends[index], index, 0.45) + rod(starts[index], index, 1) + "\n").join("") + "</svg>\n";
}

function savePicture(canvas, name) { canvas.toBlob(picture => download(name, picture), "image/png"); }

/** The text on the clipboard; where a page may not, by the old way. */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = make("textarea", { class: "unseen", "aria-hidden": "true" });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
