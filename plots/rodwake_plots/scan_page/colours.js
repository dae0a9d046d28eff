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
