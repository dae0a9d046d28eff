// The path of a point, computed here by the program's kernels (rodwake.js of the explorer) from the point's scene.

/** Opens the kernels that the page holds; without them stored trajectories are shown. */
async function openKernels() {
  if (!scan.kernel || typeof WebAssembly === "undefined") return;
  try {
    scan.engine = rodwakeOn(await createKernel({ wasmBinary: scan.kernel }));
  } catch {
    scan.engine = null;
  }
  scan.kernel = null;
}

/** Tables of a scene as the program writes it: {medium: {eta: 1}, rods: [{position: [0, 0]}]}; of its values numbers and texts. */
function tablesOf(text) {
  const tables = { rods: [] };
  let table = {};
  for (const line of text.split("\n")) {
    const header = /^\s*\[\[?([\w.]+)\]/.exec(line), entry = /^\s*(\w+)\s*=\s*([^#]*)/.exec(line);
    if (header && header[1] === "rods") tables.rods.push(table = {});
    else if (header) table = tables[header[1]] = {};
    else if (entry) table[entry[1]] = entry[2].trim();
  }
  return tables;
}

/** What simulate() takes; null for what the kernels do not have: boxes, noise, other fields, units. */
function problemOfScene(text) {
  const { medium, coupling = {}, rods, rods_run: run, ...others } = tablesOf(text), number = value => Number(value ?? NaN);
  if (!medium || !run || others.noise || others.rods_random || medium.periodic || medium.field !== '"exact"') return null;
  const divergence = coupling.polar_basis === '"divergence"', [first, second] = [number(coupling.gamma1 ?? 0), number(coupling.gamma2 ?? 0)];
  const problem = {
    eta: number(medium.eta), alpha: medium.alpha ? number(medium.alpha) : 1 / number(medium.xi), kappa: number(coupling.kappa ?? 0),
    gamma1: divergence ? first / 2 : first, gamma2: divergence ? second + first / 2 : second, t_end: number(run.t_end),
    contact_distance: number(run.contact_distance ?? 0), rtol: number(run.rtol ?? 1e-8),
    rods: rods.map(rod => [...(rod.position ?? "").slice(1, -1).split(",").map(number), number(rod.heading ?? 0)]),
  };
  const numbers = [...Object.values(problem).filter(value => typeof value === "number"), ...problem.rods.flat()];
  return numbers.every(Number.isFinite) ? problem : null;
}

/** As scan.samples, of this point alone, in even times; null if it cannot be computed. */
function computedSamples(point) {
  if (!scan.engine || !scan.scene) return null;
  try {
    const problem = problemOfScene(sceneOf(point)), run = problem && scan.engine.simulate(problem);
    if (!run || run.path.length < 2) return null;
    const steps = 401, t = Array.from({ length: steps }, (_, step) => (run.time * step) / (steps - 1));
    const poses = t.flatMap(time => posesAt(run, time));
    return { count: 1, steps, rods: problem.rods.length, point: [point], t, outcome: run.outcome,
             x: poses.map(pose => pose[0]), y: poses.map(pose => pose[1]), theta: poses.map(pose => pose[2]) };
  } catch {
    return null;
  }
}
