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
const MOST_USED = 999; // percent of a limit that are told

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
 * A change with its sign, to a tenth.
 * @param {number} number
 */
export const signed = (number) => `${number < 0 ? MINUS : "+"}${Math.abs(number).toFixed(1)}`;

/**
 * A unit in which something is shown: how many of its own unit that is, and with how many digits.
 * @typedef {{unit: string, size: number, digits: Digits}} Form
 */

/**
 * Quantity with its SI unit and digits, and the US unit in its place if there is one.
 * @typedef {{unit: string, digits: Digits, us?: Form | null}} Measured
 */

/** @typedef {"si" | "us"} System */

/** @type {System} */
let system = "si";

/** The units in which everything is shown. */
export const units = () => system;

/**
 * Show everything in other units from now on.
 * @param {System} now
 */
export function showIn(now) {
  system = now;
}

/**
 * The unit in which something is shown.
 * @param {Measured} of
 * @returns {Form}
 */
export const formOf = ({ unit, digits, us }) => (system === "us" && us ? us : { unit, digits, size: 1 });

/**
 * A unit of lengths: how many mm it is, with how many digits lengths are shown, and the step of a key.
 * @typedef {{unit: string, mm: number, digits: Digits, step: number}} Lengths
 */

/** @type {Record<System, Lengths>} */
const LENGTHS = {
  si: { unit: "mm", mm: 1, digits: { decimals: 1, digits: null, apart: null, finest: 1e-6 }, step: 1 },
  us: { unit: "in", mm: 25.4, digits: { decimals: 3, digits: null, apart: null, finest: 4e-8 }, step: 0.01 },
};

/** The unit in which lengths are shown. */
export const lengths = () => LENGTHS[system];

/**
 * A length without its unit.
 * @param {number} millimetres
 */
export const lengthText = (millimetres) => {
  const { mm, digits } = lengths();
  const text = Math.abs(millimetres / mm).toFixed(digits.decimals ?? 0);
  return (millimetres < 0 && Number(text) ? MINUS : "") + text;
};

/**
 * A change of a length with its sign and without its unit.
 * @param {number} millimetres
 */
export const signedLength = (millimetres) => (millimetres < 0 ? MINUS : "+") + lengthText(Math.abs(millimetres));

/**
 * The size of a change of a length with its unit, rounded up so that it does what it promises.
 * @param {number} millimetres
 */
export const lengthUp = (millimetres) => {
  const { mm, digits, unit } = lengths();
  const steps = 10 ** (digits.decimals ?? 0);
  const size = Math.ceil(Math.abs(millimetres / mm) * steps * (1 - 1e-12)) / steps;
  return `${size.toFixed(digits.decimals ?? 0)} ${unit}`;
};

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
 * How much of a limit is used, in whole percent: 100 only of one that is used exactly; far beyond
 * it how much does not matter.
 * @param {number} share
 */
export function useText(share) {
  let percent = Math.round(100 * share);
  if (Math.abs(share - 1) > ROUNDING) percent = share < 1 ? Math.min(percent, 99) : Math.max(percent, 101);
  return percent > MOST_USED ? `> ${MOST_USED}%` : `${percent}%`;
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

/**
 * A figure with the unit in which it is shown.
 * @param {number} value in the unit of the kind
 * @param {Measured} kind
 * @param {number[]} apartFrom what it is told apart from
 */
export function quantityText(value, kind, apartFrom = []) {
  const { unit, size, digits } = formOf(kind);
  const text = numberText(value / size, digits, apartFrom.map((other) => other / size));
  return ["", "°", "%"].includes(unit) ? text + unit : `${text} ${unit}`;
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
 * A whole number with its thousands apart.
 * @param {number} number
 */
export const grouped = (number) => String(number).replace(/\B(?=(\d{3})+$)/g, "\u2009");

/**
 * All digits that someone gave.
 * @param {number} number
 */
export const asGiven = (number) => String(Number(number.toPrecision(10)));

/**
 * Text of a value that someone gave, with the unit in which it is shown.
 * @param {number} value
 * @param {{unit: string, us?: Form | null}} of
 */
export function givenText(value, { unit, us }) {
  return system === "us" && us ? `${Number((value / us.size).toPrecision(6))} ${us.unit}` : `${asGiven(value)} ${unit}`;
}
