// @ts-check
/**
 * Points and bearings moved in the drawing, by pointer and by keys.
 *
 * @module editing
 */

import { tidy } from "./numbers.js";

const REACH = { mouse: 20, touch: 30 }; // px
const KEYS = /** @type {Record<string, number[]>} */ ({
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
});

/** @typedef {import("./drawing.js").Handle} Handle */

/** What moves the handles of a drawing. */
export class Editing {
  #drag = /** @type {{handle: Handle, off: number[]} | null} */ (null);

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
    if (this.drawing.nearest(this.#placeOf(event.touches[0]), REACH.touch)) event.preventDefault();
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
    const handle = drawing.nearest(at, event.pointerType === "touch" ? REACH.touch : REACH.mouse);
    if (!handle) return;
    event.preventDefault();
    drawing.svg.setPointerCapture(event.pointerId);
    drawing.selected = handle;
    /** @type {SVGGElement} */ (handle.element).focus({ preventScroll: true });
    this.#drag = { handle, off: at.map((x, i) => handle.at[i] - x) };
    this.model.begin();
    drawing.svg.classList.add("dragging");
    this.told.moved();
  }

  /** @param {PointerEvent} event */
  #follow(event) {
    if (!this.#drag) return;
    const { drawing, model } = this;
    const { handle, off } = this.#drag;
    const at = this.#placeOf(event).map((x, i) => x + off[i]);
    if (handle.kind === "bearing") {
      model.slide(handle.item, Math.round(drawing.positionOf(handle, at)));
    } else {
      const own = model.points(model.state)[handle.item];
      const wanted = drawing.placeOf(handle, at);
      // A coordinate that the pointer has not left keeps its tenths.
      const to = wanted.map((x, axis) => (x === null || Math.abs(x - own[axis]) < 0.5 ? null : Math.round(x)));
      model.place(handle.item, to);
    }
    this.told.moved();
  }

  #end() {
    this.#drag = null;
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
    const step = event.shiftKey ? 10 : event.altKey ? 0.1 : 1;
    model.begin();
    if (handle.kind === "bearing") {
      model.slide(handle.item, tidy(1e3 * model.part("positions", handle.item) + step * (way[0] - way[1])));
    } else {
      const { right, down } = model.sent.views[handle.view];
      const own = model.points(model.state)[handle.item];
      const to = own.map((x, axis) => {
        const by = step * (way[0] * right[axis] + way[1] * down[axis]);
        return by ? tidy(x + by) : null;
      });
      model.place(handle.item, to);
    }
    model.commit(`key ${handle.kind} ${handle.item}`, performance.now());
    this.told.stepped();
  }
}
