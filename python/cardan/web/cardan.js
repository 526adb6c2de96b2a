// @ts-check
/**
 * The core of cardan in JavaScript: drivelines with universal joints, evaluated and judged with the
 * same bits as the Python package.
 *
 * The functions of the module describe themselves: names, units and shapes of arguments and results
 * come from its table. Quantities are in SI units and angles in radians.
 *
 * @module cardan
 */

/**
 * Numbers, flat or nested, a number, or names where numbers stand for names.
 * @typedef {number | boolean | string | ArrayLike<any> | null | undefined} Values
 */

/**
 * An argument or a result: its unit, or the list of names that its numbers stand for, and its axes.
 * @typedef {{name: string, unit?: string, of?: string, shape: string}} Field
 */

/** @typedef {{name: string, arguments: Field[], results: Field[]}} FunctionRow */

/**
 * @typedef {object} OutputRow
 * @property {string} name
 * @property {"shaft" | "joint" | "bearing"} per of what each is
 * @property {string} unit
 * @property {string[]} components of a vector; one without a name of a scalar
 * @property {boolean} needs_load
 */

/**
 * @typedef {object} KindRow
 * @property {string} name
 * @property {string} unit
 * @property {"shaft" | "joint" | "bearing" | null} per
 * @property {boolean} most whether its limit is the most that it may be, or the least
 * @property {"states" | "cases" | "once"} scope where it has values
 */

/**
 * @typedef {object} Table
 * @property {string} version
 * @property {Record<string, string[]>} names
 * @property {OutputRow[]} outputs
 * @property {KindRow[]} kinds
 * @property {FunctionRow[]} functions
 */

/**
 * A machine as `cardan.Machine.to_dict` writes it: the arguments of the function `figures` by name,
 * those that it has. With `points` the drivelines follow from these.
 * @typedef {Record<string, any>} MachineData
 */

/**
 * One figure of a machine.
 * @typedef {object} Figure
 * @property {KindRow} kind
 * @property {number | null} item of which shaft, joint or bearing
 * @property {Float64Array} values in every state, and for some kinds then in every step
 * @property {string[]} ranks how each stands to the limit
 * @property {number} limit NaN if there is none
 * @property {number} maximum
 * @property {number | null} worst the place of the value nearest to the limit or farthest past it
 */

/**
 * One change of a machine.
 * @typedef {object} Change
 * @property {string} variable
 * @property {number} item the point from the upstream end, the bearing, the joint of a rating, or the
 *   shaft of a phase and of the engaged length
 * @property {number | null} axis of a point
 * @property {number} from what it is in the first state, in m, rad or N m
 * @property {number} to what it becomes there; it changes by as much in all states
 * @property {number} share its size as a part of what was tried
 * @property {string} verdict after it
 * @property {{kind: KindRow, item: number | null, value: number} | null} worst what is then worst
 */

/**
 * Message of the module about a mistake.
 * @typedef {object} Fault
 * @property {string} message one sentence
 * @property {string} [argument] its name
 * @property {number[]} [place] in the argument, outermost index first
 * @property {number | string} [value] that breaks the rule; a word where it is not finite
 * @property {string} [unit] of the value
 * @property {string} [rule]
 */

/** A mistake in what is asked for, as one sentence and in parts. */
export class CardanError extends Error {
  /** @param {string | Fault} fault */
  constructor(fault) {
    const parts = typeof fault === "string" ? { message: fault } : fault;
    super(parts.message);
    this.argument = parts.argument;
    this.place = parts.place ?? [];
    this.value = parts.value === undefined ? undefined : Number(parts.value);
    this.unit = parts.unit;
    this.rule = parts.rule;
  }
}

/** The module with its functions. */
export class Cardan {
  /** @type {WebAssembly.Module} */ #module;
  /** @type {any} */ #exports;
  /** @type {Map<string, number>} */ #numbers;

  /**
   * @param {WebAssembly.Module} module
   * @param {WebAssembly.Instance} instance
   */
  constructor(module, instance) {
    this.#module = module;
    this.#exports = instance.exports;
    this.#exports.describe();
    /**
     * Table of the functions of the module.
     * @type {Table}
     */
    this.table = JSON.parse(this.#text());
    this.#numbers = new Map(this.table.functions.map((row, number) => [row.name, number]));
  }

  /**
   * Load the module from its bytes, as they are or compressed by gzip.
   * @param {ArrayBuffer | Uint8Array} bytes
   * @returns {Promise<Cardan>}
   */
  static async load(bytes) {
    let code = new Uint8Array(/** @type {ArrayBuffer} */ (bytes));
    if (code[0] === 0x1f && code[1] === 0x8b) {
      // Older declarations of the browser's functions do not know it.
      const { DecompressionStream } = /** @type {any} */ (globalThis);
      const stream = new Blob([code]).stream().pipeThrough(new DecompressionStream("gzip"));
      code = new Uint8Array(await new Response(stream).arrayBuffer());
    }
    const module = await WebAssembly.compile(code);
    return new Cardan(module, await WebAssembly.instantiate(module));
  }

  /** How many bytes of memory the module has. It grows to what the largest call needs. */
  get memory() {
    return this.#exports.memory.buffer.byteLength;
  }

  /**
   * A machine from its data.
   * @param {MachineData} data
   * @returns {Machine}
   */
  machine(data) {
    return new Machine(this, data);
  }

  /**
   * Call a function by its name. Arguments that are left out are empty.
   * @param {string} name
   * @param {Record<string, Values>} values
   * @returns {Record<string, any>} results by name: a `Float64Array`, or names where the table says so
   */
  call(name, values) {
    const number = this.#numbers.get(name);
    if (number === undefined) throw new CardanError(`function ${name} is unknown`);
    const row = this.table.functions[number];
    const known = new Set(row.arguments.map((field) => field.name));
    for (const given of Object.keys(values)) {
      if (!known.has(given)) throw new CardanError(`${given} is no argument of ${name}`);
    }
    const parts = row.arguments.map((field) => this.#encoded(field, values[field.name]));
    const total = parts.reduce((sum, part) => sum + 1 + part.length, 0);
    return this.#decoded(row, this.#run(number, parts, total));
  }

  /**
   * @param {number} number
   * @param {number[][]} parts
   * @param {number} total
   * @returns {Float64Array}
   */
  #run(number, parts, total) {
    let status;
    try {
      const place = this.#exports.room(total);
      if (place === 0) throw new CardanError(`arguments has ${total} numbers, which are too many`);
      const room = new Float64Array(this.#exports.memory.buffer, place, total);
      let at = 0;
      for (const part of parts) {
        room[at] = part.length;
        room.set(part, at + 1);
        at += 1 + part.length;
      }
      status = this.#exports.call(number);
    } catch (fault) {
      if (fault instanceof CardanError) throw fault;
      // The memory of a module that has stopped is not to be trusted.
      this.#exports = new WebAssembly.Instance(this.#module).exports;
      throw new CardanError(`${this.table.functions[number].name} stopped: ${fault}`);
    }
    if (status !== 0) throw new CardanError(JSON.parse(this.#text()));
    const first = this.#exports.answer();
    return new Float64Array(this.#exports.memory.buffer.slice(first, first + this.#exports.answer_length()));
  }

  /** The answer as text. */
  #text() {
    const first = this.#exports.answer();
    const bytes = new Uint8Array(this.#exports.memory.buffer, first, this.#exports.answer_length());
    return new TextDecoder().decode(bytes);
  }

  /**
   * @param {Field} field
   * @param {Values} values
   * @returns {number[]}
   */
  #encoded(field, values) {
    const names = field.of === undefined ? null : this.table.names[field.of];
    /** @type {number[]} */
    const flat = [];
    /** @param {any} value */
    const add = (value) => {
      if (typeof value === "number") flat.push(value);
      else if (value === null) flat.push(NaN);
      else if (typeof value === "boolean") flat.push(Number(value));
      else if (typeof value === "string") {
        const place = names ? names.indexOf(value) : -1;
        if (place < 0) throw new CardanError(`${field.name} holds ${JSON.stringify(value)}, which is unknown`);
        flat.push(place);
      } else if (typeof value === "object" && typeof value.length === "number") {
        for (let i = 0; i < value.length; i++) add(value[i]);
      } else throw new CardanError(`${field.name} holds ${typeof value}s; it holds numbers`);
    };
    if (values !== null && values !== undefined) add(values);
    return flat;
  }

  /**
   * @param {FunctionRow} row
   * @param {Float64Array} flat
   * @returns {Record<string, any>}
   */
  #decoded(row, flat) {
    let at = 0;
    /** @type {Record<string, any>} */
    const results = {};
    for (const field of row.results) {
      const values = flat.slice(at + 1, at + 1 + flat[at]);
      at += 1 + flat[at];
      const names = field.of === undefined ? null : this.table.names[field.of];
      results[field.name] = names ? Array.from(values, (value) => names[value]) : values;
    }
    return results;
  }
}

const CHAINS = ["bends", "twists", "phases"];
const FRAMES = ["directions", "normals"];
const MOUNTED = ["lengths", "positions", "bearings"];
const LOAD = ["end", "torque", "speed", "acceleration", "inertia_shafts", "inertias"];

/** Before the names of what the states, the steps of the duty cycle and the drawing have alike. */
const LINES = ["", "step_", "drawn_"];

/** A driveline in all of its states with its parts, loads and limits. It does not change. */
export class Machine {
  /** @type {Cardan} */ #cardan;

  /**
   * @param {Cardan} cardan
   * @param {MachineData} data
   */
  constructor(cardan, data) {
    if (!data || typeof data !== "object") {
      throw new CardanError("data is missing; a scene with a study or a recording has no machine");
    }
    this.#cardan = cardan;
    /**
     * The arguments of the function `figures`, and `points`.
     * @type {MachineData}
     */
    this.data = data;
    const { joints, unit } = data;
    for (const of of LINES) {
      const [points, phases] = [data[`${of}points`], data[`${of}phases`]];
      if (!points || data[`${of}bends`]) continue;
      for (const [name, values] of Object.entries(cardan.call("from_points", { joints, points, unit, phases }))) {
        this.data = { ...this.data, [of + name]: values };
      }
    }
  }

  /** How many states it has. */
  get states() {
    return flatLength(this.data.bends) / this.data.joints;
  }

  /**
   * The machine with other data, which are otherwise as they were: the steps of a duty cycle and the
   * drawing have theirs, which `move`, `turn` and `apply` change with the states. Drivelines follow
   * from new `points` or `phases`; new `bends` or `twists` have no points.
   * @param {MachineData} changes
   * @returns {Machine}
   */
  with(changes) {
    const data = { ...this.data, ...changes };
    if ((changes.bends || changes.twists) && !changes.directions) {
      const { joints, bends, twists, phases } = data;
      Object.assign(data, this.#cardan.call("from_bends", { joints, bends, twists, phases }));
      delete data.points;
      return new Machine(this.#cardan, data);
    }
    for (const of of LINES) {
      if (data[`${of}points`] && (changes[`${of}points`] || changes[`${of}phases`])) delete data[`${of}bends`];
    }
    return new Machine(this.#cardan, data);
  }

  /**
   * The drivelines of one state with their load, of which less is computed than of all.
   * @param {number} state
   * @returns {Machine}
   */
  only(state) {
    const { states, data } = this;
    this.#check("state", state, Number.isInteger(state) && state >= 0 && state < states,
      `it must be a whole number from 0 to ${states - 1}`);
    /** @param {any} values */
    const own = (values) => {
      const all = flat(values);
      const each = all.length / states;
      return all.slice(state * each, (state + 1) * each);
    };
    const parts = [...CHAINS, ...FRAMES, "lengths", "positions", "torque", "speed", "acceleration"];
    const changes = Object.fromEntries(parts.map((name) => [name, own(data[name])]));
    return this.with({ ...changes, points: undefined, inertias: (data.inertias ?? []).map(own) });
  }

  /**
   * The machine with a point moved alike in all states and in the drawing.
   * @param {number} point from the upstream end
   * @param {[number, number, number]} by in m
   * @returns {Machine}
   */
  move(point, by) {
    const { joints, points, unit = 1 } = this.data;
    if (!points?.[0]?.[0]?.length) {
      const problem = "is missing or not nested; it is [state][point][axis]";
      throw new CardanError({ message: `points ${problem}`, argument: "points", rule: problem });
    }
    this.#check("point", point, Number.isInteger(point) && point >= 0 && point < joints + 2,
      `it must be a whole number from 0 to ${joints + 1}`);
    this.#check("by", by, by?.length === 3 && by.every(Number.isFinite),
      "it must be three finite numbers");
    const moved = (/** @type {number[]} */ p) => p.map((x, axis) => x + by[axis] / unit);
    /** @type {MachineData} */
    const changes = {};
    for (const of of LINES) {
      /** @type {number[][][] | undefined} */
      const lines = this.data[`${of}points`];
      if (lines) changes[`${of}points`] = lines.map((line) => line.map((p, i) => (i === point ? moved(p) : p)));
    }
    return this.with(changes);
  }

  /**
   * The machine with the yokes of a shaft turned alike in all states and steps.
   * @param {number} shaft from 1 on, between two joints
   * @param {number} by in rad
   * @returns {Machine}
   */
  turn(shaft, by) {
    const { joints, phases, step_phases, drawn_phases } = this.data;
    this.#check("shaft", shaft, Number.isInteger(shaft) && shaft > 0 && shaft < joints,
      `it must be a whole number from 1 to ${joints - 1}`);
    /** @param {any} all */
    const turned = (all) => flat(all).map((x, i) => (i % (joints - 1) === shaft - 1 ? x + by : x));
    /** @type {MachineData} */
    const changes = { phases: turned(phases) };
    if (step_phases) changes.step_phases = turned(step_phases);
    if (drawn_phases) changes.drawn_phases = turned(drawn_phases);
    return this.with(changes);
  }

  /**
   * The machine with a change that `suggest` has found.
   * @param {Change} change
   * @returns {Machine}
   */
  apply({ variable, item, axis, from, to }) {
    const by = to - from;
    const { positions, bearings, engaged, ratings } = this.data;
    if (variable === "point") {
      /** @type {[number, number, number]} */
      const along = [0, 0, 0];
      along[axis ?? 0] = by;
      return this.move(item, along);
    }
    if (variable === "phase") return this.turn(item, by);
    if (variable === "engaged") return this.with({ engaged: engaged + by });
    const [name, values, each] =
      variable === "bearing"
        ? ["positions", positions, flatLength(bearings)]
        : ["ratings", ratings, flatLength(ratings)];
    return this.with({ [name]: flat(values).map((x, i) => (i % each === item ? x + by : x)) });
  }

  /**
   * Call a function of the module with what the machine has of its arguments, and with others.
   * @param {string} name
   * @param {Record<string, Values>} others
   * @returns {Record<string, any>}
   */
  call(name, others = {}) {
    const row = this.#cardan.table.functions.find((row) => row.name === name);
    return this.#cardan.call(name, { ...this.#some((row?.arguments ?? []).map(({ name }) => name)), ...others });
  }

  /**
   * @param {string} argument
   * @param {any} value
   * @param {boolean} keeps
   * @param {string} rule
   */
  #check(argument, value, keeps, rule) {
    if (keeps) return;
    const message = `${argument} is ${JSON.stringify(value)}; ${rule}`;
    throw new CardanError({ message, argument, value, rule });
  }

  /**
   * Outputs of every state at drive angles.
   * @param {{outputs: string[], angles: ArrayLike<number>, of_shafts?: number[], of_joints?: number[],
   *   axes?: string, tolerance?: number}} request shafts and joints are all by default
   * @returns {Record<string, Float64Array[][][]>} by output, item, state and component
   */
  evaluate(request) {
    const { joints } = this.data;
    this.#check("outputs", request?.outputs, Array.isArray(request?.outputs), "it must be a list of names");
    this.#check("angles", request.angles, request.angles?.length > 0, "it must be a list of angles in rad");
    const { of_shafts = range(joints + 1), of_joints = range(joints), ...rest } = request;
    const given = this.#some(["joints", ...CHAINS, ...FRAMES, ...MOUNTED, ...LOAD]);
    const { values } = this.#cardan.call("evaluate", { ...given, of_shafts, of_joints, ...rest });
    const [states, samples] = [this.states, request.angles.length];
    const bearings = range(flatLength(this.data.bearings));
    const items = { shaft: of_shafts, joint: of_joints, bearing: bearings };
    let at = 0;
    /** @type {Record<string, Float64Array[][][]>} */
    const found = {};
    for (const name of request.outputs) {
      const row = this.#cardan.table.outputs.find((output) => output.name === name);
      if (row === undefined) throw new CardanError(`outputs holds "${name}", which is unknown`);
      found[name] = items[row.per].map(() => {
        const planes = row.components.map(() => {
          const plane = range(states).map((i) => values.subarray(at + i * samples, at + (i + 1) * samples));
          at += states * samples;
          return plane;
        });
        return range(states).map((state) => planes.map((plane) => plane[state]));
      });
    }
    return found;
  }

  /**
   * Every figure with its rank in every state, or only those that have a limit, which takes less time.
   * @param {{limited?: boolean}} which
   * @returns {Figure[]}
   */
  figures({ limited = false } = {}) {
    const found = this.#cardan.call("figures", { ...this.#arguments(), limited });
    let at = 0;
    return found.kinds.map((/** @type {string} */ name, /** @type {number} */ i) => {
      const [first, last] = [at, at + found.counts[i]];
      at = last;
      return {
        kind: this.#kind(name),
        item: none(found.items[i]),
        values: found.values.slice(first, last),
        ranks: found.ranks.slice(first, last),
        limit: found.limits[i],
        maximum: found.maxima[i],
        worst: none(found.worst[i]),
      };
    });
  }

  /**
   * The worst rank of all figures.
   * @returns {string}
   */
  verdict() {
    const order = this.#cardan.table.names.ranks;
    const places = this.figures({ limited: true }).flatMap((figure) => figure.ranks.map((rank) => order.indexOf(rank)));
    return order[Math.max(0, ...places)];
  }

  /**
   * The smallest single changes that bring everything within its limits.
   * @param {{reach?: number, teeth?: number[], known_ratings?: number[]}} search
   * @returns {Change[]}
   */
  suggest(search = {}) {
    return this.#changes(this.#cardan.call("suggest", this.#search(search)));
  }

  /**
   * The same search in rounds of some milliseconds, one for each turn of the loop that asks for it.
   * Another search of the module ends it.
   * @param {{reach?: number, teeth?: number[], known_ratings?: number[]}} search
   * @returns {Generator<undefined, Change[]>}
   */
  *suggesting(search = {}) {
    const begun = this.#cardan.call("search", this.#search(search));
    while (this.#cardan.call("advance", begun).goes_on[0]) yield;
    return this.#changes(this.#cardan.call("found", begun));
  }

  /** @param {{reach?: number, teeth?: number[], known_ratings?: number[]}} search */
  #search(search) {
    return { ...this.#arguments(), teeth: this.data.teeth ?? [], ...search };
  }

  /**
   * @param {Record<string, any>} found
   * @returns {Change[]}
   */
  #changes(found) {
    return found.variables.map((/** @type {string} */ variable, /** @type {number} */ i) => {
      const worst = found.worst_kinds[i];
      const left = { item: none(found.worst_items[i]), value: found.worst_values[i] };
      return {
        variable,
        item: found.items[i],
        axis: none(found.axes[i]),
        from: found.from[i],
        to: found.to[i],
        share: found.shares[i],
        verdict: found.verdicts[i],
        worst: worst === undefined ? null : { kind: this.#kind(worst), ...left },
      };
    });
  }

  /**
   * The setting of the yokes of each state that is closest to constant velocity, or one for all.
   * @param {{together?: boolean, teeth?: number[], weights?: number[]}} how weights of the states, all
   *   alike by default
   * @returns {Float64Array}
   */
  bestPhases({ together = true, teeth = [], weights } = {}) {
    const given = this.#some(["joints", ...CHAINS]);
    if (!together) return this.#cardan.call("optimal_phases", given).phases;
    const held = Array(this.data.joints - 1).fill(0);
    const shares = weights ?? this.data.weights ?? Array(this.states).fill(1);
    return this.#cardan.call("common_phases", { ...given, weights: shares, held, teeth }).phases;
  }

  /** @param {string} name */
  #kind(name) {
    return /** @type {KindRow} */ (this.#cardan.table.kinds.find((kind) => kind.name === name));
  }

  /**
   * The data with these names.
   * @param {string[]} names
   * @returns {Record<string, any>}
   */
  #some(names) {
    return Object.fromEntries(names.map((name) => [name, this.data[name]]));
  }

  #arguments() {
    const { points, step_points, drawn_points, unit, title, state_names, weights, teeth, ...given } = this.data;
    return given;
  }
}

/** @param {number} count */
const range = (count) => Array.from({ length: count }, (_, i) => i);

/** @param {number} number */
const none = (number) => (number < 0 ? null : number);

/**
 * Flat or nested values as one list.
 * @param {any} values
 * @returns {any[]}
 */
function flat(values) {
  if (values === undefined) return [];
  if (values === null || typeof values !== "object") return [values];
  return Array.from(values).flatMap(flat);
}

/** @param {any} values */
const flatLength = (values) => flat(values).length;
