// The arrays of the page (packed.py) and the columns of scan.csv.

const TYPES = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u1: Uint8Array };

async function inflated(text) {
  const packed = Uint8Array.from(atob(text), sign => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Bytes were stored by significance: put together what belongs to one number. */
function joined(bytes, told) {
  const Type = TYPES[told.type], size = Type.BYTES_PER_ELEMENT, found = new Uint8Array(bytes.length);
  for (let place = 0; place < size; ++place)
    for (let index = 0, from = place * told.count, to = place; index < told.count; ++index, ++from, to += size)
      found[to] = bytes[from];
  return new Type(found.buffer);
}

/** The array, whose text the page then forgets. */
async function unpacked(told) {
  const holder = element("array" + told.array);
  const bytes = await inflated(holder.textContent);
  holder.textContent = "";
  return joined(bytes, told);
}

/** Replaces every {array, type, count} in what the page was told by the array itself. */
async function unpackAll(told) {
  const jobs = [];
  const visit = node => {
    for (const [key, value] of Object.entries(node ?? {}))
      if (value && typeof value === "object")
        if ("array" in value) jobs.push(unpacked(value).then(array => { node[key] = array; }));
        else visit(value);
  };
  visit(told);
  await Promise.all(jobs);
  return told;
}

const scan = { points: 0 };  // what the page was told; columns by name in scan.column

async function readScan() {
  Object.assign(scan, JSON.parse(element("told").textContent));
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
