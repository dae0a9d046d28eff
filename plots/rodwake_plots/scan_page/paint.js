// Which point is nearest to a place of the view, among those that are shown: points are sorted into bins.

const bins = { across: null, up: null, side: 1, start: null, order: null, points: null };

/** Points that the slices and the legend let through. */
function shownPoints(across, up, passes) {
  const found = new Uint32Array(scan.points);
  let count = 0;
  for (let point = 0; point < scan.points; ++point)
    if (passes(point) && Number.isFinite(across.even[point]) && Number.isFinite(up.even[point])) found[count++] = point;
  return found.subarray(0, count);
}

function sortIntoBins(across, up, points) {
  const side = Math.max(1, Math.min(1024, Math.round(Math.sqrt(points.length / 3))));
  const start = new Uint32Array(side * side + 1), order = new Uint32Array(points.length), bin = order.slice();
  Object.assign(bins, { across, up, side, start, order, points });
  for (let index = 0; index < points.length; ++index) {
    bin[index] = binOf(across, across.even[points[index]]) + side * binOf(up, up.even[points[index]]);
    ++start[bin[index] + 1];
  }
  for (let index = 0; index < side * side; ++index) start[index + 1] += start[index];
  const next = start.slice();
  for (let index = 0; index < points.length; ++index) order[next[bin[index]]++] = points[index];
}

function binOf(scale, even) {
  const at = Math.floor(bins.side * (even - scale.low) / (scale.high - scale.low));
  return Math.max(0, Math.min(bins.side - 1, at));
}

/** The point nearest to even coordinates, distances in pixels; -1: none. `scaleX` is pixels for a unit across. */
function nearest(x, y, scaleX, scaleY) {
  const { across, up, side, start, order } = bins, column = binOf(across, x), row = binOf(up, y);
  const width = Math.min(scaleX * (across.high - across.low), scaleY * (up.high - up.low)) / side;
  let best = -1, distance = Infinity;
  const look = (i, j) => {
    if (i < 0 || j < 0 || i >= side || j >= side) return;
    for (let at = start[i + side * j]; at < start[i + side * j + 1]; ++at) {
      const point = order[at], dx = scaleX * (across.even[point] - x), dy = scaleY * (up.even[point] - y);
      if (dx * dx + dy * dy < distance) [best, distance] = [point, dx * dx + dy * dy];
    }
  };
  for (let ring = 0; ring <= side; ++ring) {
    for (let step = -ring; step <= ring; ++step) {
      look(column + step, row - ring);
      if (ring) look(column + step, row + ring);
      if (Math.abs(step) < ring) { look(column - ring, row + step); look(column + ring, row + step); }
    }
    if (best >= 0 && distance <= (ring * width) ** 2) break;  // what is farther out cannot be nearer
  }
  return best;
}

/** The next point from this one to the right (1, 0), up (0, 1) ...: within 45 degrees, nearest in pixels; -1: none. */
function neighbour(from, right, upwards, scaleX, scaleY) {
  const { across, up, points } = bins;
  let best = -1, least = Infinity;
  for (const point of points) {
    const dx = scaleX * (across.even[point] - across.even[from]), dy = scaleY * (up.even[point] - up.even[from]);
    const along = dx * right + dy * upwards, aside = Math.abs(dx * upwards) + Math.abs(dy * right);
    if (along < 1e-6 || aside > along) continue;
    const cost = along * along + 4 * aside * aside;  // straight on rather than slantwise
    if (cost < least) [best, least] = [point, cost];
  }
  return best;
}

// The diagram itself as pixels: leaves of a refinement, cells of a grid, or points.

/** Rows of 32-bit colours; rectangles and discs that reach beyond it are cut. */
class Picture {
  constructor(width, height, background) {
    this.width = width;
    this.height = height;
    this.image = new ImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.pixels.fill(background);
  }

  /** From (left, top) up to (right, bottom), which it leaves out. */
  rectangle(left, top, right, bottom, colour) {
    left = Math.max(0, left); right = Math.min(this.width, right);
    top = Math.max(0, top); bottom = Math.min(this.height, bottom);
    if (!colour || left >= right) return;
    for (let y = top; y < bottom; ++y) this.pixels.fill(colour, y * this.width + left, y * this.width + right);
  }

  disc(x, y, halves, colour) {
    const reach = halves.length - 1;
    for (let row = -reach; row <= reach; ++row) {
      const half = halves[Math.abs(row)];
      this.rectangle(x - half, y + row, x + half + 1, y + row + 1, colour);
    }
  }
}

/** Half-widths of the rows of a disc, from its middle on. */
function discRows(radius) {
  return Array.from({ length: Math.floor(radius) + 1 }, (_, row) => Math.floor(Math.sqrt(radius * radius - row * row)));
}

/** What the view shows now: leaves, grid or points. */
function wayToPaint(view) {
  const plane = view.across.axis >= 0 && view.up.axis >= 0 && view.across.axis !== view.up.axis;
  if (plane && scan.cells && sliceOfLeaves(view) !== null) return "leaves";
  return plane && scan.design === "grid" && view.isSlice ? "grid" : "points";
}

/** Of three axes the place on the one that is not shown, on the lattice; of two 0; null: all of it is shown. */
function sliceOfLeaves(view) {
  if (scan.axes.length === 2) return 0;
  const third = [0, 1, 2].find(axis => axis !== view.across.axis && axis !== view.up.axis);
  const at = view.slices[third];
  return at === undefined || at === null ? null : (at - scan.cells.origin[third]) / scan.cells.size[third];
}

function paintDiagram(picture, view) {
  ({ leaves: paintLeaves, grid: paintGrid, points: paintPoints })[wayToPaint(view)](picture, view);
}

function paintGrid(picture, view) {
  const [across, up] = [gridOf(view.across), gridOf(view.up)];
  const left = across.edges.map(edge => Math.round(view.x(edge))), top = up.edges.map(edge => Math.round(view.y(edge)));
  for (const point of view.points) {
    const i = across.number[point], j = up.number[point];
    picture.rectangle(left[i], top[j + 1], left[i + 1], top[j], paint.ofPoint[point]);
  }
}

function paintPoints(picture, view) {
  const seen = view.points.filter(point => view.holds(point));
  const radius = pointRadius(seen.length, picture), rows = discRows(radius);
  for (const point of seen) {
    const x = Math.round(view.x(view.across.even[point])), y = Math.round(view.y(view.up.even[point]));
    picture.disc(x, y, rows, paint.ofPoint[point]);
  }
}

/** So that points cover about a third of the view. */
function pointRadius(count, picture) {
  const free = Math.sqrt(picture.width * picture.height / Math.max(count, 1) / 3 / Math.PI);
  return Math.max(0.8, Math.min(5.5 * (window.devicePixelRatio || 1), free));
}

function paintLeaves(picture, view) {
  const { count, low, high } = scan.cells, axes = scan.axes.length;
  const a = view.across.axis, b = view.up.axis, at = sliceOfLeaves(view), third = 3 - a - b;
  const x = place => view.x(scan.cells.origin[a] + scan.cells.size[a] * place);
  const y = place => view.y(scan.cells.origin[b] + scan.cells.size[b] * place);
  for (let leaf = 0; leaf < count; ++leaf) {
    const from = leaf * axes;
    if (axes === 3 && !holdsSlice(low[from + third], high[from + third], at, third)) continue;
    const left = x(low[from + a]), right = x(high[from + a]), top = y(high[from + b]), bottom = y(low[from + b]);
    if (right < 0 || left > picture.width || bottom < 0 || top > picture.height) continue;
    const share = axes === 3 ? (at - low[from + third]) / (high[from + third] - low[from + third]) : 0;
    paintLeaf(picture, { left, right, top, bottom }, cornersOf(leaf, a, b, third, share), leaf);
  }
}

/** Whether the leaf is cut by the slice; at the end of the axis the last leaves are. */
function holdsSlice(low, high, at, third) {
  const last = scan.cells.top[third];
  return low <= at && (at < high || (high === last && at >= last - 1e-9));
}

/** Rows of the points at lower left, lower right, upper left, upper right, on the nearer side of the slice. */
function cornersOf(leaf, a, b, third, share) {
  const axes = scan.axes.length, base = leaf * 2 ** axes + (axes === 3 && share >= 0.5 ? 1 << third : 0);
  return [0, 1 << a, 1 << b, 1 << a | 1 << b].map(bit => scan.cells.corners[base + bit]);
}

function paintLeaf(picture, box, corners, leaf) {
  const colours = corners.map(point => point < 0 ? paint.byOutcome[scan.cells.outcome[leaf]] : paint.ofPoint[point]);
  const [left, right, top, bottom] = [box.left, box.right, box.top, box.bottom].map(Math.round);
  if (colours.every(colour => colour === colours[0]))
    return picture.rectangle(left, top, right, bottom, colours[0]);
  if (paint.number && areAlike(corners))
    return paintSmooth(picture, box, corners.map(point => paint.number.places[point]));
  const middle = Math.round((box.left + box.right) / 2), half = Math.round((box.top + box.bottom) / 2);
  picture.rectangle(left, half, middle, bottom, colours[0]);
  picture.rectangle(middle, half, right, bottom, colours[1]);
  picture.rectangle(left, top, middle, half, colours[2]);
  picture.rectangle(middle, top, right, half, colours[3]);
}

const JUMP = 0.4;  // of the colour map, as in the figures: what differs by more has jumped

/** Whether numbers may be joined over a leaf: one outcome, shown, and no jump. */
function areAlike(corners) {
  const places = corners.map(point => point < 0 ? NaN : paint.number.places[point]);
  return Math.max(...places) - Math.min(...places) <= JUMP  // not with a nan
    && corners.every(point => scan.outcome[point] === scan.outcome[corners[0]] && paint.ofPoint[point]);
}

/** Numbers between the corners. */
function paintSmooth(picture, { left, right, top, bottom }, [a, b, c, d]) {
  const firstX = Math.max(0, Math.round(left)), lastX = Math.min(picture.width, Math.round(right));
  const firstY = Math.max(0, Math.round(top)), lastY = Math.min(picture.height, Math.round(bottom));
  for (let y = firstY; y < lastY; ++y) {
    const v = (bottom - y - 0.5) / (bottom - top), from = a + (c - a) * v, to = b + (d - b) * v;
    for (let x = firstX; x < lastX; ++x)
      picture.pixels[y * picture.width + x] = paint.number.map(from + (to - from) * (x + 0.5 - left) / (right - left));
  }
}
