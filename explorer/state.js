// What the page shows: parameters with their ranges, the state, its history and its address.

const SYMBOLS = { "\\eta": "η", "\\alpha": "α", "\\kappa": "κ", "\\gamma_1": "γ₁", "\\gamma_2": "γ₂" };
const DEGREE = Math.PI / 180;

/** Scales: linear; log; both (logarithmic on both sides of zero, even below `even`). A range of its own: the keys' legal ranges are
 *  astronomically wide. */
const PARAMETERS = {
  kappa: { low: -300, high: 300, scale: "both", even: 0.3, short: "turning by strain" },
  gamma1: { low: -300, high: 300, scale: "both", even: 0.3, short: "polar turning by ∇²u" },
  gamma2: { low: -300, high: 300, scale: "both", even: 0.3, short: "polar turning by ∇∇·u" },
  alpha: { low: 0.01, high: 10, scale: "log", short: "screening, (f/μ)/ξ" },
  eta: { low: 0.01, high: 100, scale: "log", short: "stiffness ratio, K/μ" },
  t_end: { low: 1, high: 1000, scale: "log", short: "time followed", symbol: "T" },
  contact_distance: { low: 0.01, high: 1, scale: "log", short: "contact distance", symbol: "d" },
  x0: { low: -10, high: 10, scale: "linear", symbol: "x₀", short: "rod 0, x", unit: "f/mu" },
  y0: { low: -10, high: 10, scale: "linear", symbol: "y₀", short: "rod 0, y", unit: "f/mu" },
  theta0: { low: -Math.PI, high: Math.PI, scale: "linear", symbol: "θ₀", short: "rod 0, heading" },
  x1: { low: -10, high: 10, scale: "linear", symbol: "x₁", short: "rod 1, x", unit: "f/mu" },
  y1: { low: -10, high: 10, scale: "linear", symbol: "y₁", short: "rod 1, y", unit: "f/mu" },
  theta1: { low: -Math.PI, high: Math.PI, scale: "linear", symbol: "θ₁", short: "rod 1, heading" },
};
const SLIDERS = ["kappa", "gamma1", "gamma2", "alpha", "eta", "t_end", "contact_distance"];
const PLACES = ["x0", "y0", "theta0", "x1", "y1", "theta1"];
const AXES = [...SLIDERS, ...PLACES];

/** Names, symbols and units as the scene's keys have them. */
function describeParameters(keys) {
  for (const [name, parameter] of Object.entries(PARAMETERS)) {
    const key = keys[name] ?? {};
    parameter.name = name;
    parameter.symbol ??= SYMBOLS[key.symbol] ?? name;
    parameter.unit ??= key.unit ?? "";
    parameter.meaning = key.meaning ?? parameter.short;
    parameter.legal = key.range ?? {};
  }
}
const withUnit = parameter => parameter.symbol + (parameter.unit ? `, ${pretty(parameter.unit)}` : "");
const pretty = unit => unit.replace(/\bmu\b/g, "μ").replace("v0", "v₀");

/** A parameter's place on its scale, from 0 to 1, and back. */
function placeOf({ low, high, scale, even }, value) {
  if (scale === "log") return Math.log(value / low) / Math.log(high / low);
  if (scale === "both") return 0.5 + 0.5 * Math.asinh(value / even) / Math.asinh(high / even);
  return (value - low) / (high - low);
}
function valueAt({ low, high, scale, even }, place) {
  if (scale === "log") return low * (high / low) ** place;
  if (scale === "both") return even * Math.sinh((2 * place - 1) * Math.asinh(high / even));
  return low + (high - low) * place;
}
/** Headings are whole tenths of a degree, within half a turn. */
const evenAngle = theta => Number((Math.round(Math.atan2(Math.sin(theta), Math.cos(theta)) / DEGREE * 10) / 10 * DEGREE).toPrecision(12));
/** To three digits, as a hand on a slider means it. */
const rounded = value => Number(value.toPrecision(3));

const legal = ({ legal }, value) => Number.isFinite(value) && !(value <= legal.above) && !(value < legal.from) && !(value > legal.to);

const START = {
  eta: 1, alpha: 1, kappa: 100, gamma1: 0, gamma2: 0, t_end: 40, contact_distance: 0.1,
  x0: 0, y0: 2.5, theta0: 0, x1: 0, y1: -2.5, theta1: 0,
  across: "x1", up: "kappa", colour: "strain", lines: "axes", source: "0", time: 0, left: -8, top: 8, wide: 16,
};
const CHOICES = {
  across: AXES, up: AXES,
  colour: ["strain", "trace", "displacement", "none"],
  lines: ["axes", "laplacian", "gradient", "none"],
  source: ["0", "1", "both"],
};
const WORDS = {
  strain: "shear strain", trace: "dilation", displacement: "displacement", none: "none",
  axes: "strain axes", laplacian: "along ∇²u", gradient: "along ∇∇·u", 0: "rod 0", 1: "rod 1", both: "both rods",
};

/** The state in the address and back; what is not legal is left as it was. */
function toAddress(state) {
  return Object.keys(START).filter(key => state[key] !== START[key]).map(key => `${key}=${state[key]}`).join("&");
}
function fromAddress(text, before) {
  const state = { ...before };
  for (const [key, value] of new URLSearchParams(text)) {
    if (!Object.hasOwn(START, key)) continue;
    if (CHOICES[key]) {
      if (CHOICES[key].includes(value)) state[key] = value;
    } else if (value !== "" && legal(PARAMETERS[key] ?? { legal: {} }, Number(value))) {
      state[key] = Number(value);
    }
  }
  if (!(state.wide > 0)) state.wide = START.wide;
  return state;
}

/** What an encounter depends on, and what the kernels take. */
const problemOf = state => ({
  eta: state.eta, alpha: state.alpha, kappa: state.kappa, gamma1: state.gamma1, gamma2: state.gamma2, t_end: state.t_end,
  contact_distance: state.contact_distance, rtol: 1e-8,
  rods: [[state.x0, state.y0, state.theta0], [state.x1, state.y1, state.theta1]],
});

/** The state as a scene that `rodwake rods` runs to the same end. */
function toScene(state) {
  const number = value => (/[.e]/.test(String(value)) ? String(value) : `${value}.0`);
  const rod = index => `[[rods]]\nposition = [${number(state[`x${index}`])}, ${number(state[`y${index}`])}]\n`
    + `heading = ${number(state[`theta${index}`])}\n`;
  return `# From rodwake explore: rodwake run this.toml\nschema = 1\nunits = "reduced"\n\n`
    + `[medium]\neta = ${number(state.eta)}\nalpha = ${number(state.alpha)}\n\n`
    + `[coupling]\nkappa = ${number(state.kappa)}\ngamma1 = ${number(state.gamma1)}\ngamma2 = ${number(state.gamma2)}\n\n`
    + `${rod(0)}\n${rod(1)}\n[rods_run]\nt_end = ${number(state.t_end)}\noutput_interval = ${number(state.t_end / 200)}\n`
    + (state.contact_distance > 0 ? `contact_distance = ${number(state.contact_distance)}\n` : "");
}

/** The state with its history; listeners receive the keys that changed. */
class Store {
  constructor(state) {
    this.state = state;
    this.listeners = [];
    this.past = [];
    this.future = [];
    this.kept = state;
  }
  /** `settle`: the gesture is over, and undo goes back to before it. */
  change(patch, settle = true) {
    const keys = Object.keys(patch).filter(key => patch[key] !== this.state[key]);
    if (keys.length) {
      this.state = { ...this.state, ...patch };
      this.listeners.forEach(listener => listener(new Set(keys)));
    }
    if (settle) this.settle();
  }
  settle() {
    if (toAddress(this.kept) === toAddress(this.state)) return;
    this.past.push(this.kept);
    this.future = [];
    this.kept = this.state;
    this.listeners.forEach(listener => listener(new Set(["history"])));
  }
  go(from, to) {
    if (!from.length) return;
    to.push(this.kept);
    this.kept = from.pop();
    const patch = this.kept;
    this.state = { ...patch };
    this.listeners.forEach(listener => listener(new Set([...Object.keys(START), "history"])));
  }
  undo() { this.settle(); this.go(this.past, this.future); }
  redo() { this.go(this.future, this.past); }
}

const SIDE_BY_SIDE = { x0: 0, y0: 2.5, theta0: 0, x1: 0, y1: -2.5, theta1: 0 };
const CROSSING = { x0: 0, y0: 0, theta0: 0, y1: -5, theta1: evenAngle(Math.PI / 2) };

/** Each with what happens in a sentence; tests hold them to it. */
const PRESETS = [
  { name: "Attraction", outcome: "contact", state: { ...SIDE_BY_SIDE, kappa: 100 },
    sentence: "Side by side, each rod turns along the other's strain axes, towards the other: they meet at t = 5.9." },
  { name: "Pursuit", outcome: "pursuit", state: { ...CROSSING, kappa: 30, x1: -6, t_end: 60, across: "x1", up: "kappa" },
    sentence: "Rod 1 comes from behind, feels the wake and turns by a right angle into it; rod 0, whose wake reaches hardly ahead, walks on as if alone." },
  { name: "Weak coupling", outcome: "escape", state: { ...CROSSING, kappa: 3, x1: 3, t_end: 60, across: "x1", up: "kappa" },
    sentence: "Attraction is no capture: at κ = 3 the rods bend each other's paths by a few degrees and part." },
  { name: "Spiral", outcome: "contact", state: { ...CROSSING, kappa: 30, x1: 0, t_end: 60, across: "x1", up: "kappa" },
    sentence: "Ten times the coupling, and they circle each other for one and a half turns before they meet." },
  { name: "Screened", outcome: "undecided", state: { ...SIDE_BY_SIDE, kappa: 0.5, alpha: 10, t_end: 200, across: "y1", up: "alpha" },
    sentence: "At α = 1 this pair would meet at t = 40.6. The substrate's drag screens the strain beyond ξ = 1/α: at α = 10 the rods do not notice each other." },
  { name: "Polar couplings", outcome: "contact", state: { ...CROSSING, kappa: 0, gamma1: 10, gamma2: -10, x1: 5, t_end: 60, across: "gamma1", up: "gamma2" },
    sentence: "Rods with a front and a back follow vectors, ∇²u and ∇∇·u, instead of axes. This pair has no κ at all and meets." },
  { name: "Repulsion", outcome: "escape", state: { ...SIDE_BY_SIDE, kappa: -100 },
    sentence: "With κ < 0 a rod turns across the strain axes: the same start as in Attraction, and they part." },
  { name: "Orbit", outcome: "orbit", state: { ...CROSSING, kappa: 23.5, alpha: 0.3, x1: 0, t_end: 40, across: "x1", up: "kappa" },
    sentence: "Where the tight orbit is stable two rods end in it from many starts: 0.89 apart they circle each other for ever, once in a time of 4.05." },
];
