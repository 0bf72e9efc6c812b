// The car in motion, drawn from its mechanism: bodies, struts as networks, tyres, the road that passes below.

import { drawing } from "../network/drawing.js";
import { kindOf, numbersOf } from "../library.js";
import { Select } from "../parts/controls.js";
import { html, useEffect, useRef, useState } from "../parts/html.js";

/** @import { Store } from "../state/store.js" */
/** @typedef {{time: number[], coordinates: {[name: string]: number[]}, roads: {[name: string]: number[]}}} Motions */
/** @typedef {{[name: string]: number}} Pose  of coordinates and roads, at one time */
/** @typedef {{[name: string]: number}} Port  a place that moves: how much of each coordinate it has */
/** @typedef {{port: Port, road: string, x: number}} Tyre */
/** @typedef {{network: any, upper: {port: Port, x: number}, lower: {port: Port}}} Strut */
/** @typedef {{tyres: Tyre[], struts: Strut[], roads: {name: string, distance?: number}[],
 * coordinates: {name: string, angle: boolean}[]}} Mechanism */

const HEIGHT = 320;
const BODY = 40; // [px] from the top at rest
const WHEEL = 235;
const GROUND = 285;
const RADIUS = 24;
const METRE = 130; // [px] along the car, where there is room for it
const OVERHANG = 60; // [px] of a body beyond its struts
const THICK = 26; // [px] of a body
const SPEED = "road.speed"; // which moves the road along
const SPEEDS = [1, 0.5, 0.25, 0.1];

/** @param {{store: Store, motion: Motions, mechanism: Mechanism}} props */
export function Motion({ store, motion, mechanism }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const clock = useRef({ at: 0, frames: 0 });
  const scene = useRef(/** @type {Scene | null} */ (null));
  const [width, setWidth] = useState(0);
  const { view } = store.get();
  const speed = numbersOf(store.get()).find(({ place }) => place === SPEED)?.value ?? 20;
  scene.current = { motion, mechanism, store, travel: speed, stretch: stretchOf(motion) };

  useEffect(() => {
    let last = performance.now();
    let frame = 0;
    /** @param {number} now */
    function show(now) {
      const { view: present } = store.get();
      const shown = /** @type {Scene} */ (scene.current);
      const end = shown.motion.time[shown.motion.time.length - 1];
      if (present.playing) clock.current.at = (clock.current.at + (Math.min(now - last,
        100) / 1000) * present.speed) % end;
      last = now;
      if (canvas.current) {
        paint(canvas.current, shown, Math.min(clock.current.at, end));
        setWidth(canvas.current.clientWidth);
      }
      clock.current.frames += 1;
      if (canvas.current) canvas.current.dataset.frames = String(clock.current.frames);
      if (present.playing) frame = requestAnimationFrame(show);
    }
    frame = requestAnimationFrame(show);
    return () => cancelAnimationFrame(frame);
  }, [view.playing, motion, mechanism, view.theme]);

  return html`<figure class="motion">
    <canvas ref=${canvas} role="img" aria-label="The car on its road, drawn"
      style=${{ width: "100%", height: `${HEIGHT}px` }}></canvas>
    <figcaption class="row">
      <button type="button" aria-pressed=${view.playing} onClick=${() => store.look({ playing: !view.playing })}>
        ${view.playing ? "Pause" : "Play"}</button>
      <${Select} label="at" value=${String(view.speed)}
        choices=${SPEEDS.map((each) => [String(each),
          each === 1 ? "the true speed" : `1/${Math.round(1 / each)} of the speed`])}
        set=${(/** @type {string} */ speed) => store.look({ speed: Number(speed) })} />
      <span class="quiet">Motions drawn ${Math.round(scene.current.stretch / metreOf(endsOf(scene.current),
        width))} times as large.</span>
    </figcaption>
  </figure>`;
}

/** @typedef {{motion: Motions, mechanism: Mechanism, store: Store, travel: number, stretch: number}} Scene */

/** Pixels of a metre up and down, so that the largest motion is well seen. @param {Motions} motion */
function stretchOf({ coordinates, roads }) {
  const heights = Object.entries({ ...coordinates, ...roads }).flatMap(([, values]) => values);
  const largest = heights.reduce((most, value) => Math.max(most, Math.abs(value)), 1e-6);
  return 34 / largest;
}

/** @param {Motions} motion @param {number} at @returns {Pose} */
function poseAt({ time, coordinates, roads }, at) {
  const place = at / (time[1] - time[0]);
  const i = Math.min(Math.floor(place), time.length - 2);
  const share = Math.min(1, place - i);
  const all = Object.entries({ ...coordinates, ...roads });
  return Object.fromEntries(all.map(([name, values]) => [name, values[i] + share * (values[i + 1] - values[i])]));
}

/** The height of a port. @param {Port} port @param {Pose} pose */
const heightOf = (port, pose) =>
  Object.entries(port).reduce((sum, [name, lever]) => sum + lever * (pose[name] ?? 0), 0);

/** Whether two ports move with a coordinate in common. @param {Port} one @param {Port} other */
const shareCoordinate = (one, other) => Object.keys(one).some((name) => name in other);

/** @param {HTMLCanvasElement} canvas @param {Scene} scene @param {number} at */
function paint(canvas, scene, at) {
  const ratio = globalThis.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  if (width === 0) return;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== HEIGHT * ratio) {
    canvas.width = Math.round(width * ratio);
    canvas.height = HEIGHT * ratio;
  }
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const style = getComputedStyle(canvas);
  const ink = style.color;
  const paper = style.getPropertyValue("--raised") || "#fff";
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, HEIGHT);
  pen.lineWidth = 1.4;
  pen.lineJoin = "round";
  pen.strokeStyle = ink;
  pen.fillStyle = paper;
  const pose = poseAt(scene.motion, at);
  const ends = endsOf(scene);
  const mean = ends.reduce((sum, x) => sum + x, 0) / Math.max(1, ends.length);
  const metre = metreOf(ends, width);
  const middle = width / 2;
  /** @param {number} x */
  const across = (x) => middle + (x - mean) * metre;
  drawRoad(pen, scene, at, width, across, ends, metre);
  for (const [i, tyre] of scene.mechanism.tyres.entries()) drawWheel(pen, across(ends[i]),
    WHEEL - scene.stretch * heightOf(tyre.port, pose), GROUND - scene.stretch * (pose[tyre.road] ?? 0));
  for (const strut of standing(scene)) {
    const x = across(strutPlace(scene, strut));
    drawBogie(pen, scene, strut, pose, across);
    drawStrut(pen, scene.store, strut.network, x, levelOf(scene, strut.upper.port, pose),
      levelOf(scene, strut.lower.port, pose));
  }
  drawBody(pen, scene, pose, across);
}

/** Where the tyres are along the car. @param {Scene} scene @returns {number[]} */
const endsOf = (scene) => scene.mechanism.tyres.map((tyre) => placeOf(scene, tyre));

/** Pixels of a metre along the car, so that all of it is seen. @param {number[]} ends @param {number} width */
function metreOf(ends, width) {
  const long = ends.length ? Math.max(...ends) - Math.min(...ends) : 0;
  const room = Math.max(width - 2 * (OVERHANG + RADIUS), RADIUS);
  return long > 0 && width > 0 ? Math.min(METRE, room / long) : METRE;
}

/** Where a tyre is along the car: by its lever where the strut above it is, else by the distance of its road.
 * @param {Scene} scene @param {Tyre} tyre */
function placeOf({ mechanism }, tyre) {
  const above = mechanism.struts.find((strut) => shareCoordinate(strut.lower.port, tyre.port));
  const road = mechanism.roads.find((each) => each.name === tyre.road);
  const levers = above ? above.upper.x : 0;
  return levers !== 0 ? levers + tyre.x : -(road?.distance ?? 0);
}

/** @param {Scene} scene @param {Strut} strut */
function strutPlace(scene, strut) {
  const below = scene.mechanism.tyres.find((tyre) => shareCoordinate(tyre.port, strut.lower.port));
  return below && strut.upper.x === 0 ? placeOf(scene, below) : strut.upper.x;
}

/** Where a port is drawn: on a wheel, on the ground, or on a body.
 * @param {Scene} scene @param {Port} port @param {Pose} pose */
function levelOf(scene, port, pose) {
  const wheel = scene.mechanism.tyres.some((tyre) => shareCoordinate(tyre.port, port));
  const rest = Object.keys(port).length === 0 ? GROUND : wheel ? WHEEL - RADIUS : BODY + 26;
  return rest - scene.stretch * heightOf(port, pose);
}

/** @param {CanvasRenderingContext2D} pen @param {Scene} scene @param {number} at @param {number} width
 * @param {(x: number) => number} across @param {number[]} ends @param {number} metre */
function drawRoad(pen, { motion, travel, stretch, mechanism }, at, width, across, ends, metre) {
  const first = mechanism.roads[0];
  if (!first) return;
  const heights = motion.roads[first.name];
  const place = ends[mechanism.tyres.findIndex((tyre) => tyre.road === first.name)] ?? 0;
  const step = motion.time[1] - motion.time[0];
  const points = [];
  for (let x = 0; x <= width; x += 2) {
    const time = at + (x - across(place)) / metre / travel;
    const i = Math.min(heights.length - 1, Math.max(0, time / step));
    const [below, share] = [Math.floor(i), i - Math.floor(i)];
    const height = heights[below] + share * ((heights[below + 1] ?? heights[below]) - heights[below]);
    points.push([x, GROUND - stretch * height]);
  }
  drawLine(pen, points);
}

/** @param {CanvasRenderingContext2D} pen @param {number} x @param {number} y @param {number} ground */
function drawWheel(pen, x, y, ground) {
  const squeezed = Math.max(8, (ground - y) / 2);
  drawShape(pen, () => pen.ellipse(x, (y + ground) / 2, RADIUS, squeezed, 0, 0, 2 * Math.PI));
  drawShape(pen, () => pen.arc(x, y, 6, 0, 2 * Math.PI));
  drawLine(pen, [[x, y - 6], [x, y - RADIUS]]);
}

/** @param {CanvasRenderingContext2D} pen @param {number[][]} points */
function drawLine(pen, points) {
  pen.beginPath();
  for (const [x, y] of points) pen.lineTo(x, y);
  pen.stroke();
}

/** Something with an outline, which hides what is behind it. @param {CanvasRenderingContext2D} pen
 * @param {() => void} outline */
function drawShape(pen, outline) {
  pen.beginPath();
  outline();
  pen.fill();
  pen.stroke();
}

/** What joins a strut to wheels that are not below it. @param {CanvasRenderingContext2D} pen @param {Scene} scene
 * @param {Strut} strut @param {Pose} pose @param {(x: number) => number} across */
function drawBogie(pen, scene, strut, pose, across) {
  const [x, y] = [across(strutPlace(scene, strut)), levelOf(scene, strut.lower.port, pose)];
  for (const tyre of scene.mechanism.tyres) {
    const aside = across(placeOf(scene, tyre));
    if (aside === x || !shareCoordinate(tyre.port, strut.lower.port)) continue;
    drawLine(pen, [[x, y], [aside, WHEEL - RADIUS - scene.stretch * heightOf(tyre.port, pose)]]);
  }
}

/** A strut as its network, stretched between its ends. @param {CanvasRenderingContext2D} pen @param {Store} store
 * @param {any} tree @param {number} x @param {number} top @param {number} bottom */
function drawStrut(pen, store, tree, x, top, bottom) {
  const state = store.get();
  const plan = drawing(tree);
  const tall = (bottom - top) / plan.height;
  const wide = Math.min(1, 150 / (plan.left + plan.right));
  /** @param {readonly (readonly [number, number])[]} line @param {number} dx @param {number} dy @param {number} sign */
  const trace = (line, dx, dy, sign) =>
    line.forEach(([a, b], i) => pen[i ? "lineTo" : "moveTo"](x + wide * (a + dx), top + tall * (sign * b + dy)));
  pen.beginPath();
  for (const line of plan.lines) trace(line, 0, 0, 1);
  for (const one of plan.placed) {
    const kind = kindOf(state, one.name);
    for (const line of kind?.drawing ?? []) trace(line, one.x, one.y, -1);
  }
  pen.stroke();
}

/** The struts that stand between two places. Between others, such as an anti-roll bar, something is only as far as
 * two places part. @param {Scene} scene @returns {Strut[]} */
function standing({ mechanism }) {
  const angles = new Set(mechanism.coordinates.filter(({ angle }) => angle).map(({ name }) => name));
  return mechanism.struts.filter(({ upper }) =>
    Object.entries(upper.port).reduce((sum, [name, lever]) => sum + (angles.has(name) ? 0 : lever), 0) > 0.5);
}

/** The end of a body beyond a mount, in line with the one next to it if there is one.
 * @param {number[]} mount @param {number[]} next @param {number} reach */
function beyond([x, y], next, reach) {
  const [nextX, nextY] = next ?? [x, y];
  const slope = nextX === x ? 0 : (nextY - y) / (nextX - x);
  return [x + reach, y + reach * slope];
}

/** The lower edge of a body that joins its mounts, from the left to the right, with an overhang at both ends.
 * @param {number[][]} mounts @returns {number[][]} */
export function underside(mounts) {
  const last = mounts.length - 1;
  return [beyond(mounts[0], mounts[1], -OVERHANG), ...mounts, beyond(mounts[last], mounts[last - 1], OVERHANG)];
}

/** What is carried: a body that joins the places where the upper ends of struts are.
 * @param {CanvasRenderingContext2D} pen @param {Scene} scene @param {Pose} pose
 * @param {(x: number) => number} across */
function drawBody(pen, scene, pose, across) {
  const mounts = standing(scene).map((strut) =>
    [across(strutPlace(scene, strut)), levelOf(scene, strut.upper.port, pose)]);
  if (mounts.length === 0) return;
  mounts.sort((a, b) => a[0] - b[0]);
  const below = underside(mounts);
  const above = below.map(([x, y]) => [x, y - THICK]).reverse();
  drawShape(pen, () => {
    for (const [x, y] of [...below, ...above]) pen.lineTo(x, y);
    pen.closePath();
  });
}
