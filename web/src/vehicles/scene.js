// What a mechanism looks like at rest: which of its coordinates are one rigid body, where bodies, wheels and struts are
// along and across it [m], and what stands on what. Nothing is known of pixels here.

/** A place that moves: how much of each coordinate, or of each road, it has.
 * @typedef {{[name: string]: number}} Port */
/** @typedef {{port: Port, x?: number}} End */
/** @typedef {{name: string, upper: End, lower: End, network: any}} MechanismStrut */
/** @typedef {{name: string, port: Port, road: string, network: any}} MechanismTyre */
/** The answer `mechanism` of the server.
 * @typedef {{coordinates: {name: string, inertia: number, text: string, angle: boolean, roll?: boolean}[],
 * struts: MechanismStrut[], tyres: MechanismTyre[],
 * roads: {name: string, distance: number, side?: string}[]}} Mechanism */
/** `heave`: the coordinate, or the road, that carries its middle; without one it turns about a place that is fixed.
 * `level`: how many bodies are below it.
 * @typedef {{name: string, kind: "body" | "wheel" | "beam" | "occupant" | "table", heave: string | null,
 * pitch: string | null, roll: string | null, mass: number | null, weight: string, x: number, y: number,
 * level: number}} Body */
/** Where something is fastened: to a body, so far ahead and to the left of its middle; a lever takes `ratio` of the
 * motion. To several bodies, to the ground (`body` is null), or to the travels of others (`over`).
 * @typedef {{port: Port, body: Body | null, ratio: number, ahead: number, aside: number, over: Body[]}} Place */
/** `arm`: the share of an arm, hinged to the upper body, at which the strut stands; 1 where it stands on what is below.
 * @typedef {{name: string, upper: Place, lower: Place, network: any, x: number, y: number, arm: number}} Strut */
/** A network over the difference of two travels, such as an anti-roll bar. @typedef {{name: string, network: any,
 * bodies: Body[]}} Link */
/** `rigid`: the wheel stands on its road, and the network is above it.
 * @typedef {{name: string, body: Body, port: Port, road: string, network: any, rigid: boolean, x: number, y: number}}
 * Tyre */
/** @typedef {{name: string, x: number, y: number, distance: number, side: string}} Track */
/** From the side, or `oblique` where there are two sides, or `frontal` where these are all; all in one `column`.
 * @typedef {{model: string, bodies: Body[], struts: Strut[], links: Link[], tyres: Tyre[], tracks: Track[],
 * oblique: boolean, frontal: boolean, silhouette: boolean, column: boolean, main: Body | null, rear: number,
 * wheelbase: number}} Scene */

const APART = 1.2; // [m] between bodies of which nothing says where they are
const TRACK = 1.5; // [m] between both sides, where nothing says how far they are apart
const SAME = 1e-6; // [m]

/** The scene of a mechanism at rest. @param {Mechanism} mechanism @param {string} model of the vehicle
 * @param {string} outline as which the library declares it to be drawn @returns {Scene} */
export function scene(mechanism, model = "", outline = "") {
  const bodies = bodiesOf(mechanism);
  /** @param {Port} port */
  const place = (port) => placeOf(port, bodies);
  const mounts = mechanism.struts.map(({ name, network, upper, lower }) =>
    ({ name, network, upper: place(upper.port), lower: place(lower.port), x: 0, y: 0, arm: 1 }));
  const isLink = (/** @type {Strut} */ { upper, lower }) => [upper, lower].some(({ port }) => isTravel(port, bodies));
  const struts = mounts.filter((strut) => !isLink(strut));
  const wheels = mechanism.tyres.map((tyre) => ({ ...tyre, place: place(tyre.port) }));
  nameKinds(bodies, struts, wheels);
  locate(bodies, struts, wheels, mechanism.roads);
  const tyres = wheels.flatMap(({ place: { body, ahead, aside }, name, port, road, network }) => (body === null ? []
    : [{ name, port, road, network, body, rigid: isNetwork(network), x: body.x + ahead, y: body.y + aside }]));
  rank(bodies, struts, tyres);
  spreadOut(bodies);
  for (const strut of struts) {
    const { upper, lower } = strut;
    if (upper.body && lower.body && Math.abs(upper.ratio - lower.ratio) < SAME) strut.arm = upper.ratio;
    Object.assign(strut, whereIs(strut));
  }
  const links = mounts.filter(isLink).map(({ name, network, upper, lower }) => ({ name, network,
    bodies: [...new Set([...negative(upper, bodies), ...negative(lower, bodies)])] }));
  const tracks = tyres.flatMap(({ road, x, y }) => mechanism.roads.filter(({ name }) => name === road)
    .map(({ distance, side = "" }) => ({ name: road, x, y, distance, side })));
  const across = [...bodies, ...tyres, ...struts].map(({ y }) => y);
  const along = [...bodies, ...tyres].map(({ x }) => x);
  return {
    model, bodies, struts, links, tyres, tracks,
    oblique: spread(across) > SAME,
    silhouette: outline === "car",
    frontal: spread(along) > SAME && spread(tracks.map(({ distance }) => distance)) < SAME,
    rear: Math.min(...tyres.map(({ x }) => x)),
    wheelbase: spread(tyres.map(({ x }) => x)),
    column: spread(along) < SAME && spread(across) < SAME,
    main: bodies.reduce((/** @type {Body | null} */ most, body) =>
      (body.kind === "body" && (most?.mass ?? 0) < (body.mass ?? 0) ? body : most), null),
  };
}

/** @param {number[]} values */
export const spread = (values) => (values.length ? Math.max(...values) - Math.min(...values) : 0);

/** Whether a tyre is more than its own spring and damping: a suspension of its own. @param {any} network */
const isNetwork = (network) => network.kind === "series" || (network.parts ?? []).some((/** @type {any} */ part) =>
  part.kind !== "element");

/** Bodies: each coordinate that moves up and down, with the angles about its middle; angles alone; roads that move an
 * end of a strut. @param {Mechanism} mechanism @returns {Body[]} */
function bodiesOf({ coordinates, struts, tyres, roads }) {
  const ports = [...struts.flatMap(({ upper, lower }) => [upper.port, lower.port]), ...tyres.map(({ port }) => port)];
  const angles = coordinates.filter(({ angle }) => angle);
  const heaves = coordinates.filter(({ angle }) => !angle);
  const driven = roads.filter(({ name }) =>
    struts.some(({ upper, lower }) => name in upper.port || name in lower.port));
  /** @type {Map<string, string>} */
  const owners = new Map();
  for (const { name } of angles) {
    const found = heaves.map((heave) => ({ heave: heave.name, times: ports.filter((port) => name in port
      && (port[heave.name] ?? 0) > 0).length }));
    const most = found.reduce((best, each) => (each.times > best.times ? each : best), { heave: "", times: 0 });
    if (most.times > 0) owners.set(name, most.heave);
  }
  const blank = { pitch: null, roll: null, weight: "", x: 0, y: 0, level: 0 };
  /** @type {Body[]} */
  const bodies = [
    ...heaves.map(({ name, inertia, text }) => ({ ...blank, kind: /** @type {const} */ ("body"), name, heave: name,
      mass: inertia, weight: text })),
    ...angles.filter(({ name }) => !owners.has(name)).map(({ name }) => ({ ...blank,
      kind: /** @type {const} */ ("body"), name, heave: null, pitch: name, mass: null })),
    ...driven.map(({ name }) => ({ ...blank, kind: /** @type {const} */ ("table"), name, heave: name, mass: null })),
  ];
  for (const body of bodies) {
    const own = angles.filter(({ name }) => owners.get(name) === body.name);
    const rolls = own.filter(({ name, roll }) => roll || /roll/i.test(name));
    const rolling = own.length > 1 ? rolls[0] ?? own[1] : null;
    body.roll = rolling?.name ?? null;
    body.pitch = own.find((angle) => angle !== rolling)?.name ?? body.pitch;
  }
  return bodies;
}

/** Where a port is. @param {Port} port @param {Body[]} bodies @returns {Place} */
function placeOf(port, bodies) {
  const on = bodies.filter(({ heave, pitch, roll }) => [heave, pitch, roll].some((name) => name !== null
    && name in port));
  const [body] = on;
  if (on.length !== 1) return { port, body: null, ratio: 1, ahead: 0, aside: 0, over: on };
  const ratio = body.heave === null ? 1 : (port[body.heave] ?? 0) || 1;
  const lever = (/** @type {string | null} */ name) => (name === null ? 0 : (port[name] ?? 0) / ratio);
  return { port, body, ratio, ahead: lever(body.pitch), aside: lever(body.roll), over: [] };
}

/** Whether a port is a travel: of some bodies less that of others. @param {Port} port @param {Body[]} bodies */
const isTravel = (port, bodies) => {
  const shares = bodies.flatMap(({ heave }) => (heave !== null && heave in port ? [port[heave]] : []));
  return shares.length > 1 && shares.some((share) => share < 0);
};

/** The bodies that a travel takes off. @param {Place} place @param {Body[]} bodies */
const negative = ({ port }, bodies) => bodies.filter(({ heave }) => heave !== null && (port[heave] ?? 0) < 0);

/** @typedef {MechanismTyre & {place: Place}} Wheel */

/** What each body is: a wheel or a beam between wheels where it stands on tyres that are no suspension of their own.
 * @param {Body[]} bodies @param {Strut[]} struts @param {Wheel[]} wheels */
function nameKinds(bodies, struts, wheels) {
  for (const body of bodies) {
    const onTyres = wheels.some(({ place, network }) => place.body === body && !isNetwork(network));
    if (onTyres) body.kind = body.pitch === null && body.roll === null ? "wheel" : "beam";
    const seat = struts.find(({ upper }) => upper.body === body);
    if (body.name === "occupant" && seat?.name === "seat") body.kind = "occupant";
  }
}

/** Puts bodies along and across the vehicle: where struts hold them under each other, else by their roads.
 * @param {Body[]} bodies @param {Strut[]} struts @param {Wheel[]} wheels @param {Mechanism["roads"]} roads */
function locate(bodies, struts, wheels, roads) {
  /** @type {Map<Body, number>} */
  const fastened = new Map();
  for (const { upper, lower } of struts) {
    for (const { body } of [upper, lower]) if (body) fastened.set(body, (fastened.get(body) ?? 0) + 1);
  }
  const order = bodies.filter((body) => fastened.has(body)).sort((a, b) => Number(b.pitch !== null)
    - Number(a.pitch !== null) || Number(b.heave !== null) - Number(a.heave !== null)
    || (fastened.get(b) ?? 0) - (fastened.get(a) ?? 0));
  /** @type {Set<Body>} */
  const known = new Set();
  for (const root of order) {
    if (known.has(root)) continue;
    known.add(root);
    for (const body of known) reach(body, struts, known);
  }
  apart(bodies, wheels, roads);
  for (const { upper, lower } of struts) {
    for (const { over } of [upper, lower]) if (over.length > 1) separate(over);
  }
  sides(wheels, roads);
}

/** Puts what a body's struts hold where their other ends are. @param {Body} body @param {Strut[]} struts
 * @param {Set<Body>} known */
function reach(body, struts, known) {
  for (const { upper, lower } of struts) {
    for (const [here, there] of [[upper, lower], [lower, upper]]) {
      if (here.body !== body) continue;
      for (const other of there.body ? [there.body] : there.over) {
        if (known.has(other)) continue;
        other.x = body.x + here.ahead - there.ahead;
        other.y = body.y + here.aside - there.aside;
        known.add(other);
      }
    }
  }
}

/** Parts wheels that would be in one place, by the distances of their roads. @param {Body[]} bodies
 * @param {Wheel[]} wheels @param {Mechanism["roads"]} roads */
function apart(bodies, wheels, roads) {
  const behind = new Map(roads.map(({ name, distance }) => [name, distance]));
  const of = bodies.filter(({ kind }) => kind === "wheel").map((body) =>
    ({ body, distance: behind.get(wheels.find(({ place }) => place.body === body)?.road ?? "") ?? 0 }));
  for (const { body } of of) {
    const here = of.filter((other) => Math.abs(other.body.x - body.x) < SAME && other.body.y === body.y);
    if (spread(here.map(({ distance }) => distance)) < SAME) continue;
    const middle = here.reduce((sum, { distance }) => sum + distance, 0) / here.length;
    for (const each of here) each.body.x += middle - each.distance;
  }
}

/** Parts bodies that would be in one place on one level. @param {Body[]} bodies */
function spreadOut(bodies) {
  const placed = bodies.filter(({ kind, pitch }) => kind === "body" && pitch === null);
  for (const { level, x, y } of placed) {
    const here = placed.filter((other) => other.level === level && other.x === x && other.y === y);
    if (here.length > 1) separate(here);
  }
}

/** Parts the bodies at the ends of a lever, where they are in one place. @param {Body[]} over */
function separate(over) {
  if (spread(over.map(({ x }) => x)) > SAME || spread(over.map(({ y }) => y)) > SAME) return;
  over.forEach((body, i) => {
    body.x += ((over.length - 1) / 2 - i) * APART;
  });
}

/** Parts the wheels of both sides, where no lever says how far they are apart. @param {Wheel[]} wheels
 * @param {Mechanism["roads"]} roads */
function sides(wheels, roads) {
  const side = new Map(roads.map((road) => [road.name, road.side ?? ""]));
  for (const { place: { body }, road } of wheels) {
    const other = wheels.some(({ place, road: name }) => place.body !== null && place.body !== body && body !== null
      && Math.abs(place.body.x - body.x) < SAME && place.body.y * body.y === 0 && side.get(name) !== side.get(road));
    if (body && body.y === 0 && other) body.y = side.get(road) === "left" ? TRACK / 2 : -TRACK / 2;
  }
}

/** Gives each body its level: wheels and what stands on the ground first. @param {Body[]} bodies
 * @param {Strut[]} struts @param {Tyre[]} tyres */
function rank(bodies, struts, tyres) {
  for (const { body, rigid } of tyres) body.level = rigid ? 1 : 0;
  const on = new Set(tyres.map(({ body }) => body));
  for (let i = 0; i < bodies.length; i += 1) {
    for (const { upper, lower } of struts) {
      const below = [lower.body ?? [], lower.over].flat();
      const most = below.reduce((level, body) => Math.max(level, body.level), 0);
      for (const body of [upper.body ?? [], upper.over].flat()) {
        if (!on.has(body) && body.level < bodies.length) body.level = Math.max(body.level, most + 1);
      }
    }
  }
}

/** Where a strut is: where both of its ends are, else the one that is fastened to something.
 * @param {Strut} strut @returns {{x: number, y: number}} */
function whereIs({ upper, lower }) {
  const [above, below] = [upper, lower].map(pointOf);
  const first = above ?? below ?? { x: 0, y: 0 };
  return upper.body === null || upper.over.length > 0 ? below ?? first : first;
}

/** Where a place is along and across the vehicle, null on the ground. @param {Place} place
 * @returns {{x: number, y: number} | null} */
export function pointOf({ body, over, port, ahead, aside }) {
  if (body) return { x: body.x + ahead, y: body.y + aside };
  if (over.length === 0) return null;
  const shares = over.map(({ heave }) => (heave === null ? 0 : port[heave] ?? 0));
  const sum = shares.reduce((a, b) => a + b, 0) || 1;
  const mean = (/** @type {"x" | "y"} */ axis) =>
    over.reduce((total, body, i) => total + body[axis] * shares[i], 0) / sum;
  return { x: mean("x"), y: mean("y") };
}

/** @typedef {{[name: string]: number}} Pose  of coordinates and roads, at one time */

/** How far a port is above its place at rest [m]. @param {Port} port @param {Pose} pose */
export const heightOf = (port, pose) =>
  Object.entries(port).reduce((sum, [name, lever]) => sum + lever * (pose[name] ?? 0), 0);

/** How far a point of a rigid body is above its place at rest [m]; `x` and `y` from its middle. @param {Body} body
 * @param {number} x @param {number} y @param {Pose} pose */
export const liftOf = ({ heave, pitch, roll }, x, y, pose) => (heave === null ? 0 : pose[heave] ?? 0)
  + (pitch === null ? 0 : x * (pose[pitch] ?? 0)) + (roll === null ? 0 : y * (pose[roll] ?? 0));
