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
