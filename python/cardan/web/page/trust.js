// @ts-check
/**
 * Test of the core in a page: a list of evaluations that anyone can
 * repeat, whose results have a published digest.
 *
 * The list has 200 drivelines, 40 of each number of joints from 1 to 5, at 50 drive angles each. Their
 * numbers are those of a generator of whole numbers, x → 48271 x mod (2³¹ − 1) from 1, divided by 2³¹.
 * Scaled by powers of two they are exact, so that every language has the same ones.
 *
 * @module trust
 */

import { made } from "./elements.js";
import { grouped } from "./numbers.js";

/** The digest of the results, as the installed package computes them. */
export const PUBLISHED = "e2a151ba833e384b7ea3900a24440eff9b1d9420b61a512486a2aa08d6258d49";

const DRIVELINES = 40; // of each number of joints
const JOINTS = 5;
const ANGLES = 50;
const EVALUATIONS = DRIVELINES * JOINTS * ANGLES;
const OUTPUTS = [
  "angle",
  "angle_error",
  "speed_ratio",
  "acceleration_ratio",
  "torque",
  "moment",
  "joint_force",
  "bearing_force",
];
const SLICE_MS = 8;
const SHOWN = 12; // hexadecimal digits of a digest in a sentence

/** @template T @param {number} count @param {(i: number) => T} one */
const many = (count, one) => Array.from({ length: count }, (_, i) => one(i));

/**
 * Every driveline of the list, with its drive angles.
 * @returns {Generator<{data: import("../cardan.js").MachineData, angles: number[]}>}
 */
export function* list() {
  let x = 1;
  const next = () => {
    x = (48271 * x) % 2147483647;
    return x / 2147483648;
  };
  for (let joints = 1; joints <= JOINTS; joints++) {
    // As few bearings as carry it: two on the first shaft, two on the last one, one between.
    const between = many(joints - 1, (i) => i + 1);
    const bearings = joints === 1 ? [0, 0, 1] : [0, 0, ...between.slice(0, -1), joints, joints];
    for (let i = 0; i < DRIVELINES; i++) {
      const points = many(joints + 2, (k) => [k + next() / 4, next() / 2, next() / 2]);
      const phases = many(joints - 1, () => 4 * next() - 2);
      const positions = bearings.map((shaft, k) => (shaft === bearings[k - 1] ? 0.5 : 0.25) + next() / 8);
      const [torque, speed, acceleration] = [512 * next(), 128 * next(), 64 * next()];
      const inertias = many(joints + 1, () => [next() / 4]);
      yield {
        data: {
          joints,
          points: [points],
          phases: [phases],
          bearings,
          positions: [positions],
          end: i % 2 ? "drive" : "output",
          torque: [torque],
          speed: [speed],
          acceleration: [acceleration],
          inertia_shafts: many(joints + 1, (shaft) => shaft),
          inertias,
        },
        angles: many(ANGLES, () => 8 * next()),
      };
    }
  }
}

/**
 * Evaluate the list, in slices that leave the page time.
 * @param {import("../cardan.js").Cardan} cardan
 * @param {(share: number) => void} told how much is done
 * @param {Iterable<{data: import("../cardan.js").MachineData, angles: number[]}>} lines
 * @returns {Promise<string>} the digest of the results, that of each driveline with the one before
 */
export async function evaluated(cardan, told = () => {}, lines = list()) {
  let [digest, done, started] = [new Uint8Array(0), 0, performance.now()];
  for (const { data, angles } of lines) {
    const found = cardan.machine(data).evaluate({ outputs: OUTPUTS, angles });
    const rows = OUTPUTS.flatMap((name) => found[name].flat(2));
    const bytes = new Uint8Array(digest.length + 8 * rows.length * ANGLES);
    bytes.set(digest);
    const view = new DataView(bytes.buffer, digest.length);
    let at = 0;
    for (const row of rows) {
      // The bits of what is no number are not defined.
      for (const value of row) view.setFloat64(8 * at++, Number.isNaN(value) ? NaN : value, true);
    }
    digest = sha256(bytes);
    done += angles.length;
    if (performance.now() - started > SLICE_MS) {
      told(done / EVALUATIONS);
      await new Promise((resume) => setTimeout(resume));
      started = performance.now();
    }
  }
  return hexadecimal(digest);
}

/**
 * Sentence on the core in this browser, by the digest of its results.
 * @param {string} digest
 */
export function said(digest) {
  const count = grouped(EVALUATIONS);
  if (digest === PUBLISHED) {
    return `All ${count} evaluations have the published results (${short(digest)}).`;
  }
  const other = `The results of ${count} evaluations are not the published ones`;
  return `${other} (${short(digest)}, not ${short(PUBLISHED)}). Open the page in another browser.`;
}

/** @param {string} digest */
const short = (digest) => digest.slice(0, SHOWN);

/**
 * Say below the machine what computes here and from which scene, with a button that tests the core.
 * @param {Element} element
 * @param {import("../cardan.js").Cardan} cardan
 * @param {import("./model.js").Sent} sent
 */
export function foot(element, cardan, { core, title, source }) {
  const text = hexadecimal(sha256(new TextEncoder().encode(source.text)));
  const scene = `${title ? `“${title}”, ` : ""}${source.name} (${short(text)})`;
  made("span", "", element, `Computed in this page by cardan ${cardan.table.version} (${short(core)}) from ${scene}. `);
  const name = "Test the core in this browser";
  const button = /** @type {HTMLButtonElement} */ (made("button", "", element, name));
  button.type = "button";
  button.title = "Evaluates a published list of drivelines, not this scene, and compares the results";
  const result = made("span", "", element);
  result.setAttribute("role", "status");
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      const digest = await evaluated(cardan, (share) => {
        button.textContent = `Testing: ${Math.floor(100 * share)}%`;
      });
      result.className = digest === PUBLISHED ? "within" : "beyond";
      result.textContent = said(digest);
    } catch (error) {
      result.className = "beyond";
      result.textContent = `The evaluations have stopped: ${error}`;
    }
    button.textContent = name;
    button.disabled = false;
  });
}

const ROUNDS = Uint32Array.of(
  0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
  0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
  0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
  0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
  0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
  0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
  0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
  0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
);
const START = Uint32Array.of(
  0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19,
);

/**
 * The SHA-256 of bytes. Browsers have it too, but not in pages that come from a server without
 * encryption.
 * @param {Uint8Array} bytes
 */
export function sha256(bytes) {
  const padded = new Uint8Array((((bytes.length + 8) >> 6) + 1) << 6);
  padded.set(bytes);
  padded[bytes.length] = 0x80;
  const view = new DataView(padded.buffer);
  view.setUint32(padded.length - 8, Math.floor(bytes.length / 2 ** 29));
  view.setUint32(padded.length - 4, bytes.length << 3);
  const state = START.slice();
  const words = new Uint32Array(64);
  const turned = (/** @type {number} */ x, /** @type {number} */ by) => (x >>> by) | (x << (32 - by));
  for (let block = 0; block < padded.length; block += 64) {
    for (let i = 0; i < 16; i++) words[i] = view.getUint32(block + 4 * i);
    for (let i = 16; i < 64; i++) {
      const [x, y] = [words[i - 15], words[i - 2]];
      const first = turned(x, 7) ^ turned(x, 18) ^ (x >>> 3);
      const second = turned(y, 17) ^ turned(y, 19) ^ (y >>> 10);
      words[i] = words[i - 16] + first + words[i - 7] + second;
    }
    let [a, b, c, d, e, f, g, h] = state;
    for (let i = 0; i < 64; i++) {
      const choice = (e & f) ^ (~e & g);
      const one = (h + (turned(e, 6) ^ turned(e, 11) ^ turned(e, 25)) + choice + ROUNDS[i] + words[i]) | 0;
      const most = (a & b) ^ (a & c) ^ (b & c);
      const other = ((turned(a, 2) ^ turned(a, 13) ^ turned(a, 22)) + most) | 0;
      [h, g, f, e, d, c, b, a] = [g, f, e, (d + one) | 0, c, b, a, (one + other) | 0];
    }
    [a, b, c, d, e, f, g, h].forEach((x, i) => (state[i] += x));
  }
  const digest = new Uint8Array(32);
  state.forEach((x, i) => new DataView(digest.buffer).setUint32(4 * i, x));
  return digest;
}

/** @param {Uint8Array} bytes */
const hexadecimal = (bytes) => Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
