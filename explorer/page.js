// The page: opens the kernels, links the three pictures, draws what has changed once a frame.

const setup = JSON.parse(find("#setup").textContent);

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** A sentence in place of the pictures. */
function giveUp(why) {
  find("#trouble").textContent = why;
  find("#trouble").hidden = false;
  find("#work").hidden = true;
}

/** Of an address with ?show=wake,phases these panels alone, for a frame in another page, and a link to the whole page. */
function showPart() {
  const asked = (new URLSearchParams(location.search).get("show") ?? "").split(","), panels = [...document.querySelectorAll(".panel")];
  if (!panels.some(({ id }) => asked.includes(id))) return;
  document.body.classList.add("part");
  for (const panel of panels) panel.hidden = !asked.includes(panel.id);
  for (const other of document.querySelectorAll("header, nav, .knobs, .below, footer")) other.hidden = true;
  const whole = find("#whole");
  whole.hidden = false;
  whole.addEventListener("click", () => { whole.href = location.pathname + location.hash; });
}

class Explorer {
  constructor(api) {
    const start = { ...START, ...(setup.state ?? {}) };
    this.store = new Store(fromAddress(location.hash.slice(1), start));
    this.start = start;
    this.paths = new Paths(find("#paths-stage"), this.store, api);
    this.paths.solve();
    this.wake = new WakePicture(find("#wake-stage"), this.store, api, this.paths);
    this.diagram = new Diagram(find("#diagram-stage"), this.store, api);
    this.diagramKey = this.diagram.key();
    this.controls = buildControls(this.store, state => this.paths.whole(api.simulate(problemOf(state)), state));
    this.controls.forEach(control => control.follow());
    this.frames = [];
    this.store.listeners.push(keys => this.onChange(keys));
    this.wireButtons();
    this.wireKeys();
    if (!/(^|[#&])(wide|left|top)=/.test(location.hash)) this.store.state = this.store.kept = { ...this.store.state, ...this.paths.whole() };
    this.showEnd();
    this.onHistory();
    this.frame = this.frame.bind(this);
    requestAnimationFrame(this.frame);
  }

  onChange(keys) {
    if (keys.has("history")) this.onHistory();
    if ([...keys].some(key => AXES.includes(key))) this.unsolved = true;
    for (const control of this.controls) if (keys.has(control.name)) control.follow();
    if ([...keys].some(key => AXES.includes(key))) this.controls.find(({ name }) => name === "presets").follow();
    this.paths.stage.stale = this.wake.stage.stale = this.diagram.stale = true;
    this.wake_up();
  }
  wake_up() {
    if (this.asleep) {
      this.asleep = false;
      requestAnimationFrame(this.frame);
    }
  }
  onHistory() {
    const { store } = this;
    find("#undo").disabled = !store.past.length;
    find("#redo").disabled = !store.future.length;
    clearTimeout(this.writing);
    this.writing = setTimeout(() => history.replaceState(null, "", `#${toAddress(store.state)}`), 150);
    find("#scene").textContent = toScene(store.state);
    this.settled = true;
    this.wake.stage.stale = true;
  }

  /** One picture of everything that changed; the diagram gets what is left of the time. */
  frame(now) {
    const began = performance.now();
    if (this.playing) this.advance(now);
    if (this.unsolved) {
      this.unsolved = false;
      this.paths.solve();
      this.showEnd();
    }
    const busy = document.body.classList.contains("dragging") || this.playing;
    if (this.diagram.key() !== this.diagramKey && (!busy || this.diagram.stride < COARSEST)) {  // a moving hand leaves time for coarse cells
      this.diagramKey = this.diagram.key();
      this.diagram.restart();
    }
    for (const picture of [this.paths, this.wake])
      if (picture.stage.stale) {
        picture.stage.stale = false;
        picture.draw();
      }
    if (this.settled && this.count) {  // the first picture comes first
      this.settled = false;
      find("#check").textContent = this.paths.check();
      find("#spoken").textContent = find("#outcome").textContent + " " + find("#turns").textContent;
    }
    this.showTime();
    this.diagram.work(busy || !this.count ? 1 : 10);
    this.count = (this.count ?? 0) + 1;
    if (this.diagram.stale && (!busy || this.count % 3 === 0)) {  // while a hand moves its own pictures come first
      this.diagram.stale = false;
      this.diagram.draw();
      this.showDiagram();
    }
    this.frames.push([now, performance.now() - began]);
    if (this.frames.length > 240) this.frames.shift();
    this.asleep = this.diagram.done && !this.diagram.stale && !this.playing && !this.unsolved;
    if (!this.asleep) requestAnimationFrame(this.frame);
  }

  showEnd() {
    const { run } = this.paths;
    const badge = find("#badge");
    badge.textContent = run.outcome;
    badge.className = run.outcome;
    find("#outcome").textContent = this.paths.words();
    find("#turns").textContent = this.paths.trouble ? "" : this.paths.turns();
    find("#check").textContent = "";
    const scrub = find("#scrub");
    scrub.max = String(Math.max(run.time, 1e-9));
    scrub.step = String(Math.max(run.time, 1e-9) / 500);
  }
  showTime() {
    const { time } = this.paths, scrub = find("#scrub");
    if (document.activeElement !== scrub || Number(scrub.value) !== time) scrub.value = String(time);
    find("#time").textContent = `t = ${time.toFixed(2)}`;
    scrub.setAttribute("aria-valuetext", `time ${time.toFixed(2)} of ${numeral(this.paths.run.time)}`);
  }
  showDiagram() {
    const shares = this.diagram.shares();
    OUTCOMES.forEach((name, code) => { find(`#share-${name}`).textContent = shares[code] ? `${Math.round(100 * shares[code]) || "< 1"} %` : "–"; });
    find("#diagram-state").textContent = this.diagram.done ? "" : "refining…";
  }
  showColour() {
    const kind = COLOURINGS[this.store.state.colour], bar = find("#bar"), ticks = find("#bar-ticks");
    bar.parentElement.hidden = !kind;
    if (!kind) return;
    const colours = ramp(kind.ramp().map(name => ink[name]));
    bar.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(colours.buffer), 256), 0, 0);
    ticks.replaceChildren(...kind.ticks.map(([value, text]) => make("span", { style: `left: ${100 * kind.place(value)}%` }, text)));
    find("#bar-name").textContent = kind.name;
  }

  play(on) {
    this.playing = on;
    document.body.classList.toggle("playing", on);
    find("#play").textContent = on ? "Pause" : "Play";
    this.last = null;
    if (on && this.paths.time >= this.paths.run.time) this.store.change({ time: 0 }, false);
    if (!on) this.wake.stage.stale = true;
    this.wake_up();
  }
  /** The whole run in eight seconds. */
  advance(now) {
    const end = this.paths.run.time, step = this.last === null ? 0 : ((now - this.last) / 8000) * end;
    this.last = now;
    const time = Math.min(this.paths.time + step, end);
    this.store.change({ time }, false);
    if (time >= end) {
      this.play(false);
      this.store.settle();
    }
  }

  wireButtons() {
    const { store, paths, wake, diagram } = this, on = (selector, work) => find(selector).addEventListener("click", work);
    on("#undo", () => store.undo());
    on("#redo", () => store.redo());
    on("#reset", () => store.change({ ...this.start, ...{ time: 0 } }));
    on("#play", () => this.play(!this.playing));
    on("#fit", () => store.change(paths.whole()));
    on("#nearer", () => zoom(store, 0.8));
    on("#farther", () => zoom(store, 1.25));
    on("#swap", () => {
      const { state } = store;
      store.change({ x0: state.x1, y0: state.y1, theta0: state.theta1, x1: state.x0, y1: state.y0, theta1: state.theta0, time: 0 });
    });
    on("#copy-scene", () => this.copied("#copy-scene", toScene(store.state)));
    on("#copy-link", () => this.copied("#copy-link", location.href.split("#")[0] + "#" + toAddress(store.state)));
    on("#save-scene", () => download("encounter.toml", toScene(store.state), "application/toml"));
    on("#wake-csv", () => download("wake.csv", wakeTable(wake), "text/csv"));
    on("#wake-png", () => savePicture(wake.stage.canvas, "wake.png"));
    on("#paths-csv", () => download("rods.csv", pathTable(paths.run), "text/csv"));
    on("#paths-png", () => savePicture(paths.stage.canvas, "encounter.png"));
    on("#paths-svg", () => download("encounter.svg", pathDrawing(paths), "image/svg+xml"));
    on("#diagram-csv", () => download("diagram.csv", diagramTable(diagram), "text/csv"));
    on("#diagram-png", () => savePicture(diagram.canvas, "diagram.png"));
    find("#scrub").addEventListener("input", () => {
      this.play(false);
      store.change({ time: Number(find("#scrub").value) }, false);
    });
    find("#scrub").addEventListener("change", () => store.settle());
    find("#theme").addEventListener("change", () => this.paint());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint());
    store.listeners.push(keys => { if (keys.has("colour")) this.showColour(); });
    this.paint();
    window.addEventListener("hashchange", event => {  // the event's address: this page may have written its own meanwhile
      clearTimeout(this.writing);
      store.change(fromAddress(new URL(event.newURL).hash.slice(1), this.start));
    });
    window.addEventListener("resize", () => this.wake_up());
    new ResizeObserver(() => this.wake_up()).observe(find("#work"));
  }
  paint() {
    const theme = find("#theme").value;
    if (theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
    readColours();
    this.showColour();
    this.paths.stage.stale = this.wake.stage.stale = this.diagram.stale = true;
    this.wake_up();
  }
  async copied(selector, text) {
    const button = find(selector), before = button.dataset.text ??= button.textContent;
    await copy(text);
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = before; }, 1500);
  }
  wireKeys() {
    document.addEventListener("keydown", event => {
      const typing = event.target.matches("input[type=number], textarea, select");
      if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !typing) {
        event.preventDefault();
        if (event.shiftKey) this.store.redo();
        else this.store.undo();
      }
      if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, textarea, select, button, summary, a")) return;
      const work = { " ": () => this.play(!this.playing), "+": () => zoom(this.store, 0.8), "-": () => zoom(this.store, 1.25),
                     0: () => this.store.change(this.paths.whole()) }[event.key];
      if (!work) return;
      event.preventDefault();
      work();
    });
  }
}

window.rodwake = { ready: null, strain: null, simulate: null };
if (typeof WebAssembly !== "object") {
  window.rodwake.ready = Promise.reject(new Error("this browser has no WebAssembly"));
  window.rodwake.ready.catch(() => giveUp("This page computes with WebAssembly, which this browser does not have or does not allow. Any current Firefox, Chrome or Safari has it; without one, rodwake rods computes the same on the command line."));
} else {
  const began = performance.now();
  window.rodwake.ready = createKernel({ wasmBinary: bytesOf(find("#kernel").textContent) }).then(kernel => {
    const api = rodwakeOn(kernel);
    Object.assign(window.rodwake, { strain: api.strain, simulate: api.simulate, encounters: api.encounters, flat: api.flat });
    showPart();
    describeParameters(setup.keys);
    PARAMETERS.contact_distance.legal = { from: 0, to: 1e12 };  // 0: no stop
    readColours();
    find("#version").textContent = setup.version;
    find("#from").textContent = setup.scene ? ` It starts from the scene ${setup.scene}.` : "";
    window.rodwake.page = new Explorer(api);
    window.rodwake.opened = { from: began, after: performance.now() };
  });
  window.rodwake.ready.catch(error => giveUp(`The kernels of this page do not start here: ${error.message}`));
}
