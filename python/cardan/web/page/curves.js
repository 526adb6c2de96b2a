// @ts-check
/**
 * Accelerations, torques and bearing forces over the turn in the state that is shown.
 *
 * @module curves
 */

import { Chart } from "./charts.js";
import { formOf, minus, numberText, units } from "./numbers.js";
import { briefly, made } from "./elements.js";
import { copy } from "./sharing.js";

const STEP = 3; // degrees between samples
const HALF = Array.from({ length: 180 / STEP }, (_, i) => i * STEP);
const TURN = Array.from({ length: 360 / STEP + 1 }, (_, i) => i * STEP);
const ANGLES = HALF.map((angle) => (angle * Math.PI) / 180);
const OVER = "drive angle [deg]";
/** Lines of one colour, by how many there are before. */
const DASHES = ["", " second", " third"];
/** What varies by less than this share of its size is text. */
const STEADY = 0.01;
/** What joints leave of each other's motions below this is rounding, and of loads below that. */
const [CANCELLED, ROUNDING] = [1e-12, 1e-9];
/** A torque is drawn over a tenth of its size at least, above and below. */
const ROOM = 0.1;

/**
 * One chart as Python sends it: its items with their names and, for every state, the place of the
 * largest in an answer.
 * @typedef {object} SentCurves
 * @property {"acceleration_ratio" | "torque" | "bearing_force"} output
 * @property {string} heading
 * @property {string} unit
 * @property {import("./numbers.js").Digits} digits
 * @property {import("./numbers.js").Form | null} us the US unit in its place
 * @property {string} [bounded] the kind of figure whose limit is drawn
 * @property {{number: number, name: string, shaft: number, paths: string[]}[]} items
 */

/** Charts over the turn, with what they show as text for other programs. */
export class Curves {
  /** Whether they are in sight. */
  #isSeen = true;
  /** Curves of the scene as sent, by state. */
  #drawn = /** @type {Map<number, number[][][]>} */ (new Map());
  #now = /** @type {number[][][]} */ ([]);
  /** The units of the charts, and what makes these anew. */
  #units = units();
  #begin = () => {};

  /**
   * @param {HTMLElement} element
   * @param {import("./model.js").Model} model
   * @param {(degrees: number) => void} turned called with the drive angle that is pointed at
   */
  constructor(element, model, turned) {
    this.model = model;
    this.sent = model.sent.curves;
    const head = made("div", "top", element);
    made("h3", "", head, "Curves over the turn");
    this.of = made("span", "of", head);
    const button = made("button", "", head, "Copy as CSV");
    button.setAttribute("type", "button");
    const grid = made("div", "three", element);
    this.charts = /** @type {Chart[]} */ ([]);
    this.#begin = () => {
      grid.replaceChildren();
      this.#units = units();
      this.charts = this.sent.map((own) => {
        const { unit } = formOf(own);
        return new Chart(grid, { heading: own.heading, unit, over: OVER }, turned);
      });
    };
    this.#begin();
    const said = made("span", "", head);
    said.setAttribute("role", "status");
    button.addEventListener("click", async () => {
      briefly(said, (await copy(this.csv())) ? "copied" : "the browser does not copy");
    });
    let width = 0;
    // A size that is set while sizes are observed would be observed again.
    const fit = () => requestAnimationFrame(() => {
      if (grid.clientWidth === width) return;
      width = grid.clientWidth;
      for (const chart of this.charts) chart.fit();
      this.show(true);
    });
    new ResizeObserver(fit).observe(grid);
    new IntersectionObserver(([seen]) => (this.#isSeen = seen.isIntersecting)).observe(grid);
    element.hidden = !this.sent.length;
  }

  /**
   * Values of all curves, by chart and item over half a turn.
   * @param {import("../cardan.js").Machine} machine of one state
   */
  #evaluated(machine) {
    const outputs = this.sent.map(({ output }) => output);
    if (!outputs.length) return [];
    const found = machine.evaluate({ outputs, angles: ANGLES });
    return this.sent.map((own) =>
      own.items.map(({ number }) => {
        const [x, y, z] = found[own.output][number][0];
        const factor = factorOf(own, machine);
        return Array.from(x, (value, i) => (y ? Math.hypot(value, y[i], z[i]) : factor * value));
      }),
    );
  }

  /**
   * The largest of every item of a chart over the turn, found between the samples.
   * @param {SentCurves} own
   * @param {import("../cardan.js").Machine} machine of one state
   * @returns {number[]}
   */
  #largest(own, machine) {
    const { output, items } = own;
    const numbers = items.map(({ number }) => number);
    if (output === "acceleration_ratio") {
      return numbers.map((shaft) => {
        const ratio = machine.call("equivalent", { shaft }).max_acceleration_ratio[0];
        return ratio > CANCELLED ? ratio * factorOf(own, machine) : 0;
      });
    }
    const isShaft = output === "torque";
    const { values } = machine.call("peaks", { outputs: [output], of_shafts: isShaft ? numbers : [] });
    // Of bearings there are all.
    return numbers.map((number, i) => values[isShaft ? i : number]);
  }

  /**
   * Show the machine as it is.
   * @param {boolean} isWhole whether axes fit and figures are exact; during a drag axes grow only
   */
  show(isWhole) {
    const { model, sent } = this;
    const { state } = model;
    if (!isWhole && !this.#isSeen) return;
    if (this.#units !== units()) this.#begin();
    const machine = model.machine.only(state);
    this.#now = this.#evaluated(machine);
    if (!this.#drawn.has(state)) this.#drawn.set(state, this.#evaluated(model.drawnMachine.only(state)).map((each) => each.map(whole)));
    const former = model.isDrawn ? [] : this.#drawn.get(state) ?? [];
    const place = minus(model.sent.states[state]);
    if (this.of.textContent !== place) this.of.textContent = place;
    sent.forEach((own, k) => {
      const sizes = isWhole ? this.#largest(own, machine) : this.#now[k].map(largest);
      const least = own.output === "acceleration_ratio" ? factorOf(own, machine) : 0;
      this.#draw(this.charts[k], own, { found: this.#now[k], former: former[k] ?? [], sizes, least }, isWhole);
    });
  }

  /**
   * @param {Chart} chart
   * @param {SentCurves} sent
   * @param {{found: number[][], former: number[][], sizes: number[], least: number}} values
   *   with the size beside which others are rounding
   * @param {boolean} isWhole
   */
  #draw(chart, sent, { found, former, sizes, least }, isWhole) {
    const { model } = this;
    const isMotion = sent.output === "acceleration_ratio";
    const { size, digits } = formOf(sent);
    const shown = (/** @type {number[]} */ values) => (size === 1 ? values : values.map((value) => value / size));
    const scale = Math.max(...sizes, least);
    const isSteady = (/** @type {number[]} */ values) =>
      spread(values) <= Math.max(STEADY * largest(values), ROUNDING * scale);
    const curves = sent.items.map(({ name, number, shaft, paths }, i) => {
      const values = isSteady(found[i]) ? null : whole(shown(found[i]));
      const text = numberText(sizes[i] / size, digits);
      const path = isWhole ? paths[model.state] : "derived:";
      const figure = { text: isMotion && values ? `±${text}` : text, path, value: sizes[i] };
      const alike = sent.items.slice(0, i).filter((other) => other.shaft % 4 === shaft % 4).length;
      const kind = `s${shaft % 4}${DASHES[alike % DASHES.length]}`;
      return { label: values ? name : `${name}, even`, kind, mark: String(number), values, figure };
    });
    const limit = model.figure(sent.bounded ?? "", null)?.limit ?? NaN;
    const ghosts = former.map((values) => (isSteady(values) ? [] : shown(values)));
    const mean = found[0].reduce((sum, x) => sum + x, 0) / found[0].length / size;
    const holds = sent.output === "torque" ? [mean * (1 - ROOM), mean * (1 + ROOM)] : [0];
    const bounds = Number.isNaN(limit) ? [] : [-limit, limit];
    chart.draw({ x: TURN, curves, ghosts, bounds, holds, scale: scale / size }, !isWhole);
  }

  /**
   * Mark the drive angle.
   * @param {number} degrees
   */
  mark(degrees) {
    for (const chart of this.charts) chart.mark(degrees);
  }

  /** The curves shown as text, a row for every drive angle. */
  csv() {
    const state = this.model.sent.states[this.model.state];
    const forms = this.sent.map(formOf);
    const heads = this.sent.flatMap(({ heading, items }, k) => {
      const { unit } = forms[k];
      return items.map(({ name }) => `${heading.toLowerCase()} of ${name}${unit && ` [${unit}]`}${state && ` (${state})`}`);
    });
    const curves = this.#now.flatMap((own, k) => own.map((values) => whole(values.map((value) => value / forms[k].size))));
    const rows = TURN.map((angle, i) => [angle, ...curves.map((curve) => curve[i])].join());
    return `${[OVER, ...heads].join()}\n${rows.join("\n")}\n`;
  }
}

/**
 * Half a turn twice, to its end.
 * @param {number[]} half
 */
const whole = (half) => [...half, ...half, half[0]];

/** @param {number[]} values */
const spread = (values) => Math.max(...values) - Math.min(...values);

/** @param {number[]} values */
const largest = (values) => Math.max(...values.map(Math.abs));

/**
 * Factor from ratio to acceleration: the square of the speed of the drive, if there is any.
 * @param {SentCurves} sent
 * @param {import("../cardan.js").Machine} machine of one state
 */
const factorOf = ({ output, unit }, machine) =>
  output === "acceleration_ratio" && unit ? machine.data.speed[0] ** 2 : 1;
