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
