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
