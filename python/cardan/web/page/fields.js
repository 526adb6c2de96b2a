// @ts-check
/**
 * Numbers that are typed, stepped by keys or dragged sideways.
 *
 * @module fields
 */

import { exact, lengths, numberText } from "./numbers.js";
import { made } from "./elements.js";

const SCRUB = 4; // px from which a press is a drag
const PER_STEP = 3; // px of a drag for one step

/**
 * What a field shows and sets.
 * @typedef {object} Shown
 * @property {string} label
 * @property {string} unit of `get` and `set`; of lengths mm, whatever is shown
 * @property {import("./numbers.js").Digits} digits
 * @property {number} step by an arrow key; ten with Shift, a tenth with Alt
 * @property {number} most its magnitude, beyond which it is refused
 * @property {() => number} get
 * @property {(value: number) => void} set
 */

/**
 * What is told.
 * @typedef {object} Told
 * @property {() => void} begin a gesture
 * @property {() => void} moved
 * @property {(what: string, time?: number) => void} done
 * @property {(words: string) => void} refuse
 */

/**
 * A number that was typed, with a decimal comma or a true minus sign as well.
 * @param {string} text
 */
export function typed(text) {
  const plain = text.replace(/[\s\u2009]/g, "").replace("\u2212", "-").replace(/^([-+]?\d*),(\d*)$/, "$1.$2");
  return plain ? Number(plain) : NaN;
}

/** A number in a line of text. */
export class Field {
  /**
   * @param {Element} parent
   * @param {Shown} shown
   * @param {Told} told
   */
  constructor(parent, shown, told) {
    this.shown = shown;
    const whole = made("label", "number", parent);
    made("span", "", whole, shown.label);
    this.input = /** @type {HTMLInputElement} */ (made("input", "", whole));
    Object.assign(this.input, { type: "text", inputMode: "decimal", autocomplete: "off", spellcheck: false });
    this.unit = made("span", "", whole);
    this.#listen(told);
    this.show();
  }

  /** How it is shown: its unit, how much of its own unit that is, digits and step. */
  get #form() {
    const { unit, digits, step } = this.shown;
    const { mm: size, ...form } = unit === "mm" ? lengths() : { unit, digits, step, mm: 1 };
    return { size, ...form };
  }

  /** Show the number as it is, unless somebody types. */
  show() {
    const { get, label } = this.shown;
    if (this.isTyped) return;
    const { unit, size, digits } = this.#form;
    const text = numberText(get() / size, digits);
    if (this.unit.textContent !== unit) {
      this.unit.textContent = unit;
      this.input.setAttribute("aria-label", `${label}, ${unit}`);
    }
    if (this.input.value !== text) this.input.value = text;
    this.input.style.width = `${Math.max(5, text.length + 2)}ch`;
    this.input.dataset.value = String(get());
  }

  /** Whether the text has been changed and not yet been taken. */
  isTyped = false;

  /** @param {Told} told */
  #listen(told) {
    const { input, shown } = this;
    const { label, unit, most } = shown;
    const sized = (/** @type {KeyboardEvent | PointerEvent} */ event) =>
      this.#form.step * this.#form.size * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
    /** @param {number} value */
    const put = (value) => {
      if (Math.abs(value) > most) told.refuse(`${label} must be within ±${most} ${unit}; the last value stays.`);
      else shown.set(exact(value));
    };
    const take = () => {
      if (!this.isTyped) return;
      this.isTyped = false;
      const value = typed(input.value);
      if (Number.isFinite(value)) {
        told.begin();
        put(value * this.#form.size);
        told.done(label);
      } else told.refuse(`“${input.value}” is no number; ${label} stays as it was.`);
      this.show();
    };
    input.addEventListener("input", () => {
      this.isTyped = true;
    });
    input.addEventListener("change", take);
    input.addEventListener("keydown", (event) => {
      const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (event.key === "Escape" || event.key === "Enter") {
        if (event.key === "Enter") take();
        this.isTyped = false;
        this.show();
        input.select();
      }
      if (!way || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      this.isTyped = false;
      told.begin();
      put(shown.get() + way * sized(event));
      told.done(label, performance.now());
    });
    /** @type {{x: number, value: number, drags: boolean} | null} */
    let press = null;
    input.addEventListener("pointerdown", (event) => {
      if (event.button || document.activeElement === input) return;
      press = { x: event.clientX, value: shown.get(), drags: false };
      input.setPointerCapture(event.pointerId);
    });
    input.addEventListener("pointermove", (event) => {
      if (!press) return;
      const far = event.clientX - press.x;
      if (!press.drags) {
        if (Math.abs(far) < SCRUB) return;
        press.drags = true;
        input.blur();
        told.begin();
      }
      put(press.value + Math.round(far / PER_STEP) * sized(event));
      told.moved();
    });
    const release = () => {
      const was = press;
      press = null;
      if (was?.drags) {
        input.blur();
        told.done(label);
      }
    };
    input.addEventListener("pointerup", release);
    input.addEventListener("pointercancel", release);
    input.addEventListener("focus", () => input.select());
  }
}
