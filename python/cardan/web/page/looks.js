// @ts-check
/**
 * How the page is seen, whatever the machine is.
 *
 * @module looks
 */

import { asGiven, lengths, showIn } from "./numbers.js";

const THEMES = [
  { name: "auto", scheme: "", media: "" },
  { name: "light", scheme: "light", media: "not all" },
  { name: "dark", scheme: "dark", media: "screen" },
];
/** @type {import("./numbers.js").System[]} */
const SYSTEMS = ["si", "us"];
const STRETCH = 4;
const PAPER = 680; // px, the width of a page without its margins

/** @param {string} name */
const element = (name) => /** @type {HTMLElement} */ (document.getElementById(`live-${name}`));

/**
 * Let one of some buttons be chosen.
 * @param {string[]} names
 * @param {(place: number) => void} chosen
 */
function choice(names, chosen) {
  const buttons = names.map(element);
  buttons.forEach((button, place) =>
    button.addEventListener("click", () => {
      buttons.forEach((each) => each.setAttribute("aria-pressed", String(each === button)));
      chosen(place);
    }),
  );
}

/**
 * Let the heights of the drawing be stretched.
 * @param {import("./drawing.js").Drawing} drawing
 * @param {() => void} ask to be drawn
 */
export function stretched(drawing, ask) {
  choice(["true", "high"], (place) => {
    drawing.stretch = place ? STRETCH : 1;
    drawing.fit();
    ask();
  });
}

/**
 * Let everything be shown in SI or US units, where they differ; at first it is in those of the scene.
 * @param {import("./model.js").Model} model
 * @param {() => void} settle
 */
export function measured(model, settle) {
  const { curves, figures, given, kinds, units } = model.sent;
  const shown = [given.torque, ...curves, ...figures.map(({ kind }) => kinds[kind])];
  element("units").hidden = !(given.points || given.bearings.length || shown.some((each) => each?.us));
  const steps = () => {
    const { step, unit } = lengths();
    const [one, ten, tenth] = [1, 10, 0.1].map((times) => `${asGiven(times * step)} ${unit}`);
    element("steps").textContent = `${one}, with Shift ${ten}, with Alt ${tenth}`;
  };
  choice(SYSTEMS, (place) => {
    showIn(SYSTEMS[place]);
    steps();
    settle();
  });
  for (const each of SYSTEMS) element(each).setAttribute("aria-pressed", String(each === units));
  steps();
}

/** Let the page be light or dark whatever the system is. */
export function coloured() {
  const button = element("theme");
  const { style } = document.documentElement;
  const rules = Array.from(document.styleSheets).flatMap((sheet) =>
    Array.from(sheet.cssRules).flatMap((rule) =>
      rule instanceof CSSMediaRule && rule.conditionText.includes("prefers-color-scheme: dark")
        ? [{ rule, condition: rule.media.mediaText }]
        : [],
    ),
  );
  let theme = 0;
  const show = () => {
    const { name, scheme, media } = THEMES[theme];
    style.colorScheme = scheme;
    for (const { rule, condition } of rules) rule.media.mediaText = media || condition;
    button.textContent = `Colours: ${name}`;
  };
  button.addEventListener("click", () => {
    theme = (theme + 1) % THEMES.length;
    show();
  });
  show();
}

/**
 * Draw for paper while the page is printed.
 * @param {import("./drawing.js").Drawing} drawing
 */
export function printed(drawing) {
  for (const [event, width] of /** @type {[string, number | undefined][]} */ ([["beforeprint", PAPER], ["afterprint", undefined]])) {
    addEventListener(event, () => {
      drawing.fit(width);
      drawing.draw();
    });
  }
}
