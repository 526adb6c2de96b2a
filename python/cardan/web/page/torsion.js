// @ts-check
/**
 * Natural frequencies of the driveline of the drawing and the critical speeds of orders: what the core
 * says of them, and a table and a Campbell diagram of it.
 *
 * @module torsion
 */

import { Chart } from "./charts.js";
import { made, say } from "./elements.js";
import { asGiven, quantityText } from "./numbers.js";
import { newMark } from "./panel.js";

/** In shares of the highest natural frequency: how far lines of orders and the axis go. */
const [RAYS, ROOM] = [1.12, 1.25];
/** In shares of the largest speed of the range: how far the axis goes, and to how far a critical speed. */
const [BEYOND, FAR] = [1.05, 2];
/** Where the names of natural frequencies are, in shares of the axis. */
const NAMED = 0.88;
const MINUTE = 60; // s
/** Lines of one colour, by how many there are before. */
const DASHES = ["", " second", " third"];
const OVER = "drive speed [rpm]";

/** @typedef {import("./numbers.js").Measured & {factor: number}} Quantity */

/**
 * Data that Python sends.
 * @typedef {object} SentTorsion
 * @property {Record<string, any>} arguments of the core's function, inertias without those of tubes
 * @property {boolean} is_loaded whether the load torque is that of the load, which is the same in all states
 * @property {number[]} springs shafts with the stiffness of their tube
 * @property {number[]} shear_modulus of the tubes in Pa
 * @property {Quantity} frequency
 * @property {Quantity} speed
 * @property {Quantity} away
 */

/**
 * Results of the core; of critical speeds those of every mode for one order after the other.
 * @typedef {object} Found
 * @property {number[]} frequencies in rad/s
 * @property {number[]} shafts that are twisted most
 * @property {number[]} speeds in rad/s
 * @property {number[]} away how far the range of speeds is from each, in shares of it
 * @property {number} nearest of them to the range; −1 for none
 * @property {string} rank of this distance
 * @property {number} at the speed at hand in rad/s; 0 for none
 * @property {number[]} away_now how far it is from each
 * @property {number} nearest_now
 */

/**
 * Natural frequencies and critical speeds of a machine.
 * @param {import("../cardan.js").Machine} machine
 * @param {SentTorsion} sent
 * @param {number} state whose speed counts
 * @returns {Found}
 */
export function torsionOf(machine, sent, state) {
  const { data } = machine;
  const inertias = sent.arguments.inertias.map((/** @type {number[]} */ ends) => [...ends]);
  const stiffnesses = [...sent.arguments.stiffnesses];
  const tubes = Array.from(/** @type {ArrayLike<number>} */ (data.tubes ?? []));
  if (tubes.length) {
    const lengths = Array.from(data.drawn_lengths ?? []).flat();
    const length = tubes.map((shaft, i) => data.tube_length?.[i] ?? lengths[shaft]);
    const found = machine.call("tubes", { shear_modulus: sent.shear_modulus, length });
    tubes.forEach((shaft, i) => {
      inertias[shaft] = inertias[shaft].map((/** @type {number} */ end) => end + 0.5 * found.inertia[i]);
      if (sent.springs.includes(shaft)) stiffnesses[shaft] = found.stiffness[i];
    });
  }
  const at = data.speed?.[state] ?? 0;
  const { drawn_bends: bends, drawn_twists: twists, drawn_phases: phases } = data;
  const told = machine.call("torsion", {
    ...sent.arguments,
    ...{ bends, twists, phases, inertias, stiffnesses },
    ...(sent.is_loaded ? { load_torque: data.torque[0] } : {}),
    speed: at > 0 ? at : null,
  });
  const list = (/** @type {string} */ name) => Array.from(/** @type {ArrayLike<number>} */ (told[name]));
  return {
    frequencies: list("frequencies"),
    shafts: list("shafts"),
    speeds: list("speeds"),
    away: list("away"),
    nearest: told.nearest[0],
    rank: told.rank[0],
    at,
    away_now: list("away_now"),
    nearest_now: told.nearest_now[0],
  };
}

/**
 * A cell of the table: a figure of the check and words behind it.
 * @param {Element} row
 * @param {string} path
 */
function newCell(row, path) {
  const own = made("td", "", row);
  const figure = made("b", "", own);
  figure.dataset.path = `check:torsion.${path}`;
  return { own, figure, words: made("small", "", own) };
}

/**
 * Show a figure.
 * @param {HTMLElement} element
 * @param {number} value in the unit that is shown
 * @param {string} text
 */
function put(element, value, text) {
  say(element, text);
  element.dataset.value = String(value);
}

/**
 * A sentence with a figure in it.
 * @param {Element} parent
 * @param {string} path
 */
function newSentence(parent, path) {
  const [before, figure, behind] = [made("span", "", parent), made("b", "", parent), made("span", "", parent)];
  figure.dataset.path = path;
  return { before, figure, behind };
}

/**
 * The table, a row for each order and a column for each mode, and what fills it.
 * @param {Element} parent
 * @param {SentTorsion} sent
 * @param {number} count of modes
 */
function newTable(parent, { arguments: { orders, excited }, frequency, speed }, count) {
  const table = made("table", "", made("div", "scroll", parent));
  const modes = Array.from({ length: count }, (_, mode) => mode);
  const row = (/** @type {string} */ name, /** @type {string} */ kind, /** @type {string[]} */ paths) => {
    const own = made("tr", kind, table);
    made("th", "", own, name).setAttribute("scope", "row");
    return paths.map((path) => newCell(own, path));
  };
  const first = row("natural frequency", "", modes.map((mode) => `modes[mode=${mode}].frequency_Hz`));
  const second = row("shaft twisted most", "", modes.map((mode) => `modes[mode=${mode}].shaft`));
  const critical = orders.flatMap((/** @type {number} */ order, /** @type {number} */ i) => {
    const [name, kind] = excited[i] ? ["", ""] : [", not excited", "idle"];
    return row(`order ${asGiven(order)}${name}`, kind, modes.map((mode) => `critical_speeds[${i * count + mode}].speed_rpm`));
  });
  return (/** @type {Found} */ { frequencies, shafts, speeds, away }) => {
    first.forEach(({ figure }, mode) => put(figure, ...told(frequencies[mode], frequency)));
    second.forEach(({ figure }, mode) => put(figure, shafts[mode], String(shafts[mode])));
    critical.forEach((/** @type {ReturnType<newCell>} */ { own, figure, words }, /** @type {number} */ place) => {
      put(figure, ...told(speeds[place], speed));
      own.classList.toggle("inside", away[place] === 0);
      say(words, away[place] === 0 ? " in the range" : "");
    });
  };
}

/**
 * A value in the unit that is shown, and its text.
 * @param {number} inside in SI units
 * @param {Quantity} of
 * @returns {[number, string]}
 */
const told = (inside, of) => [inside * of.factor, quantityText(inside * of.factor, of)];

/**
 * Show natural frequencies and critical speeds in an element, if the scene has any.
 * @param {HTMLElement} element
 * @param {import("./model.js").Model} model
 * @returns {(isWhole: boolean) => void} shows them as they are; during a drag axes grow only
 */
export function torsionCard(element, model) {
  const { torsion: sent, states } = model.sent;
  const former = model.torsion;
  element.hidden = !sent;
  if (!sent || !former) return () => {};
  const { orders, range: [low, high] } = sent.arguments;
  const head = made("div", "top", element);
  made("h3", "", head, "Natural frequencies and critical speeds");
  made("span", "of", head, states.length > 1 ? "of the driveline in [driveline]" : "");
  const parts = made("div", "parts", element);
  const picture = made("div", "", parts);
  const chart = new Chart(picture, { heading: "Campbell diagram", unit: sent.frequency.unit, over: OVER });
  const words = made("div", "", parts);
  const fill = newTable(words, sent, former.frequencies.length);
  const judged = made("p", "judged", words);
  const mark = newMark(judged);
  const beside = newSentence(made("span", "", judged), "check:torsion.margin.value_percent");
  const now = newSentence(made("p", "", words), "derived:");

  /** @param {Found} found */
  const tell = (found) => {
    const speed = (/** @type {number} */ inside) => told(inside, sent.speed)[1];
    const own = model.rows().find((row) => row.key.startsWith("resonance "));
    const met = (/** @type {number} */ place) =>
      `order ${asGiven(orders[Math.floor(place / found.frequencies.length)])} at ${speed(found.speeds[place])}, `;
    mark(own?.verdict ?? "not judged");
    judged.classList.toggle("unlimited", !own);
    const { nearest, nearest_now: next } = found;
    if (nearest < 0) {
      say(beside.before, "No order that joints or torques excite is listed.");
      return;
    }
    const [value, text] = told(found.away[nearest], sent.away);
    say(beside.before, `Nearest to the range from ${speed(low)} to ${speed(high)}: ${met(nearest)}`);
    put(beside.figure, value, own?.text ?? text);
    say(beside.behind, ` away${own ? ` (${own.bound})` : ""}.`);
    if (next < 0) return;
    say(now.before, `Nearest to ${speed(found.at)}, the speed at hand: ${met(next)}`);
    put(now.figure, ...told(found.away_now[next], sent.away));
    say(now.behind, " away.");
  };

  const show = (/** @type {boolean} */ isWhole) => {
    const found = model.torsion;
    if (!found) return;
    fill(found);
    tell(found);
    draw(chart, sent, found, model.isDrawn ? null : former, !isWhole);
  };
  chart.follow(picture, () => show(true));
  return show;
}

/**
 * The Campbell diagram: natural frequencies over the speed, lines of the orders, the range of speeds, and
 * the speed at hand.
 * @param {Chart} chart
 * @param {SentTorsion} sent
 * @param {Found} found
 * @param {Found | null} former what was sent, where something has moved
 * @param {boolean} isGrowing
 */
function draw(chart, { arguments: { orders, excited, range }, frequency, speed }, found, former, isGrowing) {
  const [low, high] = range.map((/** @type {number} */ end) => end * speed.factor);
  const hertz = (/** @type {Found} */ of) => of.frequencies.map((each) => each * frequency.factor);
  const frequencies = hertz(found);
  const at = found.at * speed.factor;
  const critical = found.speeds.map((each) => each * speed.factor);
  const isExcited = (/** @type {number} */ place) => excited[Math.floor(place / frequencies.length)];
  const near = critical.filter((each, place) => isExcited(place) && each < FAR * high);
  const right = BEYOND * Math.max(high, at, ...near);
  const top = Math.max(...frequencies, ...(former ? hertz(former) : []));
  // Lines of orders end above all natural frequencies or at the right.
  const ends = orders.map((/** @type {number} */ order) => Math.min((MINUTE * RAYS * top) / order, right));
  const x = [...new Set([0, ...ends, NAMED * right, right])].sort((a, b) => a - b);
  const level = (/** @type {number} */ value) => x.map(() => value);
  const modes = frequencies.map((value, mode) => {
    const shaft = found.shafts[mode];
    const alike = found.shafts.slice(0, mode).filter((other) => other % 4 === shaft % 4).length;
    const text = quantityText(value, frequency);
    const figure = { text, path: "derived:", value };
    const kind = `s${shaft % 4}${DASHES[alike % DASHES.length]}`;
    const label = `mostly twist of shaft ${shaft}`;
    return { label, kind, mark: text, marked: x.indexOf(NAMED * right), values: level(value), figure };
  });
  const rays = orders.map((/** @type {number} */ order, /** @type {number} */ i) => ({
    label: `order ${asGiven(order)}`,
    kind: excited[i] ? "ray" : "ray idle",
    mark: asGiven(order),
    marked: x.indexOf(ends[i]),
    values: x.map((each) => (each <= ends[i] ? (order * each) / MINUTE : null)),
  }));
  const dots = critical.flatMap((each, place) => {
    const kind = isExcited(place) ? (found.away[place] === 0 ? "met inside" : "met") : "";
    return kind && each <= right ? [{ x: each, y: frequencies[place % frequencies.length], kind }] : [];
  });
  const ghosts = former ? hertz(former).map(level) : [];
  chart.mark(at > 0 ? at : Infinity);
  chart.draw({ x, curves: [...modes, ...rays], ghosts, holds: [0, ROOM * top], span: [low, high], dots }, isGrowing);
}
