// Puts the page together: controls, and the start.

function start() {
  const names = scan.axes.map(axis => axis.key);
  const numbers = scan.columns.filter(column => column.norm).map(column => column.name);
  const first = ["final_separation", "delta_y", ...numbers].find(name => numbers.includes(name));
  const second = names[1] ?? first ?? names[0];
  [view.across, view.up] = [scaleOf[names[0]], scaleOf[second]];
  view.slices = firstSlices(view);
  fillChoices(view, choose);
  fillSlices(view, cut);
  listen();
  if (!scan.scene) element("scene-told").textContent = `No scenes of points: ${scan.noScene}.`;
  refill();
  whole();
}

function listen() {
  const marks = element("marks"), on = (id, act) => element(id).addEventListener("click", act);
  marks.addEventListener("pointerdown", pressed);
  marks.addEventListener("pointermove", moved);
  for (const name of ["pointerup", "pointercancel"]) marks.addEventListener(name, released);
  marks.addEventListener("pointerleave", () => drag || hover(-1));
  marks.addEventListener("blur", () => hover(-1));
  marks.addEventListener("keydown", keyed);
  marks.addEventListener("wheel", event => {
    event.preventDefault();
    zoom(Math.exp(0.0015 * Math.max(-400, Math.min(400, event.deltaY))), view.even(...pixelsOf(event)));
    hover(nearestAt(pixelsOf(event)));
  }, { passive: false });
  on("nearer", () => zoom(0.6));
  on("farther", () => zoom(1 / 0.6));
  on("whole", whole);
  on("drag", () => {
    view.moves = !view.moves;
    marks.classList.toggle("moves", view.moves);
    element("drag").setAttribute("aria-pressed", String(view.moves));
    element("drag").textContent = view.moves ? "Drag: move" : "Drag: select";
  });
  on("select-view", () => select(inRectangle([view.low, view.high])));
  on("zoom-selection", zoomToSelection);
  on("clear", () => select(null));
  on("csv", () => save("selection.csv", csvOf(view.selection), "text/csv"));
  on("scene", () => save(`point-${view.clicked}.toml`, sceneOf(view.clicked), "application/toml"));
  element("clock").addEventListener("input", redrawWalk);
  darkness.addEventListener("change", () => { recolour(); draw(); redrawWalk(); });
  let width = window.innerWidth;
  window.addEventListener("resize", () => {
    if (width === window.innerWidth) return;
    width = window.innerWidth;
    draw();
    redrawWalk();
  });
}

/** For scripts: `ready` when the diagram is drawn, places of points in the window, the view. */
window.scanPage = { ready: null, view, timings, scan, pointAt(point) {
  const { left, top } = element("marks").getBoundingClientRect(), [x, y] = view.place(point);
  return [left + x, top + y];
} };

window.scanPage.ready = (async () => {
  const begun = performance.now();
  await readScan();
  timings.read = performance.now() - begun;
  readScales();
  start();
  timings.ready = performance.now() - begun;
})().catch(error => {
  element("trouble").hidden = false;
  const tooOld = typeof DecompressionStream === "undefined";
  element("trouble").textContent = tooOld ? "This browser is too old for this page: it cannot unpack the points."
    : `The page could not be drawn: ${error.message}`;
  throw error;
});
