// The phase diagram: how encounters end over two parameters. Coarse cells first, then finer ones; between cells that end alike only
// their middles are looked at until everything else is done.

const CELLS = 128, COARSEST = 16, BATCH = 12, MARGIN = { left: 46, right: 10, top: 10, bottom: 40 };

class Diagram extends Square {
  constructor(place, store, api) {
    super(place, store, { tabindex: "0", role: "application", "aria-label": "Phase diagram: arrow keys move the encounter over it",
                          "aria-describedby": "diagram-tip" });
    this.api = api;
    this.image = make("canvas", { width: CELLS, height: CELLS });
    this.shown = new Int8Array(CELLS * CELLS).fill(-1);
    this.restart();
    this.canvas.addEventListener("pointerdown", event => this.onPick(event));
    this.canvas.addEventListener("pointermove", event => this.onHover(event));
    this.canvas.addEventListener("pointerleave", () => this.describe(null));
    this.canvas.addEventListener("keydown", event => this.onKey(event));
  }
  get axes() { return [PARAMETERS[this.store.state.across], PARAMETERS[this.store.state.up]]; }
  /** What the cells depend on: all but what stands on the axes. */
  key() {
    const { state } = this.store;
    return AXES.map(name => (name === state.across || name === state.up ? name : state[name])).join();
  }

  restart() {
    this.known = new Uint8Array(CELLS * CELLS);
    this.stride = COARSEST;
    this.list = this.cellsOf(COARSEST);
    this.counted = this.spent = 0;
    this.stale = true;
  }
  get done() { return this.stride === 0; }
  /** Cells of a stride that are not known yet; of the fine ones only those whose surroundings differ. */
  cellsOf(stride) {
    const cells = [];
    for (let row = 0; row < CELLS; row += stride)
      for (let column = 0; column < CELLS; column += stride)
        if (!this.known[row * CELLS + column] && (stride >= COARSEST / 4 || this.differs(row, column, 2 * stride)))
          cells.push(row * CELLS + column);
    return cells;
  }
  differs(row, column, reach) {
    const here = this.shown[row * CELLS + column];
    for (const [up, across] of [[-1, 0], [1, 0], [0, -1], [0, 1], [1, 1], [-1, -1], [1, -1], [-1, 1]]) {
      const r = row + up * reach, c = column + across * reach;
      if (r >= 0 && c >= 0 && r < CELLS && c < CELLS && this.shown[r * CELLS + c] !== here) return true;
    }
    return false;
  }
  numbersAt(across, up) {
    const { state } = this.store, [x, y] = this.axes;
    const problem = problemOf({ ...state, [y.name]: valueAt(y, up), [x.name]: valueAt(x, across) });
    return this.api.flat(problem, problem.rods);
  }
  /** Works for so many milliseconds. */
  work(budget) {
    const end = performance.now() + budget;
    while (!this.done && performance.now() < end) {
      if (!this.list.length) {
        this.stride = this.stride > 1 ? this.stride / 2 : 0;
        this.list = this.done ? [] : this.cellsOf(this.stride);
        this.stale = true;
        continue;
      }
      const cells = this.list.splice(0, BATCH), numbers = [];
      for (const cell of cells)
        numbers.push(...this.numbersAt(((cell % CELLS) + 0.5) / CELLS, (Math.floor(cell / CELLS) + 0.5) / CELLS));
      const began = performance.now(), ends = this.api.encounters(numbers, 1e-6);
      this.spent += performance.now() - began;
      this.counted += cells.length;
      cells.forEach((cell, index) => this.put(cell, ends[5 * index]));
      this.stale = true;
    }
  }
  put(cell, code) {
    const row = Math.floor(cell / CELLS), column = cell % CELLS;
    this.known[cell] = 1;
    for (let r = row; r < Math.min(row + this.stride, CELLS); ++r)
      for (let c = column; c < Math.min(column + this.stride, CELLS); ++c)
        if (!this.known[r * CELLS + c] || r * CELLS + c === cell) this.shown[r * CELLS + c] = code;
  }
  shares() {
    const counts = OUTCOMES.map(() => 0);
    for (const code of this.shown) if (code >= 0) ++counts[code];
    return counts.map(count => count / (CELLS * CELLS));
  }

  get inner() { return this.size - MARGIN.left - MARGIN.right; }
  get height() { return this.size - MARGIN.top - MARGIN.bottom; }
  toPixel(across, up) { return [MARGIN.left + across * this.inner, MARGIN.top + (1 - up) * this.height]; }
  toPlaces(event) {
    const box = this.canvas.getBoundingClientRect(), clamp = place => Math.min(Math.max(place, 0), 1);
    return [clamp((event.clientX - box.left - MARGIN.left) / this.inner), clamp(1 - (event.clientY - box.top - MARGIN.top) / this.height)];
  }
  draw() {
    const { pen } = this;
    this.clear(ink.card);
    const colours = new Uint32Array(Uint8Array.from(OUTCOMES.flatMap(name => [...rgb(ink[name]), 255])).buffer);
    paintCells(this.image, CELLS, i => colours[this.shown[i + (CELLS - 1 - 2 * Math.floor(i / CELLS)) * CELLS]] ?? 0);  // the last row on top
    pen.imageSmoothingEnabled = false;
    pen.drawImage(this.image, MARGIN.left, MARGIN.top, this.inner, this.height);
    this.drawAxes();
    this.drawMark();
  }
  ticksOf(parameter) {
    const { name, low, high, scale } = parameter;
    if (name.startsWith("theta")) return [-180, -90, 0, 90, 180].map(angle => [angle * DEGREE, `${angle}°`.replace("-", "−")]);
    let values = [];
    if (scale === "linear") for (let k = Math.ceil(low / 5); k * 5 <= high; ++k) values.push(k * 5);
    else if (scale === "log") values = [0.01, 0.1, 1, 10, 100, 1000].filter(value => value >= low && value <= high);
    else values = [-100, -10, -1, 0, 1, 10, 100];
    return values.map(value => [value, numeral(value)]);
  }
  drawAxes() {
    const { pen } = this, [across, up] = this.axes;
    pen.strokeStyle = ink.soft;
    pen.fillStyle = ink.soft;
    pen.lineWidth = 1;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.beginPath();
    for (const [value, text] of this.ticksOf(across)) {
      const [x, y] = this.toPixel(placeOf(across, value), 0);
      pen.moveTo(x, y);
      pen.lineTo(x, y + 4);
      pen.fillText(text, x, y + 15);
    }
    pen.textAlign = "right";
    for (const [value, text] of this.ticksOf(up)) {
      const [x, y] = this.toPixel(0, placeOf(up, value));
      pen.moveTo(x, y);
      pen.lineTo(x - 4, y);
      pen.fillText(text, x - 6, y + 4);
    }
    pen.stroke();
    pen.fillStyle = ink.ink;
    pen.font = "italic 14px Georgia, serif";
    pen.textAlign = "center";
    pen.fillText(withUnit(across), MARGIN.left + this.inner / 2, this.size - 6);
    pen.save();
    pen.translate(12, MARGIN.top + this.height / 2);
    pen.rotate(-Math.PI / 2);
    pen.fillText(withUnit(up), 0, 0);
    pen.restore();
  }
  drawMark() {
    const { pen } = this, { state } = this.store, [across, up] = this.axes;
    const places = [placeOf(across, state[across.name]), placeOf(up, state[up.name])];
    this.outside = places.some(place => !(place >= 0 && place <= 1));
    const [x, y] = this.toPixel(...places.map(place => Math.min(Math.max(place || 0, 0), 1)));
    for (const [colour, width] of [[ink.sheet, 5], [ink.ink, 2]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.globalAlpha = this.outside ? 0.5 : 1;
      pen.beginPath();
      pen.arc(x, y, 7, 0, 2 * Math.PI);
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        pen.moveTo(x + 7 * dx, y + 7 * dy);
        pen.lineTo(x + 13 * dx, y + 13 * dy);
      }
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }

  choose([across, up], settle) {
    const [x, y] = this.axes;
    this.store.change({ [y.name]: rounded(valueAt(y, up)), [x.name]: rounded(valueAt(x, across)), time: 0 }, settle);
  }
  onPick(event) {
    this.choose(this.toPlaces(event), false);
    this.follow(event, moved => this.choose(this.toPlaces(moved), false));
  }
  onKey(event) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way) return;
    event.preventDefault();
    const { state } = this.store, step = event.shiftKey ? 0.002 : 0.02;
    const places = this.axes.map((axis, k) => Math.min(Math.max(placeOf(axis, state[axis.name]) + way[k] * step, 0), 1));
    this.choose(places, true);
  }
  onHover(event) {
    const places = this.toPlaces(event), [x, y] = this.axes;
    const [code, time, closest] = this.api.encounters(this.numbersAt(...places), 1e-8);
    const number = (axis, value) => (axis.name.startsWith("theta") ? `${numeral(value / DEGREE, 3)}°` : numeral(rounded(value)));
    const value = (axis, place) => `${axis.symbol} = ${number(axis, valueAt(axis, place))}`;
    this.describe(`${value(x, places[0])}, ${value(y, places[1])}: ${OUTCOMES[code]}${code === 0 ? ` at t = ${numeral(time)}` : ""}, `
              + `closest ${numeral(closest, 3)}`);
  }
  describe(text) { find("#diagram-tip").textContent = text ?? "Point at the diagram for its values; click to take an encounter from it."; }
}
