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

// Colours of outcomes and of numbers, those of the figures; a colour is one 32-bit number, as ImageData has them.

const NONE = 255;  // no outcome: the point failed
const PURSUIT = 1;  // capture without a time of its own

const packColour = (red, green, blue) => (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
/** #rrggbb or #rgb */
function packHex(hex) {
  const short = hex.length === 4, two = at => hex.slice(at, at + 2);
  const signs = short ? [...hex.slice(1)].map(sign => sign + sign) : [1, 3, 5].map(two);
  return packColour(...signs.map(two => parseInt(two, 16)));
}

const paint = { byOutcome: null, nothing: 0, number: null, ofPoint: null };

const darkness = matchMedia("(prefers-color-scheme: dark)");
const nothing = () => scan.nothing[darkness.matches ? "dark" : "light"];

/** Takes up a choice of colour: "outcome" or the name of a column. */
function chooseColours(name, hidden) {
  paint.byOutcome = new Uint32Array(256);
  scan.outcomes.forEach((one, code) => { paint.byOutcome[code] = hidden.has(code) ? 0 : packHex(one.colour); });
  paint.nothing = packHex(nothing());
  paint.number = name === "outcome" ? null : numberColours(scan.column[name]);
  paint.hidden = hidden;
  paint.ofPoint = Uint32Array.from(scan.outcome, (_, point) => colourOf(point));
}

/** {places: of points on the colour map, 0 to 1; nan: no number, map: place -> colour} */
function numberColours(column) {
  const table = new Uint32Array(256), bytes = scan.maps[column.map];
  for (let index = 0; index < 256; ++index) table[index] = packColour(...bytes.subarray(3 * index, 3 * index + 3));
  const even = column.log ? Math.log10 : Number, [low, high] = column.norm.map(even);
  const places = Float64Array.from(column.data, (value, point) =>
    means(column, scan.outcome[point]) && !scan.failed[point] ? (even(value) - low) / (high - low) : NaN);
  return { places, map: place => table[Math.max(0, Math.min(255, Math.floor(256 * place)))] };
}

/** 0: not to be seen */
function colourOf(point) {
  const code = scan.outcome[point];
  if (code === NONE || paint.hidden.has(code)) return 0;
  if (!paint.number) return paint.byOutcome[code];
  const place = paint.number.places[point];
  if (Number.isNaN(place)) return code === PURSUIT ? paint.byOutcome[code] : paint.nothing;
  return paint.number.map(place);
}

const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function tag(point) {
  if (scan.failed[point]) return node("span", { class: "cross" }, `× ${cell(scan.column.status, point)}`);
  const one = scan.outcomes[scan.outcome[point]];
  if (!one) return node("span", {}, "no outcome");
  return node("span", { class: one.name === "contact" ? "tag dark" : "tag", style: `background:${one.colour}` }, one.name);
}
