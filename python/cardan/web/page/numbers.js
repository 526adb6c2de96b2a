// @ts-check
/**
 * Numbers as people read them.
 *
 * @module numbers
 */

/**
 * With how many digits a kind of figure is shown, as `cardan.app.answers.rows.Digits`.
 * @typedef {{decimals: number | null, digits: number | null, apart: number | null, finest: number}} Digits
 */

/** Values that differ by less than this share of their size differ by rounding only. */
export const ROUNDING = 1e-9;
const MINUS = "\u2212";

/**
 * A text with true minus signs.
 * @param {string} text
 */
export const minus = (text) => text.replace(/(^| )-(?=[\d.])/g, `$1${MINUS}`);

/**
 * An angle within half a period of 0.
 * @param {number} angle
 * @param {number} period
 */
export const folded = (angle, period) => angle - period * Math.round(angle / period);

/**
 * A change with its sign, to a tenth, or to what it is.
 * @param {number} number
 */
export const signed = (number) => `${number < 0 ? MINUS : "+"}${Math.abs(number).toFixed(1)}`;

/**
 * A length in mm without what a change of units or a subtraction adds.
 * @param {number} number
 */
export const tidy = (number) => Math.round(1e6 * number) / 1e6;

/**
 * A number without what adding leaves of rounding errors, as a scene has it.
 * @param {number} number
 */
export const exact = (number) => Number(number.toFixed(9));

/**
 * How much of a limit is used, in whole percent: 100 only of one that is used exactly.
 * @param {number} share
 */
export function useText(share) {
  let percent = Math.round(100 * share);
  if (Math.abs(share - 1) > ROUNDING) percent = share < 1 ? Math.min(percent, 99) : Math.max(percent, 101);
  return `${percent}%`;
}

/**
 * A number, or 0 where it is mere rounding: finer than its kind, and than what it is told apart from.
 * @param {number} number in the unit that is shown
 * @param {Digits} rule
 * @param {number[]} apartFrom
 */
export function settled(number, rule, apartFrom) {
  const isTold = apartFrom.some((other) => other / number > 0 && other / number <= 1 + ROUNDING);
  return Math.abs(number) < rule.finest && !isTold ? 0 : number;
}

/** @param {string} text @param {{unit: string}} kind */
export function withUnit(text, kind) {
  return ["", "°", "%"].includes(kind.unit) ? text + kind.unit : `${text} ${kind.unit}`;
}

/**
 * A number as `cardan.app.answers.printed.number_text` writes it, with a true minus sign.
 * @param {number} number in the unit that is shown
 * @param {Digits} rule
 * @param {number[]} apartFrom what it is told apart from
 */
export function numberText(number, rule, apartFrom = []) {
  return digitsOf(settled(number, rule, apartFrom), rule, apartFrom).replace(/^-/, MINUS);
}

/** @param {number} number @param {Digits} rule @param {number[]} apartFrom */
function digitsOf(number, rule, apartFrom) {
  if (Number.isNaN(number)) return "not known";
  if (!Number.isFinite(number)) return "unlimited";
  if (number === 0) return "0";
  const others = [...apartFrom.filter(Number.isFinite), 0, ...(rule.apart === null ? [] : [rule.apart])];
  for (const other of others) {
    if (Math.abs(number - other) <= ROUNDING * Math.abs(other)) return asGiven(other);
  }
  const size = Math.floor(Math.log10(Math.abs(number)));
  const isReadable = size >= -5 && size < 7;
  const digits = rule.digits ?? 3;
  const exponent = Number(number.toExponential(digits - 1).split("e")[1]);
  const fewest = rule.decimals ?? Math.max(0, digits - 1 - exponent);
  for (let more = 0; more < 15; more++) {
    const text = isReadable ? number.toFixed(fewest + more) : number.toExponential(2 + more);
    const shown = Number(text);
    if (others.every((other) => Math.sign(shown - other) === Math.sign(number - other))) return text;
  }
  return String(number);
}

/**
 * All digits that someone gave.
 * @param {number} number
 */
export const asGiven = (number) => String(Number(number.toPrecision(10)));
