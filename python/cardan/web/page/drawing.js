// @ts-check
/**
 * The driveline from the side and from above as SVG, both with one scale.
 *
 * @module drawing
 */

import { drawn, put } from "./elements.js";
import { lengthText, lengths, numberText } from "./numbers.js";

const TALLEST = 460; // px of both views together, if the driveline is as tall as long
const HIGHEST = 920; // px of both views with heights stretched
const ABOVE = 70; // px above what is drawn in a view, for names
const BELOW = 34; // for slopes and forces
const LEFT = 26;
const YOKE = 0.026; // half the length of a joint over the length of the driveline
const RADIUS = 0.009; // of shafts without a tube
const WIDE = 600; // px from which slopes are called so
const LONG = 64; // px of a shaft beside which its slope is written
const APART = 44; // px from a bearing to a slope
const ARROW = 64; // px of the largest force of the drawing
const GUIDE = 200; // px from a point to the end of the line that shows what it has come to
const WIDEST = 0.08; // of that over the width
const HEAD = 8; // px of the head of an arrow
const MARGIN = 0.03; // above and below what is drawn in a view, over the length of the driveline
const [LETTER, LINE] = [6.8, 15]; // px of a letter and of a line of text
const AWAY = 34; // px from what is dragged to where it is written

/**
 * Write a figure with its place in the answer of the check.
 * @param {Element} element
 * @param {{value: number, text: string, path: string} | null} here
 */
function mark(element, here) {
  element.textContent = here ? here.text : "";
  if (here) put(element, { "data-path": here.path, "data-value": String(here.value) });
}

/** @param {number[]} a @param {number[]} b */
const product = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);

/** @param {number[][]} points */
const listOf = (points) => points.map((p) => p.map((x) => x.toFixed(1)).join()).join(" ");

/** @param {number[]} a @param {number[]} b @param {number} share */
const between = (a, b, share) => a.map((x, i) => x + share * (b[i] - x));

/** @param {{axes: {down: number[]}}} view */
const acrossOf = ({ axes }) => axes.down.findIndex((x) => x !== 0);

/**
 * @typedef {object} Handle
 * @property {"point" | "bearing"} kind
 * @property {number} item
 * @property {number} view
 * @property {Element} element
 * @property {number[]} at in px
 */

/** Both views with a handle for every point in each. */
export class Drawing {
  /**
   * @param {SVGSVGElement} svg
   * @param {import("./model.js").Model} model
   */
  constructor(svg, model) {
    this.svg = svg;
    this.model = model;
    /** The drive angle in rad. */
    this.angle = 0.7;
    /** @type {Handle[]} */
    this.handles = [];
    this.views = model.sent.views.map((view, number) => this.#view(view, number));
    this.scale = 1;
    /** How many times true size the direction across is drawn. */
    this.stretch = 1;
    /** px of an arrow for 1 N. */
    this.push = 0;
    /** What is drawn is so long in mm. */
    this.length = 1;
    /** Of the drawing in px. */
    this.width = 0;
    /** @type {Handle | null} */
    this.selected = null;
    /** What the selected point has come to. */
    this.snaps = /** @type {import("./snaps.js").Snap[]} */ ([]);
    /** Whether what is selected is dragged. */
    this.isHeld = false;
    this.callout = drawn("text", { class: "callout" }, svg);
    this.guides = [0, 1].map(() => ["line", "text"].map((tag) => drawn(tag, { class: "snap" }, svg)));
    this.fit();
  }

  /**
   * @param {{name: string, right: number[], down: number[]}} axes
   * @param {number} number
   */
  #view(axes, number) {
    const { sent, movable } = this.model;
    const group = drawn("g", {}, this.svg);
    const name = drawn("text", { class: "name", x: LEFT - 10 }, group);
    name.textContent = axes.name;
    const many = (/** @type {ArrayLike<any>} */ of, /** @type {string} */ tag, /** @type {string} */ kind) =>
      Array.from(of, () => drawn(tag, { class: kind }, group));
    const joints = sent.points.slice(1, -1);
    const own = {
      axes,
      name,
      edge: drawn("line", { class: "edge" }, group),
      others: many(sent.states, "polyline", "other"),
      tubes: many(sent.points.slice(1), "polygon", "tube"),
      // The far fork of each yoke and the near one, of the driving yoke and the driven one.
      yokes: [0, 1].flatMap((near) =>
        joints.flatMap((_, joint) =>
          [0, 1].map((side) => ({
            near,
            joint,
            side,
            fork: drawn("polyline", { class: `fork s${(joint + side) % 4} ${near ? "" : "far"}` }, group),
          })),
        ),
      ),
      bearings: many(sent.machine.bearings ?? [], "path", "box"),
      arrows: many(sent.machine.bearings ?? [], "path", "arrow"),
      ghost: drawn("polyline", { class: "ghost" }, group),
      joints: (number ? [] : joints).map((_, joint) => {
        const name = drawn("text", {}, group);
        name.textContent = sent.points[joint + 1];
        return [name, drawn("text", { class: "big" }, group)];
      }),
      slopes: many(sent.points.slice(1), "text", "slope"),
      forces: number ? [] : many(sent.machine.bearings ?? [], "text", "force"),
      /** Where bearings are. @type {number[][]} */
      centres: [],
      zero: [0, 0],
      /** Where texts are wanted, and whether others push them up or down. @type {{text: Element, x: number, y: number, way: number}[]} */
      texts: [],
    };
    const along = (/** @type {number} */ i) => {
      const shaft = sent.machine.bearings[i];
      return shaft + this.model.part("positions", i) / this.model.part("lengths", shaft);
    };
    /** @type {{kind: "point" | "bearing", i: number, name: string, at: number}[]} */
    const handles = sent.given.bearings.map((_, i) => ({ kind: "bearing", i, name: `bearing ${i}`, at: along(i) }));
    if (movable) sent.points.forEach((name, i) => handles.push({ kind: "point", i, name, at: i }));
    // The Tab key follows the flow of power.
    handles.sort((a, b) => a.at - b.at);
    for (const { kind, i, name } of handles) this.#handle(kind, i, name, number, group);
    return own;
  }

  /**
   * @param {"point" | "bearing"} kind
   * @param {number} item
   * @param {string} name
   * @param {number} view
   * @param {Element} group
   */
  #handle(kind, item, name, view, group) {
    const label = `${name}, ${this.model.sent.views[view].name.split(":")[0].toLowerCase()}`;
    // One stop of the Tab key for both views.
    const tabindex = view ? "-1" : "0";
    const element = drawn("g", { class: "handle", tabindex, role: "slider", "aria-label": label }, group);
    const orientation = kind === "point" ? "vertical" : "horizontal";
    put(element, { "aria-orientation": orientation, [`data-${kind}`]: String(item), "data-view": String(view) });
    drawn("circle", { class: "hit", r: 20 }, element);
    drawn("circle", { class: "ring", r: 11 }, element);
    drawn("circle", { class: "knob", r: kind === "point" ? 5 : 3 }, element);
    this.handles.push({ kind, item, view, element, at: [0, 0] });
  }

  /**
   * Where a point is drawn in a view.
   * @param {number} view
   * @param {number[]} point in mm
   */
  #at(view, point) {
    const { axes, zero } = this.views[view];
    const [right, down] = [axes.right, axes.down].map((axis) => this.scale * product(axis, point));
    return [zero[0] + right, zero[1] + this.stretch * down];
  }

  /**
   * Where something would be that a handle shows there.
   * @param {Handle} handle
   * @param {number[]} at in px
   * @returns {(number | null)[]} coordinates in mm, null along the line of sight
   */
  placeOf(handle, at) {
    const { axes, zero } = this.views[handle.view];
    const right = (at[0] - zero[0]) / this.scale;
    const down = (at[1] - zero[1]) / this.scale / this.stretch;
    return [0, 1, 2].map((i) =>
      axes.right[i] ? right * axes.right[i] : axes.down[i] ? down * axes.down[i] : null,
    );
  }

  /**
   * How many px are 1 mm along each axis.
   * @param {Handle} handle
   */
  scaleOf(handle) {
    return [0, 1, 2].map((axis) => this.scale * (axis === this.across(handle) ? this.stretch : 1));
  }

  /**
   * The coordinate that a handle shows from top to bottom.
   * @param {Handle} handle
   */
  across(handle) {
    return acrossOf(this.views[handle.view]);
  }

  /**
   * How far from the upstream end of its shaft a bearing would be that a handle shows there, in mm.
   * @param {Handle} handle
   * @param {number[]} at in px
   */
  positionOf(handle, at) {
    const { model } = this;
    const shaft = model.sent.machine.bearings[handle.item];
    const points = model.points(model.state);
    const [first, last] = [points[shaft], points[shaft + 1]].map((point) => this.#at(handle.view, point));
    const along = last.map((x, i) => x - first[i]);
    const share = product(at.map((x, i) => x - first[i]), along) / product(along, along);
    return 1e3 * model.part("lengths", shaft) * share;
  }

  /**
   * The handle nearest to a place, if it is near.
   * @param {number[]} at
   * @param {number} reach in px
   */
  nearest(at, reach) {
    const far = (/** @type {Handle} */ one) => Math.hypot(one.at[0] - at[0], one.at[1] - at[1]);
    const [first] = [...this.handles].sort((a, b) => far(a) - far(b));
    return first && far(first) <= reach ? first : null;
  }

  /**
   * Choose the scale by which everything fits.
   * @param {number} width in px
   */
  fit(width = this.svg.clientWidth || 800) {
    const { model, svg } = this;
    this.width = width;
    const lines = model.sent.states.flatMap((_, state) => [model.points(state)]);
    const all = [...lines, model.drawnPoints].flat();
    const extent = (/** @type {number[]} */ axis) => {
      const along = all.map((point) => product(axis, point));
      return [Math.min(...along), Math.max(...along)];
    };
    const [first, last] = extent(this.views[0].axes.right);
    this.length = Math.max(last - first, 1);
    const heights = this.views.map(({ axes }) => {
      const [low, high] = extent(axes.down);
      return [low * this.stretch - MARGIN * this.length, high * this.stretch + MARGIN * this.length];
    });
    const total = heights.reduce((sum, [low, high]) => sum + high - low, 0);
    this.scale = Math.min((width - 2 * LEFT) / this.length, (this.stretch > 1 ? HIGHEST : TALLEST) / total);
    const middle = (width - this.scale * (first + last)) / 2;
    const reach = this.views[0].arrows.length ? this.#reach + HEAD - MARGIN * this.length * this.scale : 0;
    let top = 0;
    this.views.forEach((view, number) => {
      const [low, high] = heights[number];
      const above = Math.max(number ? 30 : ABOVE, reach);
      view.zero = [middle, top + above - this.scale * low];
      put(view.name, { y: top + 18 });
      put(view.edge, { x1: 0, x2: width, y1: top, y2: top });
      top += above + this.scale * (high - low) + Math.max(BELOW, reach);
    });
    put(svg, { viewBox: `0 0 ${width} ${top.toFixed(0)}`, height: top.toFixed(0) });
  }

  /** Draw the machine as it is. */
  draw() {
    const { model } = this;
    const [points, sent] = [model.points(model.state), model.drawnPoints];
    const { pins, forces } = model.at(this.angle);
    this.views.forEach((view, number) => {
      const at = (/** @type {number[]} */ point) => this.#at(number, point);
      view.texts = [];
      model.sent.states.forEach((_, state) => {
        const line = state === model.state ? [] : model.points(state).map(at);
        put(view.others[state], { points: listOf(line) });
      });
      put(view.ghost, { points: model.isDrawn ? "" : listOf(sent.map(at)) });
      this.#tubes(view, points.map(at));
      this.#yokes(view, points, at, pins);
      this.#bearings(view, points, at);
      this.#arrows(view, forces);
      this.#slopes(view, number, points, at);
      this.#names(view, points.map(at));
      this.#spread(view);
      for (const handle of this.handles) {
        if (handle.view !== number) continue;
        handle.at = handle.kind === "point" ? at(points[handle.item]) : view.centres[handle.item];
        put(handle.element, {
          transform: `translate(${handle.at.map((x) => x.toFixed(1)).join(" ")})`,
          class: handle === this.selected ? "handle on" : "handle",
        });
      }
    });
    this.#guide();
    this.#call();
  }

  /**
   * Put the texts of a view where they are wanted, or above or below others; none is measured, which
   * takes too long.
   * @param {any} view
   */
  #spread(view) {
    /** @type {{x: number, y: number, half: number}[]} */
    const taken = [];
    for (const { text, x: wanted, y: first, way } of view.texts) {
      const half = (text.textContent.length * LETTER) / 2;
      if (!half) continue;
      const x = Math.max(half, Math.min(wanted, this.width - half));
      let y = first;
      const meets = () =>
        taken.find((other) => Math.abs(other.x - x) < other.half + half && Math.abs(other.y - y) < 0.99 * LINE);
      for (let other = meets(); other; other = meets()) y = other.y + way * LINE;
      taken.push({ x, y, half });
      put(text, { x, y });
    }
  }

  /** Write beside what is dragged where it is. */
  #call() {
    const { callout, model, selected } = this;
    const isShown = this.isHeld && selected;
    put(callout, { visibility: isShown ? "visible" : "hidden" });
    if (!isShown) return;
    const { kind, item, view, at } = selected;
    const point = model.points(model.state)[item];
    const { right } = this.views[view].axes;
    const axes = [right.findIndex(Boolean), this.across(selected)];
    const words =
      kind === "point"
        ? axes.map((axis) => `${"xyz"[axis]} ${lengthText(point[axis])}`).join(", ")
        : lengthText(1e3 * model.part("positions", item));
    callout.textContent = `${words} ${lengths().unit}`;
    const half = (callout.textContent.length * LETTER) / 2;
    const away = AWAY + (kind === "point" && !view ? this.#above : 0);
    const y = at[1] - away < LINE ? at[1] + AWAY + LINE : at[1] - away;
    put(callout, { x: Math.max(half, Math.min(at[0], this.width - half)), y });
  }

  /** Show what the selected point has come to, by a line and a word. */
  #guide() {
    this.guides.forEach(([line, text], i) => {
      const snap = this.snaps[i];
      put(text, { visibility: snap ? "visible" : "hidden" });
      put(line, { visibility: snap ? "visible" : "hidden" });
      if (!snap || !this.selected) return;
      const [x, y] = this.selected.at;
      const isAcross = snap.axis === this.across(this.selected);
      const [dx, dy] = isAcross ? [GUIDE, 0] : [0, GUIDE / 3];
      put(line, { x1: x - dx, y1: y - dy, x2: x + dx, y2: y + dy });
      const side = x + GUIDE > this.width ? -1 : 1;
      put(text, isAcross ? { x: x + side * 0.6 * GUIDE, y: y - 6 } : { x: x + 40 * side, y: y + GUIDE / 3 });
      text.textContent = snap.words;
    });
  }

  /** Write what the figures say of joints and bearings. */
  label() {
    const [side] = this.views;
    side.joints.forEach(([, bend], joint) => mark(bend, this.model.here("bend", joint)));
    this.#forces(side, this.model.sent.machine.bearings ?? []);
    this.#spread(side);
  }

  /** Choose the length of the arrows by the largest force of all states. */
  measure() {
    const found = this.model.figures.filter(({ kind }) => kind.name === "bearing_force");
    const most = Math.max(...found.flatMap(({ values }) => Array.from(values).filter(Number.isFinite)), 0);
    this.push = most > 0 ? this.#reach / most : 0;
  }

  /** The longest arrow in px. */
  get #reach() {
    return Math.min(ARROW, WIDEST * this.width);
  }

  /**
   * Announces the verdict at the handles.
   * @param {string} verdict
   */
  speak(verdict) {
    const { model } = this;
    const points = model.points(model.state);
    for (const { element, kind, item, view } of this.handles) {
      const down = acrossOf(this.views[view]);
      const now = kind === "point" ? points[item][down] : 1e3 * model.part("positions", item);
      const words =
        kind === "point" ? points[item].map((x, axis) => `${"xyz"[axis]} ${lengthText(x)}`).join(", ") : lengthText(now);
      put(element, { "aria-valuenow": String(now), "aria-valuetext": `${words} ${lengths().unit}; ${verdict}` });
    }
  }

  /** @param {number} shaft in px */
  #radius(shaft) {
    const { tubes = [], outer_diameter: across = [] } = this.model.sent.machine;
    const place = tubes.indexOf(shaft);
    const radius = place < 0 ? RADIUS * this.length : 500 * across[place];
    return Math.max(4, Math.min(radius * this.scale, 26));
  }

  /** Half the length of a joint in px. */
  get #yoke() {
    return Math.max(11, YOKE * this.length * this.scale);
  }

  /** @param {any} view @param {number[][]} line */
  #tubes(view, line) {
    view.tubes.forEach((/** @type {Element} */ tube, /** @type {number} */ shaft) => {
      const [first, last] = [line[shaft], line[shaft + 1]];
      const far = Math.hypot(last[0] - first[0], last[1] - first[1]) || 1;
      const side = [(first[1] - last[1]) / far, (last[0] - first[0]) / far].map((x) => x * this.#radius(shaft));
      const cut = Math.min(0.45, this.#yoke / far);
      const start = between(first, last, shaft ? cut : 0);
      const end = between(last, first, shaft + 2 < line.length ? cut : 0);
      const corners = [[start, 1], [end, 1], [end, -1], [start, -1]].map(([p, sign]) =>
        [0, 1].map((i) => /** @type {number[]} */ (p)[i] + Number(sign) * side[i]),
      );
      put(tube, { points: listOf(corners) });
    });
  }

  /**
   * @param {any} view
   * @param {number[][]} points
   * @param {(point: number[]) => number[]} at
   * @param {number[][][]} pins
   */
  #yokes(view, points, at, pins) {
    const { right, down } = view.axes;
    // Towards the viewer: right, up and this are right-handed.
    const viewer = [
      down[1] * right[2] - down[2] * right[1],
      down[2] * right[0] - down[0] * right[2],
      down[0] * right[1] - down[1] * right[0],
    ];
    const half = this.#yoke;
    for (const { near, joint, side, fork } of view.yokes) {
      const centre = at(points[joint + 1]);
      const along = at(points[side ? joint + 2 : joint]);
      const far = Math.hypot(along[0] - centre[0], along[1] - centre[1]) || 1;
      const pin = pins[joint][side];
      const sign = (near ? 1 : -1) * (product(viewer, pin) >= 0 ? 1 : -1);
      const across = [right, down].map((axis) => sign * 0.62 * half * product(axis, pin));
      const root = between(centre, along, Math.min(0.45, half / far));
      const knee = between(centre, along, Math.min(0.33, (0.72 * half) / far));
      const tip = centre.map((x, i) => x + across[i]);
      put(fork, {
        points: listOf([root, knee.map((x, i) => x + across[i]), tip]),
        "stroke-width": Math.max(3, 0.27 * half),
      });
    }
  }

  /**
   * @param {any} view
   * @param {number[][]} points
   * @param {(point: number[]) => number[]} at
   */
  #bearings(view, points, at) {
    const { bearings = [] } = this.model.sent.machine;
    view.bearings.forEach((/** @type {Element} */ box, /** @type {number} */ bearing) => {
      const shaft = bearings[bearing];
      const [first, last] = [at(points[shaft]), at(points[shaft + 1])];
      const share = this.model.part("positions", bearing) / this.model.part("lengths", shaft);
      const centre = between(first, last, share);
      view.centres[bearing] = centre;
      const far = Math.hypot(last[0] - first[0], last[1] - first[1]) || 1;
      const [dx, dy] = [(last[0] - first[0]) / far, (last[1] - first[1]) / far];
      const [radius, w] = [this.#radius(shaft), 4.5];
      const path = [1, -1].map((sign) => {
        const corner = (/** @type {number} */ i, /** @type {number} */ j) => {
          const [u, v] = [i * w, sign * (radius + w + 1) + j * w];
          return `${(centre[0] + u * dx - v * dy).toFixed(1)} ${(centre[1] + u * dy + v * dx).toFixed(1)}`;
        };
        return `M${corner(-1, -1)}L${corner(1, -1)}L${corner(1, 1)}L${corner(-1, 1)}ZL${corner(1, 1)}M${corner(1, -1)}L${corner(-1, 1)}`;
      });
      put(box, { d: path.join("") });
      const label = view.forces[bearing];
      if (label) view.texts.push({ text: label, x: centre[0], y: centre[1] + radius + 25, way: 1 });
    });
  }

  /**
   * The force of each bearing on its shaft at the drive angle.
   * @param {any} view
   * @param {number[][]} forces
   */
  #arrows(view, forces) {
    forces.forEach((force, bearing) => {
      const across = [view.axes.right, view.axes.down].map((axis) => this.push * product(axis, force));
      const long = Math.hypot(...across);
      const start = view.centres[bearing];
      const end = start.map((/** @type {number} */ x, /** @type {number} */ i) => x + across[i]);
      const [u, v] = across.map((x) => x / long);
      const head = [1, -1].map((side) => [end[0] - HEAD * u - 0.45 * side * HEAD * v, end[1] - HEAD * v + 0.45 * side * HEAD * u]);
      const path = `M${listOf([start])}L${listOf([end])}M${listOf([end])}L${listOf([head[0]])}L${listOf([head[1]])}Z`;
      put(view.arrows[bearing], { d: long > HEAD / 2 ? path : "" });
    });
  }

  /**
   * The slope of each shaft below it, where there is room: how fast the coordinate across rises along
   * the view, whatever is stretched.
   * @param {any} view
   * @param {number} number
   * @param {number[][]} points
   * @param {(point: number[]) => number[]} at
   */
  #slopes(view, number, points, at) {
    const { right } = view.axes;
    const axis = acrossOf(view);
    const { digits } = this.model.sent.kinds.bend;
    view.slopes.forEach((/** @type {Element} */ text, /** @type {number} */ shaft) => {
      const along = points[shaft + 1].map((x, i) => x - points[shaft][i]);
      const ends = [at(points[shaft]), at(points[shaft + 1])];
      const isLong = Math.hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]) > LONG + 2 * this.#yoke;
      const value = (Math.atan2(along[axis], product(right, along)) * 180) / Math.PI;
      const words = `${this.width < WIDE ? "" : "slope "}${numberText(value, digits)}°`;
      mark(text, isLong ? { value, text: words, path: `derived:slopes_deg[view=${number},shaft=${shaft}]` } : null);
      const isFree = (/** @type {number} */ share) =>
        view.centres.every(
          (/** @type {number[]} */ centre) => Math.abs(centre[0] - between(ends[0], ends[1], share)[0]) > APART,
        );
      const share = [0.5, 0.35, 0.65, 0.25, 0.75].find(isFree);
      const [x, y] = between(ends[0], ends[1], share ?? 0.5);
      // Below what rises towards either end of the words, and below a force.
      const rise = Math.min(2, Math.abs((ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0] || 1)));
      const below = this.#radius(shaft) * Math.hypot(1, rise) + 7 * words.length * (rise / 2) + 15;
      view.texts.push({ text, x, y: y + below, way: 1 });
    });
  }

  /**
   * The largest force of each shaft in the state shown.
   * @param {any} view
   * @param {number[]} shafts
   */
  #forces(view, shafts) {
    const { model } = this;
    if (!view.forces.length) return;
    const found = shafts.map((_, bearing) => model.here("bearing_force", bearing));
    if (!found.some(Boolean)) {
      for (const label of view.forces) put(label, { class: "force pale" });
      return;
    }
    const most = (/** @type {number} */ shaft) =>
      Math.max(...found.map((each, i) => (each && shafts[i] === shaft ? each.value : -1)));
    const named = new Set();
    shafts.forEach((shaft, bearing) => {
      const [label, here] = [view.forces[bearing], found[bearing]];
      const isShown = here && here.value === most(shaft) && !named.has(shaft);
      if (isShown) named.add(shaft);
      put(label, { class: "force" });
      mark(label, isShown ? here : null);
    });
  }

  /**
   * @param {any} view
   * @param {number[][]} line
   */
  #names(view, line) {
    view.joints.forEach((/** @type {Element[]} */ [name, bend], /** @type {number} */ joint) => {
      const [x, y] = line[joint + 1];
      view.texts.push({ text: bend, x, y: y - this.#above, way: -1 });
      view.texts.push({ text: name, x, y: y - this.#above - 17, way: -1 });
    });
  }

  /** px from a joint to its bend above it. */
  get #above() {
    return 0.62 * this.#yoke + 18;
  }
}
