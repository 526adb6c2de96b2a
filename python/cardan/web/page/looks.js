// @ts-check
/**
 * How the page is seen, whatever the machine is.
 *
 * @module looks
 */

const PAPER = 680; // px, the width of a page without its margins

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
