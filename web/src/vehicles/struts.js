// Struts at work between their two ends, with the levers, arms and beams on which these are.

import { point, unitOf } from "./layout.js";
import { heightOf, liftOf } from "./scene.js";
import { box, circle, draw, line, polygon, text, travelOf } from "./symbols.js";

/** @import { Layout, Lever, PlacedBody, PlacedStrut } from "./layout.js" */
/** @import { Moment } from "./moments.js" */
/** @import { Pose, Tyre } from "./scene.js" */
/** @import { Shape } from "./symbols.js" */

const THICK = 20; // [px] of a wheel, from which on what it carries is thick

/** What carries a strut on a hub. @param {number} x @param {number} hub @param {number} top @param {number} R
 * @param {Shape[]} into */
export function carrier(x, hub, top, R, into) {
  const thin = R > THICK ? "" : " thin";
  into.push(line([[x, hub], [x, top]], `halo${thin}`), line([[x, hub], [x, top]], `carrier${thin}`));
}

/** The suspension of a wheel that is on its road. @param {Layout} made @param {Tyre} tyre @param {Moment} moment
 * @param {number} px @param {number} hub @param {Shape[]} into */
export function primary(made, tyre, moment, px, hub, into) {
  const own = /** @type {PlacedBody} */ (made.bodies.get(tyre.body));
  const found = made.primaries.find((each) => each.tyre === tyre);
  if (!found) return;
  const rest = made.project(tyre.x, tyre.y, own.z - own.thick / 2)[1];
  const top = point(made, tyre.x, tyre.y, own.z - own.thick / 2, heightOf(tyre.port, moment.pose))[1];
  const long = made.base - 2 * made.radius - rest;
  carrier(px, hub, hub - made.radius, made.radius, into);
  draw(found.plan, px, top, long, { lift: made.lift, scale: found.scale, wide: found.scale, labels: false,
    travel: moment.travels[tyre.name] ?? {}, reach: made.range.reach[tyre.name] ?? {},
    states: moment.states[tyre.name] ?? {} }, into);
}

/** Where a strut is, and its ends. @param {Layout} made @param {PlacedStrut} one @param {Pose} pose */
export function endsOf(made, one, pose) {
  const { x, y, shift, top, bottom } = one;
  return {
    x: made.project(x, y, 0)[0] + shift,
    top: point(made, x, y, top, topHeight(one, pose))[1],
    bottom: point(made, x, y, bottom, bottomHeight(one, pose))[1],
  };
}

/** A strut between its two ends, wherever these are. @param {Layout} made @param {PlacedStrut} one
 * @param {Moment} moment @param {Shape[]} into */
export function strut(made, one, moment, into) {
  const { x, y, bottom, top, scale, wide, plan } = one;
  const { upper, lower, name: mount } = one.strut;
  const [px] = made.project(x, y, 0);
  const { x: at, top: yTop, bottom: yBottom } = endsOf(made, one, moment.pose);
  if (one.lever) lever(made, one, moment, px, into);
  over(made, lower, at, yBottom, moment, bottom, into);
  over(made, upper, at, yTop, moment, top, into);
  if (made.scene.silhouette && plan.parts.length > 0) {
    const half = [plan.left, plan.right].map((side) => side * wide + 4);
    into.push(box(at - half[0], yTop + 3, at + half[1], yBottom, "cut"),
      line([[px - 0.09 * 100 * unitOf(made), yTop], [px + 0.09 * 100 * unitOf(made), yTop]], "seat"));
  }
  const travels = moment.travels[mount] ?? {};
  draw(plan, at, yTop, yBottom - yTop - made.lift * travelOf(plan, travels), { lift: made.lift, scale, wide,
    labels: true, travel: travels, reach: made.range.reach[mount] ?? {}, states: moment.states[mount] ?? {},
    chosen: moment.chosen }, into);
  if (made.scene.column) tell(moment.states[mount] ?? {}, at + plan.right * wide + 8, yBottom - 18, into);
}

/** Says which friction sticks and which gaps are open. @param {{[element: string]: string}} states @param {number} x
 * @param {number} y @param {Shape[]} into */
function tell(states, x, y, into) {
  const names = (/** @type {string} */ state) => Object.keys(states).filter((key) => states[key] === state);
  const [stick, open] = [names("stick"), names("open")];
  if (stick.length > 0) into.push(text(x, y, `${stick.join(", ")} ${stick.length > 1 ? "stick" : "sticks"}`, "told"));
  if (open.length > 0) into.push(text(x, y - 14, `${open.join(", ")} open`, "told"));
}

/** How far the upper end of a strut is above its place [m]. @param {PlacedStrut} one @param {Pose} pose */
const topHeight = ({ strut: { upper }, lever: on }, pose) => heightOf(upper.port, pose) / (on?.hinged ? on.ratio : 1);

/** The same of its lower end; on an arm it is between the body and the wheel. @param {PlacedStrut} one
 * @param {Pose} pose */
function bottomHeight(one, pose) {
  const height = heightOf(one.strut.lower.port, pose);
  return one.lever?.hinged ? height + (1 - one.lever.ratio) * topHeight(one, pose) : height;
}

/** The lever or arm on which an end of a strut is. @param {Layout} made @param {PlacedStrut} one
 * @param {Moment} moment @param {number} px @param {Shape[]} into */
function lever(made, one, moment, px, into) {
  const { end, arm, ratio, hinged } = /** @type {Lever} */ (one.lever);
  const place = one.strut[end];
  const own = place.body && made.bodies.get(place.body);
  if (!own) return;
  const z = end === "lower" ? one.bottom : one.top;
  const moved = heightOf(place.port, moment.pose) / ratio;
  const fixed = hinged ? topHeight(one, moment.pose) : 0;
  const y = (/** @type {number} */ lift) => made.base - z - made.lift * lift;
  const hinge = px + arm;
  const share = Math.max(1, ratio);
  const far = hinge - share * arm;
  into.push(line([[hinge, y(fixed)], [far, y(fixed + share * (moved - fixed))]], "lever"));
  if (hinged) into.push(line([[hinge, y(fixed)], [hinge, made.base - one.top - made.lift * fixed]], "lever"));
  else into.push(polygon([[hinge, y(0)], [hinge - 6, y(0) + 11], [hinge + 6, y(0) + 11]], "pivot"));
  into.push(circle(hinge, y(fixed), 3, "joint"),
    circle(px + one.shift, y(fixed + ratio * (moved - fixed)), 3, "joint"));
}

/** A bar over several bodies, or a bracket to where a strut was moved. @param {Layout} made
 * @param {import("./scene.js").Place} place @param {number} at @param {number} y @param {Moment} moment
 * @param {number} z @param {Shape[]} into */
function over(made, place, at, y, moment, z, into) {
  if (place.over.length > 1) {
    const ends = place.over.map((body) => point(made, body.x, body.y, z, liftOf(body, 0, 0, moment.pose)));
    into.push(line(ends, "lever"), ...ends.map(([a, b]) => circle(a, b, 3, "joint")), circle(at, y, 3, "joint"));
    for (const [i, body] of place.over.entries()) {
      if (body.kind === "wheel") carrier(ends[i][0], point(made, body.x, body.y, made.radius, liftOf(body, 0, 0,
        moment.pose))[1], ends[i][1], made.radius, into);
    }
  }
}
