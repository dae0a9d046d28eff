// What can stand across or up: axes of the scan and its other numbers, in coordinates in which they are even.

const scaleOf = Object.create(null);  // by name: {name, marked, unit, text, even: Float64Array, low, high, log, words, factor, axis}

function readScales() {
  scan.axes.forEach((axis, index) => {
    const log = axis.scale === "log", even = evenValues(scan.column[axis.key].data, log, axis.sign);
    const ends = evenValues([axis.low, axis.high], log, axis.sign);
    const name = axis.key, [low, high] = ends;
    scaleOf[name] = { ...axis, name, text: name, even, low, high, log, axis: index };
  });
  for (const column of scan.columns)
    if (column.norm) {
      const even = evenValues(column.data, column.log, 1);
      scan.outcome.forEach((code, point) => { if (!means(column, code)) even[point] = NaN; });
      const [low, high] = extremes(even);
      scaleOf[column.name] = { ...column, text: column.label, even, low, high, factor: 1, sign: 1, axis: -1 };
    }
}

const isCapture = code => code < 2;  // contact, pursuit
const means = (column, code) => !column.of || column.of.includes(code);

/** The sign is that of a logarithmic axis, all of whose numbers have it. */
function evenValues(values, log, sign) {
  return Float64Array.from(values, log ? value => sign * Math.log10(sign * value) : undefined);
}

function extremes(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low < high ? [low, high] : Number.isFinite(low) ? [low - 0.5, high + 0.5] : [0, 1];
}

/** Ends of a view of the whole: what cells of a grid need, or a little room. */
function wholeOf(scale) {
  if (scale.words) return [scale.low, scale.high];
  const edges = scan.design === "grid" && scale.axis >= 0 ? gridOf(scale).edges : null;
  if (edges) return [edges[0], edges[edges.length - 1]];
  const room = (scale.high - scale.low) * (scan.cells && scale.axis >= 0 ? 0 : 0.02);
  return [scale.low - room, scale.high + room];
}

/** {number: which of its places each point has, edges: half-way between them} of an axis of a grid. */
function gridOf(scale) {
  if (scale.grid) return scale.grid;
  const sorted = Float64Array.from(scale.even).sort(), places = [];
  const apart = 1e-9 * (sorted[sorted.length - 1] - sorted[0] || 1);  // what differs by less is the same place
  for (const value of sorted) if (!places.length || value - places[places.length - 1] > apart) places.push(value);
  const edges = places.slice(1).map((place, index) => (place + places[index]) / 2), last = places.length - 1;
  edges.unshift(last ? 2 * places[0] - edges[0] : places[0] - 0.5);
  edges.push(last ? 2 * places[last] - edges[edges.length - 1] : places[0] + 0.5);
  const number = Uint32Array.from(scale.even, value => lowerBound(places, value - apart));
  return scale.grid = { places, edges, number };
}

/** The first index whose value is not below. */
function lowerBound(values, wanted) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < wanted) low = middle + 1; else high = middle;
  }
  return low;
}

/** What stands at an even coordinate, as the reader sees it. */
function read(scale, even) {
  if (scale.words) return scale.words[Math.round(even)] ?? "";
  return shown((scale.log ? scale.sign * 10 ** (scale.sign * even) : even) * scale.factor);
}

/** [{at, text}] */
function ticks(scale, low, high, wanted) {
  if (scale.words)
    return scale.words.map((text, at) => ({ at, text })).filter(one => one.at >= low && one.at <= high);
  if (scale.log && scale.sign < 0) return decades(-high, -low, wanted)
    .map(({ at, text }) => ({ at: -at, text: text && "−" + text }));
  if (scale.log) return decades(low, high, wanted);
  return roundNumbers(low * scale.factor, high * scale.factor, wanted).map(value =>
    ({ at: value / scale.factor, text: shown(value, 6) }));
}

function nameOf(scale) {
  const unit = scale.unit.length ? [" ", node("span", { class: "sub" }, "(", ...marked(scale.unit), ")")] : [];
  return [...marked(scale.marked), ...unit];
}
