// Square pictures, and those of the plane: their view and the handles of the rods.

const make = (tag, attributes = {}, ...children) => {
  const one = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) one.addEventListener(name.slice(2), value);
    else if (value !== false && value !== null) one.setAttribute(name, value === true ? "" : value);
  }
  one.append(...children);
  return one;
};
const find = selector => document.querySelector(selector);

/** Colours of the styles, read again when they change. */
let ink = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  ink = Object.fromEntries(["paper", "card", "sheet", "ink", "soft", "line", "grid", "accent", "rod0", "rod1", "contact", "pursuit", "orbit",
    "escape", "undecided", "low", "mid", "high", "less", "zero", "more"].map(name => [name, style.getPropertyValue(`--${name}`).trim()]));
  ink.rods = [ink.rod0, ink.rod1];
}

/** A step of 1, 2 or 5 times a power of ten, near `size`. */
function niceStep(size) {
  const power = 10 ** Math.floor(Math.log10(size)), lead = size / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

/** A number for people: no rounding noise, few digits. */
const numeral = (value, digits = 4) => String(Number(value.toPrecision(digits))).replace("-", "−");

/** A square canvas that fills its place, as fine as the screen. */
class Square {
  constructor(place, store, attributes) {
    this.place = place;
    this.store = store;
    this.canvas = make("canvas", attributes);
    place.append(this.canvas);
    this.pen = this.canvas.getContext("2d");
    this.stop = () => {};
    this.fit();
    new ResizeObserver(() => this.fit()).observe(place);
  }
  fit() {
    const size = Math.max(this.place.clientWidth, 120), dense = Math.min(window.devicePixelRatio || 1, 2);
    if (this.size === size && this.dense === dense) return;
    this.size = size;
    this.dense = dense;
    this.canvas.width = this.canvas.height = Math.round(size * dense);
    this.stale = true;
  }
  clear(colour) {
    this.pen.setTransform(this.dense, 0, 0, this.dense, 0, 0);
    this.pen.fillStyle = colour;
    this.pen.fillRect(0, 0, this.size, this.size);
  }
  /** Follows a pointer until it is released or stop() is called; `each` gets its events. */
  follow(event, each) {
    event.preventDefault();
    const target = event.currentTarget, ends = ["pointerup", "pointercancel"];
    target.setPointerCapture(event.pointerId);
    target.focus?.({ preventScroll: true });
    this.stop();
    const stop = this.stop = () => {
      this.stop = () => {};
      target.removeEventListener("pointermove", each);
      for (const kind of ends) target.removeEventListener(kind, stop);
      document.body.classList.remove("dragging");
      this.store.settle();
    };
    document.body.classList.add("dragging");
    target.addEventListener("pointermove", each);
    for (const kind of ends) target.addEventListener(kind, stop);
  }
}

const TURN_REACH = 46; // pixels from a rod to the handle of its heading

class Stage extends Square {
  /** `focusable`: its handles are buttons; else a picture that repeats another one's. */
  constructor(place, store, focusable) {
    super(place, store, { "aria-hidden": "true" });
    this.handles = [0, 1].map(rod => this.handlesOf(rod, focusable));
    this.canvas.addEventListener("wheel", event => this.onWheel(event), { passive: false });
    this.canvas.addEventListener("pointerdown", event => this.onPan(event));
    for (const kind of ["touchstart", "touchmove", "touchend", "touchcancel"])
      place.addEventListener(kind, event => this.onTouch(event), { passive: false });
  }
  get scale() { return this.size / this.store.state.wide; }
  toPixel(x, y) {
    const { left, top } = this.store.state;
    return [(x - left) * this.scale, (top - y) * this.scale];
  }
  toPlane(event) {
    const box = this.canvas.getBoundingClientRect(), { left, top } = this.store.state;
    return [left + (event.clientX - box.left) / this.scale, top - (event.clientY - box.top) / this.scale];
  }

  handlesOf(rod, focusable) {
    const kind = focusable ? "button" : "div";
    const attributes = focusable ? { type: "button" } : { "aria-hidden": "true" };
    const body = make(kind, { ...attributes, class: `handle body rod${rod}`, "data-rod": rod });
    const head = make(kind, { ...attributes, class: `handle head rod${rod}`, "data-rod": rod });
    body.addEventListener("pointerdown", event => this.onMove(event, rod));
    head.addEventListener("pointerdown", event => this.onTurn(event, rod));
    if (focusable) {
      body.addEventListener("keydown", event => this.onMoveKey(event, rod));
      head.addEventListener("keydown", event => this.onTurnKey(event, rod));
    }
    this.place.append(body, head);
    return { body, head };
  }
  placeHandles(poses, shown) {
    poses.forEach(([x, y, theta], rod) => {
      const { body, head } = this.handles[rod], [px, py] = this.toPixel(x, y);
      const at = [[body, px, py], [head, px + TURN_REACH * Math.cos(theta), py - TURN_REACH * Math.sin(theta)]];
      for (const [handle, hx, hy] of at) {
        handle.hidden = !shown || hx < 0 || hy < 0 || hx > this.size || hy > this.size;
        handle.style.transform = `translate(${hx}px, ${hy}px)`;
      }
      if (body.tagName === "BUTTON") {
        body.setAttribute("aria-label", `Rod ${rod} at x ${numeral(x, 3)}, y ${numeral(y, 3)}: arrow keys move it, with Shift in small steps`);
        head.setAttribute("aria-label", `Heading of rod ${rod}, ${Math.round(theta / DEGREE)} degrees: left and right keys turn it, with Shift in small steps`);
      }
    });
  }

  onMove(event, rod) {
    const [x, y] = this.toPlane(event), { state } = this.store;
    const off = [state[`x${rod}`] - x, state[`y${rod}`] - y];
    this.follow(event, moved => {
      const [px, py] = this.toPlane(moved), step = 1 / this.scale / 10;
      const even = value => Number((Math.round(value / step) * step).toPrecision(6));
      this.store.change({ [`x${rod}`]: even(px + off[0]), [`y${rod}`]: even(py + off[1]), time: 0 }, false);
    });
  }
  onTurn(event, rod) {
    this.follow(event, moved => {
      const [x, y] = this.toPlane(moved), { state } = this.store;
      const theta = Math.atan2(y - state[`y${rod}`], x - state[`x${rod}`]);
      this.store.change({ [`theta${rod}`]: evenAngle(theta), time: 0 }, false);
    });
  }
  onMoveKey(event, rod) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way) return;
    event.preventDefault();
    const { state } = this.store, step = niceStep(state.wide / 60) / (event.shiftKey ? 10 : 1);
    const moved = (key, by) => Number((state[key] + by * step).toPrecision(6));
    this.store.change({ [`x${rod}`]: moved(`x${rod}`, way[0]), [`y${rod}`]: moved(`y${rod}`, way[1]), time: 0 });
  }
  onTurnKey(event, rod) {
    const way = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1 }[event.key];
    if (!way) return;
    event.preventDefault();
    const theta = this.store.state[`theta${rod}`] + way * (event.shiftKey ? 0.5 : 5) * DEGREE;
    this.store.change({ [`theta${rod}`]: evenAngle(theta), time: 0 });
  }
  onPan(event) {
    const { left, top } = this.store.state, from = [event.clientX, event.clientY];
    this.follow(event, moved => this.store.change({
      left: left - (moved.clientX - from[0]) / this.scale, top: top + (moved.clientY - from[1]) / this.scale }, false));
  }
  onWheel(event) {
    event.preventDefault();
    zoom(this.store, Math.exp(event.deltaY * 0.0015), this.toPlane(event));
  }
  /** Two fingers: what is between them stays there. */
  onTouch(event) {
    const [a, b] = [...event.touches].filter(({ target }) => this.place.contains(target)), before = this.fingers;
    this.fingers = b && { clientX: (a.clientX + b.clientX) / 2, clientY: (a.clientY + b.clientY) / 2,
                          apart: Math.max(Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), 1) };
    if (this.fingers && event.cancelable) event.preventDefault();
    if (this.fingers && before) {
      const { left, top } = this.store.state, from = this.toPlane(before), to = this.toPlane(this.fingers);
      this.store.change({ left: left + from[0] - to[0], top: top + from[1] - to[1] }, false);
      zoom(this.store, before.apart / this.fingers.apart, from, false);
    } else if (this.fingers) {
      this.stop();  // what the first finger did alone
      document.body.classList.add("dragging");
    } else if (before) {
      document.body.classList.remove("dragging");
      this.store.settle();
    }
  }

  drawGrid() {
    const { pen, size } = this, { left, top, wide } = this.store.state, step = niceStep(wide / 6);
    pen.lineWidth = 1;
    pen.strokeStyle = ink.grid;
    pen.fillStyle = ink.soft;
    pen.font = "11px system-ui, sans-serif";
    pen.beginPath();
    for (let k = Math.ceil(left / step); k * step < left + wide; ++k) {
      const at = Math.round(this.toPixel(k * step, 0)[0]) + 0.5;
      pen.moveTo(at, 0);
      pen.lineTo(at, size);
      if (at > 24 && at < size - 14) pen.fillText(numeral(k * step), at + 3, size - 5);
    }
    for (let k = Math.ceil((top - wide) / step); k * step < top; ++k) {
      const at = Math.round(this.toPixel(0, k * step)[1]) + 0.5;
      pen.moveTo(0, at);
      pen.lineTo(size, at);
      if (at > 14 && at < size - 24) pen.fillText(numeral(k * step), 4, at - 3);
    }
    pen.stroke();
  }
  drawRod([x, y, theta], rod, strength = 1) {
    const { pen } = this, [px, py] = this.toPixel(x, y);
    pen.save();
    pen.translate(px, py);
    pen.rotate(-theta);
    pen.globalAlpha = strength;
    pen.beginPath();  // the thin end goes first
    pen.moveTo(-13, -7);
    pen.lineTo(11, -3.5);
    pen.arc(11, 0, 3.5, -Math.PI / 2, Math.PI / 2);
    pen.lineTo(-13, 7);
    pen.arc(-13, 0, 7, Math.PI / 2, -Math.PI / 2);
    pen.closePath();
    pen.fillStyle = ink.rods[rod];
    pen.fill();
    pen.lineWidth = 1.5;
    pen.strokeStyle = ink.sheet;
    pen.stroke();
    pen.restore();
  }
  /** The line from a rod to the handle of its heading, and its name, beside it. */
  drawAim([x, y, theta], rod) {
    const { pen } = this, [px, py] = this.toPixel(x, y);
    pen.strokeStyle = ink.rods[rod];
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(px + 16 * Math.cos(theta), py - 16 * Math.sin(theta));
    pen.lineTo(px + (TURN_REACH - 8) * Math.cos(theta), py - (TURN_REACH - 8) * Math.sin(theta));
    pen.stroke();
    const at = [`rod ${rod}`, px + 26 * Math.sin(theta), py + 4 + 17 * Math.cos(theta)];
    pen.font = "600 11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.lineWidth = 3;
    pen.strokeStyle = ink.sheet;
    pen.strokeText(...at);
    pen.fillStyle = ink.rods[rod];
    pen.fillText(...at);
    pen.textAlign = "start";
  }
}

function zoom(store, factor, about, settle = true) {
  const { left, top, wide } = store.state, next = Math.min(Math.max(wide * factor, 0.2), 2000), ratio = next / wide;
  const [x, y] = about ?? [left + wide / 2, top - wide / 2];
  const short = value => Number(value.toPrecision(6));
  store.change({ wide: short(next), left: short(x - (x - left) * ratio), top: short(y + (top - y) * ratio) }, settle);
}
