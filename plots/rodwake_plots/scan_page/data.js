// Numbers as text.

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const element = id => document.getElementById(id);

/** 12 345 */
const grouped = count => String(count).replace(/\B(?=(\d{3})+$)/g, "\u2009");

function power(exponent) {
  return "10" + [...String(exponent)].map(sign => RAISED[sign]).join("");
}

/** With so many digits at most; a power of ten only where plain digits would be unreadable. */
function shown(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  if (+exponent >= -4 && +exponent < Math.max(digits, 6)) return signed(String(+value.toPrecision(digits)));
  return (+mantissa === 1 ? "" : signed(String(+mantissa)) + " × ") + power(+exponent);
}

const signed = text => text.replace("-", "−");
const percent = share => shown(100 * share, 2) + "\u2009%";

/** Round numbers from low to high, about so many: steps of 1, 2 or 5 times a power of ten. */
function roundNumbers(low, high, wanted) {
  const raw = (high - low) / wanted, decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(one => one * decade).find(one => one >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => (first + index) * step);
}

/** [{at: log10, text}]: decades, and 2 and 5 between few of them; the others without text. */
function decades(low, high, wanted) {
  if (high - low < 1) return roundNumbers(10 ** low, 10 ** high, wanted).filter(value => value > 0)
    .map(value => ({ at: Math.log10(value), text: shown(value, 4) }));
  const every = Math.ceil((high - low) / wanted), found = [];
  for (let decade = Math.floor(low); decade <= high; ++decade)
    for (let digit = 1; digit < 10; ++digit) {
      const at = decade + Math.log10(digit);
      const named = digit === 1 ? decade % every === 0 : high - low < 2 && (digit === 2 || digit === 5);
      const text = named ? shown(+(digit + "e" + decade), 4) : "";
      if (at >= low - 1e-9 && at <= high + 1e-9) found.push({ at, text });
    }
  return found;
}

// Nodes of the page. Text stays text, whatever it holds: nothing that comes from a file is read as markup.

function node(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Nodes of the parts of marked(): texts and [tag, parts...]. */
const marked = parts => parts.map(part => typeof part === "string" ? part : node(part[0], {}, ...marked(part.slice(1))));

const swatch = colour => node("i", { class: "swatch", style: `background:${colour}` });

/** Behind a number or a name. */
const unitOf = ({ unit }) => unit.length ? [" ", ...marked(unit)] : [];

// The arrays of the page (Box of page.py) and the columns of scan.csv.

const TYPES = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u1: Uint8Array };

async function inflated(text) {
  const packed = Uint8Array.from(atob(text), sign => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Bytes were stored by significance: put together what belongs to one number. */
function joined(bytes, array) {
  const Type = TYPES[array.type], size = Type.BYTES_PER_ELEMENT, found = new Uint8Array(bytes.length);
  for (let place = 0; place < size; ++place)
    for (let index = 0, from = place * array.count, to = place; index < array.count; ++index, ++from, to += size)
      found[to] = bytes[from];
  return new Type(found.buffer);
}

/** The array, whose text the page then forgets. */
async function unpacked(array) {
  const holder = element("array" + array.array);
  const bytes = await inflated(holder.textContent);
  holder.textContent = "";
  return joined(bytes, array);
}

/** Replaces every {array, type, count} in the content of the page by the array itself. */
async function unpackAll(content) {
  const jobs = [];
  const visit = node => {
    for (const [key, value] of Object.entries(node ?? {}))
      if (value && typeof value === "object")
        if ("array" in value) jobs.push(unpacked(value).then(array => { node[key] = array; }));
        else visit(value);
  };
  visit(content);
  await Promise.all(jobs);
  return content;
}

const scan = { points: 0 };  // the content of the page; columns by name in scan.column

async function readScan() {
  Object.assign(scan, JSON.parse(element("content").textContent));
  await unpackAll(scan);
  scan.column = Object.fromEntries(scan.columns.map(column => [column.name, column]));
  scan.outcome = scan.column.outcome.data;
  const ok = scan.column.status.words.indexOf("ok");
  scan.failed = Uint8Array.from(scan.column.status.data, code => code !== ok);
}

/** A cell of scan.csv; empty where there is nothing. */
function cell(column, point) {
  const value = column.data[point];
  if (column.words) return column.words[value] ?? "";
  return Number.isNaN(value) ? "" : String(value);
}
