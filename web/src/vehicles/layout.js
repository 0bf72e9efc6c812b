// Where everything of a scene is in a picture of some size, at rest: along it to scale as far as there is room, upwards
// one level above the other; and how large motions are drawn.

import { pointOf, spread } from "./scene.js";
import { planOf, reachOf } from "./symbols.js";

/** @import { Scene, Body, Strut, Tyre } from "./scene.js" */
/** @import { Plan, Point } from "./symbols.js" */
/** The answer `history.motion` of the server. @typedef {{time: number[], coordinates: {[name: string]: number[]},
 * roads: {[name: string]: number[]}, elements?: {[mount: string]: {[element: string]: number[]}}}} Motion */
/** How far things move at most [m]: bodies up, roads down, anything, each strut and each of its elements.
 * @typedef {{up: number, down: number, any: number, slope: number, travel: {[strut: string]: number},
 * reach: {[mount: string]: {[element: string]: number}}}} Range */
/** `z`: of its middle, above the ground [px]; `from` and `to`: its ends, from its middle [px].
 * @typedef {{body: Body, z: number, thick: number, from: number, to: number}} PlacedBody */
/** On an arm or a lever an end of a strut has another part of a motion; the hinge is `arm` before what moves it [px].
 * @typedef {{end: "upper" | "lower", ratio: number, arm: number, hinged: boolean}} Lever */
/** `x` and `y` as in the scene, and moved by `shift` [px]; `bottom` and `top`: its ends above the ground [px].
 * @typedef {{strut: Strut, plan: Plan, x: number, y: number, shift: number, bottom: number, top: number,
 * scale: number, wide: number, lever: Lever | null}} PlacedStrut */
/** `metre`: [px] along the vehicle; `lift`: [px] of a metre up and down, `times` as many.
 * @typedef {{scene: Scene, width: number, height: number, metre: number, lift: number, times: number, base: number,
 * radius: number, bodies: Map<Body, PlacedBody>, struts: PlacedStrut[], primaries: {tyre: Tyre, plan: Plan,
 * scale: number}[], range: Range, roof: number | null, project: (x: number, y: number, z: number) => Point}} Layout */

const TIMES = [1, 1.5, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 40, 60, 80, 100, 150, 200, 300, 500, 1000];
const USUAL = 6; // times, where nothing moves
export const NARROW = 500; // [px] of a picture in which words stand below the controls, not beside them
const HEADER = 40; // [px] above, for what is written there, ...
const [HIGH, HIGHER] = [86, 112]; // ... below the controls, above a column and above all else, and ...
const CLEAR = 14; // ... above a column beside it
const BELOW = 0.13; // of the height, below the ground
const DIP = 0.11; // of the height, of a road at most
const SIDE = 0.44; // [px] nearer of a metre to the right, of a metre along
const WHEEL = 0.31; // [m] its radius
const SMALL = 0.6; // scale of a strut, from which on motions are drawn less large
const SHORT = 0.4; // of what is allowed to beams, which are short
const STEEPEST = 0.16; // of a body, as it is drawn

/** How far things move in one or several motions. @param {Scene} scene @param {Motion[]} motions @returns {Range} */
export function rangeOf(scene, motions) {
  /** @type {Range} */
  const range = { up: 0, down: 0, any: 0, slope: 0, travel: {}, reach: {} };
  const turning = scene.bodies.filter(({ heave }) => heave !== null);
  const angles = turning.flatMap(({ pitch, roll }) => [pitch ?? [], roll ?? []]).flat();
  const beams = turning.filter(({ kind }) => kind === "beam").flatMap(({ pitch }) => pitch ?? []);
  const free = scene.bodies.flatMap(({ heave, pitch }) => (heave === null && pitch !== null ? [pitch] : []));
  for (const motion of motions) {
    const all = { ...motion.coordinates, ...motion.roads };
    for (const [name, values] of Object.entries(all)) {
      const most = farthest(values);
      if (free.includes(name)) continue;
      if (angles.includes(name)) range.slope = Math.max(range.slope, most * (beams.includes(name) ? SHORT : 1));
      else range.any = Math.max(range.any, most);
    }
    for (const value of Object.values(motion.roads).flat()) range.down = Math.max(range.down, -value);
    for (const { heave, kind } of scene.bodies) {
      if (kind === "wheel" || heave === null) continue;
      for (const value of all[heave] ?? []) if (value > range.up) range.up = value;
    }
    for (const { name, upper, lower } of scene.struts) {
      const ends = [...Object.entries(upper.port), ...Object.entries(lower.port).map(([of, lever]) =>
        /** @type {[string, number]} */ ([of, -lever]))];
      const travel = motion.time.map((_, i) => ends.reduce((sum, [of, lever]) => sum + lever * (all[of]?.[i] ?? 0), 0));
      range.travel[name] = Math.max(range.travel[name] ?? 0, farthest(travel));
    }
    for (const [mount, elements] of Object.entries(motion.elements ?? {})) {
      const reach = range.reach[mount] ??= {};
      for (const [key, values] of Object.entries(elements)) reach[key] = Math.max(reach[key] ?? 0, farthest(values));
    }
  }
  return range;
}

/** @param {number[]} values */
const farthest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);

/** Everything at its place. @param {Scene} scene @param {{width: number, height: number}} size @param {Range} range
 * @param {number} [before] how many times as large motions were drawn before @returns {Layout} */
export function layout(scene, size, range, before = 0) {
  const frame = frameOf(scene, size);
  const fitting = TIMES.filter((times) => fits(scene, frame, range, times));
  const best = range.any + range.slope === 0 ? USUAL : fitting[fitting.length - 1] ?? TIMES[0];
  const times = before > 0 && before <= best && 2.5 * before >= best ? before : best;
  return positioned(scene, frame, range, times);
}

/** @typedef {{width: number, height: number, metre: number, base: number, radius: number,
 * project: (x: number, y: number, z: number) => Point}} Frame */

/** The scale along the vehicle, and where the ground is. @param {Scene} scene
 * @param {{width: number, height: number}} size @returns {Frame} */
function frameOf(scene, { width, height }) {
  const points = [...scene.bodies, ...scene.tyres, ...scene.struts.flatMap(({ upper, lower }) =>
    [upper, lower].flatMap((place) => pointOf(place) ?? []))];
  const [xs, ys] = [points.map(({ x }) => x), points.map(({ y }) => y)];
  const [long, wide] = [spread(xs), spread(ys)];
  const axles = scene.tyres.map(({ x }) => x);
  const [first, last] = [Math.min(...xs, ...axles), Math.max(...xs, ...axles)];
  const base = height * (1 - BELOW);
  const room = base - headerOf(scene, width);
  if (scene.column) {
    const storeys = scene.bodies.reduce((most, { level }) => Math.max(most, level), 0);
    const radius = Math.max(18, Math.min((storeys > 1 ? 0.075 : 0.098) * height, 60));
    const [metre, middle] = [Math.max(18, Math.min(0.098 * height, 60)) / WHEEL, width * (width < NARROW ? 0.5 : 0.42)];
    return { width, height, metre, base, radius, project: (x, _, z) => [middle + (x - first) * metre, base - z] };
  }
  const car = scene.silhouette ? scene.wheelbase : 0;
  const overhang = car > 0 ? 0.34 * car : Math.max(0.14 * long, 0.4);
  const whole = long + 2 * overhang;
  const metre = scene.oblique
    ? Math.min((width - 20) / (0.98 * whole + 0.56 * wide), room / (car > 0 ? 0.76 * car + SIDE * wide : 1.2 + wide))
    : Math.min((width - 24) / whole, (car > 0 ? room / (0.74 * car) : room / 2.2));
  const apart = axles.flatMap((x, i) => axles.slice(i + 1).map((other) => Math.abs(other - x)).filter((gap) => gap
    > 1e-6));
  const closest = Math.min(...apart, Infinity) * metre;
  const size = car > 0 ? 0.15 * car : scene.tyres.some(({ rigid }) => rigid) ? 0.46 : WHEEL;
  const radius = Math.max(7, Math.min(size * metre, 0.42 * closest, 0.1 * height));
  const centre = (first + last) / 2;
  const middleY = (Math.min(...ys) + Math.max(...ys)) / 2;
  /** @type {Frame["project"]} */
  const project = scene.oblique
    ? (x, y, z) => [width / 2 + (x - centre) * 0.98 * metre + (y - middleY) * 0.56 * metre,
      base - (y - middleY + wide / 2) * SIDE * metre - z]
    : (x, _, z) => [width / 2 + (x - centre) * metre, base - z];
  return { width, height, metre, base, radius, project };
}

/** The room above the vehicle for words [px]. @param {Scene} scene @param {number} width */
function headerOf({ column, tracks }, width) {
  if (width < NARROW) return column ? HIGH : HIGHER;
  return column && tracks.length > 0 ? CLEAR : HEADER;
}

/** Whether motions that are drawn so many times as large leave all in the picture, and each strut its length.
 * @param {Scene} scene @param {Frame} frame @param {Range} range @param {number} times */
function fits(scene, frame, range, times) {
  const lift = times * frame.metre;
  const most = (scene.silhouette ? 0.12 : 0.15) * frame.height;
  if (range.any * lift > most || range.down * lift > DIP * frame.height || range.slope * times > STEEPEST) return false;
  const { struts } = positioned(scene, frame, range, times);
  return struts.every(({ strut, top, bottom, scale }) => (range.travel[strut.name] ?? 0) * lift < 0.26 * (top - bottom)
    && (!scene.column || scale >= SMALL || times <= 3));
}

/** @param {Scene} scene @param {Frame} frame @param {Range} range @param {number} times @returns {Layout} */
function positioned(scene, frame, range, times) {
  const lift = times * frame.metre;
  const levels = levelsOf(scene, frame, range, lift);
  /** @type {Layout} */
  const made = { ...frame, scene, lift, times, range, bodies: new Map(), struts: [], primaries: [], roof: levels.roof };
  for (const body of scene.bodies) {
    const { z, thick } = levels.of(body);
    made.bodies.set(body, { body, z, thick, ...halves(scene, frame, body) });
  }
  for (const strut of scene.struts) {
    const { x, y } = strut;
    const [bottom, top] = [topOf(made, strut.lower.body ?? strut.lower.over[0] ?? null),
      bottomOf(made, strut.upper.body ?? strut.upper.over[0] ?? null)];
    const lever = leverOf(strut, frame);
    const shift = lever ? (1 - lever.ratio) * lever.arm : 0;
    made.struts.push({ strut, plan: planOf(strut.network, true), x, y, shift, top, scale: 1, wide: 1, lever,
      bottom: lever?.end === "lower" && strut.lower.body?.kind === "wheel" ? frame.radius : bottom });
  }
  besideEachOther(made);
  widen(made);
  for (const each of made.struts) rescale(each, made);
  made.primaries = scene.tyres.filter(({ rigid }) => rigid).map((tyre) => {
    const plan = planOf(tyre.network, false);
    const own = made.bodies.get(tyre.body);
    const long = own ? own.z - own.thick / 2 - 2 * frame.radius : 0;
    const room = roomAt(made, scene.tyres, tyre.x, tyre.y);
    return { tyre, plan, scale: Math.min(1, long / plan.height, room / (plan.left + plan.right)) };
  });
  return made;
}

/** @param {Strut} strut @param {Frame} frame @returns {Lever | null} */
function leverOf({ arm: share, upper, lower, x }, { radius }) {
  const end = Math.abs(lower.ratio - 1) > 1e-6 ? "lower" : "upper";
  const ratio = share !== 1 ? share : end === "lower" ? lower.ratio : upper.ratio;
  if (Math.abs(ratio - 1) < 1e-6) return null;
  const inward = Math.sign((upper.body?.x ?? 0) - x) || 1;
  return { end, ratio, hinged: share !== 1, arm: inward * Math.min(120, (radius + 18) / Math.abs(ratio - 1)) };
}

/** The heights of bodies, level by level [px]. @param {Scene} scene @param {Frame} frame @param {Range} range
 * @param {number} lift @returns {{roof: number | null, of: (body: Body) => {z: number, thick: number}}} */
function levelsOf(scene, frame, range, lift) {
  const { base, radius, height } = frame;
  const hangs = scene.struts.some(({ upper }) => upper.body === null && upper.over.length === 0);
  const top = scene.bodies.reduce((most, { level }) => Math.max(most, level), 0) + (hangs ? 1 : 0);
  const wheels = scene.bodies.some(({ kind }) => kind === "wheel");
  const beams = scene.bodies.some(({ kind }) => kind === "beam");
  const rigid = scene.tyres.some((tyre) => tyre.rigid);
  const bottom = wheels || rigid ? 2 * radius + 4 : beams ? radius + 4 : 0;
  if (scene.silhouette && scene.main) return carLevels(scene, frame);
  const far = scene.oblique ? spread(scene.bodies.map(({ y }) => y)) * SIDE * frame.metre : 0;
  const room = base - far - headerOf(scene, frame.width) - lift * range.up;
  /** @param {Body} body */
  const thickness = (body) => {
    const { kind, mass, pitch } = body;
    const { main } = scene;
    if (kind === "occupant") return Math.min(0.16 * height, 64);
    if (kind === "wheel") return 2 * radius;
    if (kind === "beam" || (pitch !== null && mass === null)) return 9;
    if (kind === "table") return 16;
    if (scene.oblique) return 10;
    if (body === main && pitch !== null) return Math.min(0.15 * height, 80);
    const share = main?.mass && mass ? Math.cbrt(mass / main.mass) : 1;
    return Math.max(14, Math.min(0.1 * height, 60) * Math.min(1, share));
  };
  const thick = Array.from({ length: top + 1 }, (_, level) => scene.bodies.filter((body) => body.level === level
    && level > 0).reduce((most, body) => Math.max(most, thickness(body)), 0));
  const needs = Array.from({ length: top }, (_, i) => Math.max(30, ...scene.struts.map(({ upper, lower, network }) => {
    const [from, to] = [levelOf(lower, 0), levelOf(upper, top)];
    return from <= i && i < to ? (planOf(network, false).height + 30) / (to - from) : 0;
  })));
  const sum = (/** @type {number[]} */ values) => values.reduce((total, each) => total + each, 0);
  const share = (room - bottom - sum(thick)) / Math.max(1, sum(needs));
  /** @param {number} level */
  const under = (level) => bottom + share * sum(needs.slice(0, level)) + sum(thick.slice(0, level));
  return {
    roof: hangs ? under(top) : null,
    of: (/** @type {Body} */ body) => {
      const own = thickness(body);
      if (body.level > 0) return { z: under(body.level) + own / 2, thick: own };
      if (body.kind === "wheel" || body.kind === "beam") return { z: radius, thick: own };
      return { z: bottom + own / 2, thick: own };
    },
  };
}

/** The level of an end of a strut. @param {import("./scene.js").Place} place @param {number} fixed of the ground, or of
 * a roof */
const levelOf = ({ body, over }, fixed) => (body ?? over[0])?.level ?? fixed;

/** Heights in a car that is drawn with its outline. @param {Scene} scene @param {Frame} frame */
function carLevels(scene, { radius, metre }) {
  const unit = (scene.wheelbase * metre) / 100;
  return {
    roof: null,
    of: (/** @type {Body} */ { kind, level }) => {
      if (kind === "wheel") return { z: radius, thick: 2 * radius };
      if (kind === "occupant") return { z: radius + 39 * unit, thick: 28 * unit };
      return { z: radius + 37 * unit + (level > 1 ? 24 * unit : 0), thick: 0 };
    },
  };
}

/** The ends of a body that nothing widens [px]. @param {Scene} scene @param {Frame} frame @param {Body} body */
function halves(scene, { width, metre, radius }, body) {
  const { kind, mass } = body;
  if (kind === "wheel" || kind === "beam") return { from: 0, to: 0 };
  if (kind === "occupant") return { from: -14, to: 14 };
  const share = scene.main?.mass && mass ? Math.max(0.42, Math.min(1, Math.cbrt(mass / scene.main.mass))) : 0.6;
  const half = scene.column ? Math.min(176, 0.44 * width) / 2 : Math.max(22, Math.min(0.5 * metre, 60, 2 * radius));
  return { from: -half * share, to: half * share };
}

/** The height of what stands on a body, above which a strut begins [px]. @param {Layout} made
 * @param {Body | null} body */
function topOf(made, body) {
  const own = body && made.bodies.get(body);
  if (!own) return 0;
  const { silhouette, oblique, wheelbase } = made.scene;
  if (own.body.kind === "wheel") return silhouette && oblique ? 1.6 * made.radius : 2 * made.radius + 4;
  if (own.body.kind === "body" && silhouette) return made.radius + 0.09 * made.metre * wheelbase;
  return own.z + own.thick / 2;
}

/** The height of what is below a body [px]. @param {Layout} made @param {Body | null} body */
function bottomOf(made, body) {
  const own = body && made.bodies.get(body);
  return own ? own.z - own.thick / 2 : made.roof ?? 0;
}

/** The largest scale of a strut. @param {Layout} made */
const largestScale = ({ scene, height }) => (scene.column && height > 300 ? 1.5 : 1);

/** Moves struts that would be in one place, or cross a body, to the right. @param {Layout} made */
function besideEachOther(made) {
  const done = /** @type {PlacedStrut[]} */ ([]);
  for (const one of [...made.struts].sort((a, b) => (a.top - a.bottom) - (b.top - b.bottom))) {
    const [at] = made.project(one.x, one.y, 0);
    const crossed = [...made.bodies.values()].filter(({ body, z }) => body !== one.strut.upper.body
      && body !== one.strut.lower.body && body.kind !== "wheel" && z > one.bottom && z < one.top
      && Math.abs(made.project(body.x, body.y, 0)[0] - at) < 10);
    const near = done.filter((other) => Math.abs(made.project(other.x, other.y, 0)[0] - at) < 10
      && other.y === one.y && other.top > one.bottom + 1 && other.bottom < one.top - 1);
    const most = largestScale(made);
    const edge = Math.max(-Infinity, ...crossed.map(({ to }) => to + 8), ...near.map(({ shift, plan }) => shift
      + most * plan.right));
    if (edge > -Infinity && one.lever === null) one.shift = edge + 8 + most * one.plan.left;
    done.push(one);
  }
}

/** Widens bodies so that they reach what is fastened to them. @param {Layout} made */
function widen(made) {
  const { scene, metre } = made;
  for (const own of made.bodies.values()) {
    const { body } = own;
    if (body.kind === "wheel" || body.kind === "occupant") continue;
    const arms = [
      ...made.struts.flatMap(({ strut: { upper, lower }, x, shift }) =>
        [upper, lower].filter((place) => place.body === body).map(() => (x - body.x) * metre + shift)),
      ...made.struts.flatMap(({ strut: { upper }, lever }) => (lever?.hinged && upper.body === body
        ? [upper.ahead * metre + lever.arm] : [])),
      ...scene.tyres.filter((tyre) => tyre.body === body).map(({ x }) => (x - body.x) * metre),
    ];
    const beyond = body.kind === "beam" ? 0 : body.pitch === null ? 16 : body.mass === null ? 4 : 30;
    own.from = Math.min(own.from, ...arms.map((arm) => arm - beyond));
    own.to = Math.max(own.to, ...arms.map((arm) => arm + beyond));
    if (body.pitch !== null && body.mass === null) [own.from, own.to] = [Math.min(0, ...arms), Math.max(0, ...arms)];
    if (body.pitch !== null && body.mass !== null && arms.length > 1) {
      [own.from, own.to] = [Math.min(...arms) - beyond, Math.max(...arms) + beyond];
    }
  }
}

/** The scale of a strut, so that it is no longer than its place, and leaves its neighbours theirs.
 * @param {PlacedStrut} one @param {Layout} made */
function rescale(one, made) {
  const { top, bottom } = one;
  const most = largestScale(made);
  const reach = made.range.reach[one.strut.name] ?? {};
  const beside = made.struts.filter((other) => other.top > bottom && other.bottom < top);
  const room = made.scene.column ? made.width * 0.5 : roomAt(made, beside, one.x, one.y);
  const fit = () => Math.min(most, (top - bottom - made.lift * reachOf(one.plan, reach))
    / one.plan.height, room / (one.plan.left + one.plan.right));
  one.scale = fit();
  const bare = planOf(one.strut.network, false);
  if (one.scale < 0.5 || room < 0.8 * (one.plan.left + one.plan.right)) {
    one.plan = bare;
    one.scale = fit();
  }
  one.scale = Math.max(0.2, one.scale);
  const whole = one.plan.left + one.plan.right;
  const named = one.plan.parts.length > 0 && one.plan.left + one.plan.right > bare.left + bare.right;
  one.wide = Math.max(one.scale, Math.min(named ? 1 : 0.7, room / whole));
}

/** The room of a strut, between those before and behind it [px]. @param {Layout} made
 * @param {{x: number, y: number}[]} several @param {number} x @param {number} y */
function roomAt(made, several, x, y) {
  const [at] = made.project(x, y, 0);
  const gaps = several.filter((other) => Math.abs(other.y - y) < 0.3)
    .map((other) => Math.abs(made.project(other.x, other.y, 0)[0] - at)).filter((gap) => gap > 4);
  const car = made.scene.silhouette ? 0.42 * made.scene.wheelbase * made.metre : Infinity;
  return Math.min(0.86 * Math.min(...gaps, Infinity), car, 180);
}

/** Whether a body is drawn by itself, not as a wheel or as the outline of a car. @param {Layout} made
 * @param {PlacedBody} own */
export const isDrawn = ({ scene }, { body: { kind }, body: own }) =>
  kind !== "wheel" && kind !== "beam" && !(scene.silhouette && own === scene.main);

/** The point of a picture that is so far above the ground. @param {Layout} made @param {number} x @param {number} y
 * @param {number} z [px] @param {number} lift [m] @returns {Point} */
export const point = (made, x, y, z, lift) => made.project(x, y, z + made.lift * lift);

/** [px] of a hundredth of the wheelbase. @param {Layout} made */
export const unitOf = (made) => (made.scene.wheelbase * made.metre) / 100;
