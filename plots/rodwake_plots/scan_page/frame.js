// What is drawn around and over the pixels: ticks, boundaries, failed points, marks.

const MARGIN = { left: 50, right: 14, top: 8, bottom: 30 };  // CSS pixels
const FONT = '12px system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif';

/** A canvas of this size in CSS pixels, its context scaled to them. */
function prepared(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = width + "px";
  canvas.style.height = height + "px";
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

function drawTicks(context, view) {
  const { left, top, width, height } = view.box;
  context.font = FONT;
  context.fillStyle = context.strokeStyle = css("--ink");
  context.lineWidth = 1;
  context.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const { at, text } of ticks(view.across, view.low[0], view.high[0], Math.max(3, width / 90))) {
    const x = Math.round(left + view.share(0, at) * width) + 0.5;
    mark(context, x, top + height, x, top + height + (text ? 5 : 3));
    context.fillText(text, x, top + height + 8);
  }
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const { at, text } of ticks(view.up, view.low[1], view.high[1], Math.max(3, height / 60))) {
    const y = Math.round(top + (1 - view.share(1, at)) * height) + 0.5;
    mark(context, left, y, left - (text ? 5 : 3), y);
    context.fillText(text, left - 8, y);
  }
}

function mark(context, ...ends) {
  context.beginPath();
  context.moveTo(ends[0], ends[1]);
  context.lineTo(ends[2], ends[3]);
  context.stroke();
}

/** Whatever `draw` draws stays inside the frame. */
function clipped(context, view, draw) {
  const { left, top, width, height } = view.box;
  context.save();
  context.beginPath();
  context.rect(left, top, width, height);
  context.clip();
  draw();
  context.restore();
}

function drawBoundary(context, view) {
  const { across, up } = view;
  if (!scan.boundary || across.axis < 0 || up.axis < 0 || across.axis === up.axis) return;
  const path = new Path2D(), places = scan.boundary.places;
  let start = 0;
  for (const end of scan.boundary.ends) {
    for (let row = start; row < end; ++row) {
      const [x, y] = view.css(places[2 * row + across.axis], places[2 * row + up.axis]);
      if (row === start) path.moveTo(x, y); else path.lineTo(x, y);
    }
    start = end;
  }
  context.lineJoin = "round";
  if (paint.number) strokeWith(context, path, "#ffffffb0", 2.6);
  strokeWith(context, path, "#1a1a1a", 1.1);
}

function strokeWith(context, path, colour, width) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke(path);
}

function drawFailed(context, view) {
  const path = new Path2D();
  for (const point of view.points) {
    if (!scan.failed[point] || !view.holds(point)) continue;
    const [x, y] = view.place(point);
    for (const side of [-1, 1]) {
      path.moveTo(x - 3.5, y - 3.5 * side);
      path.lineTo(x + 3.5, y + 3.5 * side);
    }
  }
  strokeWith(context, path, css("--alarm"), 1.5);
}

/** A ring that is seen on any colour. */
function drawRing(context, [x, y], radius, width = 2) {
  const path = new Path2D();
  path.arc(x, y, radius, 0, 2 * Math.PI);
  strokeWith(context, path, "#000000b0", width + 2);
  strokeWith(context, path, "#ffffff", width);
}

/** Of the point whose trajectory is drawn, joined to the one that was clicked. */
function drawSample(context, from, to) {
  context.setLineDash([4, 3]);
  const line = new Path2D();
  line.moveTo(...from);
  line.lineTo(...to);
  strokeWith(context, line, "#000000b0", 1.4);
  context.setLineDash([]);
  const path = new Path2D();
  path.rect(to[0] - 5, to[1] - 5, 10, 10);
  strokeWith(context, path, "#000000b0", 4);
  strokeWith(context, path, "#ffffff", 2);
}

// The stored trajectory nearest to a point, drawn to scale.

const GLYPH = [[-0.5, -0.19], [0.4, -0.09], [0.5, 0], [0.4, 0.09], [-0.5, 0.19]];  // thick tail, thin nose along +x
const walk = { samples: null, sample: -1 };
const rodColour = rod => scan.rodColours[rod % scan.rodColours.length];

/** {sample, distance}: over all axes, each in parts of its length; another word of a choice is one whole axis away. */
function nearestSample(point) {
  let best = { sample: -1, distance: Infinity };
  for (let sample = 0; sample < scan.samples.count; ++sample) {
    let sum = 0;
    for (const axis of scan.axes) {
      const scale = scaleOf[axis.key], apart = scale.even[scan.samples.point[sample]] - scale.even[point];
      sum += scale.words ? (apart ? 1 : 0) : (apart / (scale.high - scale.low || 1)) ** 2;
    }
    if (sum < best.distance) best = { sample, distance: sum };
  }
  return { ...best, distance: Math.sqrt(best.distance) };
}

function describeComputed(point, outcome) {
  const differs = outcome !== scan.outcomes[scan.outcome[point]]?.name;
  return ["Computed here, of this very point. ", tag(point), differs ? ` Here it ends as ${outcome}: it lies at a boundary, or the scan was made by other options.` : ""];
}

/** Nodes that say which point's it is and how far that is from the one asked for. */
function describeSample(point, { sample, distance }) {
  const stored = scan.samples.point[sample];
  const where = scan.axes.flatMap((axis, index) => [index ? ", " : "", valueNode(scaleOf[axis.key], stored)]);
  if (stored === point) return ["Of this very point: ", ...where, ". ", tag(stored)];
  const differs = scan.outcome[stored] !== scan.outcome[point];
  return [`The nearest stored one is that of point ${grouped(stored)}: `, ...where, `, ${percent(distance)} of the axes away. `,
          tag(stored), differs ? " It ends in another way than the point you asked for." : ""];
}

/** Steps of the sample until time stands still: shorter runs are filled up, with their last state or with nan. */
function stepsOf(sample) {
  const { steps, t } = walk.samples, at = step => t[sample * steps + step];
  let count = 1;
  while (count < steps && at(count) > at(count - 1)) ++count;
  return count;
}

const poseAt = (sample, step, rod) => ["x", "y", "theta"].map(name =>
  walk.samples[name][(sample * walk.samples.steps + step) * walk.samples.rods + rod]);

/** [step, next step, how far between them] at this share of the steps. */
function between(sample, share) {
  const last = stepsOf(sample) - 1, step = Math.min(Math.floor(share * last), Math.max(last - 1, 0));
  return [step, Math.min(step + 1, last), share * last - step];
}

function poseBetween(sample, share, rod) {
  const [step, next, part] = between(sample, share);
  const from = poseAt(sample, step, rod), to = poseAt(sample, next, rod);
  return from.map((value, index) => value + part * (to[index] - value));
}

function timeAt(sample, share) {
  const { steps, t } = walk.samples, [step, next, part] = between(sample, share);
  const from = t[sample * steps + step], to = t[sample * steps + next];
  return from + part * (to - from);
}

/** {x, y: places on the canvas, low, high: ends} of a window of equal scale around all paths. */
function windowOf(sample, width, height) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let step = 0; step < stepsOf(sample); ++step)
    for (let rod = 0; rod < walk.samples.rods; ++rod)
      poseAt(sample, step, rod).slice(0, 2).forEach((value, side) => {
        low[side] = Math.min(low[side], value);
        high[side] = Math.max(high[side], value);
      });
  const room = 34, sizes = [width, height];
  const scale = Math.min(...sizes.map((size, side) => (size - 2 * room) / (high[side] - low[side] || 1)));
  const middle = low.map((value, side) => (value + high[side]) / 2);
  return { x: value => width / 2 + scale * (value - middle[0]), y: value => height / 2 - scale * (value - middle[1]),
           low: middle.map((value, side) => value - sizes[side] / 2 / scale),
           high: middle.map((value, side) => value + sizes[side] / 2 / scale) };
}

function drawWalk(sample, share) {
  const canvas = element("path"), width = canvas.parentElement.clientWidth, height = Math.round(0.92 * width);
  const context = prepared(canvas, width, height), window_ = windowOf(sample, width, height);
  drawGrid(context, window_, width, height);
  for (let rod = 0; rod < walk.samples.rods; ++rod) drawPath(context, sample, rod, window_);
  for (let rod = 0; rod < walk.samples.rods; ++rod) {
    const colour = rodColour(rod);
    drawRod(context, window_, poseAt(sample, 0, rod), css("--card"), colour);
    drawRod(context, window_, poseBetween(sample, share, rod), colour, css("--card"));
  }
}

function drawGrid(context, { x, y, low, high }, width, height) {
  context.font = FONT;
  context.fillStyle = css("--soft");
  context.strokeStyle = css("--grid");
  context.lineWidth = 1;
  context.textAlign = "center";
  context.textBaseline = "bottom";
  const wanted = Math.max(3, width / 80);
  for (const value of roundNumbers(low[0], high[0], wanted)) {
    mark(context, Math.round(x(value)) + 0.5, 0, Math.round(x(value)) + 0.5, height - 16);
    if (x(value) > 20 && x(value) < width - 12) context.fillText(shown(value, 4), x(value), height);
  }
  context.textAlign = "left";
  context.textBaseline = "bottom";
  for (const value of roundNumbers(low[1], high[1], wanted)) {
    mark(context, 0, Math.round(y(value)) + 0.5, width, Math.round(y(value)) + 0.5);
    if (y(value) > 14 && y(value) < height - 30) context.fillText(shown(value, 4), 2, y(value) - 1);
  }
}

function drawPath(context, sample, rod, { x, y }) {
  const path = new Path2D();
  for (let step = 0; step < stepsOf(sample); ++step) {
    const [px, py] = poseAt(sample, step, rod);
    if (step) path.lineTo(x(px), y(py)); else path.moveTo(x(px), y(py));
  }
  context.lineJoin = context.lineCap = "round";
  strokeWith(context, path, rodColour(rod), 2);
}

function drawRod(context, { x, y }, [px, py, theta], fill, edge) {
  const length = 22, [cos, sin] = [Math.cos(theta), Math.sin(theta)], path = new Path2D();
  for (const [along, aside] of GLYPH)
    path.lineTo(x(px) + length * (along * cos - aside * sin), y(py) - length * (along * sin + aside * cos));
  path.closePath();
  context.fillStyle = fill;
  context.fill(path);
  strokeWith(context, path, edge, 1.4);
}
