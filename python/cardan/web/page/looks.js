// @ts-check
/**
 * How the page is seen, whatever the machine is.
 *
 * @module looks
 */

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
