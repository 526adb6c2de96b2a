// @ts-check
/**
 * The machine of a page without its document: what has been changed, and what the core says of it.
 *
 * @module model
 */

import { CardanError } from "../cardan.js";
import { addressOf, byOf, changeable, changed, dataOf, listed, moved, movedLine, positionsOf, readAddress, textOf, turnsOf } from "./changes.js";
import { torsionOf } from "./torsion.js";
import { ROUNDING, exact, folded, givenText, lengthText, lengths, minus, quantityText, settled, tidy, units } from "./numbers.js";

/** @typedef {import("./numbers.js").Digits} Digits */
/** @typedef {import("./changes.js").Changes} Changes */

/**
 * What the page calls a kind of figure, its units, how many of that of the SI are one inside.
 * @typedef {import("./numbers.js").Measured & {label: string, factor: number, meaning: string,
 *   source: string, path: string, ending: string}} SentKind
 */

/** @typedef {Record<import("./numbers.js").System, string>} InUnits a text in the units shown */

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
 * @property {{kind: string, item: number | null, name: string, bound: InUnits, limit: InUnits,
 *   source: string, over: string}[]} figures
 *   those that have a limit
 * @property {{name: string, verdict: string, words: InUnits}[]} others that are not computed here
 * @property {import("./torsion.js").SentTorsion | null} torsion
 * @property {import("./lateral.js").SentLateral | null} lateral
 * @property {import("./numbers.js").System} units of the scene
 * @property {import("./numbers.js").Measured} torques
 * @property {string[]} verdicts from the worst
 * @property {{reach: number, teeth: number[], known_ratings: number[]}} search for what would help
 * @property {string[] | null} shims what would help a driveline that was read with an inclinometer, as sent
 * @property {[string, number][]} fixed what the states set, so that it cannot be suggested
 * @property {string} title of the scene
 * @property {string} core the digest of its sources
 * @property {import("./curves.js").SentCurves[]} curves over the turn
 * @property {Record<string, string>} here where the check has a kind of figure of one state
 * @property {Given} given what the scene gives of what can be changed
 * @property {{name: string, text: string, pieces: Piece[], sizes: Record<string, string>}} source the
 *   file of the scene, where changes are written in it, and what it calls sizes of joints by rating
 */

/**
 * What the scene gives, in SI units, as `cardan.app.scene.changes.given`.
 * @typedef {object} Given
 * @property {boolean} points whether the scene gives points
 * @property {{value: number, factor: number, per: number}[]} bearings
 * @property {Record<string, {before: number[], turns: Turn[]}[]>} turned by point, where it is in every
 *   state before that turns it, and what turns it
 * @property {(number | null)[]} steps the state of every step of the duty cycle
 * @property {GivenLoad | null} speed
 * @property {GivenLoad | null} torque
 */

/** @typedef {{about: number[], matrix: number[][]}} Turn */

/**
 * @typedef {{value: number, key: string, unit: string, us: import("./numbers.js").Form | null, factor: number,
 *   columns: string[]}} GivenLoad
 */

/**
 * @typedef {{start: number, end: number, text: string, numbers: {start: number, end: number,
 *   variable: string, item: number, axis: number | null, size: number}[]}} Piece
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
 * A change that would help: by how much in mm or degrees, or the rating, the verdict after it, and
 * what is then worst.
 * @typedef {{variable: string, item: number, axis: number | null, by: number, verdict: string,
 *   left: string}} Suggestion
 */

const JOINED_MS = 900;
const STEPS = 500; // that can be undone
const DEGREE = Math.PI / 180;

/** A machine that can be changed, with what was done to it. */
export class Model {
  #base;
  #past = /** @type {{changes: Changes, what: string, time: number}[]} */ ([]);
  #future = /** @type {Changes[]} */ ([]);
  #before = /** @type {Changes | null} */ (null);
  #judged;
  #isLoaded;

  /**
   * @param {import("../cardan.js").Cardan} cardan
   * @param {Sent} sent
   */
  constructor(cardan, sent) {
    this.sent = sent;
    this.#base = cardan.machine(sent.machine);
    /** Whether the scene has points, so that they can be moved. @type {boolean} */
    this.movable = Boolean(sent.given.points);
    /** Everything that can be changed. */
    this.changeable = changeable(sent);
    /** @type {Changes} */
    this.changes = {};
    this.machine = this.#base;
    /** What the figures are of. */
    this.#judged = { changes: this.changes, machine: this.machine };
    /** The state that is shown. */
    this.state = sent.drawn;
    /** Why the last change was refused. */
    this.refused = "";
    /** @type {import("../cardan.js").Figure[]} */
    this.figures = [];
    /** @type {import("./torsion.js").Found | null} */
    this.torsion = null;
    this.compute();
    this.#isLoaded = this.figures.some(({ kind }) => kind.name === "bearing_force");
    /** The rows of the scene as sent. */
    this.drawnRows = new Map(this.rows().map((row) => [row.key, row]));
  }

  /** The machine as sent. */
  get drawnMachine() {
    return this.#base;
  }

  /** Whether nothing has been changed. */
  get isDrawn() {
    return !Object.keys(this.changes).length;
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
    const { points, unit = 1, directions } = this.sent.machine;
    if (points) {
      const line = this.movable ? movedLine(this.sent, changes, points[state], state) : points[state];
      return line.map((/** @type {number[]} */ p) => p.map((x) => 1e3 * unit * x));
    }
    const line = [[0, 0, 0]];
    for (const along of directions[state]) {
      line.push(line[line.length - 1].map((x, axis) => x + 1e3 * along[axis]));
    }
    return line;
  }

  /** The points as sent. */
  get drawnPoints() {
    return this.points(this.state, {});
  }

  /**
   * The phases of the shafts between joints, in the state shown, in degrees within half a turn.
   * @returns {number[]}
   */
  get phases() {
    const own = this.sent.machine.phases[this.state];
    return own.map((/** @type {number} */ phase, /** @type {number} */ i) =>
      folded(exact(phase / DEGREE) + byOf(this.changes, "phase", i + 1), 360),
    );
  }

  /**
   * What is at a drive angle in the state shown: the driving and the driven pin of every joint as unit
   * vectors, and the force of every bearing on its shaft in N, of none where forces are not known.
   * @param {number} angle in rad
   * @returns {{pins: number[][][], forces: number[][]}}
   */
  at(angle) {
    const outputs = ["driving_pin", "driven_pin", ...(this.#isLoaded ? ["bearing_force"] : [])];
    const found = this.machine.evaluate({ outputs, angles: [angle] });
    const of = (/** @type {string} */ name) =>
      (found[name] ?? []).map((states) => states[this.state].map((component) => component[0]));
    const [driving, driven] = [of("driving_pin"), of("driven_pin")];
    return { pins: driving.map((pin, joint) => [pin, driven[joint]]), forces: of("bearing_force") };
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
    const off = to.map((end, axis) => (end === null ? 0 : end - now[axis]));
    // The transpose of a turn takes it back.
    const back = (/** @type {number[]} */ arm, /** @type {Turn} */ { matrix }) =>
      [0, 1, 2].map((axis) => arm.reduce((sum, x, k) => sum + matrix[k][axis] * x, 0));
    const by = (turnsOf(this.sent, point, this.state) ?? []).reduceRight(back, off);
    let { changes } = this;
    by.forEach((own, axis) => {
      changes = changed(changes, "point", point, axis, tidy(byOf(changes, "point", point, axis) + own));
    });
    this.#take(changes);
  }

  /**
   * Set the phases of the shafts between joints.
   * @param {(number | null)[]} to in degrees in the state shown; null stays
   */
  turn(to) {
    const now = this.phases;
    let { changes } = this;
    to.forEach((end, i) => {
      if (end === null) return;
      const by = byOf(changes, "phase", i + 1) + end - now[i];
      changes = changed(changes, "phase", i + 1, null, tidy(folded(by, 360)));
    });
    this.#take(changes);
  }

  /**
   * Set the torque or the speed of the scene, in its unit.
   * @param {"torque" | "speed"} name
   * @param {number} value
   */
  load(name, value) {
    this.#take(changed(this.changes, name, 0, null, value, this.sent.given[name]?.value));
  }

  /** @param {"torque" | "speed"} name */
  loadOf(name) {
    return this.changes[`${name}.0`] ?? this.sent.given[name]?.value ?? NaN;
  }

  /**
   * Move a bearing along its shaft.
   * @param {number} bearing
   * @param {number} to in mm from the upstream end of the shaft in the state shown
   */
  slide(bearing, to) {
    const by = byOf(this.changes, "bearing", bearing) + to - 1e3 * this.part("positions", bearing);
    this.#take(changed(this.changes, "bearing", bearing, null, tidy(by)));
  }

  /**
   * By how much a bearing was moved along its shaft, in mm.
   * @param {number} bearing
   */
  slid(bearing) {
    return byOf(this.changes, "bearing", bearing);
  }

  /**
   * By how much a point was moved in the state shown, in mm.
   * @param {number} point
   */
  moved(point) {
    return moved(this.sent, this.changes, point, this.state);
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
    const isSet = variable === "rating";
    const size = isSet ? by : tidy(byOf(this.changes, variable, item, axis) + by);
    const own = isSet ? this.sent.machine.ratings[item] : 0;
    this.take(changed(this.changes, variable, item, axis, variable === "phase" ? folded(size, 360) : size, own));
  }

  /**
   * The smallest single changes that would bring everything within its limits, found in rounds of
   * some milliseconds.
   * @returns {Generator<undefined, Suggestion[]>}
   */
  *suggesting() {
    const { search, fixed } = this.sent;
    const found = yield* this.machine.suggesting(search);
    return found
      .filter(({ variable, item }) => !fixed.some(([name, held]) => name === variable && held === item))
      .map((change) => {
        const { variable, item, axis, from, to, worst } = change;
        const resonance = this.#resonance(this.#torsion(this.machine.apply(change))).flatMap(({ ranks }) => ranks);
        const verdict = this.#worst([...resonance, change.verdict]);
        const isLength = variable === "point" || variable === "bearing" || variable === "engaged";
        const size = isLength ? Math.ceil(1e4 * Math.abs(to - from) - 1e-6) / 10 : 0;
        let by = isLength ? Math.sign(to - from) * size : (to - from) / DEGREE;
        if (variable === "rating") by = to;
        const kind = verdict === change.verdict ? worst?.kind.name : "resonance";
        const left = kind ? this.sent.kinds[kind].label : "";
        return { variable, item, axis, by, verdict, left };
      });
  }

  /** What has been changed, in words, with what it would be without. */
  listed() {
    return listed(this.sent, this.changes);
  }

  /** What stands behind the # of the page's address. */
  get address() {
    return addressOf(this.sent, this.changes, this.state);
  }

  /**
   * Take what an address says, as one step; what it says wrongly changes nothing.
   * @param {string} address
   */
  read(address) {
    try {
      const { changes, state } = readAddress(this.sent, address);
      this.take(changes);
      if (!this.refused) this.state = state;
    } catch (error) {
      this.refused = `The address cannot be read, so this is the scene as it was: ${/** @type {Error} */ (error).message}.`;
    }
  }

  /** The file of the scene with what has been changed. */
  get text() {
    return textOf(this.sent, this.changes);
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
    const [odd] = Object.keys(changes).filter((key) => !Number.isFinite(changes[key]));
    if (odd) {
      this.refused = `This makes no driveline: ${this.#named(odd)} would not be finite.`;
      return;
    }
    try {
      const machine = this.#changed(changes);
      // Bearings are looked at when something is evaluated.
      machine.evaluate({ outputs: ["driving_pin"], angles: [0] });
      this.machine = machine;
      this.changes = changes;
    } catch (error) {
      this.#refuse(error, changes);
    }
  }

  /**
   * @param {unknown} error
   * @param {Changes} changes
   */
  #refuse(error, changes) {
    if (!(error instanceof CardanError)) throw error;
    this.refused = `This makes no driveline: ${this.#reason(error, changes) ?? error.message}.`;
  }

  /**
   * What a key of a change stands for.
   * @param {string} key
   */
  #named(key) {
    const { variable, item } = this.changeable.get(key) ?? { variable: key, item: 0 };
    const words = /** @type {Record<string, string>} */ ({
      point: `a coordinate of ${this.pointName(item)}`,
      phase: `the phase of shaft ${item}`,
      bearing: `the place of bearing ${item}`,
      engaged: "the engaged length of the spline",
      rating: `the rating of joint ${item}`,
    });
    return words[variable] ?? `the ${variable}`;
  }

  /**
   * What a point is called in a sentence.
   * @param {number} point
   */
  pointName(point) {
    return this.sent.points[point].replace(/(?=.*end$)/, "the ");
  }

  /**
   * What the core says of changes, with the names of the page; null if that is about something else.
   * @param {CardanError} error
   * @param {Changes} changes
   */
  #reason({ argument, place, value, rule }, changes) {
    const { states, machine: { joints, positions, bearings } } = this.sent;
    const within = (/** @type {number} */ state) => (states.length > 1 ? `, ${placeText(states[state])}` : "");
    /** @param {number} state @param {number} shaft */
    const along = (state, shaft) => {
      const [from, to] = this.points(state, changes).slice(shaft);
      return to.map((x, axis) => x - from[axis]);
    };
    /** @param {number} state @param {number} shaft */
    const length = (state, shaft) => Math.hypot(...along(state, shaft));
    if (argument === "points") {
      const [state, point] = place;
      if (point === undefined) {
        const cosines = Array.from({ length: joints }, (_, joint) => {
          const after = along(state, joint + 1);
          const product = along(state, joint).reduce((sum, x, axis) => sum + x * after[axis], 0);
          return product / length(state, joint) / length(state, joint + 1);
        });
        const sharpest = cosines.indexOf(Math.min(...cosines));
        return `${this.pointName(sharpest + 1)} would be bent by 90° or more${within(state)}`;
      }
      return `${this.pointName(point - 1)} and ${this.pointName(point)} would lie in the same place${within(state)}`;
    }
    if (argument === "bearings") {
      const [bearing, , state = 0] = place;
      const shaft = bearings[bearing];
      if (place.length === 1) return `bearing ${bearing} would lie where another bearing of shaft ${shaft} is`;
      const moved = positionsOf(this.sent, changes, (...of) => 1e-3 * length(...of)) ?? positions;
      const [at, end] = [1e3 * moved[state][bearing], length(state, shaft)].map(lengthText);
      const { unit } = lengths();
      return `bearing ${bearing} would lie ${at} ${unit} along shaft ${shaft}, which is ${end} ${unit} long${within(state)}`;
    }
    if (argument === "rating") {
      return `${this.#named(`rating.${place[0]}`)} would be ${minus(givenText(Number(value), this.sent.torques))}; ${rule}`;
    }
    return null;
  }

  /** @param {Changes} changes */
  #changed(changes) {
    const { sent } = this;
    const data = dataOf(sent, changes);
    const machine = Object.keys(data).length ? this.#base.with(data) : this.#base;
    const positions = positionsOf(sent, changes, (state, shaft) => partOf(machine, "lengths", state, shaft));
    return positions ? machine.with({ positions }) : machine;
  }

  /**
   * The verdict on what has a limit, with a point moved along one axis; "" if that makes no driveline.
   * @param {number} point
   * @param {number} axis
   * @param {number} by in mm
   */
  verdictAt(point, axis, by) {
    const size = byOf(this.changes, "point", point, axis) + by;
    try {
      const machine = this.#changed(changed(this.changes, "point", point, axis, tidy(size)));
      const found = [...machine.figures({ limited: true }), ...this.#resonance(this.#torsion(machine))];
      const ranks = found.map(({ ranks }) => this.#worst(ranks));
      return this.sent.verdicts.find((verdict) => ranks.includes(verdict)) ?? "not judged";
    } catch (error) {
      if (error instanceof CardanError) return "";
      throw error;
    }
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
    else if (this.#past.push({ changes: before, what, time }) > STEPS) this.#past.shift();
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
    this.take({});
  }

  /**
   * Find all figures, or those alone that have a limit, which takes less time. A machine that has none
   * gives way to the last one that had.
   * @param {boolean} whole
   */
  compute(whole = true) {
    try {
      const torsion = this.#torsion(this.machine);
      this.figures = [...this.machine.figures({ limited: !whole }), ...this.#resonance(torsion)];
      this.torsion = torsion;
    } catch (error) {
      this.#refuse(error, this.changes);
      ({ changes: this.changes, machine: this.machine } = this.#judged);
      return;
    }
    this.#judged = { changes: this.changes, machine: this.machine };
  }

  /** @param {import("../cardan.js").Machine} machine */
  #torsion(machine) {
    const { torsion } = this.sent;
    return torsion && torsionOf(machine, torsion, this.state);
  }

  /**
   * The distance of the nearest critical speed as a figure, if it has a limit.
   * @param {import("./torsion.js").Found | null} found
   * @returns {import("../cardan.js").Figure[]}
   */
  #resonance(found) {
    const limit = this.sent.torsion?.arguments.margin ?? null;
    if (!found || limit === null) return [];
    /** @type {import("../cardan.js").KindRow} */
    const kind = { name: "resonance", unit: "1", per: null, most: false, scope: "once" };
    const values = Float64Array.of(found.nearest < 0 ? NaN : found.away[found.nearest]);
    return [{ kind, item: null, values, ranks: [found.rank], limit, maximum: limit, worst: 0 }];
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
    return partOf(this.machine, name, this.state, item);
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
    return { value, text: quantityText(value, kinds[kind]), path };
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
    const text = (number) => quantityText(number, kind, bounds);
    const limit = found.limit * kind.factor;
    const item = of.item === null ? "" : of.item.toString();
    return {
      key: `${of.kind} ${item}`,
      name: of.name,
      text: text(value),
      bound: of.bound[units()],
      verdict: this.#worst(found.ranks),
      place: of.over || found.worst === null || isEven ? of.over : placeText(names[found.worst]),
      value,
      use: used(value, limit, found.kind.most),
      path: `check:${kind.path.replace("{}", item)}.value${kind.ending}`,
      source: `Limit ${of.limit[units()]}: ${of.source}`,
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
 * @param {unknown} a
 * @param {unknown} b
 */
const alike = (a, b) => JSON.stringify(a) === JSON.stringify(b);

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

/** @param {string} name of a state or step */
const placeText = (name) => (/^\p{L}/u.test(name) ? `in ${minus(name)}` : `in “${minus(name)}”`);

/**
 * One number of the drivelines of a machine.
 * @param {import("../cardan.js").Machine} machine
 * @param {"bends" | "lengths" | "positions"} name
 * @param {number} state
 * @param {number} item
 * @returns {number}
 */
function partOf(machine, name, state, item) {
  const values = machine.data[name];
  if (Array.isArray(values)) return values[state][item];
  return values[(state * values.length) / machine.states + item];
}
