// A vehicle in one pose, as shapes in px with classes: every height is that of the simulation, every element is as long
// as the simulation says.

import { isDrawn, point, unitOf } from "./layout.js";
import { name } from "./naming.js";
import { CAR, EDGES, WINDOWS } from "./outline.js";
import { heightOf, liftOf, spread } from "./scene.js";
import { carrier, primary, strut } from "./struts.js";
import { box, circle, line, polygon } from "./symbols.js";

/** @import { Layout, PlacedBody } from "./layout.js" */
/** @import { Moment } from "./moments.js" */
/** @import { Body, Tyre } from "./scene.js" */
/** @import { Point, Shape } from "./symbols.js" */

const SAME_SIDE = 0.3; // [m]
const STEP = 4; // [px] of a road that is drawn

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

/** The profile under the wheels of one side: of the nearest of its roads, as far as it has been seen.
 * @param {Layout} made @param {number} y @param {Moment} moment @param {number} from @param {number} to
 * @returns {Point[]} */
function profileOf(made, y, moment, from, to) {
  const { tracks, oblique, frontal } = made.scene;
  const own = (oblique ? tracks.filter((track) => Math.abs(track.y - y) < SAME_SIDE) : tracks).map(({ name, x }) =>
    ({ name, at: made.project(x, y, 0)[0] }));
  const [, level] = made.project(0, y, 0);
  /** @type {Point[]} */
  const points = [];
  for (let px = from; px <= to + STEP; px += STEP) {
    const seen = own.filter(({ at }) => px >= at - moment.passed);
    const near = (seen.length > 0 ? seen : own).reduce((best, each) =>
      (Math.abs(each.at - px) < Math.abs(best.at - px) ? each : best));
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
