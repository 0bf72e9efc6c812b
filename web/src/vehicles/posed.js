// A vehicle in one pose, as shapes in px with classes: every height is that of the simulation, every element is as long
// as the simulation says.

import { CAR, EDGES, WINDOWS } from "./outline.js";
import { heightOf, liftOf, spread } from "./scene.js";
import { box, circle, draw, line, polygon, travelOf } from "./symbols.js";

/** @import { Layout, Motion, PlacedBody, PlacedStrut } from "./layout.js" */
/** @import { Body, Pose, Strut, Tyre } from "./scene.js" */
/** @import { Point, Shape } from "./symbols.js" */
/** What is at one time: heights and angles, travels of elements [m], states of friction and gaps, how far wheels have
 * turned [rad], which element is selected, and the height of a road so many px before the wheel that it is under [m].
 * @typedef {{pose: Pose, travels: {[mount: string]: {[element: string]: number}},
 * states: {[mount: string]: {[element: string]: string}}, turned: number,
 * road: (name: string, px: number) => number,
 * chosen?: string | null}} Moment */

/** Of a vehicle that stands still. @type {Moment} */
export const REST = { pose: {}, travels: {}, states: {}, turned: 0, road: () => 0 };

const SAME_SIDE = 0.3; // [m]
const STEP = 4; // [px] of a road that is drawn
const ROLLED = 9; // [rad/s] of a wheel, so that its spokes are seen to turn
const COLUMN = 200; // [px/s] of a road under one wheel

/** How fast a road passes [px/s]. @param {Layout} made @param {number} speed [m/s] */
export const passing = (made, speed) => (made.scene.column || !(speed > 0) ? COLUMN
  : speed * (made.project(1, 0, 0)[0] - made.project(0, 0, 0)[0]));

/** What is at one time of a motion. @param {Layout} made @param {Motion} motion @param {number} at [s]
 * @param {{speed: number, shaded?: {element: string, state: string, intervals: [number, number][]}[]}} how
 * @returns {Moment} */
export function momentOf(made, motion, at, { speed, shaded = [] }) {
  const { time } = motion;
  const step = time.length > 1 ? time[1] - time[0] : 1;
  const now = Math.max(0, Math.min(time.length - 1, at / step));
  /** @param {{[name: string]: number[]}} several */
  const each = (several) => Object.fromEntries(Object.entries(several).map(([name, values]) => [name,
    between(values, now)]));
  const travels = Object.fromEntries(Object.entries(motion.elements ?? {}).map(([mount, of]) => [mount, each(of)]));
  const states = shaded.filter(({ intervals }) => isWithin(intervals, at));
  const perSample = step * passing(made, speed);
  return {
    pose: each({ ...motion.coordinates, ...motion.roads }),
    travels,
    states: Object.fromEntries(Object.entries(travels).map(([mount, of]) => [mount, Object.fromEntries(
      Object.keys(of).flatMap((key) => {
        const found = states.find(({ element }) => element === `${mount}.${key}`)
          ?? states.find(({ element }) => element === key);
        return found ? [[key, found.state]] : [];
      }),
    )])),
    turned: ROLLED * at,
    road: (name, px) => smooth(motion.roads[name] ?? [0], now + px / perSample),
  };
}

/** @param {number[]} values @param {number} at in samples */
function between(values, at) {
  const i = Math.min(Math.floor(at), values.length - 1);
  return values[i] + (at - i) * ((values[i + 1] ?? values[i]) - values[i]);
}

/** The same without corners. @param {number[]} values @param {number} at in samples */
function smooth(values, at) {
  const last = values.length - 1;
  const now = Math.max(0, Math.min(last, at));
  const i = Math.min(Math.floor(now), Math.max(0, last - 1));
  const t = now - i;
  const [a, b, c, d] = [i - 1, i, i + 1, i + 2].map((j) => values[Math.max(0, Math.min(last, j))]);
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

/** Whether a time is in one of the intervals, which are in order. @param {[number, number][]} intervals
 * @param {number} at */
function isWithin(intervals, at) {
  let [low, high] = [0, intervals.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (intervals[middle][0] <= at) low = middle + 1;
    else high = middle;
  }
  return low > 0 && at < intervals[low - 1][1];
}

/** A vehicle in a pose, before the outlines of another one. @param {Layout} made @param {Moment} moment
 * @param {{labels?: boolean, other?: Moment | null}} [how] @returns {Shape[]} */
export function posed(made, moment, { labels = true, other = null } = {}) {
  /** @type {Shape[]} */
  const into = [];
  ground(made, moment, into);
  const behind = other ? outlines(made, other) : [];
  if (made.scene.oblique) inDepth(made, moment, behind, into);
  else fromTheSide(made, moment, behind, into);
  if (labels) name(made, moment, into);
  return into;
}

/** @param {Layout} made @param {Moment} moment @param {Shape[]} behind @param {Shape[]} into */
function fromTheSide(made, moment, behind, into) {
  const { scene } = made;
  if (scene.silhouette && scene.main) car(made, scene.main, 0, moment, into);
  into.push(...behind);
  for (const tyre of scene.tyres) wheel(made, tyre, moment, into);
  for (const own of made.bodies.values()) if (own.body.kind === "beam") body(made, own, moment, into);
  for (const link of scene.links) bar(made, link.bodies, moment, into);
  for (const one of made.struts) strut(made, one, moment, into);
  for (const own of made.bodies.values()) if (isDrawn(made, own)) body(made, own, moment, into);
}

const NEAR = 0.25; // of the width, what belongs to the near side

/** From the far side to the near one. @param {Layout} made @param {Moment} moment @param {Shape[]} behind
 * @param {Shape[]} into */
function inDepth(made, moment, behind, into) {
  const { scene } = made;
  const sides = [...new Set([...scene.tyres, ...made.struts].map(({ y }) => y))].sort((a, b) => b - a);
  const [far, near] = [sides[0], sides[sides.length - 1]];
  for (const { bodies } of scene.links) if (!isAcross(bodies)) bar(made, bodies, moment, into);
  if (scene.silhouette && scene.main) car(made, scene.main, far, moment, into, "far");
  const first = sides.find((y) => y < near + NEAR * (far - near));
  for (const y of sides) {
    if (y === first) across(made, far, near, moment, into);
    if (y === first && scene.silhouette && scene.main) {
      car(made, scene.main, near, moment, into, "near");
      into.push(...behind);
    }
    for (const tyre of scene.tyres) if (tyre.y === y) wheel(made, tyre, moment, into);
    for (const one of made.struts) if (one.y === y) strut(made, one, moment, into);
    for (const own of made.bodies.values()) {
      if (own.body.kind === "occupant" && own.body.y === y) body(made, own, moment, into);
    }
  }
  for (const own of made.bodies.values()) {
    if (isDrawn(made, own) && own.body.kind !== "occupant") slab(made, own, moment, into);
  }
}

/** Whether bodies are on both sides. @param {Body[]} bodies */
const isAcross = (bodies) => spread(bodies.map(({ y }) => y)) > 1e-6;

/** What joins both sides: bars, and edges of the body. @param {Layout} made @param {number} far @param {number} near
 * @param {Moment} moment @param {Shape[]} into */
function across(made, far, near, moment, into) {
  for (const { bodies } of made.scene.links) if (isAcross(bodies)) bar(made, bodies, moment, into);
  if (!made.scene.silhouette || !made.scene.main) return;
  const { main } = made.scene;
  for (const edge of EDGES) into.push(line([far, near].map((y) => onCar(made, main, y, edge, moment)), "edge"));
}

/** Whether a body is drawn by itself, not as a wheel or as the outline of a car. @param {Layout} made
 * @param {PlacedBody} own */
const isDrawn = ({ scene }, { body: { kind }, body: own }) =>
  kind !== "wheel" && kind !== "beam" && !(scene.silhouette && own === scene.main);

/** The point of a picture that is so far above the ground. @param {Layout} made @param {number} x @param {number} y
 * @param {number} z [px] @param {number} lift [m] @returns {Point} */
const point = (made, x, y, z, lift) => made.project(x, y, z + made.lift * lift);

/** The ground, and the roads on it. @param {Layout} made @param {Moment} moment @param {Shape[]} into */
function ground(made, moment, into) {
  const { scene, width, height, base } = made;
  if (scene.oblique) {
    const [, far] = made.project(0, Math.max(...scene.tyres.map(({ y }) => y)), 0);
    into.push(box(0, far - 10, width, height, "plain"));
    const every = scene.tracks.map((track) => track.y);
    for (const y of [Math.max(...every), Math.min(...every)]) {
      const [left] = made.project(Math.min(...scene.tracks.map(({ x }) => x)), y, 0);
      const [right] = made.project(Math.max(...scene.tracks.map(({ x }) => x)), y, 0);
      const profile = profileOf(made, y, moment, Math.max(0, left - 70), Math.min(width, right + 70));
      into.push(line(profile, "strip"), line(profile, "road"));
    }
    return;
  }
  const onGround = scene.struts.some(({ lower }) => lower.body === null && lower.over.length === 0);
  if (scene.tracks.length > 0) {
    const profile = profileOf(made, 0, moment, 0, width);
    into.push(polygon([...profile, [width, height], [0, height]], "earth"), line(profile, "road"));
  } else if (onGround) {
    into.push(box(0, base, width, height, "earth"), line([[0, base], [width, base]], "road"));
  }
  if (made.roof !== null) {
    const y = base - made.roof;
    into.push(line([[width * 0.2, y], [width * 0.8, y]], "road"));
    for (let x = width * 0.2; x < width * 0.8; x += 10) into.push(line([[x, y], [x + 6, y - 6]], "hatch"));
  }
}

/** The profile under the wheels of one side: of the nearest of its roads. @param {Layout} made @param {number} y
 * @param {Moment} moment @param {number} from @param {number} to @returns {Point[]} */
function profileOf(made, y, moment, from, to) {
  const { tracks, oblique, frontal } = made.scene;
  const own = (oblique ? tracks.filter((track) => Math.abs(track.y - y) < SAME_SIDE) : tracks).map(({ name, x }) =>
    ({ name, at: made.project(x, y, 0)[0] }));
  const [, level] = made.project(0, y, 0);
  /** @type {Point[]} */
  const points = [];
  for (let px = from; px <= to + STEP; px += STEP) {
    const near = own.reduce((best, each) => (Math.abs(each.at - px) < Math.abs(best.at - px) ? each : best));
    points.push([px, level - made.lift * moment.road(near.name, frontal ? 0 : px - near.at)]);
  }
  return points;
}

const SPOKES = 5;

/** @param {Layout} made @param {Tyre} tyre @param {Moment} moment @param {Shape[]} into */
function wheel(made, tyre, moment, into) {
  const { radius: R } = made;
  const { body: own, x, y, rigid, port, road } = tyre;
  const height = heightOf(port, moment.pose);
  const under = moment.pose[road] ?? 0;
  const [px, floor] = point(made, x, y, 0, under);
  const hub = rigid ? floor - R : point(made, x, y, R, height)[1];
  const squeezed = Math.max(0.6 * R, Math.min(1.15 * R, floor - hub));
  const rim = Array.from({ length: 37 }, (_, i) => {
    const angle = (2 * Math.PI * i) / 36;
    const down = Math.sin(angle) > 0 ? squeezed : R;
    return /** @type {Point} */ ([px + R * Math.cos(angle), hub + down * Math.sin(angle)]);
  });
  into.push(polygon(rim, "tyre"), circle(px, hub, 0.62 * R, "rim"));
  for (let i = 0; i < SPOKES; i += 1) {
    const angle = moment.turned + (2 * Math.PI * i) / SPOKES;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    into.push(line([[px + 0.14 * R * c, hub + 0.14 * R * s], [px + 0.58 * R * c, hub + 0.58 * R * s]], "spoke"));
  }
  into.push(circle(px, hub, 0.15 * R, "hub"));
  if (rigid) primary(made, tyre, moment, px, hub, into);
  else if (own.kind === "wheel" && made.struts.some(({ strut: { lower }, lever }) => lower.body === own && !lever)) {
    carrier(px, hub, hub - (made.scene.silhouette && made.scene.oblique ? 0.6 * R : R + 4), R, into);
  }
}

/** What carries a strut on a hub. @param {number} x @param {number} hub @param {number} top @param {number} R
 * @param {Shape[]} into */
const carrier = (x, hub, top, R, into) => void into.push(line([[x, hub], [x, top]], R > 20 ? "halo" : "halo thin"),
  line([[x, hub], [x, top]], R > 20 ? "carrier" : "carrier thin"));

/** The suspension of a wheel that is on its road. @param {Layout} made @param {Tyre} tyre @param {Moment} moment
 * @param {number} px @param {number} hub @param {Shape[]} into */
function primary(made, tyre, moment, px, hub, into) {
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
function strut(made, one, moment, into) {
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

/** [px] of a hundredth of the wheelbase. @param {Layout} made */
const unitOf = (made) => (made.scene.wheelbase * made.metre) / 100;

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
  const { end, arm, ratio, hinged } = /** @type {NonNullable<PlacedStrut["lever"]>} */ (one.lever);
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

/** A bar between wheels, such as an anti-roll bar. @param {Layout} made @param {Body[]} bodies
 * @param {Moment} moment @param {Shape[]} into */
function bar(made, bodies, moment, into) {
  if (bodies.length < 2) return;
  const out = 0.5 * made.radius;
  const hubs = bodies.map((body) => point(made, body.x, body.y, made.bodies.get(body)?.z ?? 0, liftOf(body, 0, 0,
    moment.pose)));
  const [a, b] = [hubs[0], hubs[hubs.length - 1]];
  if (!isAcross(bodies)) {
    into.push(line([a, [a[0], a[1] - out], [b[0], b[1] - out], b], "link"));
    return;
  }
  const beside = (/** @type {Point} */ [x, y], /** @type {number} */ times) =>
    /** @type {Point} */ ([x + times * out, y + 4]);
  into.push(line([beside(a, 1), beside(a, 2), beside(b, 2), beside(b, 1)], "link"));
}

/** A point of a car's outline. @param {Layout} made @param {Body} main @param {number} y @param {number[]} of
 * @param {Moment} moment @returns {Point} */
function onCar(made, main, y, [ahead, above], moment) {
  const unit = unitOf(made);
  const x = made.scene.rear + (ahead * unit) / made.metre;
  return point(made, x, y, made.radius + above * unit, liftOf(main, x - main.x, y - main.y, moment.pose));
}

/** The outline of a car. @param {Layout} made @param {Body} main @param {number} y @param {Moment} moment
 * @param {Shape[]} into @param {"far" | "near" | ""} [side] */
function car(made, main, y, moment, into, side = "") {
  const place = (/** @type {Point} */ of) => onCar(made, main, y, of, moment);
  into.push(polygon(CAR.map(place), `body ${side}`));
  if (side !== "far") for (const pane of WINDOWS) into.push(polygon(pane.map(place), `glass ${side}`));
  if (side !== "far") mass(place([((main.x - made.scene.rear) * made.metre) / unitOf(made), 26]), into);
}

/** The sign of a centre of mass. @param {Point} at @param {Shape[]} into @param {number} [r] */
function mass([x, y], into, r = 7) {
  into.push(circle(x, y, r, "centre"));
  for (const turn of [0, Math.PI]) {
    const quarter = Array.from({ length: 7 }, (_, i) => {
      const angle = turn + (Math.PI * i) / 12;
      return /** @type {Point} */ ([x + r * Math.cos(angle), y - r * Math.sin(angle)]);
    });
    into.push(polygon([[x, y], ...quarter], "quarter"));
  }
}

/** The corners of a body, from the lower left one. @param {Layout} made @param {PlacedBody} own
 * @param {Moment} moment @returns {Point[]} */
export function cornersOf(made, { body: own, z, thick, from, to }, moment) {
  const corner = (/** @type {number} */ px, /** @type {number} */ up) => {
    const [x, y] = point(made, own.x, own.y, z + up, liftOf(own, px / made.metre, 0, moment.pose));
    return /** @type {Point} */ ([x + px, y]);
  };
  return [corner(from, -thick / 2), corner(to, -thick / 2), corner(to, thick / 2), corner(from, thick / 2)];
}

/** @param {Layout} made @param {PlacedBody} own @param {Moment} moment @param {Shape[]} into */
function body(made, own, moment, into) {
  if (own.body.kind === "occupant") return occupant(made, own, moment, into);
  const corners = cornersOf(made, own, moment);
  const [x, y] = point(made, own.body.x, own.body.y, own.z, liftOf(own.body, 0, 0, moment.pose));
  if (own.body.kind === "beam" || own.thick < 10) {
    const [a, b] = [[corners[0], corners[3]], [corners[1], corners[2]]].map(([p, q]) =>
      /** @type {Point} */ ([p[0], (p[1] + q[1]) / 2]));
    into.push(line([a, b], "beam"));
    if (own.body.heave === null) into.push(polygon([[x, y], [x - 8, y + 14], [x + 8, y + 14]], "pivot"));
    into.push(circle(x, y, 3.5, "joint"));
    return;
  }
  into.push(polygon(corners, "body round"));
  mass([x, y], into, Math.min(7, 0.3 * own.thick));
}

/** A body that is seen from above, too. @param {Layout} made @param {PlacedBody} own @param {Moment} moment
 * @param {Shape[]} into */
function slab(made, own, moment, into) {
  const { body: of, z, from, to } = own;
  const arms = made.struts.flatMap(({ strut: { upper, lower } }) =>
    [upper, lower].filter((place) => place.body === of).map(({ aside }) => aside));
  const half = Math.max(0.3, ...arms.map(Math.abs));
  const corner = (/** @type {number} */ px, /** @type {number} */ y) => {
    const x = px / made.metre;
    return point(made, of.x + x, of.y + y, z, liftOf(of, x, y, moment.pose));
  };
  into.push(polygon([corner(from, -half), corner(to, -half), corner(to, half), corner(from, half)], "body near"));
  mass(corner(0, 0), into);
}

/** Somebody on a seat, which faces forward. @param {Layout} made @param {PlacedBody} own @param {Moment} moment
 * @param {Shape[]} into */
function occupant(made, { body: own, z, thick }, moment, into) {
  const [x, y] = point(made, own.x, own.y, z - thick / 2, liftOf(own, 0, 0, moment.pose));
  const u = thick / 64;
  const at = (/** @type {number} */ a, /** @type {number} */ b) => /** @type {Point} */ ([x + a * u, y - b * u]);
  into.push(
    polygon([at(-16, 0), at(16, 0), at(16, 7), at(-10, 9), at(-19, 42), at(-25, 41), at(-19, 4)], "chair"),
    line([at(-9, 13), at(15, 14), at(21, -2)], u > 0.7 ? "limb" : "limb thin"),
    line([at(-9, 14), at(-13, 40)], u > 0.7 ? "trunk" : "trunk thin"),
    line([at(-12, 36), at(3, 26), at(15, 31)], u > 0.7 ? "limb" : "limb thin"),
    circle(...at(-10, 55), 8.5 * u, "head"),
  );
}

/** The outlines of bodies alone, such as of another design on the same road. @param {Layout} made
 * @param {Moment} moment @returns {Shape[]} */
export function outlines(made, moment) {
  /** @type {Shape[]} */
  const into = [];
  const { main, silhouette, tyres, oblique } = made.scene;
  if (silhouette && main) {
    const y = oblique ? Math.min(...tyres.map((tyre) => tyre.y)) : 0;
    into.push(polygon(CAR.map((of) => onCar(made, main, y, of, moment)), "other"));
  }
  for (const own of made.bodies.values()) {
    if (isDrawn(made, own) && own.body.kind !== "occupant" && !oblique) {
      into.push(polygon(cornersOf(made, own, moment), "other round"));
    }
  }
  return into;
}

/** Where a body was, left of it, in a vehicle with one wheel. @param {Layout} made @param {Moment["road"]} past
 * @param {string} kind @returns {Shape[]} */
export function trail(made, past, kind) {
  const { main, column, tracks } = made.scene;
  const own = main && made.bodies.get(main);
  if (!own || !column || tracks.length === 0 || own.body.heave === null) return [];
  const [x, y] = made.project(own.body.x, own.body.y, own.z);
  /** @type {Point[]} */
  const points = [];
  for (let px = x + own.from; px >= 0; px -= STEP) {
    const height = past(own.body.heave, px - (x + own.from));
    if (Number.isNaN(height)) break;
    points.push([px, y - made.lift * height]);
  }
  return points.length > 1 ? [line(points, kind)] : [];
}

/** How high a coordinate was, so many px ago; nan before the beginning. @param {Layout} made @param {Motion} motion
 * @param {number} at [s] @param {number} speed [m/s] @returns {Moment["road"]} */
export const pastOf = (made, motion, at, speed) => (name, px) => {
  const time = at + px / passing(made, speed);
  const step = motion.time.length > 1 ? motion.time[1] - motion.time[0] : 1;
  return time < 0 ? NaN : smooth(motion.coordinates[name] ?? [0], time / step);
};

/** @type {{[name: string]: string}} */
const WORDS = { sprung: "body", unsprung: "wheel", primary: "primary mass" };

/** A name as words. @param {string} name */
export const inWords = (name) => WORDS[name] ?? name.replace(/^unsprung_/, "").replaceAll("_", " ");

/** A mass with its unit. @param {number} mass [kg] */
export const massText = (mass) => (mass >= 1e4 ? `${Number((mass / 1e3).toPrecision(4))} t`
  : `${Number(mass.toPrecision(5))} kg`);

/** @param {number} value @param {string} unit */
function quantity(value, unit) {
  const [factor, prefix] = value >= 1e6 ? [1e6, "M"] : value >= 1e3 ? [1e3, "k"] : [1, ""];
  return `${Number((value / factor).toPrecision(4))} ${prefix}${unit}`;
}

/** What stands beside things. @param {Layout} made @param {Moment} moment @param {Shape[]} into */
function name(made, moment, into) {
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
  const weight = of.mass === null ? "" : massText(of.mass);
  const fits = 2 * LETTER * Math.max(words.length, weight.length) + 56 < to - from && thick >= 15;
  if (fits && of.kind !== "occupant" && !made.scene.oblique) {
    into.push(text(...at(from + 12), words), text(...at(to - 12), weight, "text", "end"));
    return;
  }
  if (made.scene.oblique && of.kind !== "occupant") {
    into.push(text(at(0)[0] + 12, at(0)[1], `${words} ${weight}`, "beside"));
    return;
  }
  if (made.scene.oblique) {
    const [x, y] = at(-6);
    into.push(text(x, y - 0.52 * thick - 6, words, "text", "middle"));
    return;
  }
  const wide = LETTER * Math.max(words.length, weight.length) + 8;
  const left = made.project(of.x, of.y, 0)[0] + to + wide > made.width || (made.scene.column && of.kind === "body");
  const [x, y] = at(left ? from - 7 : of.kind === "occupant" ? 26 : to + 7);
  const anchor = left ? "end" : "start";
  into.push(text(x, y - 7, words, "text", anchor), text(x, y + 8, weight, "quiet", anchor));
}

/** @param {Layout} made @param {Tyre} tyre @param {Moment} moment @param {Shape[]} into */
function nameWheel(made, { x, y, port, body: of, network }, moment, into) {
  const [px, py] = point(made, x, y, made.radius, heightOf(port, moment.pose));
  const beside = px + made.radius + 12;
  if (of.mass !== null) into.push(text(beside, py - 4, `${inWords(of.name)} ${massText(of.mass)}`, "beside"));
  if (network.kind === "element") into.push(text(beside, py + 11, `tyre ${quantity(network.value, network.unit)}`,
    "beside"));
}

/** @param {number} x @param {number} y @param {string} words @param {string} [kind]
 * @param {"start" | "middle" | "end"} [anchor] @returns {Shape} */
const text = (x, y, words, kind = "text", anchor = "start") =>
  ({ kind: "text", x, y, text: words, class: kind, anchor });

