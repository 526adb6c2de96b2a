// @ts-check
/**
 * Points and bearings moved in the drawing, by pointer and by keys.
 *
 * @module editing
 */

import { lengths, tidy } from "./numbers.js";
import { snapped } from "./snaps.js";

const REACH = { mouse: 20, touch: 30 }; // px
const FINE = 0.1; // of a drag with Alt
/** How far a key moves: to the right, down, and along the axis that a view does not show. */
const KEYS = /** @type {Record<string, number[]>} */ ({
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, -1, 0],
  ArrowDown: [0, 1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
});

/** @typedef {import("./drawing.js").Handle} Handle */

/** What moves the handles of a drawing. */
export class Editing {
  /**
   * The handle dragged, from where in mm, where the pointer was last and where it has taken the handle, in px.
   * @type {{handle: Handle, from: number[], last: number[], spot: number[]} | null}
   */
  #drag = null;

  /**
   * @param {import("./drawing.js").Drawing} drawing
   * @param {{select: () => void, moved: () => void, done: () => void, stepped: () => void}} told a
   *   handle is chosen, a drag goes on, a gesture has ended, and so has one of those that may follow fast
   */
  constructor(drawing, told) {
    this.drawing = drawing;
    this.model = drawing.model;
    this.told = told;
    const { svg } = drawing;
    svg.addEventListener("pointerdown", (event) => this.#press(event));
    svg.addEventListener("pointermove", (event) => this.#follow(event));
    svg.addEventListener("pointerup", () => this.#release());
    svg.addEventListener("pointercancel", () => this.giveUp());
    // A browser scrolls by parts of a drawing, whatever their touch-action.
    svg.addEventListener("touchstart", (event) => this.#hold(event), { passive: false });
    for (const handle of drawing.handles) {
      handle.element.addEventListener("focus", () => {
        drawing.selected = handle;
        told.select();
      });
      handle.element.addEventListener("keydown", (event) => this.#step(handle, /** @type {KeyboardEvent} */ (event)));
    }
  }

  get isDragging() {
    return this.#drag !== null;
  }

  /**
   * Let a finger move handles, and scroll the page everywhere else.
   * @param {TouchEvent} event
   */
  #hold(event) {
    // The pointer has come down before.
    if (this.isDragging && event.cancelable) event.preventDefault();
  }

  /**
   * Whether a finger moves what a handle is of: it chooses first, since it also scrolls the page.
   * @param {Handle} handle
   */
  #isChosen({ kind, item }) {
    const { selected } = this.drawing;
    return selected?.kind === kind && selected.item === item;
  }

  /** @param {{clientX: number, clientY: number}} event */
  #placeOf(event) {
    const box = this.drawing.svg.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** @param {PointerEvent} event */
  #press(event) {
    if (event.button) return;
    const { drawing } = this;
    const at = this.#placeOf(event);
    const isTouch = event.pointerType === "touch";
    const handle = drawing.nearest(at, isTouch ? REACH.touch : REACH.mouse);
    if (!handle) return;
    const moves = !isTouch || this.#isChosen(handle);
    drawing.selected = handle;
    /** @type {SVGGElement} */ (handle.element).focus({ preventScroll: true });
    if (!moves) return this.told.select();
    event.preventDefault();
    drawing.svg.setPointerCapture(event.pointerId);
    const from = handle.kind === "point" ? this.model.points(this.model.state)[handle.item] : [];
    this.#drag = { handle, from, last: at, spot: [...handle.at] };
    this.model.begin();
    drawing.svg.classList.add("dragging");
    drawing.isHeld = true;
    this.told.moved();
  }

  /** @param {PointerEvent} event */
  #follow(event) {
    if (!this.#drag) return;
    const { drawing, model } = this;
    const { handle, from, last, spot } = this.#drag;
    const at = this.#placeOf(event);
    spot.forEach((_, i) => {
      spot[i] += (event.altKey ? FINE : 1) * (at[i] - last[i]);
    });
    this.#drag.last = at;
    if (handle.kind === "bearing") {
      const position = drawing.positionOf(handle, spot);
      model.slide(handle.item, event.altKey ? Math.round(10 * position) / 10 : Math.round(position));
    } else {
      const points = model.points(model.state);
      const others = [{ at: model.drawnPoints[handle.item], words: "as drawn" }];
      for (const i of [handle.item - 1, handle.item + 1]) {
        if (points[i]) others.push({ at: points[i], words: `level with ${model.sent.points[i]}` });
      }
      const { to, snaps } = snapped(drawing.placeOf(handle, spot), {
        from,
        own: points[handle.item],
        others,
        scale: drawing.scaleOf(handle),
        isFree: event.altKey,
        isStraight: event.shiftKey,
      });
      drawing.snaps = snaps;
      model.place(handle.item, to);
    }
    this.told.moved();
  }

  #end() {
    this.#drag = null;
    this.drawing.snaps = [];
    this.drawing.isHeld = false;
    this.drawing.svg.classList.remove("dragging");
  }

  #release() {
    if (!this.#drag) return;
    const { kind, item } = this.#drag.handle;
    this.model.commit(`move ${kind} ${item}`);
    this.#end();
    this.told.done();
  }

  /** Take a drag back. */
  giveUp() {
    if (!this.#drag) return;
    this.#end();
    this.model.cancel();
    this.told.done();
  }

  /** @param {Handle} handle @param {KeyboardEvent} event */
  #step(handle, event) {
    const way = KEYS[event.key];
    if (!way || this.#drag || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const { model } = this;
    const { mm, step: one } = lengths();
    const step = mm * one * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
    model.begin();
    if (handle.kind === "bearing") {
      model.slide(handle.item, tidy(1e3 * model.part("positions", handle.item) + step * (way[0] - way[1] + way[2])));
    } else {
      const { right, down } = model.sent.views[handle.view];
      const own = model.points(model.state)[handle.item];
      const to = own.map((x, axis) => {
        const depth = right[axis] || down[axis] ? 0 : way[2];
        const by = step * (way[0] * right[axis] + way[1] * down[axis] + depth);
        return by ? tidy(x + by) : null;
      });
      model.place(handle.item, to);
    }
    model.commit(`key ${handle.kind} ${handle.item}`, performance.now());
    this.told.stepped();
  }
}
