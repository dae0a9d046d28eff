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
