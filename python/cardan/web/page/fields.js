// @ts-check
/**
 * Numbers that are typed, stepped by keys or dragged sideways.
 *
 * @module fields
 */

import { exact, formOf, grouped, lengths, numberText } from "./numbers.js";
import { made } from "./elements.js";

const SCRUB = 4; // px from which a press is a drag
const PER_STEP = 3; // px of a drag for one step

/**
 * Value that a field shows and sets.
 * @typedef {object} Shown
 * @property {string} label
 * @property {string} unit of `get` and `set`; of lengths mm, whatever is shown
 * @property {import("./numbers.js").Digits} digits
 * @property {import("./numbers.js").Form | null} [us] the US unit in its place
 * @property {number} step by an arrow key; ten with Shift, a tenth with Alt
 * @property {number} most its magnitude, beyond which it is refused
 * @property {() => number} get
 * @property {(value: number) => void} set
 */

/**
 * Callbacks of a field.
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
    const group = made("span", "number", parent);
    const less = this.#button(group, "\u2212", `less ${shown.label}`);
    const whole = made("label", "", group);
    made("span", "", whole, shown.label);
    this.input = /** @type {HTMLInputElement} */ (made("input", "", whole));
    Object.assign(this.input, { type: "text", inputMode: "decimal", autocomplete: "off", spellcheck: false });
    this.unit = made("span", "", whole);
    const more = this.#button(group, "+", `more ${shown.label}`);
    this.#listen(told, [less, more]);
    this.show();
  }

  /**
   * A button for fingers, which keys do not need.
   * @param {Element} group
   * @param {string} text
   * @param {string} label
   */
  #button(group, text, label) {
    const button = /** @type {HTMLButtonElement} */ (made("button", "", group, text));
    Object.assign(button, { type: "button", tabIndex: -1, ariaLabel: label });
    return button;
  }

  /** How it is shown: its unit, how much of its own unit that is, digits and step. */
  get #form() {
    const { unit, step } = this.shown;
    if (unit !== "mm") return { step, ...formOf(this.shown) };
    const { mm: size, ...form } = lengths();
    return { size, ...form };
  }

  /** How large it may be, in words. */
  get #rule() {
    const { unit, size } = this.#form;
    return `must be within ±${grouped(Math.floor(this.shown.most / size))} ${unit}, more than any driveline has`;
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
      this.input.title = `${label} ${this.#rule}`;
    }
    if (this.input.value !== text) this.input.value = text;
    this.input.style.width = `${Math.max(5, text.length + 2)}ch`;
    this.input.dataset.value = String(get());
  }

  /** Whether the text has been changed and not yet been taken. */
  isTyped = false;

  /** @param {Told} told @param {HTMLButtonElement[]} buttons for less and for more */
  #listen(told, buttons) {
    const { input, shown } = this;
    const { label, unit, most } = shown;
    const sized = (/** @type {KeyboardEvent | MouseEvent} */ event) =>
      this.#form.step * this.#form.size * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
    /** @param {number} value */
    const put = (value) => {
      if (Math.abs(value) > most) told.refuse(`${label} ${this.#rule}; the last value stays.`);
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
    const step = (/** @type {number} */ way, /** @type {KeyboardEvent | MouseEvent} */ event) => {
      this.isTyped = false;
      told.begin();
      put(shown.get() + way * sized(event));
      told.done(label, performance.now());
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
      step(way, event);
    });
    buttons.forEach((button, i) => button.addEventListener("click", (event) => step(2 * i - 1, event)));
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
