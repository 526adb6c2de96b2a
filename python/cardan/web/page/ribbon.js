// @ts-check
/**
 * At which heights of a point the verdict holds, as a ribbon beside it.
 *
 * @module ribbon
 */

import { drawn, put } from "./elements.js";
import { lengthText, lengths } from "./numbers.js";

const SLICE = 8; // ms that it may take of a frame
const WAIT = 150; // ms after a change
const SPAN = 0.035; // how far the ribbon goes either way, over the length of the driveline
const BANDS = 20; // either way
const WIDTH = 8; // px
const HATCH = 4; // px between lines that tell verdicts apart without colour
const ASIDE = 30; // px from the point
/** @type {Record<string, string>} */
const LINES = { beyond: `l${WIDTH} ${-HATCH}`, tolerable: `h${WIDTH}` };

/** @typedef {import("./drawing.js").Handle} Handle */

/**
 * The heights in the order in which they are looked at: the nearest first.
 * @type {number[]}
 */
const ORDER = Array.from({ length: 2 * BANDS + 1 }, (_, i) => (i % 2 ? 1 : -1) * Math.ceil(i / 2)).map((x) => x || 0);

/** The ribbon of a drawing. */
export class Ribbon {
  #timer = 0;
  #what = "";
  /** The verdict at each height that has been looked at. @type {Map<number, string>} */
  #found = new Map();
  /** How many heights each slice has looked at, and how long it took in ms. */
  slices = /** @type {number[][]} */ ([]);

  /** @param {import("./drawing.js").Drawing} drawing */
  constructor(drawing) {
    this.drawing = drawing;
    this.group = drawn("g", { class: "ribbon", role: "img" }, drawing.svg);
    this.bands = new Map(ORDER.map((place) => [place, drawn("rect", { width: WIDTH }, this.group)]));
    this.hatch = drawn("path", { class: "hatch" }, this.group);
    this.here = drawn("path", { class: "here" }, this.group);
    this.hide();
  }

  /** Take the ribbon away, until it is asked for. */
  hide() {
    clearTimeout(this.#timer);
    this.#what = "";
    put(this.group, { visibility: "hidden" });
  }

  /** Look for the verdicts around the point that is selected, if they are not known. */
  ask() {
    const { selected, model, stretch, scale } = this.drawing;
    if (selected?.kind !== "point") {
      this.hide();
      return;
    }
    const { item, view } = selected;
    const what = JSON.stringify([item, view, stretch, scale, model.state, model.changes]);
    if (what === this.#what) return;
    this.hide();
    this.#what = what;
    this.#found.clear();
    this.#timer = window.setTimeout(() => this.#look(selected, 0), WAIT);
  }

  /** The distance between two heights in mm. */
  get #step() {
    return (SPAN * this.drawing.length) / BANDS;
  }

  /**
   * Look at as many heights as a slice permits.
   * @param {Handle} handle
   * @param {number} first
   */
  #look(handle, first) {
    const { model } = this.drawing;
    const axis = this.drawing.across(handle);
    const start = performance.now();
    let [at, last] = [first, 0];
    do {
      const before = performance.now();
      this.#found.set(ORDER[at], model.verdictAt(handle.item, axis, this.#step * ORDER[at]));
      last = performance.now() - before;
      at += 1;
    } while (at < ORDER.length && performance.now() - start + last < SLICE);
    this.slices.push([at - first, performance.now() - start]);
    if (at < ORDER.length) this.#timer = window.setTimeout(() => this.#look(handle, at));
    else this.#show(handle, axis);
  }

  /** @param {Handle} handle @param {number} axis */
  #show(handle, axis) {
    const { drawing } = this;
    const [x, y] = handle.at;
    const high = this.#step * drawing.scale * drawing.stretch;
    const left = x + ASIDE + WIDTH > drawing.width ? x - ASIDE - WIDTH : x + ASIDE;
    const sign = drawing.views[handle.view].axes.down[axis];
    let lines = "";
    for (const [place, band] of this.bands) {
      const verdict = (this.#found.get(place) || "none").replace(" ", "-");
      const top = y + sign * place * high - high / 2;
      put(band, { x: left, y: top, height: high + 0.2, class: verdict });
      const line = LINES[verdict];
      for (let at = HATCH * Math.ceil(top / HATCH); line && at < top + high; at += HATCH) lines += `M${left} ${at}${line}`;
    }
    put(this.hatch, { d: lines });
    put(this.here, { d: `M${left - 2} ${y}l-7-5v10z` });
    put(this.group, { visibility: "visible", "aria-label": this.#words(handle, axis) });
  }

  /**
   * Where everything is within its limits, in words.
   * @param {Handle} handle
   * @param {number} axis
   */
  #words(handle, axis) {
    const { model } = this.drawing;
    const own = model.points(model.state)[handle.item][axis];
    const within = ORDER.filter((place) => this.#found.get(place) === "within").sort((a, b) => a - b);
    const starts = within.filter((place) => !within.includes(place - 1));
    const ends = within.filter((place) => !within.includes(place + 1));
    const text = (/** @type {number} */ place) => lengthText(own + this.#step * place);
    const ranges = starts.map((start, i) => `from ${text(start)} to ${text(ends[i])} ${lengths().unit}`);
    return `Within all limits with ${"xyz"[axis]} ${ranges.join(" and ") || "nowhere near"}`;
  }
}
