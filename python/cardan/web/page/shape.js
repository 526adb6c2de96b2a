// @ts-check
/**
 * Shafts that vibrate, much enlarged: they swing slowly, or stand at both ends of their swing for whoever
 * wants no motion.
 *
 * @module shape
 */

import { drawn, made, put, say } from "./elements.js";

const [WIDTH, HEIGHT, EDGE] = [640, 170, 24];
/** The largest displacement in the picture, as a share of its height. */
const SWING = 0.28;
const SWING_MS = 1800; // of one swing

/**
 * A place of a shaft: where it is in m, and its displacement as a complex vector.
 * @typedef {{at: number[], re: number[], im: number[]}} Place
 */

/** @param {number[]} a @param {number[]} b */
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);

export class Shape {
  /** @type {{x: number, y: number, re: number, im: number}[]} */
  #places = [];
  /** @type {{x: number, y: number, re: number, im: number}[]} */
  #bearings = [];
  #isSeen = false;
  #frame = 0;

  /** @param {Element} parent */
  constructor(parent) {
    this.figure = made("figure", "shape", parent);
    this.caption = made("figcaption", "", this.figure);
    const svg = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" }, this.figure);
    this.svg = svg;
    this.rest = drawn("path", { class: "rest" }, svg);
    this.other = drawn("path", { class: "other" }, svg);
    this.line = drawn("path", { class: "moving" }, svg);
    this.dots = drawn("g", {}, svg);
    this.still = window.matchMedia("(prefers-reduced-motion: reduce)");
    this.still.addEventListener("change", () => this.#go());
    new IntersectionObserver(([seen]) => {
      this.#isSeen = seen.isIntersecting;
      this.#go();
    }).observe(svg);
  }

  /**
   * Show a vibration in the plane of the page.
   * @param {Place[]} places along the driveline
   * @param {Place[]} bearings
   * @param {{right: number[], down: number[]}} view
   * @param {string} words
   */
  show(places, bearings, { right, down }, words) {
    const across = places.map(({ at }) => dot(at, right));
    const along = places.map(({ at }) => dot(at, down));
    const [left, top] = [Math.min(...across), Math.min(...along)];
    const size = Math.max(...across) - left;
    const scale = Math.min((WIDTH - 2 * EDGE) / size, (0.4 * HEIGHT) / (Math.max(...along) - top));
    const middle = 0.5 * (Math.max(...along) + top);
    const most = Math.max(...places.map(({ re, im }) => Math.hypot(dot(re, down), dot(im, down))));
    const swing = most > 0 ? (SWING * HEIGHT) / most : 0;
    const placed = (/** @type {Place} */ { at, re, im }) => ({
      x: EDGE + (dot(at, right) - left) * scale,
      y: HEIGHT / 2 + (dot(at, down) - middle) * scale,
      re: swing * dot(re, down),
      im: swing * dot(im, down),
    });
    this.#places = places.map(placed);
    this.#bearings = bearings.map(placed);
    const times = swing / scale;
    say(this.caption, `${words}, displacements ${Number(times.toPrecision(2))} times as large`);
    this.svg.setAttribute("aria-label", words);
    put(this.rest, { d: this.#path(null) });
    this.#go();
  }

  /**
   * The line of the shafts at an angle of the swing; at rest without one.
   * @param {number | null} angle
   */
  #path(angle) {
    const [c, s] = angle === null ? [0, 0] : [Math.cos(angle), Math.sin(angle)];
    const at = this.#places.map(({ x, y, re, im }) => `${x.toFixed(1)} ${(y + re * c - im * s).toFixed(1)}`);
    return `M${at.join("L")}`;
  }

  /** @param {number} angle */
  #draw(angle) {
    put(this.line, { d: this.#path(angle) });
    put(this.other, { d: this.still.matches ? this.#path(angle + Math.PI) : "" });
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    while (this.dots.children.length < this.#bearings.length) drawn("circle", { r: 5, class: "held" }, this.dots);
    this.#bearings.forEach(({ x, y, re, im }, i) => put(this.dots.children[i], { cx: x, cy: y + re * c - im * s }));
  }

  #go() {
    cancelAnimationFrame(this.#frame);
    if (!this.#places.length) return;
    if (this.still.matches || !this.#isSeen) return void this.#draw(this.#widest());
    const step = (/** @type {number} */ time) => {
      this.#draw((2 * Math.PI * time) / SWING_MS);
      this.#frame = requestAnimationFrame(step);
    };
    this.#frame = requestAnimationFrame(step);
  }

  /** The angle at which the place that moves most is farthest from rest. */
  #widest() {
    const size = (/** @type {{re: number, im: number}} */ { re, im }) => Math.hypot(re, im);
    const most = this.#places.reduce((best, place) => (size(place) > size(best) ? place : best));
    return -Math.atan2(most.im, most.re);
  }
}
