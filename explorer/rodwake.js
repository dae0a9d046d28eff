// The kernels behind window.rodwake: numbers in, numbers out. Reduced units: lengths in f/mu, times in f/(mu v0).

const OUTCOMES = ["contact", "pursuit", "escape", "undecided", "orbit"];

function numberOf(from, key, fallback) {
  const value = from[key] ?? fallback;
  if (value === undefined) throw new TypeError(`${key} is missing`);
  if (typeof value !== "number" || Number.isNaN(value)) throw new TypeError(`${key} = ${value}: must be a number`);
  return value;
}

/** Poses at a time of a run of simulate(), on the cubic through the step's ends and their rates. */
function posesAt({ path, turning }, time) {
  const last = path.length - 1, rods = turning[0].map((_, rod) => rod);
  if (time >= path[last][0] || last === 0) return rods.map(rod => path[last].slice(1 + 3 * rod, 4 + 3 * rod));
  let low = 0, high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (path[middle][0] <= time) low = middle;
    else high = middle;
  }
  const a = path[low], b = path[high], h = b[0] - a[0], u = (time - a[0]) / h, v = 1 - u;
  const between = (at, rateA, rateB) => v * v * ((1 + 2 * u) * a[at] + u * h * rateA) + u * u * ((1 + 2 * v) * b[at] - v * h * rateB);
  return rods.map(rod => {
    const i = 1 + 3 * rod, [ta, tb] = [a[i + 2], b[i + 2]];
    return [between(i, Math.cos(ta), Math.cos(tb)), between(i + 1, Math.sin(ta), Math.sin(tb)),
            between(i + 2, turning[low][rod], turning[high][rod])];
  });
}

/** What rodwake computes, on a compiled kernel (createKernel of kernel.js). */
function rodwakeOn(kernel) {
  let place = 0, size = 0;
  /** Room for so many numbers in the kernel's memory; a later call may take it back. */
  const room = count => {
    if (count > size) {
      if (place) kernel._free(place);
      place = kernel._malloc(8 * count);
      size = count;
    }
    return place;
  };
  const read = (at, count) => kernel.HEAPF64.slice(at / 8, at / 8 + count);
  const write = (at, numbers) => kernel.HEAPF64.set(numbers, at / 8);
  /** Runs work(answer); what the kernel throws is thrown here, in its own words. */
  const ask = work => {
    const answer = kernel._rw_answer();
    try {
      const value = work(answer), error = kernel.UTF8ToString(kernel._rw_error(answer));
      if (error) throw new RangeError(error);
      return value();
    } finally {
      kernel._rw_free(answer);
    }
  };

  /** eta, alpha, kappa, gamma1, gamma2, t_end, contact distance (0: none) and the rods. */
  const flat = (problem, rods) => [
    numberOf(problem, "eta", 1), numberOf(problem, "alpha", 1), numberOf(problem, "kappa", 0), numberOf(problem, "gamma1", 0),
    numberOf(problem, "gamma2", 0), numberOf(problem, "t_end"), numberOf(problem, "contact_distance", 0), ...rods.flat()];

  /** Strain [exx, exy, eyy] at (x, y) of a rod at the origin that walks along +x. */
  function strain(x, y, medium = {}) {
    const at = room(3);
    return ask(answer => {
      kernel._rw_strain(answer, numberOf(medium, "eta", 1), numberOf(medium, "alpha", 1), numberOf({ x }, "x"), numberOf({ y }, "y"), at);
      return () => [...read(at, 3)];
    });
  }

  /** Rods [x, y, theta] until t_end or until two are contact_distance apart. Rows of the path: t, then x, y, theta of each rod, at
   *  the ends of the integrator's steps. */
  function simulate(problem) {
    const rods = problem.rods;
    if (!Array.isArray(rods) || !rods.every(rod => rod.length === 3 && rod.every(Number.isFinite)))
      throw new TypeError("rods must be a list of [x, y, theta]");
    const numbers = flat(problem, rods), at = room(numbers.length + 5), out = at + 8 * numbers.length;
    write(at, numbers);
    return ask(answer => {
      kernel._rw_encounter(answer, at, rods.length, numberOf(problem, "rtol", 1e-8), out);
      return () => {
        const [ending, time, min_separation, min_separation_time, count] = read(out, 5);
        const width = 1 + 4 * rods.length, rows = read(kernel._rw_rows(answer), count), path = [], turning = [];
        for (let row = 0; row < count; row += width) {
          path.push([...rows.subarray(row, row + width - rods.length)]);
          turning.push([...rows.subarray(row + width - rods.length, row + width)]);
        }
        const last = path[path.length - 1];
        return { outcome: OUTCOMES[ending], time, min_separation, min_separation_time,
                 turn: rods.map((rod, index) => last[3 + 3 * index] - rod[2]),
                 reason: kernel.UTF8ToString(kernel._rw_reason(answer)), path, turning };
      };
    });
  }

  /** Many pairs, 13 numbers each as in `flat`: five numbers each, the outcome's place in OUTCOMES, time, smallest separation and the
   *  turns of both rods. */
  function encounters(numbers, rtol = 1e-8) {
    const pairs = numbers.length / 13, at = room(18 * pairs), out = at + 8 * numbers.length;
    write(at, numbers);
    return ask(answer => {
      kernel._rw_encounters(answer, at, pairs, rtol, out);
      return () => read(out, 5 * pairs);
    });
  }

  /** Columns at the points: exx, exy, eyy, lap u (2), grad div u (2) and, if wanted, u (2), one after the other. */
  function wakes({ eta, alpha, rods }, x, y, displacement = false) {
    const points = x.length, columns = displacement ? 9 : 7, of = room(3 * rods.length + (2 + columns) * points);
    const xs = of + 24 * rods.length, ys = xs + 8 * points, out = ys + 8 * points;
    write(of, rods.flat());
    write(xs, x);
    write(ys, y);
    return ask(answer => {
      kernel._rw_wakes(answer, eta, alpha, of, rods.length, xs, ys, points, displacement ? 1 : 0, out);
      return () => read(out, columns * points);
    });
  }

  return { strain, simulate, encounters, wakes, flat };
}
