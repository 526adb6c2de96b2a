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
 * @property {number[]} weights of the states
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
 * @property {{reach: number, teeth: number[], known_ratings: number[]}} search for what would help
 * @property {[string, number][]} fixed what the states set, so that it cannot be suggested
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

/**
 * By how much everything has been changed: points along each axis in mm, phases in degrees, bearings
 * along their shafts and the engaged length of the spline in mm; other ratings of joints in N m.
 * @typedef {{points: number[][], phases: number[], bearings: number[], engaged: number,
 *   ratings: (number | null)[]}} Changes
 */

/**
 * A change that would help: by how much in mm or degrees, or the rating, the verdict after it, and
 * what is then worst.
 * @typedef {{variable: string, item: number, axis: number | null, by: number, verdict: string,
 *   left: string}} Suggestion
 */

/** Values that differ by less than this share of their size differ by rounding only. */
const ROUNDING = 1e-9;
const MINUS = "\u2212";
const JOINED_MS = 900;
const DEGREE = Math.PI / 180;

/** A machine that can be changed, with what was done to it. */
export class Model {
  #base;
  #nothing;
  #past = /** @type {{changes: Changes, what: string, time: number}[]} */ ([]);
  #future = /** @type {Changes[]} */ ([]);
  #before = /** @type {Changes | null} */ (null);
  #judged;

  /**
   * @param {import("../cardan.js").Cardan} cardan
   * @param {Sent} sent
   */
  constructor(cardan, sent) {
    this.sent = sent;
    this.#base = cardan.machine(sent.machine);
    const { points, unit = 1, joints, bearings = [] } = sent.machine;
    /** Whether the drawing has lengths, so that points can be moved. @type {boolean} */
    this.movable = Boolean(points);
    /** How many mm one unit of the points is. */
    this.millimetres = 1e3 * unit;
    this.#nothing = {
      points: sent.points.map(() => [0, 0, 0]),
      phases: Array(joints - 1).fill(0),
      bearings: bearings.map(() => 0),
      engaged: 0,
      ratings: Array(joints).fill(null),
    };
    /** @type {Changes} */
    this.changes = this.#nothing;
    this.machine = this.#base;
    /** What the figures are of. */
    this.#judged = { changes: this.changes, machine: this.machine };
    /** The state that is shown. */
    this.state = sent.drawn;
    /** Why the last change was refused. */
    this.refused = "";
    /** @type {import("../cardan.js").Figure[]} */
    this.figures = [];
    this.compute();
    /** The rows of the scene as sent. */
    this.drawnRows = new Map(this.rows().map((row) => [row.key, row]));
  }

  /** Whether nothing has been changed. */
  get isDrawn() {
    return alike(this.changes, this.#nothing);
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
   * @param {Changes} changes
   * @returns {number[][]}
   */
  points(state, changes = this.changes) {
    const { points, directions } = this.sent.machine;
    if (points) {
      return points[state].map((/** @type {number[]} */ p, /** @type {number} */ i) =>
        p.map((x, axis) => this.millimetres * x + changes.points[i][axis]),
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
    return this.points(this.state, this.#nothing);
  }

  /**
   * The phases of the shafts between joints, in the state shown, in degrees within half a turn.
   * @returns {number[]}
   */
  get phases() {
    const own = this.sent.machine.phases[this.state];
    return own.map((/** @type {number} */ phase, /** @type {number} */ i) =>
      folded(tidy(phase / DEGREE) + this.changes.phases[i], 360),
    );
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

  /** Begin a gesture, which is one step of undo. */
  begin() {
    this.#before ??= this.changes;
  }

  /**
   * Move a point to a place along one or more axes; what makes no driveline is refused.
   * @param {number} point
   * @param {(number | null)[]} to in mm in the state shown; null stays
   */
  place(point, to) {
    const now = this.points(this.state)[point];
    const by = this.changes.points[point].map((move, axis) => {
      const end = to[axis];
      return end === null ? move : tidy(move + end - now[axis]);
    });
    this.#take({ ...this.changes, points: replaced(this.changes.points, point, by) });
  }

  /**
   * Set the phases of the shafts between joints.
   * @param {(number | null)[]} to in degrees in the state shown; null stays
   */
  turn(to) {
    const now = this.phases;
    const phases = this.changes.phases.map((by, i) => {
      const end = to[i];
      return end === null ? by : tidy(folded(by + end - now[i], 360));
    });
    this.#take({ ...this.changes, phases });
  }

  /**
   * The best setting of the yokes for all states together, in degrees, each phase as near as it can
   * be to what it is.
   * @param {number[]} teeth of the splines, which stay on those of the scene as sent; none are turned at will
   * @returns {number[]}
   */
  bestPhases(teeth) {
    const { weights, machine: { phases } } = this.sent;
    const machine = teeth.length ? this.machine.with({ phases }) : this.machine;
    const now = this.phases;
    // Half a turn of a yoke changes nothing.
    return Array.from(machine.bestPhases({ teeth, weights }), (phase, i) => now[i] + folded(phase / DEGREE - now[i], 180));
  }

  /**
   * Make a change that the core suggests, of lengths to the next tenth of a millimetre.
   * @param {Suggestion} suggestion
   */
  apply({ variable, item, axis, by }) {
    const { points, phases, bearings, engaged } = this.changes;
    this.begin();
    if (variable === "point" && axis !== null) {
      const moved = replaced(points[item], axis, tidy(points[item][axis] + by));
      this.#take({ ...this.changes, points: replaced(points, item, moved) });
    } else if (variable === "phase") {
      const turned = folded(phases[item - 1] + by, 360);
      this.#take({ ...this.changes, phases: replaced(phases, item - 1, turned) });
    } else if (variable === "bearing") {
      this.#take({ ...this.changes, bearings: replaced(bearings, item, tidy(bearings[item] + by)) });
    } else if (variable === "engaged") {
      this.#take({ ...this.changes, engaged: tidy(engaged + by) });
    } else if (variable === "rating") {
      this.#take({ ...this.changes, ratings: replaced(this.changes.ratings, item, by) });
    }
    this.commit("suggestion");
  }

  /**
   * The smallest single changes that would bring everything within its limits. It takes some tenths
   * of a second.
   * @returns {Suggestion[]}
   */
  suggest() {
    const { search, fixed } = this.sent;
    const found = this.machine.suggest(search);
    return found
      .filter(({ variable, item }) => !fixed.some(([name, held]) => name === variable && held === item))
      .map(({ variable, item, axis, from, to, verdict, worst }) => {
        const isLength = variable === "point" || variable === "bearing" || variable === "engaged";
        const size = isLength ? Math.ceil(1e4 * Math.abs(to - from) - 1e-6) / 10 : 0;
        let by = isLength ? Math.sign(to - from) * size : (to - from) / DEGREE;
        if (variable === "rating") by = to;
        const left = worst ? this.sent.kinds[worst.kind.name].label : "";
        return { variable, item, axis, by, verdict, left };
      });
  }

  /**
   * What has been changed, in words, with what it would be without.
   * @returns {{words: string, without: Changes}[]}
   */
  listed() {
    const { changes } = this;
    const none = this.#nothing;
    const { kinds, points } = this.sent;
    /** @type {{words: string, without: Changes}[]} */
    const found = [];
    changes.points.forEach((by, i) => {
      by.forEach((x, axis) => {
        if (!x) return;
        const without = { ...changes, points: replaced(changes.points, i, replaced(by, axis, 0)) };
        found.push({ words: `${points[i]} ${"xyz"[axis]} ${signed(x)} mm`, without });
      });
    });
    changes.phases.forEach((by, i) => {
      const without = { ...changes, phases: replaced(changes.phases, i, 0) };
      if (by) found.push({ words: `phase of shaft ${i + 1} ${signed(by)}°`, without });
    });
    changes.bearings.forEach((by, i) => {
      const without = { ...changes, bearings: replaced(changes.bearings, i, 0) };
      if (by) found.push({ words: `bearing ${i} ${signed(by)} mm`, without });
    });
    const label = kinds.spline_engaged.label;
    const without = { ...changes, engaged: none.engaged };
    if (changes.engaged) found.push({ words: `${label} ${signed(changes.engaged)} mm`, without });
    changes.ratings.forEach((rating, i) => {
      const before = { ...changes, ratings: replaced(changes.ratings, i, null) };
      if (rating !== null) found.push({ words: `joint ${i} ${asGiven(rating)} N m`, without: before });
    });
    return found;
  }

  /**
   * Take changes as they are, as one step.
   * @param {Changes} changes
   */
  take(changes) {
    this.begin();
    this.#take(changes);
    this.commit("take");
  }

  /** @param {Changes} changes */
  #take(changes) {
    this.refused = "";
    try {
      const machine = this.#changed(changes);
      // Bearings are looked at when something is evaluated.
      machine.evaluate({ outputs: ["driving_pin"], angles: [0] });
      this.machine = machine;
      this.changes = changes;
    } catch (error) {
      this.#refuse(error);
    }
  }

  /** @param {unknown} error */
  #refuse(error) {
    if (!(error instanceof CardanError)) throw error;
    this.refused = `This makes no driveline: ${error.message}.`;
  }

  /** @param {Changes} changes */
  #changed(changes) {
    const { machine: sent } = this.sent;
    const none = this.#nothing;
    /** @type {import("../cardan.js").MachineData} */
    const data = {};
    if (!alike(changes.points, none.points)) {
      /** @type {(line: number[][], millimetres: number) => number[][]} */
      const at = (line, millimetres) =>
        line.map((p, i) => p.map((x, axis) => x + changes.points[i][axis] / millimetres));
      data.points = sent.points.map((/** @type {number[][]} */ line) => at(line, this.millimetres));
      if (sent.drawn && sent.drawn.length) data.drawn = at(sent.drawn, 1e3);
      if (sent.step_points) {
        data.step_points = sent.step_points.map((/** @type {number[][]} */ line) => at(line, this.millimetres));
      }
    }
    /** @type {(name: string, by: number[], unit: number) => void} */
    const shift = (name, by, unit) => {
      for (const key of [name, `step_${name}`]) {
        if (!sent[key]) continue;
        data[key] = sent[key].map((/** @type {number[]} */ row) => row.map((x, i) => x + unit * by[i]));
      }
    };
    if (!alike(changes.phases, none.phases)) shift("phases", changes.phases, DEGREE);
    if (!alike(changes.bearings, none.bearings)) shift("positions", changes.bearings, 1e-3);
    if (changes.engaged) data.engaged = sent.engaged + 1e-3 * changes.engaged;
    if (!alike(changes.ratings, none.ratings)) {
      data.ratings = sent.ratings.map(
        (/** @type {number} */ own, /** @type {number} */ i) => changes.ratings[i] ?? own,
      );
    }
    return Object.keys(data).length ? this.#base.with(data) : this.#base;
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
    if (!before || alike(before, this.changes)) return;
    const last = this.#past[this.#past.length - 1];
    if (last && last.what === what && time - last.time < JOINED_MS) last.time = time;
    else this.#past.push({ changes: before, what, time });
    this.#future = [];
  }

  undo() {
    const last = this.#past.pop();
    if (!last) return;
    this.#future.push(this.changes);
    this.#take(last.changes);
  }

  redo() {
    const next = this.#future.pop();
    if (!next) return;
    this.#past.push({ changes: this.changes, what: "", time: NaN });
    this.#take(next);
  }

  /** Go back to the scene as sent; this can be undone. */
  reset() {
    this.take(this.#nothing);
  }

  /**
   * Find all figures, or those alone that have a limit, which takes less time. A machine that has none
   * gives way to the last one that had.
   * @param {boolean} whole
   */
  compute(whole = true) {
    try {
      this.figures = this.machine.figures({ limited: !whole });
    } catch (error) {
      this.#refuse(error);
      ({ changes: this.changes, machine: this.machine } = this.#judged);
      return;
    }
    this.#judged = { changes: this.changes, machine: this.machine };
  }

  /**
   * The figure of a kind.
   * @param {string} kind
   * @param {number | null} item
   */
  figure(kind, item) {
    return this.figures.find((each) => each.kind.name === kind && each.item === item);
  }

  /**
   * One number of the driveline in the state shown, of an array of all states.
   * @param {"bends" | "lengths" | "positions"} name
   * @param {number} item
   * @returns {number}
   */
  part(name, item) {
    const values = this.machine.data[name];
    if (Array.isArray(values)) return values[this.state][item];
    return values[(this.state * values.length) / this.sent.states.length + item];
  }

  /**
   * What a figure is in the state shown: in the unit that is shown, as text, and its place in the
   * answer of the check.
   * @param {string} kind
   * @param {number} item
   * @returns {{value: number, text: string, path: string} | null}
   */
  here(kind, item) {
    // Bends belong to the geometry, which is known before any figure.
    const found =
      kind === "bend" ? this.part("bends", item) : this.figure(kind, item)?.values[this.state];
    if (found === undefined || !Number.isFinite(found)) return null;
    const { states, kinds, here } = this.sent;
    const value = found * kinds[kind].factor;
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
    const value = settled(inside * kind.factor, kind.digits, bounds);
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
        text: text(each * kind.factor),
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

/**
 * @param {unknown} a
 * @param {unknown} b
 */
const alike = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * A list with another value at a place.
 * @template T
 * @param {T[]} list
 * @param {number} place
 * @param {T} value
 */
const replaced = (list, place, value) => list.map((own, i) => (i === place ? value : own));

/**
 * An angle within half a period of 0.
 * @param {number} angle
 * @param {number} period
 */
export const folded = (angle, period) => angle - period * Math.round(angle / period);

/**
 * A change with its sign, to a tenth, or to what it is.
 * @param {number} number
 */
export const signed = (number) => `${number < 0 ? MINUS : "+"}${Math.abs(number).toFixed(1)}`;

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
 * A number, or 0 where it is mere rounding: finer than its kind, and than what it is told apart from.
 * @param {number} number in the unit that is shown
 * @param {Digits} rule
 * @param {number[]} apartFrom
 */
function settled(number, rule, apartFrom) {
  const isTold = apartFrom.some((other) => other / number > 0 && other / number <= 1 + ROUNDING);
  return Math.abs(number) < rule.finest && !isTold ? 0 : number;
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
  return digitsOf(settled(number, rule, apartFrom), rule, apartFrom).replace(/^-/, MINUS);
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
