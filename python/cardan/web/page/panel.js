// @ts-check
/**
 * The verdict, and every figure that has a limit beside it.
 *
 * @module panel
 */

import { drawn, made, put, say } from "./elements.js";
import { givenText, lengthUp, minus, units, useText } from "./numbers.js";

const MARKS = /** @type {Record<string, string[]>} */ ({
  within: ["M7 0a7 7 0 1 1 0 14A7 7 0 0 1 7 0z", "m4 7.2 2.2 2.2L10.2 5"],
  tolerable: ["M7 .8 13.8 13H.2z", "M7 5v3.8M7 10.8v.2"],
  beyond: ["M4.1 0h5.8L14 4.1v5.8L9.9 14H4.1L0 9.9V4.1z", "m4.6 4.6 4.8 4.8M9.4 4.6 4.6 9.4"],
  "not judged": ["M0 0h14v14H0z", "M4 7h6"],
});
const HEADS = /** @type {Record<string, string>} */ ({
  within: "Within all limits",
  tolerable: "Tolerable",
  beyond: "Beyond its limits",
  "not judged": "Not judged",
});
const NAMED = 3; // figures in the first sentence
const OFFERED = 4; // changes that would help
const SPAN = 1.5; // times its limit that a bar shows

/**
 * The class of a verdict.
 * @param {string} verdict
 */
const classOf = (verdict) => verdict.replace(" ", "-");

/**
 * The mark of a verdict, which a shape tells as well as its colour.
 * @param {Element} parent
 */
export function newMark(parent) {
  const svg = drawn("svg", { viewBox: "0 0 14 14", "aria-hidden": "true" }, parent);
  const paths = [0, 1].map(() => drawn("path", {}, svg));
  let shown = "";
  return (/** @type {string} */ verdict) => {
    if (verdict === shown) return;
    shown = verdict;
    put(svg, { class: `mark ${classOf(verdict)}` });
    paths.forEach((path, i) => put(path, { d: MARKS[verdict][i] }));
  };
}

/**
 * Names, of many the first few and how many more.
 * @param {string[]} names
 */
function listed(names) {
  const shown = names.length > NAMED + 1 ? names.slice(0, NAMED) : names;
  const more = names.length - shown.length;
  return [...shown, ...(more ? [`${more} more`] : [])].join("; ");
}

/**
 * A name within a sentence.
 * @param {string} name
 */
const lowered = (name) => name.replace(/^\p{Lu}(?=\p{Ll})/u, (letter) => letter.toLowerCase());

/**
 * A change that would help, in words.
 * @param {import("./model.js").Suggestion} suggestion
 * @param {import("./model.js").Sent} sent
 */
function wordsOf({ variable, item, axis, by }, { points, torques }) {
  const size = lengthUp(by);
  if (variable === "point") {
    return `Move ${points[item]} by ${size} along ${by > 0 ? "+" : "\u2212"}${"xyz"[axis ?? 0]}`;
  }
  if (variable === "phase") {
    return `Turn the output-side yoke of shaft ${item} by ${Math.abs(by).toFixed(1)}° ${by > 0 ? "" : "counter-"}clockwise`;
  }
  if (variable === "bearing") return `Move bearing ${item} by ${size} ${by > 0 ? "down" : "up"}stream`;
  if (variable === "engaged") return `Let the spline engage ${size} ${by > 0 ? "more" : "less"} as drawn`;
  return `Choose a rating of ${givenText(by, torques)} for joint ${item}`;
}

/**
 * Let the panel be opened, which is a sheet on a narrow screen: of that only the head is seen until then.
 * @param {Element} panel
 * @param {Element} head
 * @param {Element} body
 */
function opens(panel, head, body) {
  const button = made("button", "opener", head);
  const set = (/** @type {boolean} */ isOpen) => {
    const isHeld = body.contains(document.activeElement);
    panel.classList.toggle("open", isOpen);
    button.setAttribute("aria-expanded", String(isOpen));
    if (!isOpen) panel.scrollTop = 0;
    if (!isOpen && isHeld) button.focus({ preventScroll: true });
  };
  button.setAttribute("type", "button");
  button.setAttribute("aria-label", "All figures");
  button.setAttribute("aria-controls", body.id);
  set(false);
  button.addEventListener("click", () => set(!panel.classList.contains("open")));
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") set(false);
  });
  document.addEventListener("pointerdown", ({ target }) => {
    if (target instanceof Node && !panel.contains(target)) set(false);
  });
}

/** The panel in an element. */
export class Panel {
  #rows = /** @type {Map<string, (row: import("./model.js").Row, drawn: import("./model.js").Row) => HTMLElement>} */ (
    new Map()
  );

  /**
   * @param {Element} element
   * @param {Element} printed where paper says what has been changed
   * @param {import("./model.js").Model} model
   */
  constructor(element, printed, model) {
    this.model = model;
    this.printed = printed;
    this.head = made("div", "head", element);
    this.mark = newMark(this.head);
    this.word = made("p", "word", this.head);
    this.why = made("p", "why", this.head);
    const body = made("div", "body", element);
    body.id = "live-figures";
    this.items = made("ul", "rows", body);
    for (const row of model.sorted([...model.drawnRows.values()])) this.#rows.set(row.key, this.#row(row));
    this.help = made("div", "help", body);
    this.changed = made("h3", "", this.help, "Changed");
    this.changes = made("div", "changes", this.help);
    made("h3", "", this.help, "What would help");
    this.ways = made("div", "ways", this.help);
    this.sent = made("div", "sent", body);
    this.others = /** @type {{span: Element, name: string, words: import("./model.js").InUnits}[]} */ ([]);
    made("h3", "", this.sent, "As sent, not computed here");
    this.stale = made("p", "", this.sent);
    const others = made("ul", "", this.sent);
    for (const { name, verdict, words } of model.sent.others) {
      const item = made("li", "", others);
      newMark(item)(verdict);
      this.others.push({ span: made("span", "", item), name, words });
    }
    this.sent.hidden = model.sent.others.length === 0;
    opens(element, this.head, body);
  }

  /**
   * Elements of a row, and what fills them.
   * @param {import("./model.js").Row} first
   */
  #row(first) {
    const item = made("li", "", this.items);
    const details = /** @type {HTMLDetailsElement} */ (made("details", "", item));
    const summary = made("summary", "", details);
    const mark = newMark(summary);
    const name = made("span", "name", summary, first.name.replace(/ (?=\d+$)/, "\u00a0"));
    const use = made("span", "use", summary);
    const gauge = made("span", "gauge", summary);
    gauge.setAttribute("aria-hidden", "true");
    const bar = made("i", "", made("span", "clip", gauge));
    made("u", "", gauge);
    const tick = made("s", "", gauge);
    const line = made("span", "value", summary);
    const figure = made("span", "", line);
    const value = made("b", "", figure);
    const bound = made("span", "", figure);
    const place = made("span", "place", line);
    const more = made("div", "more", details);
    for (const words of [first.kind.meaning, first.kind.source]) {
      if (words) made("p", "", more, words);
    }
    const source = made("p", "", more);
    const each = made("ul", "", more);
    value.dataset.path = first.path;
    let now = first;
    const fill = () => {
      each.replaceChildren();
      for (const here of now.each) made("li", classOf(here.verdict), each, `${minus(here.name)}: ${here.text}`);
    };
    details.addEventListener("toggle", fill);
    /** @param {import("./model.js").Row} row @param {import("./model.js").Row} drawn */
    return (row, drawn) => {
      now = row;
      if (details.open) fill();
      mark(row.verdict);
      if (item.className !== classOf(row.verdict)) item.className = classOf(row.verdict);
      say(value, row.text);
      say(bound, ` ${row.bound}`);
      say(source, row.source);
      value.dataset.value = String(row.value);
      say(place, row.place);
      say(use, row.use === null ? row.verdict : useText(row.use));
      gauge.hidden = row.use === null;
      bar.style.transform = `scaleX(${Math.min(row.use ?? 0, SPAN) / SPAN})`;
      tick.hidden = drawn.use === null || this.model.isDrawn;
      tick.style.left = `${(100 * Math.min(drawn.use ?? 0, SPAN)) / SPAN}%`;
      return item;
    };
  }

  /**
   * List what has been changed, each to be taken back.
   * @param {(changes: import("./model.js").Changes) => void} take
   */
  list(take) {
    this.changes.replaceChildren();
    const listed = this.model.listed();
    const names = listed.map(({ words }) => words).join("; ");
    this.changed.hidden = !listed.length;
    say(this.printed, names ? `Changed: ${names}.` : "As sent.");
    for (const { words, without } of listed) {
      const button = made("button", "", this.changes, `${words} ✕`);
      button.setAttribute("type", "button");
      button.title = "Take this change back";
      button.addEventListener("click", () => take(without));
    }
    this.ways.classList.add("pale");
    // They are of the machine before.
    this.ways.querySelectorAll("button").forEach((button) => (button.disabled = true));
  }

  /**
   * Offer what would help.
   * @param {import("./model.js").Suggestion[]} found
   * @param {(suggestion: import("./model.js").Suggestion) => void} apply
   */
  offer(found, apply) {
    this.ways.replaceChildren();
    this.ways.classList.remove("pale");
    const { shims } = this.model.sent;
    if (shims) {
      for (const words of shims) made("p", "", this.ways, words);
      return;
    }
    const isPart = this.model.sent.others.length > 0;
    for (const suggestion of found.slice(0, OFFERED)) {
      const button = made("button", "", this.ways);
      button.setAttribute("type", "button");
      made("span", "", button, wordsOf(suggestion, this.model.sent));
      const { verdict, left } = suggestion;
      const then = verdict === "within" ? `all within${isPart ? " here" : ""}` : `${left} ${verdict}`;
      made("span", `then ${classOf(verdict)}`, button, then);
      button.addEventListener("click", () => apply(suggestion));
    }
    if (found.length) return;
    const words = this.model.withoutChange;
    const asSent = this.model.sent.others.some((other) => other.verdict === "beyond");
    const help = asSent ? "What is beyond is as sent: the report below says more." : `Nothing${isPart ? " computed here" : ""} needs help.`;
    made("p", "", this.ways, words || help);
  }

  /**
   * Show rows and the verdict on them.
   * @param {boolean} isSorted whether rows take their order, from the worst
   * @returns {string} the verdict in words
   */
  show(isSorted) {
    const { model } = this;
    const rows = model.rows();
    const verdict = model.verdict(rows);
    const sorted = model.sorted(rows);
    const items = sorted.map((row) => {
      const fill = this.#rows.get(row.key);
      const drawn = model.drawnRows.get(row.key);
      return fill && drawn ? fill(row, drawn) : null;
    });
    if (isSorted) {
      const held = document.activeElement;
      for (const item of items) if (item) this.items.append(item);
      if (held instanceof HTMLElement && this.items.contains(held)) held.focus();
    }
    const judged = [...sorted, ...(model.isDrawn ? model.sent.others : [])];
    const count = judged.length;
    const names = judged.filter((each) => each.verdict === verdict).map(({ name }) => name);
    const near = verdict === "beyond" && judged.filter((each) => each.verdict === "tolerable").length;
    this.head.className = `head ${classOf(verdict)}`;
    this.head.dataset.verdict = verdict;
    this.mark(verdict);
    const { others } = model.sent;
    const isPart = !model.isDrawn && others.length > 0;
    const head = isPart && verdict === "within" ? "Within what is computed here" : HEADS[verdict];
    say(this.word, head);
    const said =
      verdict === "within"
        ? `${count} of ${count}`
        : count
          ? `${names.length} of ${count} ${verdict}: ${listed(names)}${near ? `. ${near} tolerable` : ""}`
          : "The scene gives no limit.";
    const moved = isPart
      ? `Something has moved; not computed here: ${listed([...new Set(others.map(({ name }) => lowered(name)))])}.`
      : "Something has moved.";
    say(this.why, model.isDrawn ? said : `${said}. ${moved}`);
    const which = model.isDrawn ? "which is the one shown." : "not to the moved one.";
    for (const { span, name, words } of this.others) say(span, `${name}: ${words[units()]}`);
    say(this.stale, `These belong to the scene as sent, ${which}`);
    this.sent.classList.toggle("stale", !model.isDrawn);
    return `${head}: ${said}`;
  }
}
