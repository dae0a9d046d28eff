/** Reduced units: lengths in f/mu, times in f/(mu v0). */

export type Outcome = "contact" | "pursuit" | "escape" | "undecided" | "orbit";
/** x, y and heading (rad, counter-clockwise from +x). */
export type Rod = [x: number, y: number, theta: number];

export interface Medium {
  /** lambda/mu, coefficient of grad div over the shear modulus; above -1. 1 if left out. */
  eta?: number;
  /** (f/mu)/xi, inverse screening length; above 0. 1 if left out. */
  alpha?: number;
}

export interface Problem extends Medium {
  /** Turning by strain, v0 mu/f. 0 if left out. */
  kappa?: number;
  /** Polar turning by lap u, v0. 0 if left out. */
  gamma1?: number;
  /** Polar turning by grad div u, v0. 0 if left out. */
  gamma2?: number;
  rods: Rod[];
  t_end: number;
  /** Stop when two rods are this near; left out or 0: no stop. */
  contact_distance?: number | null;
  /** Relative tolerance of the local error, 1e-13 to 0.1. 1e-8 if left out. */
  rtol?: number;
}

export interface Encounter {
  outcome: Outcome;
  /** Of contact, else t_end. */
  time: number;
  /** Smallest separation of any pair at any time; infinite for one rod. */
  min_separation: number;
  min_separation_time: number;
  /** Heading at the end less that at the start, of each rod, rad. */
  turn: number[];
  /** How it ended, in words. */
  reason: string;
  /** Rows of t, then x, y, theta of each rod, at the ends of the integrator's steps; the last is the end. */
  path: number[][];
  /** theta' of each rod, a row for each of the path. */
  turning: number[][];
}

/** Resolves when the functions can be called. */
export const ready: Promise<void>;
/** Strain [exx, exy, eyy] at (x, y) of a rod at the origin that walks along +x. Throws at the rod itself. */
export function strain(x: number, y: number, medium?: Medium): [number, number, number];
/** Rods until t_end or until two are contact_distance apart. Throws for what cannot be computed, and says why. */
export function simulate(problem: Problem): Encounter;
/** Many pairs: 13 numbers each (eta, alpha, kappa, gamma1, gamma2, t_end, contact distance or 0, x, y, theta of both). Five numbers
 *  each: outcome (0 to 3 in the order of Outcome), time, smallest separation, turn of both rods. */
export function encounters(numbers: ArrayLike<number>, rtol?: number): Float64Array;
/** Columns at points, one after the other: exx, exy, eyy, lap u (x, y), grad div u (x, y) and, if wanted, u (x, y). */
export function wakes(of: { eta: number; alpha: number; rods: Rod[] }, x: ArrayLike<number>, y: ArrayLike<number>, displacement?: boolean): Float64Array;
