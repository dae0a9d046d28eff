// A point: its numbers, its trajectory.

/** Marks the point and describes it; -1: none. */
function hover(point) {
  view.current = point;
  const tip = element("tip");
  tip.hidden = point < 0;
  if (point >= 0) {
    tip.replaceChildren(tag(point), " ", node("span", { class: "sub" }, `point ${grouped(point)}`), pointTable(point, false));
    placeTip(tip, view.place(point));
  }
  drawMarks();
}

/** Beside the point, on the side that has room. */
function placeTip(tip, [x, y]) {
  const stage = element("stage"), toLeft = x > stage.clientWidth / 2;
  const left = toLeft ? x - tip.offsetWidth - 14 : x + 14;
  tip.style.left = Math.max(0, Math.min(left, stage.clientWidth - tip.offsetWidth)) + "px";
  tip.style.top = Math.max(0, Math.min(y - tip.offsetHeight / 2, stage.clientHeight - tip.offsetHeight)) + "px";
}

const say = text => { element("said").textContent = text; };

function sayPoint(point) {
  const axes = scan.axes.map(axis => valueNode(scaleOf[axis.key], point).textContent).join(", ");
  say(`Point ${point}: ${axes}. ${tag(point).textContent}`);
}

function pick(point) {
  if (point < 0) return;
  view.clicked = point;
  element("point-name").replaceChildren(`Point ${grouped(point)} `, tag(point));
  element("point").replaceChildren(pointTable(point, true));
  element("scene").disabled = !scan.scene;
  showWalk(point);
  sayPoint(point);
  drawMarks();
}

function showWalk(point) {
  element("walk").hidden = false;
  const stored = scan.samples ? nearestSample(point) : { distance: Infinity };
  const computed = stored.distance > 0 ? computedSamples(point) : null;  // a stored one of this very point is the scan's own
  walk.samples = computed ?? scan.samples;
  element("path").hidden = element("clock").parentElement.hidden = !walk.samples;
  if (!walk.samples) {
    element("walk-text").textContent = "This scan has stored no trajectories.";
    return;
  }
  walk.sample = computed ? 0 : stored.sample;
  view.sample = walk.samples.point[walk.sample];
  element("walk-text").replaceChildren(...(computed ? describeComputed(point, computed.outcome) : describeSample(point, stored)));
  const rods = Array.from({ length: walk.samples.rods }, (_, rod) => node("span", {}, swatch(rodColour(rod)), ` rod ${rod}`));
  element("rods").replaceChildren(...rods, node("span", {}, "hollow: start; lengths in ", ...marked(scan.lengthUnit)));
  element("clock").value = 1000;
  redrawWalk();
}

function redrawWalk() {
  if (walk.sample < 0) return;
  const share = element("clock").value / 1000;
  drawWalk(walk.sample, share);
  element("time").replaceChildren(`${shown(timeAt(walk.sample, share), 4)} `, ...marked(scan.timeUnit));
}

// A selection of points.

function select(points) {
  view.selection = points && points.length ? points : null;
  if (!view.selection) view.rectangle = null;
  const count = view.selection ? view.selection.length : 0;
  const points_ = `${grouped(count)} point${count > 1 ? "s" : ""}`;
  element("selected").textContent = count ? `${points_} selected` : "Nothing selected";
  element("csv").disabled = element("clear").disabled = !count;
  element("zoom-selection").disabled = !view.rectangle;
  say(element("selected").textContent);
  drawMarks();
}

/** Shown points between two places in even coordinates. */
function inRectangle([a, b]) {
  const low = a.map((value, side) => Math.min(value, b[side])), high = a.map((value, side) => Math.max(value, b[side]));
  view.rectangle = [low, high];
  const { across, up } = view;
  return view.points.filter(point => across.even[point] >= low[0] && across.even[point] <= high[0]
    && up.even[point] >= low[1] && up.even[point] <= high[1]);
}

function zoomToSelection() {
  if (!view.rectangle || view.rectangle[0].some((low, side) => !(low < view.rectangle[1][side]))) return;
  [view.low, view.high] = view.rectangle.map(corner => [...corner]);
  draw();
}

// What pointer and keys do on the diagram.

const pointers = new Map();
let drag = null;  // {from: pixels, last: pixels, moves: whether it moves the view}

const pixelsOf = event => {
  const { left, top } = element("marks").getBoundingClientRect();
  return [event.clientX - left, event.clientY - top];
};

function nearestAt(pixels) {
  return view.points.length ? nearest(...view.even(...pixels), ...view.pixels()) : -1;
}

function inFrame([x, y]) {
  const { left, top, width, height } = view.box;
  return x >= left && x <= left + width && y >= top && y <= top + height;
}

function pressed(event) {
  const at = pixelsOf(event);
  if (event.button || !inFrame(at)) return;
  element("marks").setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, at);
  drag = pointers.size > 1 ? null : { from: at, last: at, moves: view.moves !== event.shiftKey, far: false };
}

function moved(event) {
  const at = pixelsOf(event);
  if (pointers.size > 1 && pointers.has(event.pointerId)) return pinch(event.pointerId, at);
  if (!drag) return hover(inFrame(at) ? nearestAt(at) : -1);
  drag.far ||= Math.hypot(at[0] - drag.from[0], at[1] - drag.from[1]) > 4;
  if (!drag.far) return;
  hover(-1);
  if (drag.moves) move(at[0] - drag.last[0], at[1] - drag.last[1]);
  else {
    view.rectangle = [view.even(...drag.from), view.even(...at)];
    drawMarks();
  }
  drag.last = at;
}

function released(event) {
  pointers.delete(event.pointerId);
  const at = pixelsOf(event);
  if (drag && !drag.far && event.type === "pointerup") pick(nearestAt(at));
  if (drag && drag.far && !drag.moves) select(inRectangle([view.even(...drag.from), view.even(...at)]));
  drag = null;
}

/** Two fingers: the view follows them. */
function pinch(id, at) {
  const before = pointers.get(id), other = [...pointers].find(([one]) => one !== id)[1];
  const apart = place => Math.hypot(place[0] - other[0], place[1] - other[1]) || 1;
  pointers.set(id, at);
  zoom(apart(before) / apart(at), view.even((at[0] + other[0]) / 2, (at[1] + other[1]) / 2));
}

const STEPS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function keyed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key in STEPS) step(...STEPS[event.key], event.shiftKey);
  else if (event.key === "Enter" || event.key === " ") pick(view.current);
  else if (event.key === "+" || event.key === "=") zoom(0.6);
  else if (event.key === "-") zoom(1 / 0.6);
  else if (event.key === "0") whole();
  else if (event.key === "Escape") select(null);
  else return;
  event.preventDefault();
}

/** To the next point, which comes into view; with Shift the view moves instead. */
function step(right, upwards, moves) {
  if (moves) return move(-0.1 * right * view.box.width, 0.1 * upwards * view.box.height);
  const { left, top, width, height } = view.box;
  const next = view.current < 0 ? nearestAt([left + width / 2, top + height / 2])
    : neighbour(view.current, right, upwards, ...view.pixels());
  if (next < 0) return;
  if (!view.holds(next)) bringIntoView(next);
  hover(next);
  sayPoint(next);
}

function bringIntoView(point) {
  [view.across, view.up].forEach((scale, side) => {
    const size = view.high[side] - view.low[side], at = scale.even[point];
    if (at >= view.low[side] && at <= view.high[side]) return;
    view.low[side] = at - size / 2;
    view.high[side] = at + size / 2;
  });
  draw();
}

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
  if (!scan.scene) element("scene-text").textContent = `No scenes of points: ${scan.noScene}.`;
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
window.scanPage = { ready: null, kernels: null, view, walk, timings, scan, pointAt(point) {
  const { left, top } = element("marks").getBoundingClientRect(), [x, y] = view.place(point);
  return [left + x, top + y];
} };

window.scanPage.ready = (async () => {
  const begun = performance.now();
  await readScan();
  window.scanPage.kernels = openKernels();  // the diagram does not wait for them
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
