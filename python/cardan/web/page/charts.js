// @ts-check
/**
 * Charts as SVG from data: curves over an axis, maps over two, bars.
 *
 * @module charts
 */

import { drawn, made, put, px, say } from "./elements.js";

const MINUS = "\u2212";
/** The width of a chart that is not laid out, and in px the frame of all. */
const [WIDTH, LEFT, RIGHT, TOP, BOTTOM, HEIGHT] = [360, 56, 16, 8, 38, 180];
const TICKS = 4; // steps along an axis, about
const DEGREES = [1, 2, 5, 10, 15, 30, 45, 90, 180, 360];
/** Values that vary by less beside their size are one, and would fill the chart with rounding. */
const FLAT = 1e-9;
const APART = 16; // px between the marks of curves
// Names below a chart: their font, what a line takes of it, the gap between two, and their letters.
const [FONT, LINE, GAP, LETTERS] = [11, 13, 7, 24];
const TILTS = [0, 30, 45, 60, 90];

/**
 * Numbers as JSON has them: null where there is none.
 * @typedef {ArrayLike<number | null>} Values
 */

/**
 * A curve, or its words alone where it has no values.
 * @typedef {object} Curve
 * @property {string} label
 * @property {Values | null} values
 * @property {string} [kind] the classes of its line, which else follow from its place
 * @property {string} [mark] what is written beside the line
 * @property {number} [marked] at which sample; else where the line turns
 * @property {{text: string, path: string, value: number} | null} [figure] its size
 */

/**
 * Contents of a chart: curves over numbers, or over names that are as far from each other.
 * @typedef {object} Drawn
 * @property {Values} x
 * @property {Curve[]} curves
 * @property {Values[]} [ghosts] thin and dashed, each of the colour of the curve at its place
 * @property {number[]} [bounds] a band from the first to the second
 * @property {number[]} [holds] values that the axis shows in any case
 * @property {number} [scale] a size beside which a billionth is rounding
 * @property {number[]} [span] a band from the first to the second place along the axis
 * @property {{x: number, y: number, kind: string}[]} [dots]
 * @property {string[]} [names]
 */

/**
 * @typedef {object} Titles
 * @property {string} heading
 * @property {string} unit
 * @property {string} over what is along the axis
 * @property {number} [left_out] how many smaller curves are not drawn
 */

/**
 * A round number with a true minus sign.
 * @param {number} value
 */
const roundText = (value) => String(Number(value.toPrecision(10))).replace("-", MINUS);

/** @param {Titles} titles */
const headed = ({ heading, unit }) => (unit ? `${heading} [${unit}]` : heading);

/** @param {number | null | undefined} value */
const isKnown = (value) => Number.isFinite(value);

/**
 * The least and the largest of some lists.
 * @param {Values[]} lists
 * @returns {[number, number]}
 */
function extent(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (let i = 0; i < list.length; i++) {
      const value = /** @type {number} */ (list[i]);
      if (!isKnown(value)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 0];
}

/**
 * Where an axis begins and ends that shows values, with some room if they differ by rounding only,
 * and whether they do.
 * @param {number} low
 * @param {number} high
 * @param {number} scale
 * @returns {[number, number, boolean]}
 */
function shown(low, high, scale) {
  const noise = FLAT * Math.max(scale, Math.abs(low), Math.abs(high));
  if (high - low > noise) return [low, high, false];
  const middle = (low + high) / 2;
  const room = Math.abs(middle) > noise ? 0.05 * Math.abs(middle) : scale || 1;
  return [middle - room, middle + room, true];
}

/**
 * Round numbers from at or below `low` to at or above `high`.
 * @param {number} low
 * @param {number} high
 * @param {number} about how many steps
 */
function ticks(low, high, about = TICKS) {
  const rough = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * (/** @type {number} */ ([1, 2, 2.5, 5, 10].find((part) => part * power >= rough)));
  return multiples(step, Math.floor(low / step), Math.ceil(high / step));
}

/** @param {number} step @param {number} first @param {number} last */
const multiples = (step, first, last) =>
  Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => step * (first + i));

/**
 * Round numbers within an axis: of an angle parts of the turn, of a count whole numbers.
 * @param {string} label
 * @param {number} low
 * @param {number} high
 */
function ticksAlong(label, low, high) {
  const span = high - low;
  if (/deg/.test(label) && span > 2) {
    const step = DEGREES.find((each) => span <= 5 * each) ?? 360 * Math.ceil(span / 1800);
    return multiples(step, Math.ceil(low / step), Math.floor(high / step));
  }
  const isCounted = label.endsWith("counted from 0");
  return ticks(low, high).filter((at) => at >= low && at <= high && !(isCounted && at % 1));
}

/**
 * Function that maps values from `low` to `high` into places from `start` to `stop`.
 * @param {number} low
 * @param {number} high
 * @param {number} start
 * @param {number} stop
 */
const scaled = (low, high, start, stop) => (/** @type {number} */ value) =>
  start + ((stop - start) * (value - low)) / (high - low);

/** The frame of a drawing with its axes. */
class Frame {
  /** @type {(value: number) => number} */ across = Number;
  /** @type {(value: number) => number} */ up = Number;

  /** @param {Element} parent @param {Titles} titles */
  constructor(parent, titles) {
    this.titles = titles;
    this.figure = made("figure", "", parent);
    made("figcaption", "", this.figure, headed(titles));
    this.svg = /** @type {SVGSVGElement} */ (drawn("svg", { role: "img" }, this.figure));
    this.below = drawn("g", {}, this.svg);
    this.grid = drawn("g", {}, this.svg);
    this.plot = drawn("g", {}, this.svg);
    this.legend = made("ul", "legend", this.figure);
    this.width = WIDTH;
    this.height = HEIGHT;
  }

  get right() {
    return this.width - RIGHT;
  }

  get bottom() {
    return HEIGHT - BOTTOM;
  }

  /**
   * @param {number[]} x where the axes begin and end
   * @param {number[]} y
   * @param {[number, string][]} across places along the axis with their texts
   * @param {[number, string][]} up
   * @param {{lines: boolean, tilt?: number, room?: number}} how
   */
  axes(x, y, across, up, { lines, tilt = 0, room = 0 }) {
    const { svg, grid, width, right, bottom, titles } = this;
    this.height = HEIGHT + room;
    put(svg, { viewBox: `0 0 ${px(width)} ${px(this.height)}` });
    this.across = scaled(x[0], x[1], LEFT, right);
    this.up = scaled(y[0], y[1], bottom, TOP);
    grid.replaceChildren();
    for (const [value, text] of across) {
      const at = this.across(value);
      if (lines) drawn("line", { class: "grid", x1: at, x2: at, y1: TOP, y2: bottom }, grid);
      const from = `rotate(-${tilt} ${px(at)} ${bottom + 9})`;
      /** @type {Record<string, string | number>} */
      const place = tilt
        ? { x: at, y: bottom + 9, dy: "4", transform: from, class: "end" }
        : { x: at, y: bottom + 18, class: "middle" };
      drawn("text", { ...place, "data-x": String(value) }, grid, text);
    }
    for (const [value, text] of up) {
      const at = this.up(value);
      if (lines) drawn("line", { class: "grid", x1: LEFT, x2: right, y1: at, y2: at }, grid);
      drawn("text", { x: LEFT - 7, y: at + 4, class: "end", "data-y": String(value) }, grid, text);
    }
    const middle = { x: (LEFT + right) / 2, y: this.height - 5, class: "middle" };
    drawn("text", middle, grid, titles.over);
  }
}

/** Curves over an axis, which may be drawn anew. */
export class Chart {
  /** What the axis of the values shows: its ends, and for what it was drawn. */
  #axis = { low: Infinity, high: -Infinity, key: "" };
  /** @type {{line: Element, ghost: Element, mark: Element | null, item: HTMLElement, words: Element, figure: HTMLElement, at: number,
   *   former?: Values, key?: string}[]} what is drawn of each, and its ghost for which axes */
  #curves = [];
  /** @type {Values} */ #x = [];
  #marked = Infinity;
  /**
   * Where the samples are drawn along the axis.
   * @type {string[]}
   */
  #along = [];

  /**
   * @param {Element} parent
   * @param {Titles} titles
   * @param {((x: number) => void) | null} picked called with what the pointer points at
   */
  constructor(parent, titles, picked = null) {
    this.frame = new Frame(parent, titles);
    const { below, plot, svg } = this.frame;
    this.band = drawn("path", { class: "allowed" }, below);
    this.span = drawn("path", { class: "span" }, below);
    this.limits = drawn("path", { class: "bound" }, plot);
    this.cursor = drawn("path", { class: "cursor" }, plot);
    this.dots = drawn("g", {}, svg);
    if (picked) this.#follow(svg, picked);
  }

  /** @param {SVGSVGElement} svg @param {(x: number) => void} picked */
  #follow(svg, picked) {
    const pick = (/** @type {PointerEvent} */ event) => {
      const box = svg.getBoundingClientRect();
      const { width, right } = this.frame;
      const at = ((event.clientX - box.left) * width) / box.width;
      const [first, last] = extent([this.#x]);
      picked(first + ((last - first) * (Math.min(Math.max(at, LEFT), right) - LEFT)) / (right - LEFT));
    };
    svg.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      svg.setPointerCapture(event.pointerId);
      pick(event);
    });
    svg.addEventListener("pointermove", (event) => {
      if (svg.hasPointerCapture(event.pointerId)) pick(event);
    });
  }

  /** Take the width that the chart has on the page. */
  fit() {
    this.frame.width = this.frame.svg.clientWidth || WIDTH;
  }

  /**
   * Fit to an element whenever its width changes, and show again.
   * @param {HTMLElement} element
   * @param {() => void} show
   */
  follow(element, show) {
    let width = 0;
    // A size that is set while sizes are observed would be observed again.
    const fit = () => requestAnimationFrame(() => {
      if (element.clientWidth === width) return;
      width = element.clientWidth;
      this.fit();
      show();
    });
    new ResizeObserver(fit).observe(element);
  }

  /**
   * Draw curves.
   * @param {Drawn} what
   * @param {boolean} isGrowing whether the axis of the values may only grow
   */
  draw(what, isGrowing = false) {
    const { x, curves, ghosts = [], bounds = [], holds = [], scale = 1, names = [], span = [], dots = [] } = what;
    const { frame } = this;
    const isMoved = this.#x !== x;
    this.#x = x;
    const lists = curves.flatMap(({ values }) => (values ? [values] : []));
    const axis = this.#axis;
    let [low, high, isFlat] = shown(...extent([...lists, ...ghosts, holds, bounds]), scale);
    if (isGrowing) [low, high] = [Math.min(low, axis.low), Math.max(high, axis.high)];
    const up = ticks(low, high);
    [low, high] = [Math.min(low, up[0]), Math.max(high, up[up.length - 1])];
    const fitted = fittedNames(names, frame.width);
    const [first, last] = fitted ? [-0.5, names.length - 0.5] : extent([x]);
    const ends = [first, last > first ? last : first + 1];
    const key = [low, high, ...ends, frame.width].join();
    const places = fitted ? names.map((_, i) => i) : x;
    const former = axis.key;
    if (key !== former) {
      this.#axis = { low, high, key };
      /** @type {[number, string][]} */
      const along = fitted
        ? fitted.texts.map((text, i) => [i, text])
        : ticksAlong(frame.titles.over, ends[0], ends[1]).map((at) => [at, roundText(at)]);
      frame.axes(ends, [low, high], along, up.map((at) => [at, roundText(at)]), { lines: true, ...fitted });
      this.#bounds(bounds);
      this.mark(this.#marked);
    }
    if (key !== former || isMoved) this.#along = Array.from(places, (at) => px(frame.across(Number(at))));
    const [left, right] = span.map((at) => px(frame.across(at)));
    put(this.span, { d: span.length ? `M${left} ${TOP}H${right}V${frame.bottom}H${left}Z` : "" });
    this.dots.replaceChildren();
    for (const { x: along, y, kind } of dots) {
      drawn("circle", { class: kind, cx: frame.across(along), cy: frame.up(y), r: 4 }, this.dots);
    }
    this.#fill(curves, ghosts, places, isFlat, isGrowing);
    const { heading, unit } = frame.titles;
    const range = `from ${roundText(low)} to ${roundText(high)}${unit && ` ${unit}`}`;
    const said = curves.map(({ label, figure }) => (figure ? `${label} ${figure.text}` : label));
    put(frame.svg, { "aria-label": `${heading} over ${frame.titles.over}, ${range}: ${said.join(", ")}` });
  }

  /** @param {number[]} bounds */
  #bounds(bounds) {
    const { up, right } = this.frame;
    const [low, high] = bounds.map(up);
    const edges = bounds.map((bound) => `M${LEFT} ${px(up(bound))}H${right}`);
    put(this.limits, { d: edges.join("") });
    put(this.band, { d: bounds.length ? `M${LEFT} ${px(low)}H${right}V${px(high)}H${LEFT}Z` : "" });
  }

  /**
   * @param {Curve[]} curves
   * @param {Values[]} ghosts
   * @param {Values} x
   * @param {boolean} isFlat
   * @param {boolean} isGrowing
   */
  #fill(curves, ghosts, x, isFlat, isGrowing) {
    /** @type {number[][]} */
    const taken = [];
    curves.forEach(({ label, values, kind, mark, marked, figure }, i) => {
      const own = (this.#curves[i] ??= this.#made(kind ?? `c${i % 6}`, mark !== undefined));
      own.line.setAttribute("d", values ? this.#path(values, isFlat) : "");
      const ghost = ghosts[i] ? `${this.#axis.key} ${i}` : "";
      if (own.former !== ghosts[i] || own.key !== ghost) {
        own.ghost.setAttribute("d", ghost && this.#path(ghosts[i], false));
        [own.former, own.key] = [ghosts[i], ghost];
      }
      if (marked !== undefined) own.at = marked;
      else if (!isGrowing) own.at = values && mark ? this.#free(values, x, taken) : -1;
      const at = values && own.at >= 0 ? this.#place(values, x, own.at) : null;
      if (own.mark) {
        put(own.mark, at ? { x: at[0], y: at[1] - 4, visibility: "visible" } : { visibility: "hidden" });
        say(own.mark, mark ?? "");
      }
      say(own.words, `${label} `);
      say(own.figure, figure ? figure.text : "");
      own.item.classList.toggle("flat", !values);
      if (figure) {
        own.figure.dataset.path = figure.path;
        own.figure.dataset.value = String(figure.value);
      }
    });
  }

  /** @param {string} kind @param {boolean} isMarked */
  #made(kind, isMarked) {
    const { plot, legend } = this.frame;
    const ghost = drawn("path", { class: `curve former ${kind}` }, plot);
    const line = drawn("path", { class: `curve ${kind}` }, plot);
    const mark = isMarked ? drawn("text", { class: "middle" }, plot) : null;
    const item = made("li", "", legend);
    const swatch = drawn("svg", { class: "swatch", "aria-hidden": "true", viewBox: "0 0 30 12" }, item);
    drawn("path", { class: `curve ${kind}`, d: "M0 6H30" }, swatch);
    return { line, ghost, mark, item, words: made("span", "", item), figure: made("b", "", item), at: -1 };
  }

  /**
   * A sample at which a curve turns, away from what is taken.
   * @param {Values} values
   * @param {Values} x
   * @param {number[][]} taken
   */
  #free(values, x, taken) {
    let [best, room] = [0, -1];
    for (let i = 1; i + 1 < values.length; i++) {
      const [before, value, after] = [i - 1, i, i + 1].map((at) => Number(values[at]));
      if (!(value >= before && value >= after) && !(value <= before && value <= after)) continue;
      const at = this.#place(values, x, i);
      const away = Math.min(2 * APART, ...taken.map((other) => Math.hypot(other[0] - at[0], other[1] - at[1])));
      if (away > room) [best, room] = [i, away];
    }
    taken.push(this.#place(values, x, best));
    return best;
  }

  /** @param {Values} values @param {Values} x @param {number} i */
  #place(values, x, i) {
    return [this.frame.across(Number(x[i])), this.frame.up(Number(values[i]))];
  }

  /**
   * A line through known values; a gap stays a gap.
   * @param {Values} values
   * @param {boolean} isFlat
   */
  #path(values, isFlat) {
    const { up } = this.frame;
    let [path, pen] = ["", "M"];
    const middle = isFlat ? extent([values]).reduce((a, b) => (a + b) / 2) : 0;
    for (let i = 0; i < values.length; i++) {
      if (!isKnown(values[i])) {
        pen = "M";
        continue;
      }
      const value = isFlat ? middle : Number(values[i]);
      path += `${pen}${this.#along[i]} ${px(up(value))}`;
      pen = "L";
    }
    return path;
  }

  /**
   * Set the mark along the axis.
   * @param {number} x
   */
  mark(x) {
    this.#marked = x;
    const { across, bottom } = this.frame;
    put(this.cursor, { d: Number.isFinite(x) ? `M${px(across(x))} ${TOP}V${bottom}` : "" });
  }
}

/**
 * Names below a frame, level where they fit, else aslant; null where they are too many.
 * @param {string[]} names
 * @param {number} width of the frame
 */
function fittedNames(names, width) {
  if (!names.length) return null;
  const right = width - RIGHT;
  const texts = names.map((name) => (name.length > LETTERS ? `${name.slice(0, LETTERS - 1)}…` : name));
  const wide = texts.map(textWidth);
  const step = (right - LEFT) / names.length;
  const places = names.map((_, i) => LEFT + (i + 0.5) * step);
  const [most, last] = [Math.max(...wide), names.length - 1];
  for (const tilt of TILTS) {
    const [cosine, sine] = [Math.cos((tilt * Math.PI) / 180), Math.sin((tilt * Math.PI) / 180)];
    const fits = tilt
      ? (last === 0 || step * sine >= LINE) &&
        places.every((at, i) => at - wide[i] * cosine >= 0) &&
        places[last] + FONT * sine <= width
      : places.every((at, i) => i === last || at + (wide[i] + wide[i + 1]) / 2 + GAP <= places[i + 1]) &&
        places[0] >= wide[0] / 2 &&
        places[last] + wide[last] / 2 <= width;
    if (fits) return { texts, tilt, room: tilt ? Math.round(most * sine) : 0 };
  }
  return null;
}

/**
 * Pixels that a name takes at most in the fonts of browsers.
 * @param {string} name
 */
const textWidth = (name) =>
  FONT * Array.from(name).reduce((sum, letter) => sum + (letter > "\u10ff" ? 1 : 0.62), 0);

/**
 * Curves as Python sends them, with the names of the samples and what these are.
 * @typedef {Titles & Drawn & {named: string}} SentChart
 */

/**
 * A quantity over two keys, both rising: rows of values from the least `y` on.
 * @typedef {Titles & {beside: string, x: number[], y: number[], values: number[][], scale: number,
 *   least: number[], thinned: string}} SentMap
 */

/** @param {Element} parent @param {SentChart} sent */
function drawChart(parent, sent) {
  const over = fittedNames(sent.names ?? [], WIDTH) ? sent.named : sent.over;
  const chart = new Chart(parent, { ...sent, over });
  chart.draw(sent);
  const { left_out: left } = sent;
  if (left) made("li", "", chart.frame.legend, `not drawn: ${left} that var${left > 1 ? "y" : "ies"} no more than these`);
}

/**
 * Bands of colour, with the least value marked.
 * @param {Element} parent
 * @param {SentMap} sent
 */
function drawMap(parent, sent) {
  const { x, y, values, least, thinned, over, beside, heading, unit, scale } = sent;
  const frame = new Frame(parent, sent);
  const [first, last] = extent(values);
  const [low, high, isFlat] = shown(first, last, scale);
  const levels = ticks(low, high, 7);
  const [across, up] = [edges(x), edges(y)];
  /** @type {(at: number) => [number, string]} */
  const named = (at) => [at, roundText(at)];
  const along = (/** @type {string} */ label, /** @type {number[]} */ own) =>
    ticksAlong(label, own[0], own[own.length - 1]).map(named);
  const ends = (/** @type {number[]} */ own) => [own[0], own[own.length - 1]];
  frame.axes(ends(across), ends(up), along(over, x), along(beside, y), { lines: false });
  const { plot, legend, svg } = frame;
  const middle = (TOP + frame.bottom) / 2;
  drawn("text", { x: -middle, y: 12, transform: "rotate(-90)", class: "middle" }, plot, beside);
  const bands = levels.slice(1).map(() => "");
  const place = (/** @type {number} */ i, /** @type {number} */ j) =>
    `${px(frame.across(across[i]))} ${px(frame.up(up[j]))}`;
  values.forEach((row, j) => {
    const of = row.map((value) => bandOf(isFlat ? (low + high) / 2 : value, levels));
    for (let i = 0, start = 0; i < row.length; i++) {
      if (of[i + 1] === of[i]) continue;
      const right = px(frame.across(across[i + 1]));
      bands[of[i]] += `M${place(start, j)}H${right}V${px(frame.up(up[j + 1]))}H${px(frame.across(across[start]))}z`;
      start = i + 1;
    }
  });
  bands.forEach((path, band) => {
    drawn("path", { class: `band m${band}`, d: path }, frame.below);
    const item = made("li", "", legend);
    const patch = drawn("svg", { class: "patch", "aria-hidden": "true" }, item);
    drawn("rect", { class: `band m${band}`, width: 14, height: 14 }, patch);
    item.append(` ${roundText(levels[band])} to ${roundText(levels[band + 1])}`);
  });
  if (!isFlat) {
    drawn("circle", { class: "least", cx: frame.across(least[0]), cy: frame.up(least[1]), r: 4 }, plot);
    made("li", "", legend, `○ least value, at ${least.map(roundText).join(", ")}`);
  }
  if (thinned) made("li", "", legend, thinned);
  const range = `from ${roundText(first)} to ${roundText(last)}${unit && ` ${unit}`}`;
  put(svg, { "aria-label": `${heading} over ${over} and ${beside}, ${range}` });
}

/**
 * The band between two levels that holds a value.
 * @param {number} value
 * @param {number[]} levels
 */
function bandOf(value, levels) {
  const above = levels.slice(1, -1).findIndex((level) => value < level);
  return above < 0 ? levels.length - 2 : above;
}

/**
 * Borders of cells around places: halfway between neighbours, and as far beyond the ends.
 * @param {number[]} places
 */
function edges(places) {
  const middles = places.slice(1).map((place, i) => (place + places[i]) / 2);
  const last = places.length - 1;
  return [2 * places[0] - middles[0], ...middles, 2 * places[last] - middles[last - 1]];
}

/**
 * Bars with a label on the left and a text on the right.
 * @param {Element} parent
 * @param {{heading: string, items: [string, number, string][]}} sent
 */
function drawBars(parent, { heading, items }) {
  const figure = made("figure", "", parent);
  made("figcaption", "", figure, heading);
  const said = items.map(([label, , text]) => `${label} ${text}`).join(", ");
  const viewBox = `0 0 ${WIDTH} ${18 * items.length + 6}`;
  const svg = drawn("svg", { role: "img", viewBox, "aria-label": said }, figure);
  const most = Math.max(...items.map(([, size]) => size)) || 1;
  items.forEach(([label, size, text], i) => {
    const width = (170 * size) / most;
    drawn("text", { x: 118, y: 18 * i + 15, class: "end" }, svg, label);
    drawn("rect", { class: "share", x: 124, y: 18 * i + 5, width, height: 12 }, svg);
    drawn("text", { x: 128 + width, y: 18 * i + 15 }, svg, text);
  });
}

/** Draw what the page holds as data. */
export function start() {
  const kinds = /** @type {Record<string, (parent: Element, sent: any) => void>} */ ({
    chart: drawChart,
    map: drawMap,
    bars: drawBars,
  });
  for (const script of Array.from(document.querySelectorAll(".drawing > script"))) {
    const sent = JSON.parse(script.textContent ?? "");
    kinds[sent.kind](/** @type {Element} */ (script.parentElement), sent);
  }
}
