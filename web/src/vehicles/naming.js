// What is written at bodies and wheels: names, masses, and which friction sticks.

import { isDrawn, point } from "./layout.js";
import { heightOf, liftOf } from "./scene.js";
import { text } from "./symbols.js";

/** @import { Layout, PlacedBody } from "./layout.js" */
/** @import { Moment } from "./moments.js" */
/** @import { Tyre } from "./scene.js" */
/** @import { Point, Shape } from "./symbols.js" */

/** @type {{[name: string]: string}} */
const WORDS = { sprung: "body", unsprung: "wheel", primary: "primary mass" };

/** A name as words. @param {string} name */
export const inWords = (name) => WORDS[name] ?? name.replace(/^unsprung_/, "").replaceAll("_", " ");

/** What stands beside things. @param {Layout} made @param {Moment} moment @param {Shape[]} into */
export function name(made, moment, into) {
  const { scene } = made;
  for (const own of made.bodies.values()) if (isDrawn(made, own) && own.thick >= 10) nameBody(made, own, moment, into);
  if (scene.column && scene.tyres.length === 1) return nameWheel(made, scene.tyres[0], moment, into);
  for (const { x, y, rigid, body: of } of scene.tyres) {
    const [px, floor] = made.project(x, y, 0);
    if (rigid || of.kind !== "wheel" || (scene.oblique && y > 0)) continue;
    into.push(text(px, scene.oblique ? floor + 18 : made.height - 10, inWords(of.name), "quiet", "middle"));
  }
}

const LETTER = 6.2; // [px] about as wide

/** The name and the mass of a body: in it, where there is room. @param {Layout} made @param {PlacedBody} own
 * @param {Moment} moment @param {Shape[]} into */
function nameBody(made, own, moment, into) {
  const { body: of, z, thick, from, to } = own;
  const at = (/** @type {number} */ px) => {
    const [x, y] = point(made, of.x, of.y, z, liftOf(of, px / made.metre, 0, moment.pose));
    return /** @type {Point} */ ([x + px, y + 4]);
  };
  const words = of.kind === "table" ? "table" : inWords(of.name);
  const room = Math.min(-from, to); // to either side of the mark of its middle
  const isOccupant = of.kind === "occupant";
  const wide = LETTER * Math.max(words.length, of.weight.length) + 8;
  if (made.scene.oblique) {
    const [x, y] = at(isOccupant ? -6 : 0);
    into.push(isOccupant ? text(x, y - 0.52 * thick - 6, words, "text", "middle")
      : text(x + 12, y, `${words} ${of.weight}`, "beside"));
  } else if (wide + 20 < room && thick >= 15 && !isOccupant) {
    into.push(text(...at(from + 12), words), text(...at(to - 12), of.weight, "text", "end"));
  } else {
    const left = made.project(of.x, of.y, 0)[0] + to + wide > made.width || (made.scene.column && of.kind === "body");
    const [x, y] = at(left ? from - 7 : isOccupant ? 26 : to + 7);
    const anchor = left ? "end" : "start";
    into.push(text(x, y - 7, words, "text", anchor), text(x, y + 8, of.weight, "quiet", anchor));
  }
}

/** @param {Layout} made @param {Tyre} tyre @param {Moment} moment @param {Shape[]} into */
function nameWheel(made, { x, y, port, body: of, network }, moment, into) {
  const [px, py] = point(made, x, y, made.radius, heightOf(port, moment.pose));
  const beside = px + made.radius + 12;
  if (of.mass !== null) into.push(text(beside, py - 4, `${inWords(of.name)} ${of.weight}`, "beside"));
  if (network.kind === "element") into.push(text(beside, py + 11, `tyre ${network.text}`, "beside"));
}
