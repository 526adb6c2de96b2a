// @ts-check
/**
 * The machine of a page without its document: what has been moved, what the core says of it, and
 * numbers as people read them.
 *
 * @module model
 */

import { CardanError } from "../cardan.js";

/**
 * With how many digits a kind of figure is shown, as `cardan.app.answers.rows.Digits`.
 * @typedef {{decimals: number | null, digits: number | null, apart: number | null, finest: number}} Digits
 */

/**
 * What the page calls a kind of figure, its unit, how many of that are one inside, and its digits.
 * @typedef {{label: string, unit: string, factor: number, digits: Digits, meaning: string,
 *   source: string, path: string, ending: string}} SentKind
 */

/**
 * What Python sends: the machine, names, and what is said of its figures.
 * @typedef {object} Sent
 * @property {import("../cardan.js").MachineData} machine
 * @property {string[]} states
 * @property {string[]} steps of the duty cycle
 * @property {number} drawn the state that is drawn first
 * @property {string[]} points what each point is called
 * @property {{name: string, right: number[], down: number[]}[]} views
 * @property {Record<string, SentKind>} kinds
 * @property {{kind: string, item: number | null, name: string, bound: string, limit: string,
 *   source: string}[]} figures
 *   those that have a limit
 * @property {{name: string, verdict: string, words: string}[]} others that are not computed here
 * @property {string[]} verdicts from the worst
 * @property {Record<string, string>} here where the check has a kind of figure of one state
 */

/**
 * A figure beside its limit.
 * @typedef {object} Row
 * @property {string} key
 * @property {string} name
 * @property {string} text
 * @property {string} bound
 * @property {string} verdict
 * @property {string} place
 * @property {number} value in the unit that is shown
 * @property {number | null} use as a share of the limit
 * @property {string} path of the value in the answer of the check
 * @property {string} source
 * @property {SentKind} kind
 * @property {{name: string, text: string, verdict: string}[]} each in every state and step
 */

/** @typedef {number[][]} Moves how far each point has been moved, in mm */

/** Values that differ by less than this share of their size differ by rounding only. */
const ROUNDING = 1e-9;
const MINUS = "\u2212";
const JOINED_MS = 900;

/** A machine that can be moved, with what was done to it. */
export class Model {
  #base;
  #past = /** @type {{moves: Moves, what: string, time: number}[]} */ ([]);
  #future = /** @type {Moves[]} */ ([]);
  #before = /** @type {Moves | null} */ (null);

  /**
   * @param {import("../cardan.js").Cardan} cardan
   * @param {Sent} sent
   */
  constructor(cardan, sent) {
    this.sent = sent;
    this.#base = cardan.machine(sent.machine);
    const { points, unit = 1 } = sent.machine;
    /** Whether the drawing has lengths, so that points can be moved. @type {boolean} */
    this.movable = Boolean(points);
    /** How many mm one unit of the points is. */
    this.millimetres = 1e3 * unit;
    /** @type {Moves} */
    this.moves = sent.points.map(() => [0, 0, 0]);
    this.machine = this.#base;
    /** What the figures are of. */
    this.#judged = { moves: this.moves, machine: this.machine };
    /** The state that is shown. */
    this.state = sent.drawn;
    /** Why the last change was refused. */
    this.refused = "";
    const judged = new Set(sent.figures.map((figure) => figure.kind));
    this.#judgesForces = judged.has("joint_force") || judged.has("bearing_force");
    /** @type {import("../cardan.js").Figure[]} */
    this.figures = [];
    this.compute();
    /** The rows of the scene as sent. */
    this.drawnRows = new Map(this.rows().map((row) => [row.key, row]));
  }

  #judgesForces;

  /** Whether nothing has been moved. */
  get isDrawn() {
    return this.moves.every((by) => by.every((each) => each === 0));
  }

  get canUndo() {
    return this.#past.length > 0;
  }

  get canRedo() {
    return this.#future.length > 0;
  }

  /**
   * The points of a state in mm, of a scene without lengths with shafts of one metre.
   * @param {number} state
   * @param {Moves} moves
   * @returns {number[][]}
   */
  points(state, moves = this.moves) {
    const { points, directions } = this.sent.machine;
    if (points) {
      return points[state].map((/** @type {number[]} */ p, /** @type {number} */ i) =>
        p.map((x, axis) => this.millimetres * x + moves[i][axis]),
      );
    }
    const line = [[0, 0, 0]];
    for (const along of directions[state]) {
      line.push(line[line.length - 1].map((x, axis) => x + 1e3 * along[axis]));
    }
    return line;
  }

  /** The points as sent. */
  get drawnPoints() {
    return this.points(this.state, this.sent.points.map(() => [0, 0, 0]));
  }

  /**
   * The driving and the driven pin of every joint at a drive angle, as unit vectors.
   * @param {number} angle in rad
   * @returns {number[][][]}
   */
  pins(angle) {
    const outputs = ["driving_pin", "driven_pin"];
    const found = this.machine.evaluate({ outputs, angles: [angle] });
    const of = (/** @type {string} */ name, /** @type {number} */ joint) =>
      found[name][joint][this.state].map((component) => component[0]);
    return found.driving_pin.map((_, joint) => outputs.map((name) => of(name, joint)));
  }

  /**
   * Begin a gesture, which is one step of undo.
   */
  begin() {
    this.#before ??= this.moves;
  }

  /**
   * Move a point to a place along one or more axes; what makes no driveline is refused.
   * @param {number} point
   * @param {(number | null)[]} to in mm in the state shown; null stays
   */
  place(point, to) {
    const [now] = [this.points(this.state)[point]];
    const by = this.moves[point].map((move, axis) => {
      const end = to[axis];
      return end === null ? move : tidy(move + end - now[axis]);
    });
    this.#take(this.moves.map((own, i) => (i === point ? by : own)));
  }

  /** @param {Moves} moves */
  #take(moves) {
    this.refused = "";
    try {
      const machine = this.#moved(moves);
      // Bearings are looked at when something is evaluated.
      machine.evaluate({ outputs: ["driving_pin"], angles: [0] });
      this.machine = machine;
      this.moves = moves;
    } catch (error) {
      this.#refuse(error);
    }
  }

  /** @param {unknown} error */
  #refuse(error) {
    if (!(error instanceof CardanError)) throw error;
    this.refused = `This makes no driveline: ${error.message}.`;
  }

  /** @param {Moves} moves */
  #moved(moves) {
    const { points, drawn, step_points } = this.sent.machine;
    if (moves.every((by) => by.every((each) => each === 0))) return this.#base;
    /** @param {number[][]} line @param {number} millimetres */
    const at = (line, millimetres) =>
      line.map((p, i) => p.map((x, axis) => x + moves[i][axis] / millimetres));
    /** @param {number[][]} line */
    const own = (line) => at(line, this.millimetres);
    /** @type {import("../cardan.js").MachineData} */
    const changes = { points: points.map(own) };
    if (drawn && drawn.length) changes.drawn = at(drawn, 1e3);
    if (step_points) changes.step_points = step_points.map(own);
    return this.#base.with(changes);
  }

  /** Give up a gesture. */
  cancel() {
    if (this.#before) this.#take(this.#before);
    this.#before = null;
  }

  /**
   * End a gesture.
   * @param {string} what was done
   * @param {number} time in ms; what is done again at once is one step with it, where it is given
   */
  commit(what, time = NaN) {
    const before = this.#before;
    this.#before = null;
    if (!before || alike(before, this.moves)) return;
    const last = this.#past[this.#past.length - 1];
    if (last && last.what === what && time - last.time < JOINED_MS) last.time = time;
    else this.#past.push({ moves: before, what, time });
    this.#future = [];
  }

  undo() {
    const last = this.#past.pop();
    if (!last) return;
    this.#future.push(this.moves);
    this.#take(last.moves);
  }

  redo() {
    const next = this.#future.pop();
    if (!next) return;
    this.#past.push({ moves: this.moves, what: "", time: NaN });
    this.#take(next);
  }

  /** Go back to the scene as sent; this can be undone. */
  reset() {
    this.begin();
    this.#take(this.moves.map(() => [0, 0, 0]));
    this.commit("as drawn");
  }

  /**
   * Find all figures; the forces, which take longest, only if they are judged or asked for. A machine
   * that has none gives way to the last one that had.
   * @param {boolean} whole
   */
  compute(whole = true) {
    const without = { bearings: [], positions: [], step_positions: [] };
    const machine = whole || this.#judgesForces ? this.machine : this.machine.with(without);
    try {
      this.figures = machine.figures();
    } catch (error) {
      this.#refuse(error);
      ({ moves: this.moves, machine: this.machine } = this.#judged);
      return;
    }
    this.#judged = { moves: this.moves, machine: this.machine };
    /** Whether the forces are those of the machine as it is. */
    this.hasForces = machine === this.machine;
  }

  #judged;

  /**
   * The figure of a kind.
   * @param {string} kind
   * @param {number | null} item
   */
  figure(kind, item) {
    return this.figures.find((each) => each.kind.name === kind && each.item === item);
  }

  /**
   * What a figure is in the state shown: in the unit that is shown, as text, and its place in the
   * answer of the check.
   * @param {string} kind
   * @param {number} item
   * @returns {{value: number, text: string, path: string} | null}
   */
  here(kind, item) {
    const found = this.figure(kind, item);
    if (!found || !Number.isFinite(found.values[this.state])) return null;
    const { states, kinds, here } = this.sent;
    const value = shownValue(found.values[this.state], kinds[kind]);
    const path = here[kind].replace("{}", String(item)).replace("{state}", states[this.state]);
    return { value, text: withUnit(numberText(value, kinds[kind].digits), kinds[kind]), path };
  }

  /**
   * The figures that have a limit.
   * @returns {Row[]}
   */
  rows() {
    return this.sent.figures.flatMap((of) => {
      const found = this.figure(of.kind, of.item);
      return found ? [this.#row(of, found)] : [];
    });
  }

  /**
   * @param {Sent["figures"][number]} of
   * @param {import("../cardan.js").Figure} found
   * @returns {Row}
   */
  #row(of, found) {
    const kind = this.sent.kinds[of.kind];
    const bounds = [found.limit, found.maximum].map((bound) => bound * kind.factor);
    const inside = found.worst === null ? NaN : found.values[found.worst];
    const value = shownValue(inside, kind);
    const names = [...this.sent.states, ...this.sent.steps];
    const isEven = spread(found.values) <= ROUNDING || value === 0;
    /** @param {number} number */
    const text = (number) => withUnit(numberText(number, kind.digits, bounds), kind);
    const limit = found.limit * kind.factor;
    const item = of.item === null ? "" : of.item.toString();
    return {
      key: `${of.kind} ${item}`,
      name: of.name,
      text: text(value),
      bound: of.bound,
      verdict: this.#worst(found.ranks),
      place: found.worst === null || isEven ? "" : placeText(names[found.worst]),
      value,
      use: used(value, limit, found.kind.most),
      path: `check:${kind.path.replace("{}", item)}.value${kind.ending}`,
      source: `Limit ${of.limit}: ${of.source}`,
      kind,
      each: Array.from(isEven ? [] : found.values, (each, i) => ({
        name: names[i],
        text: text(shownValue(each, kind)),
        verdict: found.ranks[i],
      })),
    };
  }

  /** @param {string[]} verdicts the worst of them; what is not judged in one place is not judged */
  #worst(verdicts) {
    if (verdicts.includes("not judged")) return "not judged";
    return this.sent.verdicts.find((verdict) => verdicts.includes(verdict)) ?? "not judged";
  }

  /**
   * The verdict on some rows and, while nothing has been moved, on what is not computed here.
   * @param {Row[]} rows
   * @returns {string}
   */
  verdict(rows) {
    const found = rows.map((row) => row.verdict);
    if (this.isDrawn) found.push(...this.sent.others.map((other) => other.verdict));
    return this.sent.verdicts.find((verdict) => found.includes(verdict)) ?? "not judged";
  }

  /**
   * The verdict on each state.
   * @returns {string[]}
   */
  stateVerdicts() {
    const judged = this.sent.figures.flatMap((of) => this.figure(of.kind, of.item) ?? []);
    return this.sent.states.map((_, state) => {
      const ranks = judged.filter((each) => each.kind.scope !== "once").map((each) => each.ranks[state]);
      return this.sent.verdicts.find((verdict) => ranks.includes(verdict)) ?? "not judged";
    });
  }

  /**
   * Rows from the worst.
   * @param {Row[]} rows
   * @returns {Row[]}
   */
  sorted(rows) {
    const rank = (/** @type {Row} */ row) => this.sent.verdicts.indexOf(row.verdict);
    return [...rows].sort((a, b) => rank(a) - rank(b) || (b.use ?? -1) - (a.use ?? -1));
  }
}

/**
 * A text with true minus signs.
 * @param {string} text
 */
export const minus = (text) => text.replace(/(^| )-(?=[\d.])/g, `$1${MINUS}`);

/** @param {Moves} a @param {Moves} b */
const alike = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * A length in mm without what a change of units or a subtraction adds.
 * @param {number} number
 */
export const tidy = (number) => Math.round(1e6 * number) / 1e6;

/** @param {ArrayLike<number>} values */
function spread(values) {
  const all = Array.from(values);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  return (high - low) / Math.max(Math.abs(low), Math.abs(high), 1e-300);
}

/**
 * How much of its limit a value uses; null if that has no size.
 * @param {number} value
 * @param {number} limit
 * @param {boolean} most
 */
function used(value, limit, most) {
  if (!(limit > 0)) return null;
  const use = most ? value / limit : limit / value;
  return use >= 0 && Number.isFinite(use) ? use : null;
}

/**
 * How much of a limit is used, in whole percent: 100 only of one that is used exactly.
 * @param {number} share
 */
export function useText(share) {
  let percent = Math.round(100 * share);
  if (Math.abs(share - 1) > ROUNDING) percent = share < 1 ? Math.min(percent, 99) : Math.max(percent, 101);
  return `${percent}%`;
}

/** @param {string} name of a state or step */
const placeText = (name) => (/^\p{L}/u.test(name) ? `in ${name}` : `in “${minus(name)}”`);

/**
 * A value in the unit that is shown; what is mere rounding is 0.
 * @param {number} inside
 * @param {SentKind} kind
 */
function shownValue(inside, kind) {
  const value = inside * kind.factor;
  return Math.abs(value) < kind.digits.finest ? 0 : value;
}

/** @param {string} text @param {SentKind} kind */
function withUnit(text, kind) {
  return ["", "°", "%"].includes(kind.unit) ? text + kind.unit : `${text} ${kind.unit}`;
}

/**
 * A number as `cardan.app.answers.printed.number_text` writes it, with a true minus sign.
 * @param {number} number in the unit that is shown
 * @param {Digits} rule
 * @param {number[]} apartFrom what it is told apart from
 */
export function numberText(number, rule, apartFrom = []) {
  return digitsOf(number, rule, apartFrom).replace(/^-/, MINUS);
}

/** @param {number} number @param {Digits} rule @param {number[]} apartFrom */
function digitsOf(number, rule, apartFrom) {
  if (Number.isNaN(number)) return "not known";
  if (!Number.isFinite(number)) return "unlimited";
  if (number === 0) return "0";
  const others = [...apartFrom.filter(Number.isFinite), 0, ...(rule.apart === null ? [] : [rule.apart])];
  for (const other of others) {
    if (Math.abs(number - other) <= ROUNDING * Math.abs(other)) return asGiven(other);
  }
  const size = Math.floor(Math.log10(Math.abs(number)));
  const isReadable = size >= -5 && size < 7;
  const digits = rule.digits ?? 3;
  const exponent = Number(number.toExponential(digits - 1).split("e")[1]);
  const fewest = rule.decimals ?? Math.max(0, digits - 1 - exponent);
  for (let more = 0; more < 15; more++) {
    const text = isReadable ? number.toFixed(fewest + more) : number.toExponential(2 + more);
    const shown = Number(text);
    if (others.every((other) => Math.sign(shown - other) === Math.sign(number - other))) return text;
  }
  return String(number);
}

/**
 * All digits that someone gave.
 * @param {number} number
 */
export const asGiven = (number) => String(Number(number.toPrecision(10)));
