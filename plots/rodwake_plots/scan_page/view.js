// What the diagram shows, and what changes that.

/** What the diagram shows. `low` and `high` are its ends in even coordinates, `all` and `points` rows of scan.csv. */
const view = {
  across: null, up: null, colour: "outcome", low: [0, 0], high: [1, 1], slices: [], hidden: new Set(), isSlice: true,
  all: null, points: null, box: null, current: -1, clicked: -1, sample: -1,
  selection: null, rectangle: null, moves: false,

  share(side, even) { return (even - this.low[side]) / (this.high[side] - this.low[side]); },
  x(even) { return this.share(0, even) * this.picture[0]; },        // pixels of the picture
  y(even) { return (1 - this.share(1, even)) * this.picture[1]; },
  css(x, y) {
    const { left, top, width, height } = this.box;
    return [left + this.share(0, x) * width, top + (1 - this.share(1, y)) * height];
  },
  place(point) { return this.css(this.across.even[point], this.up.even[point]); },
  even(x, y) {
    const parts = [(x - this.box.left) / this.box.width, 1 - (y - this.box.top) / this.box.height];
    return parts.map((part, side) => this.low[side] + part * (this.high[side] - this.low[side]));
  },
  holds(point) {
    const x = this.across.even[point], y = this.up.even[point];
    return x >= this.low[0] && x <= this.high[0] && y >= this.low[1] && y <= this.high[1];
  },
  pixels() { return [this.box.width / (this.high[0] - this.low[0]), this.box.height / (this.high[1] - this.low[1])]; },
};
function choose(id, name) {
  if (id === "colour") {
    view.colour = name;
    recolour();
    return draw();
  }
  view[id] = scaleOf[name];
  view.slices = firstSlices(view);
  view.rectangle = null;
  fillSlices(view, cut);
  refill();
  whole();
}

function cut(axis, at) {
  view.slices[axis] = at;
  refill();
  draw();
}

function toggleOutcome(code) {
  if (!view.hidden.delete(code)) view.hidden.add(code);
  refill();
  draw();
}

/** After a change of axes, slices or hidden outcomes. */
function refill() {
  const passes = passesSlices(view);
  const isFixed = index => index === view.across.axis || index === view.up.axis || view.slices[index] !== null;
  view.isSlice = scan.axes.every((_, index) => isFixed(index));
  view.all = shownPoints(view.across, view.up, passes);
  view.points = view.all.filter(point => !view.hidden.has(scan.outcome[point]));
  sortIntoBins(view.across, view.up, view.points);
  if (view.current >= 0 && !view.points.includes(view.current)) view.current = -1;
  recolour();
  element("across-name").replaceChildren(...nameOf(view.across));
  element("up-name").replaceChildren(...nameOf(view.up));
}

function recolour() {
  chooseColours(view.colour, view.hidden);
  fillLegend(view, toggleOutcome);
}

function whole() {
  [view.across, view.up].forEach((scale, side) => { [view.low[side], view.high[side]] = wholeOf(scale); });
  draw();
}

function zoom(factor, at = view.low.map((low, side) => (low + view.high[side]) / 2)) {
  const limits = [view.across, view.up].map(wholeOf);
  at.forEach((middle, side) => {
    const [low, high] = limits[side], size = Math.min((view.high[side] - view.low[side]) * factor, 1.5 * (high - low));
    if (size < 1e-7 * (high - low)) return;
    const share = (middle - view.low[side]) / (view.high[side] - view.low[side]);
    view.low[side] = middle - share * size;
    view.high[side] = view.low[side] + size;
  });
  draw();
}

function move(x, y) {
  [x / view.box.width, -y / view.box.height].forEach((share, side) => {
    const step = share * (view.high[side] - view.low[side]);
    view.low[side] -= step;
    view.high[side] -= step;
  });
  draw();
}

// The two canvases: the diagram, and what follows the pointer.

const timings = {}, MOST_RINGS = 300;  // more selected points have the rectangle alone

function draw() {
  const begun = performance.now(), width = element("stage").clientWidth;
  const height = Math.round(Math.max(260, Math.min(0.82 * width, 0.74 * Math.max(window.innerHeight, 480))));
  const { left, right, top, bottom } = MARGIN;
  view.box = { left, top, width: width - left - right, height: height - top - bottom };
  const context = prepared(element("map"), width, height), ratio = window.devicePixelRatio || 1;
  view.picture = [view.box.width, view.box.height].map(size => Math.max(1, Math.round(size * ratio)));
  const picture = new Picture(...view.picture, packHex(css("--sheet")));
  paintDiagram(picture, view);
  context.putImageData(picture.image, Math.round(view.box.left * ratio), Math.round(view.box.top * ratio));
  clipped(context, view, () => { drawBoundary(context, view); drawFailed(context, view); });
  drawTicks(context, view);
  timings.draw = performance.now() - begun;
  drawMarks();
}

/** The upper canvas: what follows the pointer. */
function drawMarks() {
  const { width, height } = element("map").getBoundingClientRect(), context = prepared(element("marks"), width, height);
  clipped(context, view, () => {
    if (view.selection && view.selection.length <= MOST_RINGS)
      for (const point of view.selection) if (view.holds(point)) drawRing(context, view.place(point), 3.5, 1);
    if (view.rectangle) drawRectangle(context);
    if (view.sample >= 0 && view.clicked >= 0) drawSample(context, view.place(view.clicked), view.place(view.sample));
    if (view.clicked >= 0) drawRing(context, view.place(view.clicked), 8, 2.5);
    if (view.current >= 0) drawRing(context, view.place(view.current), 5);
  });
}

function drawRectangle(context) {
  const [[left, top], [right, bottom]] = [view.css(...view.rectangle[0]), view.css(...view.rectangle[1])];
  context.fillStyle = "#ffffff38";
  context.fillRect(left, top, right - left, bottom - top);
  const path = new Path2D();
  path.rect(left, top, right - left, bottom - top);
  strokeWith(context, path, "#ffffff", 3);
  context.setLineDash([5, 3]);
  strokeWith(context, path, "#000000", 1.4);
  context.setLineDash([]);
}
