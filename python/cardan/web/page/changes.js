// @ts-check
/**
 * Changes of a scene: as keys and numbers, as data of the machine, in words, in an
 * address, and in the text of the scene.
 *
 * @module changes
 */

import { asGiven, exact, folded, givenText, lengths, signed, signedLength, tidy } from "./numbers.js";

/**
 * Changes by key: `"point.2.y": -24`. Points, bearings and the engaged length of the
 * spline by so many mm and phases by so many degrees, in every state; ratings, torque and speed to a
 * value in the unit of the scene.
 * @typedef {Record<string, number>} Changes
 */

/** @typedef {import("./model.js").Sent} Sent */
/** @typedef {import("./model.js").Turn} Turn */

const AXES = "xyz";
/** Sizes that no driveline has, by their unit. */
const MOST = /** @type {Record<string, number>} */ ({ mm: 1e6, "N m": 1e7, rpm: 1e5, "rad/s": 1e4 });
const DEGREE = Math.PI / 180;

/**
 * The key of a change.
 * @param {string} variable
 * @param {number} item the point from the upstream end, the shaft of a phase, the bearing or the joint
 * @param {number | null} axis of a point
 */
const keyOf = (variable, item, axis) =>
  axis === null ? `${variable}.${item}` : `${variable}.${item}.${AXES[axis]}`;

/**
 * Everything that can be changed in a scene, by key, with what it is without a change.
 * @param {Sent} sent
 * @returns {Map<string, {variable: string, item: number, axis: number | null, own: number}>}
 */
export function changeable(sent) {
  /** @type {Map<string, {variable: string, item: number, axis: number | null, own: number}>} */
  const found = new Map();
  const { given, machine } = sent;
  const add = (/** @type {string} */ variable, /** @type {number} */ item, own = 0, /** @type {number | null} */ axis = null) =>
    found.set(keyOf(variable, item, axis), { variable, item, axis, own });
  if (given.points) sent.points.forEach((_, i) => [0, 1, 2].forEach((axis) => add("point", i, 0, axis)));
  for (let shaft = 1; shaft < machine.joints; shaft++) add("phase", shaft);
  given.bearings.forEach((_, i) => add("bearing", i));
  if (machine.engaged !== undefined) add("engaged", 0);
  (machine.ratings ?? []).forEach((/** @type {number} */ rating, /** @type {number} */ i) => add("rating", i, rating));
  if (given.torque) add("torque", 0, given.torque.value);
  if (given.speed) add("speed", 0, given.speed.value);
  return found;
}

/**
 * The largest size that a change may give something, which a scene may exceed.
 * @param {Sent} sent
 * @param {string} variable
 * @param {number} own what it is without a change
 */
export function mostOf({ given }, variable, own = 0) {
  const { torque, speed } = given;
  const unit = { torque: torque?.unit, speed: speed?.unit, rating: "N m", phase: "°" }[variable] ?? "mm";
  return Math.max(MOST[unit] ?? Infinity, Math.abs(own));
}

/**
 * Changes with one more, or without the one that is taken back.
 * @param {Changes} changes
 * @param {string} variable
 * @param {number} item
 * @param {number | null} axis
 * @param {number} value
 * @param {number} own what it is without a change
 * @returns {Changes}
 */
export function changed(changes, variable, item, axis, value, own = 0) {
  const { [keyOf(variable, item, axis)]: _, ...others } = changes;
  if (value !== own) others[keyOf(variable, item, axis)] = value;
  return Object.fromEntries(Object.entries(others).sort(([a], [b]) => (a < b ? -1 : 1)));
}

/**
 * By how much something has been changed.
 * @param {Changes} changes
 * @param {string} variable
 * @param {number} item
 * @param {number | null} axis
 */
export const byOf = (changes, variable, item, axis = null) => changes[keyOf(variable, item, axis)] ?? 0;

/**
 * By how much a point has been moved along each axis, in mm: in the drawing, or in a state, which may
 * turn it.
 * @param {Sent} sent
 * @param {Changes} changes
 * @param {number} point
 * @param {number} [state]
 */
export function moved(sent, changes, point, state) {
  const by = [0, 1, 2].map((axis) => byOf(changes, "point", point, axis));
  return (turnsOf(sent, point, state) ?? []).reduce((arm, { matrix }) => product(matrix, arm), by);
}

/**
 * Turns of a point in a state, one after another.
 * @param {Sent} sent
 * @param {number} point
 * @param {number} [state]
 */
export const turnsOf = (sent, point, state) =>
  state === undefined ? undefined : sent.given.turned[point]?.[state].turns;

/**
 * @param {number[][]} matrix
 * @param {number[]} vector
 */
const product = (matrix, [x, y, z]) => matrix.map((row) => row[0] * x + row[1] * y + row[2] * z);

/**
 * The points of a scene, in the unit of the scene, moved. What a state turns is moved before.
 * @param {Sent} sent
 * @param {Changes} changes
 * @param {number[][]} line
 * @param {number} [state]
 */
export function movedLine(sent, changes, line, state) {
  const millimetres = 1e3 * sent.machine.unit;
  return line.map((p, i) => {
    const by = moved(sent, changes, i);
    const add = (/** @type {number[]} */ to) => to.map((x, axis) => (by[axis] ? exact(x + by[axis] / millimetres) : x));
    const turns = turnsOf(sent, i, state);
    if (!turns?.length || !by.some(Boolean)) return add(p);
    const turn = (/** @type {number[]} */ at, /** @type {Turn} */ { about, matrix }) =>
      product(matrix, at.map((x, axis) => x - about[axis])).map((x, axis) => about[axis] + x);
    return turns.reduce(turn, add(sent.given.turned[i][state ?? 0].before));
  });
}

/**
 * The columns of the machine's data that are other than as sent, but for what follows from lengths.
 * @param {Sent} sent
 * @param {Changes} changes
 * @returns {import("../cardan.js").MachineData}
 */
export function dataOf(sent, changes) {
  const { machine, given } = sent;
  const has = (/** @type {string} */ variable) => Object.keys(changes).some((key) => key.startsWith(`${variable}.`));
  /** @type {import("../cardan.js").MachineData} */
  const data = {};
  if (has("point")) {
    data.points = machine.points.map((/** @type {number[][]} */ line, /** @type {number} */ state) =>
      movedLine(sent, changes, line, state),
    );
    data.drawn_points = [movedLine(sent, changes, machine.drawn_points[0])];
    if (machine.step_points) {
      data.step_points = machine.step_points.map((/** @type {number[][]} */ line, /** @type {number} */ step) =>
        movedLine(sent, changes, line, given.steps[step] ?? undefined),
      );
    }
  }
  if (has("phase")) {
    const turned = (/** @type {number} */ phase, /** @type {number} */ i) => {
      const by = byOf(changes, "phase", i + 1);
      return by ? DEGREE * exact(exact(phase / DEGREE) + by) : phase;
    };
    for (const name of ["phases", "step_phases", "drawn_phases"]) {
      if (machine[name]) data[name] = machine[name].map((/** @type {number[]} */ row) => row.map(turned));
    }
  }
  if (has("engaged")) data.engaged = 1e-3 * exact(1e3 * machine.engaged + byOf(changes, "engaged", 0));
  if (has("rating")) {
    data.ratings = machine.ratings.map(
      (/** @type {number} */ own, /** @type {number} */ i) => changes[keyOf("rating", i, null)] ?? own,
    );
  }
  for (const [name, load] of /** @type {[string, Sent["given"]["torque"]][]} */ ([
    ["torque", given.torque],
    ["speed", given.speed],
  ])) {
    const value = changes[keyOf(name, 0, null)];
    if (value === undefined || !load) continue;
    for (const column of load.columns) data[column] = machine[column].map(() => load.factor * value);
  }
  return data;
}

/**
 * Where the bearings are on their shafts, in m, if that is other than as sent.
 * @param {Sent} sent
 * @param {Changes} changes
 * @param {(state: number, shaft: number) => number} length of a shaft of what has moved
 * @returns {number[][] | null}
 */
export function positionsOf(sent, changes, length) {
  const { given, machine } = sent;
  const isMoved = (/** @type {number} */ i) => byOf(changes, "bearing", i) !== 0 || given.bearings[i].per < 0;
  if (!given.bearings.some((_, i) => isMoved(i))) return null;
  return machine.positions.map((/** @type {number[]} */ row, /** @type {number} */ state) =>
    row.map((own, i) => {
      if (!isMoved(i)) return own;
      const { value, factor, per } = given.bearings[i];
      const at = factor * exact(value + per * byOf(changes, "bearing", i));
      return per < 0 ? length(state, machine.bearings[i]) - at : at;
    }),
  );
}

/**
 * Changes in words, each with the changes that are left without it.
 * @param {Sent} sent
 * @param {Changes} changes
 * @returns {{words: string, without: Changes}[]}
 */
export function listed(sent, changes) {
  const known = changeable(sent);
  return Object.entries(changes).map(([key, value]) => {
    const { [key]: _, ...without } = changes;
    const { variable, item, axis } = /** @type {{variable: string, item: number, axis: number | null}} */ (known.get(key));
    return { words: wordsOf(sent, variable, item, axis, value), without };
  });
}

/** @param {Sent} sent @param {string} variable @param {number} item @param {number | null} axis @param {number} value */
function wordsOf({ points, kinds, given, torques }, variable, item, axis, value) {
  const { unit } = lengths();
  if (variable === "point") return `${points[item]} ${AXES[axis ?? 0]} ${signedLength(value)} ${unit}`;
  if (variable === "phase") return `phase of shaft ${item} ${signed(value)}°`;
  if (variable === "bearing") return `bearing ${item} ${signedLength(value)} ${unit}`;
  if (variable === "engaged") return `${kinds.spline_engaged.label} ${signedLength(value)} ${unit}`;
  if (variable === "rating") return `joint ${item} ${givenText(value, torques)}`;
  return `${variable} ${givenText(value, (variable === "torque" ? given.torque : given.speed) ?? torques)}`;
}

/**
 * The part of an address behind #.
 * @param {Sent} sent
 * @param {Changes} changes
 * @param {number} state that is shown
 */
export function addressOf(sent, changes, state) {
  const words = Object.entries(changes).map(([key, value]) => [key, String(value)]);
  if (state !== sent.drawn) words.push(["state", sent.states[state]]);
  return new URLSearchParams(words).toString();
}

/**
 * Changes and state of an address; a mistake in it is an error in words.
 * @param {Sent} sent
 * @param {string} address behind its #
 * @returns {{changes: Changes, state: number}}
 */
export function readAddress(sent, address) {
  const known = changeable(sent);
  /** @type {Changes} */
  let changes = {};
  let state = sent.drawn;
  new URLSearchParams(address).forEach((text, key) => {
    if (key === "state") {
      state = sent.states.indexOf(text);
      if (state < 0) throw new Error(`this scene has no state “${text}”`);
      return;
    }
    const found = known.get(key);
    if (!found) throw new Error(`this scene has nothing called “${key}”`);
    const value = text.trim() ? Number(text) : NaN;
    if (!Number.isFinite(value)) throw new Error(`“${text}”, for ${key}, is no number`);
    const { variable, item, axis, own } = found;
    if (Math.abs(value) > mostOf(sent, variable, own)) {
      throw new Error(`“${text}”, for ${key}, is more than any driveline has`);
    }
    const isTurn = variable === "phase";
    changes = changed(changes, variable, item, axis, isTurn ? tidy(folded(value, 360)) : value, own);
  });
  return { changes, state };
}

/**
 * The text of the scene with what has been changed; what it has no place for is an error in words.
 * @param {Sent} sent
 * @param {Changes} changes
 */
export function textOf(sent, changes) {
  const { text, pieces, sizes } = sent.source;
  const left = new Set(Object.keys(changes));
  let [found, at] = ["", 0];
  for (const piece of pieces) {
    const numbers = piece.numbers.map(({ variable, item, axis, ...place }) => ({
      ...place,
      variable,
      key: keyOf(variable, item, axis),
      per: perOf(sent, variable, item),
    }));
    if (!numbers.some(({ key }) => key in changes)) continue;
    let [own, end] = ["", 0];
    for (const { key, variable, per, size, start, end: next } of numbers) {
      const given = piece.text.slice(start, next);
      left.delete(key);
      own += piece.text.slice(end, start);
      if (!(key in changes)) own += given;
      else if (variable === "rating") own += sizes[asGiven(changes[key])];
      else own += exact((per ? Number(given.replace(/_/g, "")) : 0) + ((per || 1) * changes[key]) / size);
      end = next;
    }
    found += text.slice(at, piece.start) + own + piece.text.slice(end);
    at = piece.end;
  }
  if (left.size) {
    const words = listed(sent, Object.fromEntries([...left].map((key) => [key, changes[key]])));
    throw new Error(`The scene has no number for this: ${words.map((each) => each.words).join(", ")}.`);
  }
  return found + text.slice(at);
}

/**
 * By how much a number of the scene changes with a unit of the change; 0 of what is set to a value.
 * @param {Sent} sent
 * @param {string} variable
 * @param {number} item
 */
function perOf({ given, machine }, variable, item) {
  if (variable === "point") return 1e-3 / machine.unit;
  if (variable === "bearing") return given.bearings[item].per;
  return variable === "phase" || variable === "engaged" ? 1 : 0;
}
