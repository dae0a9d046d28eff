// The stored trajectory nearest to a point, drawn to scale.

const GLYPH = [[-0.5, -0.19], [0.4, -0.09], [0.5, 0], [0.4, 0.09], [-0.5, 0.19]];  // thick tail, thin nose along +x
const walk = { sample: -1 };
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

/** Nodes that say which point's it is and how far that is from the one asked for. */
function tellSample(point, { sample, distance }) {
  const stored = scan.samples.point[sample];
  const where = scan.axes.flatMap((axis, index) => [index ? ", " : "", valueNode(scaleOf[axis.key], stored)]);
  if (stored === point) return ["Of this very point: ", ...where, ". ", tag(stored)];
  const differs = scan.outcome[stored] !== scan.outcome[point];
  return [`The nearest stored one is that of point ${grouped(stored)}: `, ...where, `, ${percent(distance)} of the axes away. `,
          tag(stored), differs ? " It ends in another way than the point you asked for." : ""];
}

/** Steps of the sample until time stands still: shorter runs are filled up, with their last state or with nan. */
function stepsOf(sample) {
  const { steps, t } = scan.samples, at = step => t[sample * steps + step];
  let count = 1;
  while (count < steps && at(count) > at(count - 1)) ++count;
  return count;
}

const poseAt = (sample, step, rod) => ["x", "y", "theta"].map(name =>
  scan.samples[name][(sample * scan.samples.steps + step) * scan.samples.rods + rod]);

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
  const { steps, t } = scan.samples, [step, next, part] = between(sample, share);
  const from = t[sample * steps + step], to = t[sample * steps + next];
  return from + part * (to - from);
}

/** {x, y: places on the canvas, low, high: ends} of a window of equal scale around all paths. */
function windowOf(sample, width, height) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let step = 0; step < stepsOf(sample); ++step)
    for (let rod = 0; rod < scan.samples.rods; ++rod)
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
  for (let rod = 0; rod < scan.samples.rods; ++rod) drawPath(context, sample, rod, window_);
  for (let rod = 0; rod < scan.samples.rods; ++rod) {
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
