// The encounter: where the rods go, how it ends, and where they are at a time.

class Paths {
  constructor(place, store, api) {
    this.store = store;
    this.api = api;
    this.stage = new Stage(place, store, true);
  }
  solve() {
    const began = performance.now();
    try {
      this.run = this.api.simulate(problemOf(this.store.state));
      this.trouble = "";
    } catch (error) {
      const rods = problemOf(this.store.state).rods;
      this.trouble = error.message;
      this.run = { outcome: "undecided", time: 0, min_separation: 0, reason: error.message, turn: [0, 0], path: [[0, ...rods.flat()]],
                   turning: [[0, 0]] };
    }
    this.milliseconds = performance.now() - began;
    this.stage.stale = true;
  }
  get time() { return Math.min(this.store.state.time, this.run.time); }
  poses() { return posesAt(this.run, this.time); }

  /** The path of a rod in pixels, up to a time, bent lines cut fine enough for the eye. */
  trace(rod, until) {
    const { path } = this.run, points = [];
    for (let row = 0; row < path.length; ++row) {
      const here = path[row], next = path[row + 1], at = here.slice(1 + 3 * rod, 4 + 3 * rod);
      points.push(this.stage.toPixel(at[0], at[1]));
      if (!next || here[0] >= until) break;
      const bend = Math.abs(next[3 + 3 * rod] - at[2]), parts = Math.min(12, 1 + Math.ceil(bend / 0.1));
      for (let k = 1; k < parts; ++k) {
        const time = here[0] + ((next[0] - here[0]) * k) / parts;
        if (time > until) break;
        const [x, y] = posesAt(this.run, time)[rod];
        points.push(this.stage.toPixel(x, y));
      }
      if (next[0] > until) {
        const [x, y] = posesAt(this.run, until)[rod];
        points.push(this.stage.toPixel(x, y));
        break;
      }
    }
    return points;
  }
  line(points, colour, width, strength, dash = []) {
    const { pen } = this.stage;
    pen.save();
    pen.globalAlpha = strength;
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.lineJoin = pen.lineCap = "round";
    pen.setLineDash(dash);
    pen.beginPath();
    points.forEach(([x, y], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.stroke();
    pen.restore();
  }
  draw() {
    const { stage, run } = this, { state } = this.store, { pen } = stage;
    stage.clear(ink.sheet);
    stage.drawGrid();
    for (const rod of [1, 0]) {
      this.line(this.trace(rod, Infinity), ink.rods[rod], 2, this.time > 0 ? 0.35 : 0.85);
      if (this.time > 0) this.line(this.trace(rod, this.time), ink.rods[rod], 3, 1);
    }
    this.drawTicks();
    if (run.outcome === "contact") {
      const [a, b] = posesAt(run, run.time), [x, y] = stage.toPixel((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
      pen.strokeStyle = ink.ink;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.arc(x, y, Math.max(9, 0.5 * state.contact_distance * stage.scale), 0, 2 * Math.PI);
      pen.stroke();
    }
    const starts = problemOf(state).rods;
    starts.forEach((pose, rod) => {
      stage.drawAim(pose, rod);
      stage.drawRod(pose, rod, this.time > 0 ? 0.45 : 1);
    });
    if (this.time > 0) this.poses().forEach((pose, rod) => stage.drawRod(pose, rod));
    stage.placeHandles(starts, true);
  }
  /** Dots at even times, so that speed and order can be seen. */
  drawTicks() {
    const { stage, run } = this, step = niceStep(Math.max(run.time, 1e-9) / 8);
    for (let k = 1; k * step < run.time; ++k)
      posesAt(run, k * step).forEach(([x, y], rod) => {
        const [px, py] = stage.toPixel(x, y);
        stage.pen.fillStyle = ink.rods[rod];
        stage.pen.beginPath();
        stage.pen.arc(px, py, 3, 0, 2 * Math.PI);
        stage.pen.fill();
      });
    this.tick = step;
  }
  /** A view of all that happens, or of its first part where rods go far, and of the wakes at the start: ten screening lengths
   *  behind the rods, but no longer than the paths, which would be small beside them. */
  whole({ path } = this.run, { alpha } = this.store.state) {
    const reach = 40, low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    const include = place => place.forEach((at, k) => { low[k] = Math.min(low[k], at); high[k] = Math.max(high[k], at); });
    const [x0, y0] = [(path[0][1] + path[0][4]) / 2, (path[0][2] + path[0][5]) / 2];
    for (const row of path)
      for (const [x, y] of [[row[1], row[2]], [row[4], row[5]]]) if (row === path[0] || Math.hypot(x - x0, y - y0) < reach) include([x, y]);
    const tail = Math.min(10 / alpha, Math.max(high[0] - low[0], high[1] - low[1]));
    for (const k of [1, 4]) include([path[0][k] - tail * Math.cos(path[0][k + 2]), path[0][k + 1] - tail * Math.sin(path[0][k + 2])]);
    const wide = Number((1.35 * Math.max(high[0] - low[0], high[1] - low[1], 6)).toPrecision(4));
    const short = value => Number(value.toPrecision(5));
    return { wide, left: short((low[0] + high[0] - wide) / 2), top: short((low[1] + high[1] + wide) / 2) };
  }
  /** How it ends, in words. */
  words() {
    const { run } = this;
    if (this.trouble) return this.trouble;
    return run.reason.charAt(0).toUpperCase() + run.reason.slice(1).replace("t_end", "T") + ".";
  }
  /** Whether a run a hundred times tighter ends alike, in words. */
  check() {
    if (this.trouble) return "";
    let end;
    try {
      end = this.api.simulate({ ...problemOf(this.store.state), rtol: 1e-10 }).outcome;
    } catch (error) {
      end = error.message;
    }
    return end === this.run.outcome ? "Checked: a run a hundred times tighter ends alike." : `Open: a run a hundred times tighter: ${end}.`;
  }
  turns() {
    const [a, b] = this.run.turn.map(turn => Math.abs(turn)), degrees = turn => `${Math.round(Math.abs(turn) / DEGREE)}°`;
    const both = `Rod 0 turned by ${degrees(this.run.turn[0])}, rod 1 by ${degrees(this.run.turn[1])}`;
    const more = Math.max(a, b), less = Math.min(a, b);
    if (more < 0.5 * DEGREE) return "Neither rod turned.";
    if (less > 0.8 * more) return `${both}: both alike.`;
    return `${both}: ${a > b ? "rod 0" : "rod 1"} reacts${less < 0.05 * more ? ", the other hardly at all" : " more"}.`;
  }
}
