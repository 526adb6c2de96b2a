// Calls the module of the page and digests what it returns: `node calls.mjs FOLDER_OF_MODULE CALLS`
// reads a list of calls as JSON and prints a list of answers. In a browser `answers` is called with
// the same list. Arrays of doubles are {"f64": base64}, so that every bit arrives.

/** The numbers of base64 in a string. */
function doubles(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float64Array(bytes.buffer);
}

function decoded(value) {
  return value && value.f64 !== undefined ? doubles(value.f64) : value;
}

const FACTORS = [0x01000193, 0x9e3779b1];

/** The number of values, and two polynomials in their words; all NaN are alike. */
export function digest(values) {
  const own = Float64Array.from(values, (value) => (Number.isNaN(value) ? NaN : value));
  const words = new Int32Array(own.buffer);
  const sums = FACTORS.map((factor) => {
    let sum = 0;
    for (let i = 0; i < words.length; i++) sum = (Math.imul(sum, factor) + words[i]) | 0;
    return sum >>> 0;
  });
  return [own.length, ...sums];
}

/** Of planes with so many rows of so many samples, one row of each. */
function rowsOf([row, rows, samples], values) {
  const planes = values.length / (rows * samples);
  const parts = Array.from({ length: planes }, (_, plane) => {
    const first = (plane * rows + row) * samples;
    return Array.from(values.subarray(first, first + samples));
  });
  return Float64Array.from(parts.flat());
}

/**
 * The answer to each call: digests or names by result, or the message of an error. A call may name
 * one driveline of all, whose rows count.
 */
export function answers(cardan, calls) {
  return calls.map(([name, given, line]) => {
    const values = Object.entries(given).map(([key, value]) => [key, decoded(value)]);
    try {
      const found = cardan.call(name, Object.fromEntries(values));
      if (line !== undefined && found.values) found.values = rowsOf(line, found.values);
      const shown = ([key, values]) => [key, Array.isArray(values) ? values : digest(values)];
      return Object.fromEntries(Object.entries(found).map(shown));
    } catch (error) {
      const { argument, place, value, unit, rule } = error;
      const parts = { argument, place, value: String(value), unit, rule };
      return { error: error.message, kind: error.constructor.name, parts };
    }
  });
}

const shownFigure = (figure) => [figure.kind.name, figure.item, digest(figure.values), figure.ranks];

/** What a machine answers as it is, and after a point has moved. */
export function judged(cardan, { data, search }) {
  const machine = cardan.machine(data);
  const { bends, ...rest } = data;
  const suggested = machine.suggest(search);
  // The same search in rounds, which finds the same.
  const rounds = machine.suggesting(search);
  let round = rounds.next();
  while (!round.done) round = rounds.next();
  if (JSON.stringify(round.value) !== JSON.stringify(suggested)) throw new Error("rounds find something else");
  const shown = (change) => [change.variable, change.item, change.axis, digest([change.from, change.to])];
  return {
    verdict: machine.verdict(),
    figures: machine.figures().map(shownFigure),
    limited: machine.figures({ limited: true }).map(shownFigure),
    // Without its arrays it is made from its points.
    made: data.unit === undefined ? null : cardan.machine(rest).figures().map(shownFigure),
    applied: suggested.map((change) => [change.verdict, machine.apply(change).verdict()]),
    suggested: suggested.map(shown),
    raised: data.unit !== undefined ? machine.move(1, [0, 0, 0.004]).figures().map(shownFigure) : null,
  };
}

/** Milliseconds of frames in which a point moves: the figures of all states and their curves. */
export function frames(cardan, data, count) {
  const angles = Array.from({ length: 33 }, (_, i) => (i * Math.PI) / 32);
  const outputs = ["speed_ratio", "acceleration_ratio"];
  if (data.torque) outputs.push("torque", "moment");
  if (data.torque && data.bearings.length) outputs.push("bearing_force");
  const times = [];
  for (let i = 0; i < count; i++) {
    const start = performance.now();
    let machine = cardan.machine(data);
    if (data.points) machine = machine.move(1, [0, (i % 7) * 1e-3, 0]);
    machine.evaluate({ outputs, angles });
    const curves = performance.now();
    machine.figures({ limited: true });
    times.push([curves - start, performance.now() - start]);
  }
  const worst = (i) => times.map((time) => time[i]).sort((a, b) => a - b);
  const [curves, all] = [worst(0), worst(1)];
  const middle = count >> 1;
  return { curves: curves[middle], median: all[middle], worst: all[count - 1] };
}

/** How much memory the module has after the second and the last round of the same calls, for some seconds. */
export function endured(cardan, data, seconds) {
  const sizes = [];
  const end = performance.now() + 1e3 * seconds;
  do {
    frames(cardan, data, 4);
    cardan.machine(data).suggest({ reach: 0.02 });
    sizes.push(cardan.memory);
  } while (performance.now() < end || sizes.length < 3);
  return [sizes[1], sizes[sizes.length - 1]];
}

if (typeof process !== "undefined") {
  const { readFileSync } = await import("node:fs");
  const [folder, file] = process.argv.slice(2);
  const { Cardan } = await import(`${folder}/cardan.js`);
  const cardan = await Cardan.load(readFileSync(`${folder}/cardan.wasm.gz`));
  const asked = JSON.parse(readFileSync(file, "utf8"));
  const answer = { table: cardan.table };
  answer.answers = answers(cardan, asked.calls ?? []);
  answer.judged = (asked.machines ?? []).map((machine) => judged(cardan, machine));
  answer.frames = (asked.frames ?? []).map((data) => frames(cardan, data, 60));
  if (asked.endure) answer.memory = endured(cardan, ...asked.endure);
  console.log(JSON.stringify(answer));
}
