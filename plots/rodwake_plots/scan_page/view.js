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
