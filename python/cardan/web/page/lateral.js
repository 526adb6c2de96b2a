// @ts-check
/**
 * Lateral vibration of the driveline of the drawing: what the core says of the first resonance of shafts
 * on elastic bearings, and the forces of the bearings over the speed.
 *
 * @module lateral
 */

import { CardanError } from "../cardan.js";
import { Chart } from "./charts.js";
import { made, say } from "./elements.js";
import { asGiven, quantityText } from "./numbers.js";
import { Shape } from "./shape.js";

/** Drive angles at which moments are taken apart into orders. */
const ANGLES = Array.from({ length: 96 }, (_, i) => (2 * Math.PI * i) / 96);
/** Speeds of the chart, and those around a resonance in shares of it. */
const [STEPS, AROUND] = [120, Array.from({ length: 97 }, (_, i) => 1 + 0.0025 * (i - 48))];
/** In shares of a resonance: how far its peak reaches, and the band of one whose damping is not known. */
const [REACH, BAND] = [0.12 + 1e-9, 0.16];
/** Natural frequencies nearer to each other are those of one shape. */
const ALIKE = 1.02;
/** How far beside the range the first resonance is still drawn. */
const ROOM = 1.15;
/** The largest moments of an order that rounding leaves, as a share of all. */
const ROUNDING = 1e-9;
/** Places of a shaft of which the motion is shown, in shares of its length. */
const PLACES = Array.from({ length: 13 }, (_, i) => i / 12);
const CLEARLY = 1.5;
const COUNT = 8; // natural frequencies
const OVER = "drive speed [rpm]";

/** @typedef {import("./numbers.js").Measured & {factor: number}} Quantity */

/**
 * Data that Python sends.
 * @typedef {object} SentLateral
 * @property {Record<string, any>} arguments of the core's function, which do not follow from the driveline
 * @property {number[]} elastic the bearings of the scene that are elastic
 * @property {Record<"of_masses" | "of_unbalances", boolean[]>} from_end whether positions are from the downstream end
 * @property {number[]} orders
 * @property {boolean[][]} known of each shape whether the damping of order 1 is known, and that of others
 * @property {[number, number]} range of speeds in rad/s
 * @property {Quantity} frequency
 * @property {Quantity} speed
 * @property {Quantity} force
 * @property {Quantity} moved
 */

/**
 * The resonance of an order with the largest force, or the first one where no force is known.
 * @typedef {object} Resonance
 * @property {number} order
 * @property {number} frequency in rad/s
 * @property {number} speed in rad/s at which the order meets it
 * @property {boolean} known whether its damping is
 * @property {number} at the speed of the peak in rad/s, NaN without a peak in the range
 * @property {number} bearing with the largest force of this order
 * @property {number} force in N
 * @property {number} moved in m
 */

/**
 * Results of the core.
 * @typedef {object} Found
 * @property {Resonance[]} resonances one of each order that joints or unbalances excite
 * @property {number[]} speeds in rad/s
 * @property {number[][][]} forces in N, by order and bearing; NaN where the damping is not known
 * @property {{places: import("./shape.js").Place[], bearings: import("./shape.js").Place[], of: Resonance} | null} shape
 *   at the peak with the largest force
 */

/**
 * The moments of all joints by order, without and with the square of the speed.
 * @param {import("../cardan.js").Machine} machine of one state
 * @param {number[]} orders
 * @returns {{re: number[], im: number[]}} in N m, `(orders, joints, 3)`
 */
function momentsOf(machine, orders) {
  const { moment } = machine.evaluate({ outputs: ["moment"], angles: ANGLES });
  const [re, im] = [/** @type {number[]} */ ([]), /** @type {number[]} */ ([])];
  for (const order of orders) {
    const scale = (order ? 2 : 1) / ANGLES.length;
    for (const [planes] of moment) {
      for (const plane of planes) {
        const sum = (/** @type {(x: number) => number} */ of) =>
          ANGLES.reduce((all, angle, i) => all + plane[i] * of(order * angle), 0) * scale;
        re.push(sum(Math.cos));
        im.push(-sum(Math.sin));
      }
    }
  }
  return { re, im };
}

/**
 * The first resonances and the forces over the speed.
 * @param {import("../cardan.js").Machine} machine
 * @param {SentLateral} sent
 * @param {number} state
 * @returns {Found}
 */
export function lateralOf(machine, sent, state) {
  const own = machine.only(state);
  const { orders, range: [low, high] } = sent;
  const lengths = Array.from(/** @type {ArrayLike<number>} */ (own.data.lengths)).flat();
  const positions = Array.from(/** @type {ArrayLike<number>} */ (own.data.positions)).flat();
  const given = { ...sent.arguments };
  given.of_elastic = given.of_elastic.map((/** @type {number[]} */ [, ...rest], /** @type {number} */ i) =>
    [positions[sent.elastic[i]], ...rest]);
  for (const [name, shafts] of [["of_masses", given.mass_shafts], ["of_unbalances", given.unbalance_shafts]]) {
    given[name] = given[name].map((/** @type {number[]} */ [at, ...rest], /** @type {number} */ i) =>
      [sent.from_end[/** @type {"of_masses"} */ (name)][i] ? lengths[shafts[i]] - at : at, ...rest]);
  }
  // The torques of inertias grow with the square of the speed.
  const torque = momentsOf(own.with({ speed: [0] }), orders);
  const unit = (own.data.inertias ?? []).length
    ? momentsOf(own.with({ torque: [0], speed: [1] }), orders)
    : { re: torque.re.map(() => 0), im: torque.im.map(() => 0) };
  /**
   * @param {number} count of natural frequencies
   * @param {number[]} speeds
   * @param {[number, number][]} probes shaft and position of each
   */
  const call = (count, speeds, probes = []) => {
    const of = (/** @type {"re" | "im"} */ part) =>
      speeds.flatMap((speed) => torque[part].map((x, i) => x + speed * speed * unit[part][i]));
    const [probe_shafts, probe_positions] = [0, 1].map((i) => probes.map((probe) => probe[i]));
    const moments = { moments_re: of("re"), moments_im: of("im") };
    return own.call("lateral", { ...given, ...moments, lengths, count, speeds, orders, probe_shafts, probe_positions });
  };
  const { frequencies } = call(COUNT, []);
  const each = torque.re.length / orders.length;
  const size = orders.map((_, k) => Math.hypot(...[torque, unit].flatMap(({ re, im }) =>
    [...re.slice(k * each, (k + 1) * each), ...im.slice(k * each, (k + 1) * each)])));
  const most = Math.max(...size);
  const excited = orders.map((order, k) => size[k] > ROUNDING * most || (order === 1 && given.unbalance_shafts.length > 0));
  // Natural frequencies of one shape in two directions belong together.
  /** @type {number[]} */
  const shapes = [];
  for (const frequency of frequencies) {
    if (Number.isFinite(frequency) && !(frequency < ALIKE * shapes[shapes.length - 1])) shapes.push(frequency);
  }
  const met = orders.map((order) => shapes.map((frequency, mode) =>
    ({ order, frequency, speed: frequency / order, known: sent.known[mode]?.[order > 1 ? 1 : 0] ?? false })));
  const near = met.flat().flatMap(({ order, speed }) =>
    (excited[orders.indexOf(order)] ? AROUND.map((share) => share * speed) : []));
  const even = Array.from({ length: STEPS + 1 }, (_, i) => low + ((high - low) * i) / STEPS);
  const speeds = [...even, ...near].filter((x) => low <= x && x <= high).sort((a, b) => a - b);
  const told = call(0, speeds);
  const bearings = sent.elastic.length;
  // Near a resonance whose damping is not known there is no peak.
  const isKnown = orders.map((_, k) => speeds.map((speed) =>
    !excited[k] || met[k].every((one) => one.known || Math.abs(speed / one.speed - 1) > BAND)));
  const over = (/** @type {Float64Array} */ flat) => orders.map((_, k) =>
    sent.elastic.map((_, b) => speeds.map((_, i) => (isKnown[k][i] ? flat[(i * orders.length + k) * bearings + b] : NaN))));
  const [forces, moved] = [over(told.forces), over(told.displacements)];
  const resonances = orders.flatMap((_, k) => {
    if (!excited[k] || !met[k].length) return [];
    const [first] = met[k];
    let found = { ...first, at: NaN, bearing: sent.elastic[0], force: 0, moved: 0 };
    speeds.forEach((speed, i) => {
      const [one] = [...met[k]].sort((x, y) => Math.abs(speed / x.speed - 1) - Math.abs(speed / y.speed - 1));
      if (Math.abs(speed / one.speed - 1) > REACH) return;
      forces[k].forEach((values, b) => {
        if (!(values[i] > found.force)) return;
        found = { ...one, at: speed, bearing: sent.elastic[b], force: values[i], moved: moved[k][b][i] };
      });
    });
    return [found];
  });
  const peak = resonances.reduce((best, each) => (each.force > best.force ? each : best), resonances[0]);
  if (!peak || !peak.force) return { resonances, speeds, forces, shape: null };
  const directions = Array.from(/** @type {ArrayLike<number>} */ (own.data.directions)).flat();
  const starts = [[0, 0, 0]];
  lengths.forEach((length, shaft) => {
    starts.push(starts[shaft].map((x, i) => x + length * directions[3 * shaft + i]));
  });
  const along = lengths.flatMap((length, shaft) =>
    PLACES.map((share) => /** @type {[number, number]} */ ([shaft, share * length])));
  const held = sent.elastic.map((bearing, i) =>
    /** @type {[number, number]} */ ([given.elastic_shafts[i], positions[bearing]]));
  const { probes_re, probes_im } = call(0, [peak.at], [...along, ...held]);
  const first_of = 3 * orders.indexOf(peak.order) * (along.length + held.length);
  const all = [...along, ...held].map(([shaft, position], i) => {
    const [re, im] = [probes_re, probes_im].map((flat) => Array.from(flat.slice(first_of + 3 * i, first_of + 3 * i + 3)));
    return { at: starts[shaft].map((x, k) => x + position * directions[3 * shaft + k]), re, im, shaft };
  });
  const shape = { places: all.slice(0, along.length), bearings: all.slice(along.length), of: peak };
  return { resonances, speeds, forces, shape };
}

/**
 * Show the first resonance and the forces in an element, if the scene has elastic bearings.
 * @param {HTMLElement} element
 * @param {import("./model.js").Model} model
 * @returns {(isWhole: boolean) => void} shows them as they are; during a drag axes grow only
 */
export function lateralCard(element, model) {
  const { lateral: sent, states } = model.sent;
  element.hidden = !sent;
  if (!sent) return () => {};
  const head = made("div", "top", element);
  made("h3", "", head, "Lateral vibration");
  const place = made("span", "of", head);
  const parts = made("div", "parts", element);
  const picture = made("div", "", parts);
  const chart = new Chart(picture, { heading: "Largest force of each order", unit: sent.force.unit, over: OVER });
  const words = made("div", "", parts);
  words.setAttribute("role", "status");
  const shape = new Shape(element);
  const drawn = /** @type {Map<number, Found>} */ (new Map());
  const told = (/** @type {number} */ inside, /** @type {Quantity} */ of) => quantityText(inside * of.factor, of);

  /** @param {Found} found */
  const tell = ({ resonances }) => {
    words.replaceChildren();
    const [low, high] = sent.range;
    if (!resonances.length) return void made("p", "", words, "Nothing excites these shafts.");
    made("p", "", words, `The speeds are ${told(low, sent.speed)} to ${told(high, sent.speed)}.`);
    for (const { order, frequency, speed, known, at, bearing, force, moved } of resonances) {
      const line = made("p", "", words);
      made("span", "", line, `Order ${asGiven(order)} meets ${told(frequency, sent.frequency)} at `);
      const figure = made("b", "", line, told(speed, sent.speed));
      figure.dataset.path = "derived:";
      figure.dataset.value = String(speed * sent.speed.factor);
      if (!Number.isNaN(at)) {
        made("span", "", line, `. Bearing ${bearing} bears up to `);
        const size = made("b", "", line, told(force, sent.force));
        size.dataset.path = "derived:";
        size.dataset.value = String(force * sent.force.factor);
        made("span", "", line, ` at ${told(at, sent.speed)} and moves ${told(moved, sent.moved)}.`);
      } else if (speed < low || speed > high) made("span", "", line, ", outside the speeds.");
      else if (!known) made("span", "", line, ". Its damping is not known well enough for a force.");
      else made("span", "", line, ".");
    }
  };

  /** @param {Found} found @param {Found | undefined} former @param {boolean} isGrowing */
  const draw = (found, former, isGrowing) => {
    const x = found.speeds.map((speed) => speed * sent.speed.factor);
    const shown = found.resonances.map(({ order }) => sent.orders.indexOf(order));
    const newton = (/** @type {Found} */ of, /** @type {number} */ k, /** @type {number} */ b) =>
      of.forces[k][b].map((value) => value * sent.force.factor);
    const curves = shown.flatMap((k) => sent.elastic.map((bearing, b) => {
      const values = newton(found, k, b);
      const most = values.reduce((best, value, i) => (value > (values[best] ?? -1) || Number.isNaN(values[best]) ? i : best), 0);
      const text = told(found.forces[k][b][most], sent.force);
      const figure = { text, path: "derived:", value: values[most] };
      const label = `order ${asGiven(sent.orders[k])}, bearing ${bearing}`;
      return { label, kind: `s${k % 4}`, mark: text, marked: most, values: values.map(orGap), figure };
    }));
    const top = ROOM * Math.max(...curves.map(({ figure }) => figure.value));
    // What was sent stands at its own speeds.
    const ghosts = former ? shown.flatMap((k) => sent.elastic.map((_, b) => at(former, newton(former, k, b), found.speeds).map(orGap))) : [];
    chart.draw({ x, curves, ghosts, holds: [0, top] }, isGrowing);
  };

  /** @param {Found["shape"]} found */
  const swing = (found) => {
    shape.figure.hidden = !found;
    if (!found) return;
    // In the side view, unless much more is to be seen from above.
    const size = (/** @type {{down: number[]}} */ { down }) => Math.max(...found.places.map(({ re, im }) =>
      Math.hypot(...[re, im].map((part) => part.reduce((sum, x, i) => sum + x * down[i], 0)))));
    const view = model.sent.views.reduce((best, each) => (size(each) > CLEARLY * size(best) ? each : best));
    const { order, at } = found.of;
    shape.show(found.places, found.bearings, view, `Order ${asGiven(order)} at ${told(at, sent.speed)}. ${view.name}`);
  };

  const show = (/** @type {boolean} */ isWhole) => {
    const { state } = model;
    const where = states.length > 1 ? states[state] : "";
    say(place, where);
    try {
      if (!drawn.has(state)) drawn.set(state, lateralOf(model.drawnMachine, sent, state));
      const found = lateralOf(model.machine, sent, state);
      tell(found);
      swing(found.shape);
      draw(found, model.isDrawn ? undefined : drawn.get(state), !isWhole);
    } catch (error) {
      if (!(error instanceof CardanError)) throw error;
      words.replaceChildren(made("p", "", words, error.message));
    }
  };
  chart.follow(picture, () => show(true));
  return show;
}

/**
 * Unknown values are gaps.
 * @param {number} value
 */
const orGap = (value) => (Number.isNaN(value) ? null : value);

/**
 * Values at other speeds, by straight lines between their own.
 * @param {Found} found
 * @param {number[]} values
 * @param {number[]} speeds
 */
function at({ speeds: own }, values, speeds) {
  return speeds.map((speed) => {
    const next = Math.min(Math.max(own.findIndex((each) => each >= speed), 1), own.length - 1);
    const step = own[next] - own[next - 1];
    const share = step > 0 ? Math.min(Math.max((speed - own[next - 1]) / step, 0), 1) : 0;
    return values[next - 1] + share * (values[next] - values[next - 1]);
  });
}
