// A selection of points.

function select(points) {
  view.selection = points && points.length ? points : null;
  if (!view.selection) view.rectangle = null;
  const count = view.selection ? view.selection.length : 0;
  const points_ = `${grouped(count)} point${count > 1 ? "s" : ""}`;
  element("selected").textContent = count ? `${points_} selected` : "Nothing selected";
  element("csv").disabled = element("clear").disabled = !count;
  element("zoom-selection").disabled = !view.rectangle;
  say(element("selected").textContent);
  drawMarks();
}

/** Shown points between two places in even coordinates. */
function inRectangle([a, b]) {
  const low = a.map((value, side) => Math.min(value, b[side])), high = a.map((value, side) => Math.max(value, b[side]));
  view.rectangle = [low, high];
  const { across, up } = view;
  return view.points.filter(point => across.even[point] >= low[0] && across.even[point] <= high[0]
    && up.even[point] >= low[1] && up.even[point] <= high[1]);
}

function zoomToSelection() {
  if (!view.rectangle || view.rectangle[0].some((low, side) => !(low < view.rectangle[1][side]))) return;
  [view.low, view.high] = view.rectangle.map(corner => [...corner]);
  draw();
}
