// @ts-check
/**
 * How the yokes of each shaft between two joints are set, as dials seen from the drive.
 *
 * @module dials
 */

import { drawn, made } from "./elements.js";
import { folded, numberText } from "./numbers.js";

const SNAP = 3; // degrees within which the best setting is taken
const DEGREE = Math.PI / 180;
const TENTH = { decimals: 1, digits: null, apart: null, finest: 1e-3 };
const KEYS = /** @type {Record<string, number>} */ ({
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
});

/**
 * An angle in words, seen from the drive.
 * @param {number} degrees
 */
const turned = (degrees) => {
  const size = `${numberText(Math.abs(degrees), TENTH)}°`;
  return Math.abs(degrees) >= TENTH.finest ? `${size} ${degrees > 0 ? "clockwise" : "counter-clockwise"}` : size;
};

/** A dial for each shaft between two joints. */
export class Dials {
  /** @type {number[]} */ #best = [];

  /**
   * @param {HTMLElement} element
   * @param {import("./model.js").Model} model
   * @param {{moved: () => void, done: (what: string, time?: number) => void}} on
   */
  constructor(element, model, on) {
    this.model = model;
    const { sent } = model;
    this.dials = sent.machine.phases[0].map((/** @type {number} */ _, /** @type {number} */ i) =>
      this.#dial(element, i, on),
    );
    const actions = made("div", "actions", element);
    const { teeth } = sent.search;
    const buttons = /** @type {[string, number[]][]} */ ([["Best phases", []]]);
    if (teeth.some(Boolean)) buttons.push([`Best on ${[...new Set(teeth.filter(Boolean))].join(" and ")} teeth`, teeth]);
    for (const [name, teeth] of buttons) {
      const button = made("button", "", actions, name);
      button.setAttribute("type", "button");
      button.addEventListener("click", () => {
        model.begin();
        model.turn(model.bestPhases(teeth));
        on.done(name);
      });
    }
    const over = sent.states.length > 1 ? " over all states by their weights; single states may get worse" : "";
    made("small", "", actions, `Seen from the drive. Best, in green: the smallest equivalent bend${over}.`);
    element.hidden = !this.dials.length || sent.fixed.some(([variable]) => variable === "phase");
  }

  /**
   * @param {HTMLElement} element
   * @param {number} i
   * @param {{moved: () => void, done: (what: string, time?: number) => void}} on
   */
  #dial(element, i, on) {
    const { model } = this;
    const own = made("div", "dial", element);
    const svg = /** @type {SVGSVGElement} */ (
      drawn("svg", {
        viewBox: "-30 -30 60 60",
        role: "slider",
        tabindex: "0",
        "aria-label": `Yokes of shaft ${i + 1}`,
        "aria-valuemin": "-180",
        "aria-valuemax": "180",
      }, own)
    );
    drawn("path", { class: "rim", d: "M0-23A23 23 0 1 1 0 23A23 23 0 1 1 0-23" }, svg);
    drawn("path", { class: "ticks", d: [0, 90, 180, 270].map((a) => `M${at(a, 20)}L${at(a, 23)}`).join("") }, svg);
    const best = drawn("path", { class: "best" }, svg);
    drawn("path", { class: "driving", d: "M0 15V-15" }, svg);
    const driven = drawn("path", { class: `driven s${(i + 1) % 4}` }, svg);
    const grip = drawn("circle", { class: `grip s${(i + 1) % 4}`, r: 4.5 }, svg);
    const words = made("div", "", own);
    made("strong", "", words, `Yokes of shaft ${i + 1}`);
    const value = made("span", "phase", words);

    const set = (/** @type {number} */ degrees) => {
      model.turn(model.phases.map((_, k) => (k === i ? degrees : null)));
      on.moved();
    };
    svg.addEventListener("keydown", (event) => {
      const way = KEYS[event.key];
      if (!way || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      const step = event.shiftKey ? 10 : event.altKey ? 0.1 : 1;
      model.begin();
      set(model.phases[i] + way * step);
      on.done(`phase ${i}`, performance.now());
    });
    let drags = false;
    const follow = (/** @type {PointerEvent} */ event) => {
      const box = svg.getBoundingClientRect();
      const [x, y] = [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
      const angle = Math.atan2(x, -y) / DEGREE;
      const near = [this.#best[i], this.#best[i] + 180].find((one) => Math.abs(folded(one - angle, 360)) < SNAP);
      set(near ?? Math.round(angle));
    };
    svg.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      event.preventDefault();
      svg.setPointerCapture(event.pointerId);
      svg.focus({ preventScroll: true });
      drags = true;
      model.begin();
      follow(event);
    });
    svg.addEventListener("pointermove", (event) => {
      if (drags) follow(event);
    });
    const release = () => {
      if (drags) on.done(`phase ${i}`);
      drags = false;
    };
    svg.addEventListener("pointerup", release);
    svg.addEventListener("pointercancel", release);
    return { svg, best, driven, grip, value };
  }

  /** Show the phases as they are. */
  show() {
    this.model.phases.forEach((phase, i) => {
      const { svg, driven, grip, value } = this.dials[i];
      driven.setAttribute("d", `M${at(phase + 180, 15)}L${at(phase, 15)}`);
      const [x, y] = at(phase, 17).split(" ");
      grip.setAttribute("cx", x);
      grip.setAttribute("cy", y);
      const text = turned(phase);
      value.textContent = text;
      value.dataset.path = `derived:phases_deg[${i}]`;
      value.dataset.value = String(phase);
      svg.setAttribute("aria-valuenow", String(phase));
      svg.setAttribute("aria-valuetext", text);
    });
  }

  /** Mark the best setting of the machine as it is. */
  mark() {
    if (!this.dials.length) return;
    this.#best = this.model.bestPhases([]);
    this.#best.forEach((phase, i) => {
      const marks = [phase, phase + 180].map((a) => `M${at(a, 23)}L${at(a - 8, 29)}L${at(a + 8, 29)}Z`);
      this.dials[i].best.setAttribute("d", marks.join(""));
    });
  }
}

/**
 * A place on a dial, clockwise from the top.
 * @param {number} angle in degrees
 * @param {number} radius
 */
const at = (angle, radius) =>
  [Math.sin(angle * DEGREE), -Math.cos(angle * DEGREE)].map((x) => (radius * x).toFixed(2)).join(" ");
