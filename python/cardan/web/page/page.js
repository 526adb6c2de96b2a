// @ts-check
/**
 * The live part of a page: pointer, keys and buttons move the machine; the drawing follows at once,
 * and the verdict as fast as the core finds it.
 *
 * @module page
 */

import { Cardan } from "../cardan.js";
import { Dials } from "./dials.js";
import { Drawing, tenth } from "./drawing.js";
import { Model } from "./model.js";
import { minus, tidy } from "./numbers.js";
import { Panel, made, newMark } from "./panel.js";

const FRAME_MS = 6; // that figures may take of a frame, on average
const SEARCH_MS = 600; // after the last change, before it is looked for what would help
const REACH = { mouse: 20, touch: 30 }; // px
const KEYS = /** @type {Record<string, number[]>} */ ({
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
});

/** @param {string} name */
const element = (name) => /** @type {HTMLElement} */ (document.getElementById(`live-${name}`));

/**
 * Show a machine that can be moved.
 * @param {Cardan} cardan
 * @param {import("./model.js").Sent} sent
 */
function show(cardan, sent) {
  const model = new Model(cardan, sent);
  for (const name of ["page", "panel", "dials"]) element(name).hidden = false;
  document.body.classList.add("is-live");
  const svg = /** @type {SVGSVGElement} */ (/** @type {unknown} */ (element("drawing")));
  const drawing = new Drawing(svg, model);
  const panel = new Panel(element("panel"), model);
  const chips = chipsOf(model, () => {
    drawing.fit();
    ask();
    settle();
  });
  const dials = new Dials(element("dials"), model, {
    moved: () => {
      isTurning = true;
      ask();
    },
    done: (what, time) => {
      isTurning = false;
      model.commit(what, time);
      settle();
    },
  });
  let isTurning = false;
  let search = 0;
  /** How many frames there are to one in which figures are found, and how many have passed. */
  let [every, passed] = [1, 0];
  let frame = 0;
  /** @type {{handle: import("./drawing.js").Handle, off: number[]} | null} */
  let drag = null;
  const times = /** @type {number[]} */ ([]);

  const ask = () => {
    frame ||= requestAnimationFrame(render);
  };

  const render = () => {
    frame = 0;
    const start = performance.now();
    drawing.draw();
    dials.show();
    about();
    times.push(performance.now() - start);
    // The browser paints the drawing before the next task.
    if ((drag || isTurning) && ++passed >= every) setTimeout(follow);
  };

  const follow = () => {
    if (!drag && !isTurning) return;
    passed = 0;
    const start = performance.now();
    model.compute(false);
    panel.show(false);
    chips();
    drawing.label();
    every = Math.max(1, Math.ceil((performance.now() - start) / FRAME_MS));
  };

  /** Everything as it is after a change. */
  const settle = () => {
    model.compute();
    drawing.fit();
    drawing.draw();
    drawing.label();
    const words = panel.show(true);
    chips();
    about();
    drawing.speak(words);
    element("said").textContent = words;
    button("undo").disabled = !model.canUndo;
    button("redo").disabled = !model.canRedo;
    button("drawn").disabled = model.isDrawn;
    dials.show();
    dials.mark();
    panel.list((changes) => {
      model.take(changes);
      settle();
    });
    clearTimeout(search);
    search = window.setTimeout(help, SEARCH_MS);
    element("below").hidden = model.isDrawn;
  };

  /** What would help, which takes too long for a frame. */
  const help = () => {
    if (drag || isTurning) return;
    panel.offer(model.suggest(), (suggestion) => {
      model.apply(suggestion);
      settle();
    });
  };

  /** What is selected, where it is and how far it was moved. */
  const about = () => {
    const { selected } = drawing;
    const refused = element("refused");
    if (refused.textContent !== model.refused) refused.textContent = model.refused;
    element("help").hidden = !model.movable;
    if (!selected) return;
    const point = model.points(model.state)[selected.point];
    const by = model.moved(selected.point);
    const moved = by.map((x, axis) => (x ? `${"xyz"[axis]} ${x > 0 ? "+" : ""}${tenth(x)}` : ""));
    const words = point.map((x, axis) => `${"xyz"[axis]} ${tenth(x)}`).join(" \u00a0");
    const change = moved.filter(Boolean).join(", ");
    element("selected").textContent = `${sent.points[selected.point]} \u00a0${words} mm`;
    element("moved").textContent = change ? `moved ${change} mm` : "";
  };

  /** @param {string} name */
  const button = (name) => /** @type {HTMLButtonElement} */ (element(name));

  /** @param {PointerEvent} event */
  const placeIn = (event) => {
    const box = svg.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  svg.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    const at = placeIn(event);
    const handle = drawing.nearest(at, event.pointerType === "touch" ? REACH.touch : REACH.mouse);
    if (!handle) return;
    event.preventDefault();
    svg.setPointerCapture(event.pointerId);
    drawing.selected = handle;
    /** @type {SVGGElement} */ (handle.element).focus({ preventScroll: true });
    drag = { handle, off: at.map((x, i) => handle.at[i] - x) };
    model.begin();
    svg.classList.add("dragging");
    ask();
  });

  svg.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const { handle, off } = drag;
    const own = model.points(model.state)[handle.point];
    const wanted = drawing.placeOf(handle, placeIn(event).map((x, i) => x + off[i]));
    // A coordinate that the pointer has not left keeps its tenths.
    const to = wanted.map((x, axis) => (x === null || Math.abs(x - own[axis]) < 0.5 ? null : Math.round(x)));
    model.place(handle.point, to);
    ask();
  });

  const release = () => {
    if (!drag) return;
    model.commit(`move ${drag.handle.point}`);
    drag = null;
    svg.classList.remove("dragging");
    settle();
  };
  svg.addEventListener("pointerup", release);
  svg.addEventListener("pointercancel", () => giveUp());

  const giveUp = () => {
    if (!drag) return;
    drag = null;
    svg.classList.remove("dragging");
    model.cancel();
    settle();
  };

  for (const handle of drawing.handles) {
    handle.element.addEventListener("focus", () => {
      drawing.selected = handle;
      ask();
    });
    handle.element.addEventListener("keydown", (raw) => {
      const event = /** @type {KeyboardEvent} */ (raw);
      const way = KEYS[event.key];
      if (!way || drag || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      const step = event.shiftKey ? 10 : event.altKey ? 0.1 : 1;
      const { right, down } = sent.views[handle.view];
      const own = model.points(model.state)[handle.point];
      const to = own.map((x, axis) => {
        const by = step * (way[0] * right[axis] + way[1] * down[axis]);
        return by ? tidy(x + by) : null;
      });
      model.begin();
      model.place(handle.point, to);
      model.commit(`key ${handle.point}`, performance.now());
      ask();
      settleSoon();
    });
  }

  /** Keys that are held down are drawn one by one, and judged when there is time. */
  let waiting = 0;
  const settleSoon = () => {
    waiting ||= requestAnimationFrame(() => {
      waiting = 0;
      settle();
    });
  };

  button("undo").addEventListener("click", () => {
    model.undo();
    settle();
  });
  button("redo").addEventListener("click", () => {
    model.redo();
    settle();
  });
  button("drawn").addEventListener("click", () => {
    model.reset();
    settle();
  });

  const angle = /** @type {HTMLInputElement} */ (element("angle"));
  const turn = () => {
    drawing.angle = (Number(angle.value) * Math.PI) / 180;
    element("angle-shown").textContent = `${angle.value}°`;
    ask();
  };
  angle.addEventListener("input", turn);
  turn();

  addEventListener("keydown", (event) => {
    if (event.key === "Escape") giveUp();
    const isCommand = (event.ctrlKey || event.metaKey) && !drag;
    const key = event.key.toLowerCase();
    if (!isCommand || (key !== "z" && key !== "y")) return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) model.redo();
    else model.undo();
    settle();
  });

  let width = svg.clientWidth;
  new ResizeObserver(() => {
    if (svg.clientWidth === width) return;
    width = svg.clientWidth;
    // A size that is set while sizes are observed would be observed again.
    requestAnimationFrame(() => {
      drawing.fit();
      drawing.draw();
    });
  }).observe(svg);
  settle();
  return { model, drawing, panel, times };
}

/**
 * The states as chips with their verdict.
 * @param {Model} model
 * @param {() => void} changed
 */
function chipsOf(model, changed) {
  const { states } = model.sent;
  const group = element("states");
  group.hidden = states.length < 2;
  const chips = states.map((name, state) => {
    const chip = made("button", "chip", group);
    chip.setAttribute("type", "button");
    chip.setAttribute("role", "radio");
    const mark = newMark(chip);
    made("span", "", chip, minus(name));
    const choose = () => {
      model.state = state;
      changed();
    };
    chip.addEventListener("click", choose);
    chip.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      const next = chips[(state + step + states.length) % states.length].chip;
      next.click();
      next.focus();
    });
    return { chip, mark };
  });
  return () => {
    model.stateVerdicts().forEach((verdict, state) => {
      const { chip, mark } = chips[state];
      mark(verdict);
      const isChosen = state === model.state;
      chip.setAttribute("aria-checked", String(isChosen));
      chip.setAttribute("aria-label", `${states[state]}, ${verdict}`);
      chip.tabIndex = isChosen ? 0 : -1;
    });
  };
}

/** Start the live part, if this browser can; without it the page is a page. */
export async function start() {
  if (typeof WebAssembly === "undefined" || typeof DecompressionStream === "undefined") return;
  const text = (/** @type {string} */ name) => element(name).textContent ?? "";
  const bytes = Uint8Array.from(atob(text("module")), (letter) => letter.charCodeAt(0));
  const cardan = await Cardan.load(bytes);
  // For those who test the page.
  Object.assign(globalThis, { cardanPage: show(cardan, JSON.parse(text("data"))) });
}
