// What is written over the picture: how the vehicle stands, how large motions are drawn, whose outline is dashed.

import { NARROW } from "./layout.js";
import { shortLabel } from "../network/drawing.js";
import { capital } from "../state/scale.js";
import { inWords } from "./naming.js";
import { liftOf } from "./scene.js";
import { line, text } from "./symbols.js";

/** @import { Layout, Motion } from "./layout.js" */
/** @import { Moment } from "./moments.js" */
/** @import { Shape } from "./symbols.js" */

const BARS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 40, 50, 100, 200, 500, 1000]; // [mm]
const SHORTEST = 22; // [px]
const STILL = 1e-9; // [rad]

/** @param {Layout} made @param {{moment: Moment, motion: Motion}} moved
 * @param {{own: string, other: string} | null} names of the design and of the one that is dashed @returns {Shape[]} */
export function captions(made, moved, names) {
  const { width, height, scene } = made;
  const narrow = width < NARROW;
  /** @type {Shape[]} */
  const into = [...scaleBar(made, narrow)];
  const large = made.times === 1 ? "motions to scale" : `motions drawn ${made.times} times as large`;
  const road = scene.tracks.length > 0 && scene.column ? "; road length not to scale" : "";
  const above = standing(made, moved, large);
  if (above.length === 0) into.push(text(12, height - 10, `${capital(large)}${road}`, "on earth"));
  above.forEach((words, i) => into.push(text(12, (narrow ? 60 : 18) + 16 * i, words, "quiet")));
  if (names) into.push(...legend(made, names, narrow, above.length));
  return into;
}

/** Heave, pitch and roll of the body, a line each. @param {Layout} made
 * @param {{moment: Moment, motion: Motion}} moved @param {string} large @returns {string[]} */
function standing({ scene: { main, column } }, { moment: { pose }, motion }, large) {
  if (!main || column || (main.pitch === null && main.roll === null)) return [];
  const signed = (/** @type {number} */ value, /** @type {number} */ digits) =>
    value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  const degrees = (/** @type {string} */ name) => signed(((pose[name] ?? 0) * 180) / Math.PI, 2);
  const parts = [`heave ${signed(liftOf(main, 0, 0, pose) * 1000, 1)} mm`];
  if (main.pitch !== null) parts.push(`${inWords(main.pitch)} ${degrees(main.pitch)}°`);
  const rolls = main.roll !== null && (motion.coordinates[main.roll] ?? []).some((value) => Math.abs(value) > STILL);
  if (main.roll !== null && rolls) parts.push(`roll ${degrees(main.roll)}°`);
  const lines = [parts.join(", "), large];
  return main.roll !== null && !rolls ? [...lines, "roll 0: same road on both sides"] : lines;
}

/** A length upwards. @param {Layout} made @param {boolean} narrow @returns {Shape[]} */
function scaleBar({ lift, width }, narrow) {
  const length = BARS.find((each) => (each / 1000) * lift >= SHORTEST) ?? BARS[BARS.length - 1];
  const [x, y, tall] = [width - 32, narrow ? 56 : 58, (length / 1000) * lift];
  return [
    line([[x - 4, y], [x + 4, y]], "bar"), line([[x, y], [x, y + tall]], "bar"),
    line([[x - 4, y + tall], [x + 4, y + tall]], "bar"),
    text(x, y + tall + 15, `${length} mm`, "beside", "middle"),
  ];
}

/** Whose body is which. @param {Layout} made @param {{own: string, other: string}} names @param {boolean} narrow
 * @param {number} below so many lines @returns {Shape[]} */
function legend({ scene }, { own, other }, narrow, below) {
  const body = scene.column && scene.tracks.length > 0 ? "body on " : "";
  const y = (narrow ? 62 : 20) + 16 * below;
  const otherWords = `${body ? "on" : "dashed:"} ${shortLabel(other)}, same road`;
  if (!scene.column) return [line([[12, y - 4], [30, y - 4]], "other trail"), text(36, y, otherWords)];
  return [line([[12, y - 4], [30, y - 4]], "own"), text(36, y, `${body}${shortLabel(own)}`),
    line([[12, y + 14], [30, y + 14]], "other trail"), text(36, y + 18, otherWords)];
}
