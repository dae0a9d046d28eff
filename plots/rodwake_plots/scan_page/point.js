// A point: its numbers, its trajectory.

/** Marks the point and tells of it; -1: none. */
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
  element("path").hidden = element("clock").parentElement.hidden = !scan.samples;
  if (!scan.samples) {
    element("walk-told").textContent = "This scan has stored no trajectories.";
    return;
  }
  const found = nearestSample(point);
  view.sample = scan.samples.point[found.sample];
  walk.sample = found.sample;
  element("walk-told").replaceChildren(...tellSample(point, found));
  const rods = Array.from({ length: scan.samples.rods }, (_, rod) => node("span", {}, swatch(rodColour(rod)), ` rod ${rod}`));
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
