// @ts-check
/**
 * Elements of a page and of its drawings.
 *
 * @module elements
 */

const SAID_MS = 10_000; // a text that is said for a while

/**
 * An element at the end of another.
 * @param {string} tag
 * @param {string} kind
 * @param {Element} parent
 * @param {string} text
 */
export function made(tag, kind, parent, text = "") {
  const element = document.createElement(tag);
  if (kind) element.className = kind;
  element.textContent = text;
  parent.append(element);
  return element;
}

/**
 * Give an element a text that it may have.
 * @param {Element} element
 * @param {string} text
 */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** When what was said for a while goes, by its element. */
const passing = new WeakMap();

/**
 * Give an element a text for a while.
 * @param {Element} element
 * @param {string} text
 */
export function briefly(element, text) {
  clearTimeout(passing.get(element));
  say(element, text);
  if (text) passing.set(element, setTimeout(() => say(element, ""), SAID_MS));
}

/**
 * An element of SVG at the end of another.
 * @param {string} name
 * @param {Record<string, string | number>} attributes
 * @param {Element} parent
 * @param {string} text
 */
export function drawn(name, attributes, parent, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  put(element, attributes);
  if (text) element.textContent = text;
  parent.append(element);
  return element;
}

/**
 * Give an element attributes, of which it may have some; numbers are in px.
 * @param {Element} element
 * @param {Record<string, string | number>} attributes
 */
export function put(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    const text = typeof value === "number" ? px(value) : value;
    if (element.getAttribute(name) !== text) element.setAttribute(name, text);
  }
}

/**
 * A length in px, to the tenth.
 * @param {number} value
 */
export const px = (value) => String(Math.round(10 * value) / 10);
