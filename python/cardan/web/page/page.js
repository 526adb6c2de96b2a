// @ts-check
/**
 * The live part of a page: pointer, keys and buttons move the machine; the drawing follows at once,
 * and the verdict as fast as the core finds it.
 *
 * @module page
 */

import { Cardan } from "../cardan.js";
import { mostOf } from "./changes.js";
import { Curves } from "./curves.js";
import { Dials } from "./dials.js";
import { Drawing } from "./drawing.js";
import { briefly, made } from "./elements.js";
import { Editing } from "./editing.js";
import { Field } from "./fields.js";
import { coloured, measured, printed, stretched } from "./looks.js";
import { lateralCard } from "./lateral.js";
import { Model } from "./model.js";
import { lengths, minus, showIn, signedLength } from "./numbers.js";
import { Panel, newMark } from "./panel.js";
import { Ribbon } from "./ribbon.js";
import { copy, note, noted, save } from "./sharing.js";
import { torsionCard } from "./torsion.js";
import { foot } from "./trust.js";

const FRAME_MS = 6; // that figures may take of a frame, on average
const STILL_MS = 100; // without a frame, after which the figures of the last one are found
const SLICE_MS = 4; // after which the search for what would help waits for the next frame
const SEARCH_MS = 600; // after the last change, before it is looked for what would help
const TURN_MS = 6000; // of a turn that plays
const GIVEN = { decimals: null, digits: 4, apart: null, finest: 0 };
const KEPT = 1000; // times of frames

/** @param {string} name */
const element = (name) => /** @type {HTMLElement} */ (document.getElementById(`live-${name}`));

/**
 * Show a machine that can be moved.
 * @param {Cardan} cardan
 * @param {import("./model.js").Sent} sent
 */
function show(cardan, sent) {
  showIn(sent.units);
  const model = new Model(cardan, sent);
  for (const name of ["page", "panel", "dials", "curves", "trust"]) element(name).hidden = false;
  document.body.classList.add("is-live");
  foot(element("trust"), cardan, sent);
  const report = document.getElementById("sent");
  if (report instanceof HTMLDetailsElement) {
    report.open = false;
    // Paper shows all of it.
    addEventListener("beforeprint", () => (report.open = true));
  }
  const svg = /** @type {SVGSVGElement} */ (/** @type {unknown} */ (element("drawing")));
  const drawing = new Drawing(svg, model);
  const ribbon = new Ribbon(drawing);
  const panel = new Panel(element("panel"), element("changed"), model);
  const chips = chipsOf(model, () => {
    drawing.fit();
    ask();
    settle();
  });
  /** Whether dials or fields are being moved. */
  let isGoing = false;
  const told = {
    begin: () => model.begin(),
    moved: () => {
      isGoing = true;
      ask();
    },
    /** @param {string} what @param {number} [time] */
    done: (what, time) => {
      isGoing = false;
      model.commit(what, time);
      settle();
    },
    /** @param {string} words */
    refuse: (words) => {
      model.refused = words;
      about();
    },
  };
  const dials = new Dials(element("dials"), model, told);
  const loads = loadsOf(model, told);
  const curves = new Curves(element("curves"), model, (degrees) => {
    angle.value = String(Math.round(degrees));
    turn();
  });
  const torsion = torsionCard(element("torsion"), model);
  const lateral = lateralCard(element("lateral"), model);
  let search = 0;
  /** How many frames there are to one in which figures are found, and how many have passed. */
  let [every, passed] = [1, 0];
  let areCurvesDue = true;
  let [frame, late] = [0, 0];
  let [figuresOf, curvesOf] = [model.machine, model.machine];
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
    if (editing.isDragging || isGoing) ribbon.hide();
    else ribbon.ask();
    if (times.push(performance.now() - start) > KEPT) times.shift();
    // The browser paints the drawing before the next task.
    if (!editing.isDragging && !isGoing) return;
    clearTimeout(late);
    late = window.setTimeout(follow, ++passed >= every ? 0 : STILL_MS);
  };

  const follow = () => {
    if (!editing.isDragging && !isGoing) return;
    passed = 0;
    const start = performance.now();
    // Figures and curves together would take too long for one frame.
    areCurvesDue = !areCurvesDue;
    if (areCurvesDue) {
      curves.show(false);
      curvesOf = model.machine;
    } else {
      model.compute(false);
      panel.show(false);
      torsion(false);
      lateral(false);
      chips();
      drawing.label();
      figuresOf = model.machine;
    }
    // Whoever holds still sees all of what is drawn.
    clearTimeout(late);
    if (curvesOf !== model.machine || figuresOf !== model.machine) late = window.setTimeout(follow, STILL_MS);
    every = Math.max(1, Math.ceil((performance.now() - start) / FRAME_MS));
  };

  /** Everything as it is after a change. */
  const settle = () => {
    model.compute();
    drawing.fit();
    drawing.measure();
    drawing.draw();
    drawing.label();
    ribbon.ask();
    const words = panel.show(true);
    chips();
    about();
    drawing.speak(words);
    element("said").textContent = words;
    button("undo").disabled = !model.canUndo;
    button("redo").disabled = !model.canRedo;
    button("drawn").disabled = model.isDrawn;
    note(() => model.address);
    said("");
    dials.show();
    dials.mark();
    curves.show(true);
    torsion(true);
    lateral(true);
    panel.list((changes) => {
      model.take(changes);
      settle();
    });
    clearTimeout(search);
    search = window.setTimeout(help, SEARCH_MS);
  };

  /** What would help, as long as nothing is changed; it takes too long for one frame. */
  const help = () => {
    const rounds = model.suggesting();
    const { changes } = model;
    const go = () => {
      if (editing.isDragging || isGoing || model.changes !== changes) return;
      const start = performance.now();
      let next = rounds.next();
      while (!next.done && performance.now() - start < SLICE_MS) next = rounds.next();
      if (!next.done) {
        search = window.setTimeout(go);
        return;
      }
      panel.offer(next.value, (suggestion) => {
        model.apply(suggestion);
        settle();
      });
    };
    go();
  };

  const editing = new Editing(drawing, { select: ask, moved: ask, done: () => settle(), stepped: () => settleSoon() });
  const places = placesOf(model, told);

  /** What is selected, where it is and how far it was moved. */
  const about = () => {
    const refused = element("refused");
    if (refused.textContent !== model.refused) refused.textContent = model.refused;
    element("help").hidden = !drawing.handles.length;
    places(drawing.selected);
    for (const field of loads) field.show();
  };

  /** @param {string} name */
  const button = (name) => /** @type {HTMLButtonElement} */ (element(name));

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
  const said = (/** @type {string} */ words) => briefly(element("shared"), words);
  // A frame without an address has none to copy.
  button("link").hidden = location.protocol === "about:";
  button("link").addEventListener("click", async () => {
    const [page] = location.href.split("#");
    const isCopied = await copy(`${page}#${model.address}`);
    const where = location.protocol === "file:" ? " Send this file as well: whoever has it opens it and adds what follows # to its address." : "";
    said(isCopied ? `The link is copied.${where}` : "This browser does not let a page copy; the address has it.");
  });
  button("save").addEventListener("click", () => {
    try {
      const name = model.isDrawn ? sent.source.name : sent.source.name.replace(/(\.toml)?$/, ".changed.toml");
      save(name, model.text, "application/toml");
      said(`${name} has been saved.`);
    } catch (error) {
      said(/** @type {Error} */ (error).message);
    }
  });
  addEventListener("hashchange", () => {
    if (!noted() || noted() === model.address) return;
    model.read(noted());
    settle();
    chips();
  });

  const angle = /** @type {HTMLInputElement} */ (element("angle"));
  const turn = () => {
    drawing.angle = (Number(angle.value) * Math.PI) / 180;
    element("angle-shown").textContent = `${Math.round(Number(angle.value))}°`;
    curves.mark(Number(angle.value));
    ask();
  };
  angle.addEventListener("input", turn);
  turn();
  let last = 0;
  const play = (/** @type {number} */ time) => {
    if (!last) return;
    angle.value = String((Number(angle.value) + (360 * (time - last)) / TURN_MS) % 360);
    last = time;
    turn();
    requestAnimationFrame(play);
  };
  button("play").addEventListener("click", () => {
    last = last ? 0 : performance.now();
    button("play").textContent = last ? "Stop" : "Turn";
    requestAnimationFrame(play);
  });

  addEventListener("keydown", (event) => {
    if (event.key === "Escape") editing.giveUp();
    const isCommand = (event.ctrlKey || event.metaKey) && !editing.isDragging;
    const key = event.key.toLowerCase();
    if (!isCommand || (key !== "z" && key !== "y")) return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) model.redo();
    else model.undo();
    settle();
  });

  printed(drawing);
  stretched(drawing, ask);
  measured(model, settle);
  coloured();
  let width = svg.clientWidth;
  new ResizeObserver(() => {
    if (svg.clientWidth === width) return;
    width = svg.clientWidth;
    // A size that is set while sizes are observed would be observed again.
    requestAnimationFrame(() => {
      drawing.fit();
      render();
    });
  }).observe(svg);
  if (noted()) model.read(noted());
  settle();
  return { model, drawing, panel, curves, ribbon, times, memory: () => cardan.memory };
}

/**
 * Speed and torque in a sentence; none that the states set.
 * @param {Model} model
 * @param {import("./fields.js").Told} told
 */
function loadsOf(model, told) {
  const { given, machine } = model.sent;
  const line = element("loads");
  const end = machine.end === "drive" ? "into the drive" : "at the output";
  const found = /** @type {const} */ (["speed", "torque"]).flatMap((name) => {
    const own = given[name];
    if (!own) return [];
    const step = 10 ** Math.max(0, Math.floor(Math.log10(Math.abs(own.value) || 1)) - 2);
    return new Field(line, {
      label: name,
      unit: name === "torque" ? `${own.unit} ${end}` : own.unit,
      us: own.us && { ...own.us, unit: `${own.us.unit} ${end}`, digits: GIVEN },
      digits: GIVEN,
      step,
      most: mostOf(model.sent, name, own.value),
      get: () => model.loadOf(name),
      set: (value) => model.load(name, value),
    }, told);
  });
  line.hidden = !found.length;
  return found;
}

/**
 * The coordinates of what is selected as fields, and how far it was moved.
 * @param {Model} model
 * @param {import("./fields.js").Told} told
 */
function placesOf(model, told) {
  let selected = /** @type {import("./drawing.js").Handle | null} */ (null);
  /** @type {Field[]} */
  let fields = [];
  const line = element("place");
  const fieldsOf = (/** @type {import("./drawing.js").Handle} */ { kind, item }) => {
    const common = { ...lengths(), unit: "mm", most: mostOf(model.sent, kind) };
    if (kind === "bearing") {
      const get = () => 1e3 * model.part("positions", item);
      const label = `from the upstream end of shaft ${model.sent.machine.bearings[item]}`;
      return [new Field(line, { ...common, label, get, set: (value) => model.slide(item, value) }, told)];
    }
    return [0, 1, 2].map((axis) => {
      const get = () => model.points(model.state)[item][axis];
      const set = (/** @type {number} */ value) => model.place(item, [0, 1, 2].map((i) => (i === axis ? value : null)));
      return new Field(line, { ...common, label: "xyz"[axis], get, set }, told);
    });
  };
  return (/** @type {import("./drawing.js").Handle | null} */ handle) => {
    if (!handle) return;
    const { kind, item } = handle;
    if (kind !== selected?.kind || item !== selected.item) {
      line.replaceChildren();
      made("strong", "", line, kind === "point" ? model.sent.points[item] : `bearing ${item}`);
      fields = fieldsOf(handle);
    }
    selected = handle;
    for (const field of fields) field.show();
    const moves =
      kind === "point"
        ? model.moved(item).map((x, axis) => (x ? `${"xyz"[axis]} ${signedLength(x)}` : ""))
        : [model.slid(item) ? signedLength(model.slid(item)) : ""];
    const words = moves.filter(Boolean).join(", ");
    element("moved").textContent = words ? `moved ${words} ${lengths().unit}` : "";
  };
}

/**
 * Which points the states move, in words; nothing where these are all of them, or none.
 * @param {Model} model
 */
function ofStates(model) {
  const { points, states } = model.sent;
  const lines = states.map((_, state) => model.points(state));
  const isMoved = (/** @type {number} */ i) => lines.some((line) => line[i].some((x, axis) => x !== lines[0][i][axis]));
  const moved = points.flatMap((_, i) => (isMoved(i) ? [model.pointName(i)] : []));
  return model.movable && moved.length && moved.length < points.length ? ` of ${moved.join(" and ")}` : "";
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
  element("states-of").textContent = `States${ofStates(model)}`;
  const line = /** @type {HTMLElement} */ (group.querySelector(".chips"));
  const chips = states.map((name, state) => {
    const chip = made("button", "chip", line);
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
  if (!("WebAssembly" in globalThis && "DecompressionStream" in globalThis)) return;
  const text = (/** @type {string} */ name) => element(name).textContent ?? "";
  const bytes = Uint8Array.from(atob(text("module")), (letter) => letter.charCodeAt(0));
  const cardan = await Cardan.load(bytes);
  // For those who test the page.
  Object.assign(globalThis, { cardanPage: show(cardan, JSON.parse(text("data"))) });
}
