// The wake: what the rods do to the medium, as colours and lines.

const GRID = { quick: 64, fine: 144 };  // points a side of the colours, while a hand moves and after

/** Middles of the cells of a view, row by row from the top. */
function middles({ left, top, wide }, count) {
  const x = new Float64Array(count * count), y = new Float64Array(count * count), cell = wide / count;
  for (let row = 0, i = 0; row < count; ++row)
    for (let column = 0; column < count; ++column, ++i) {
      x[i] = left + (column + 0.5) * cell;
      y[i] = top - (row + 0.5) * cell;
    }
  return { x, y };
}

const rgb = colour => [1, 3, 5].map(at => parseInt(colour.slice(at, at + 2), 16));
/** 256 colours through the given ones, a pixel each. */
function ramp(colours) {
  const stops = colours.map(rgb), table = new Uint8ClampedArray(256 * 4).fill(255);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2), u = at - k;
    for (let c = 0; c < 3; ++c) table[4 * i + c] = stops[k][c] * (1 - u) + stops[k + 1][c] * u;
  }
  return new Uint32Array(table.buffer);
}
/** Draws so many cells a side, `pixelOf` each, into a canvas of that size. */
function paintCells(image, count, pixelOf) {
  const pen = image.getContext("2d"), picture = new ImageData(count, count), pixels = new Uint32Array(picture.data.buffer);
  for (let i = 0; i < pixels.length; ++i) pixels[i] = pixelOf(i);
  pen.putImageData(picture, 0, 0);
}

/** What colours can show: value of a point, its place from 0 to 1, ticks of the bar. The scales never move, so that pictures compare. */
const COLOURINGS = {
  strain: {
    value: (of, i, n) => Math.hypot(0.5 * (of[i] - of[2 * n + i]), of[n + i]),
    place: value => (Math.log10(value) + 3.5) / 3, ramp: () => ["low", "mid", "high"], unit: "1",
    ticks: [[0.001, "10⁻³"], [0.01, "10⁻²"], [0.1, "10⁻¹"]], name: "shear strain: ε without its trace",
  },
  trace: {
    value: (of, i, n) => of[i] + of[2 * n + i],
    place: value => 0.5 + 0.5 * (Math.asinh(value / 0.002) / Math.asinh(0.3 / 0.002)), ramp: () => ["less", "zero", "more"], unit: "1",
    ticks: [[-0.1, "−0.1"], [-0.01, "−0.01"], [0, "0"], [0.01, "0.01"], [0.1, "0.1"]], name: "dilation, tr ε: negative where compressed",
  },
  displacement: {
    value: (of, i, n) => Math.hypot(of[7 * n + i], of[8 * n + i]),
    place: value => (Math.log10(value) + 2.2) / 2.4, ramp: () => ["low", "mid", "high"], unit: "f/μ",
    ticks: [[0.01, "0.01"], [0.1, "0.1"], [1, "1"]], name: "displacement |u|, f/μ",
  },
};

class WakePicture {
  constructor(place, store, api, paths) {
    this.store = store;
    this.api = api;
    this.paths = paths;
    this.stage = new Stage(place, store, false);
    this.image = make("canvas");
  }
  sources() {
    const poses = this.paths.poses(), { source } = this.store.state;
    return source === "both" ? poses : [poses[Number(source)]];
  }
  ask(x, y, displacement) {
    const { eta, alpha } = this.store.state;
    return this.api.wakes({ eta, alpha, rods: this.sources() }, x, y, displacement);
  }
  colour(count, quick) {
    const { state } = this.store, kind = COLOURINGS[state.colour];
    if (!kind) return;
    const { x, y } = middles(state, count), n = count * count;
    const of = this.ask(x, y, state.colour === "displacement"), table = ramp(kind.ramp().map(name => ink[name]));
    this.image.width = this.image.height = count;
    paintCells(this.image, count, i => table[Math.round(255 * Math.min(Math.max(kind.place(kind.value(of, i, n)) || 0, 0), 1))]);
    this.stage.pen.imageSmoothingEnabled = true;
    this.stage.pen.imageSmoothingQuality = quick ? "low" : "high";
    this.stage.pen.drawImage(this.image, 0, 0, this.stage.size, this.stage.size);
  }
  draw() {
    const { stage } = this, { state } = this.store;
    const began = performance.now(), first = !this.drawn;
    const quick = first || document.body.classList.contains("dragging") || document.body.classList.contains("playing");
    this.drawn = true;
    stage.stale = first;  // it is drawn finely next
    stage.clear(ink.sheet);
    try {
      this.colour(state.colour === "displacement" ? GRID.quick / (quick ? 2 : 1) : quick ? GRID.quick : GRID.fine, quick);
      if (state.colour === "none") stage.drawGrid();
      if (state.lines === "axes") this.drawAxes();
      else if (state.lines !== "none") this.drawStreams(state.lines === "laplacian" ? 3 : 5);
    } catch (error) {
      stage.drawGrid();
    }
    this.milliseconds = performance.now() - began;
    const poses = this.paths.poses(), still = this.paths.time === 0;
    poses.forEach((pose, rod) => {
      const felt = state.source === "both" || Number(state.source) === rod;
      if (still) stage.drawAim(pose, rod);
      stage.drawRod(pose, rod, felt ? 1 : 0.7);
    });
    stage.placeHandles(poses, still);
  }
  /** Along these a rod with kappa > 0 turns. */
  drawAxes() {
    const { stage } = this, count = Math.round(stage.size / 26), { x, y } = middles(this.store.state, count), n = count * count;
    const of = this.ask(x, y, false), { pen } = stage, levels = Array.from({ length: 9 }, () => new Path2D());
    for (let i = 0; i < n; ++i) {
      const half = 0.5 * (of[i] - of[2 * n + i]), value = Math.hypot(half, of[n + i]);
      const strength = Math.min(Math.max((Math.log10(value) + 4.2) / 2.4, 0), 1);
      if (!(strength > 0.02)) continue;
      const angle = 0.5 * Math.atan2(of[n + i], half), [px, py] = stage.toPixel(x[i], y[i]);
      const dx = 9 * Math.cos(angle), dy = -9 * Math.sin(angle);
      const level = levels[Math.round(8 * strength)];
      level.moveTo(px - dx, py - dy);
      level.lineTo(px + dx, py + dy);
    }
    pen.strokeStyle = ink.ink;
    pen.lineWidth = 1.4;
    levels.forEach((level, index) => {
      pen.globalAlpha = 0.15 + (0.65 * index) / 8;
      pen.stroke(level);
    });
    pen.globalAlpha = 1;
  }
  /** Streamlines of the vector in these columns, kept apart by a grid of cells. */
  drawStreams(column) {
    const { stage } = this, count = 56, { x, y } = middles(this.store.state, count), n = count * count;
    const of = this.ask(x, y, false), cells = 26, owner = new Int16Array(cells * cells).fill(-1);
    const sample = (px, py) => {
      const fx = Math.min(Math.max(px * count - 0.5, 0), count - 1.001), fy = Math.min(Math.max(py * count - 0.5, 0), count - 1.001);
      const i = Math.floor(fy) * count + Math.floor(fx), u = fx - Math.floor(fx), v = fy - Math.floor(fy);
      const of2 = at => (1 - v) * ((1 - u) * of[at + i] + u * of[at + i + 1]) + v * ((1 - u) * of[at + i + count] + u * of[at + i + count + 1]);
      const vx = of2(column * n), vy = of2((column + 1) * n), size = Math.hypot(vx, vy);
      return size > 1e-9 ? [vx / size, -vy / size] : null;
    };
    const { pen } = stage;
    pen.strokeStyle = pen.fillStyle = ink.ink;
    pen.lineWidth = 1.2;
    pen.globalAlpha = 0.7;
    let line = 0;
    for (let seed = 0; seed < cells * cells; seed += 1) {
      const cell = (seed * 193) % (cells * cells);  // 193 and 676 have no common factor: every cell once
      if (owner[cell] >= 0) continue;
      const start = [((cell % cells) + 0.5) / cells, (Math.floor(cell / cells) + 0.5) / cells];
      const ways = [-1, 1].map(way => this.walk(start, way, sample, owner, cells, line));
      const points = [...ways[0].reverse(), start, ...ways[1]];
      line += 1;
      if (points.length > 14) this.drawStream(points);
    }
    pen.globalAlpha = 1;
  }
  walk([x, y], way, sample, owner, cells, line) {
    const points = [], step = 0.008;
    for (let k = 0; k < 90; ++k) {
      const v = sample(x, y), m = v && sample(x + 0.5 * way * step * v[0], y + 0.5 * way * step * v[1]);
      if (!m) break;
      x += way * step * m[0];
      y += way * step * m[1];
      if (!(x > 0 && y > 0 && x < 1 && y < 1)) break;
      const cell = Math.floor(y * cells) * cells + Math.floor(x * cells);
      if (owner[cell] >= 0 && owner[cell] !== line) break;
      owner[cell] = line;
      points.push([x, y]);
    }
    return points;
  }
  drawStream(points) {
    const { pen, size } = this.stage, middle = Math.floor(points.length / 2);
    pen.beginPath();
    points.forEach(([x, y], index) => (index ? pen.lineTo(x * size, y * size) : pen.moveTo(x * size, y * size)));
    pen.stroke();
    const [a, b] = [points[middle - 1], points[middle]], angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
    pen.beginPath();
    for (const [along, across] of [[4, 0], [-3, 3], [-3, -3]])
      pen.lineTo(b[0] * size + along * Math.cos(angle) - across * Math.sin(angle), b[1] * size + along * Math.sin(angle) + across * Math.cos(angle));
    pen.fill();
  }
}
