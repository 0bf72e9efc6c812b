// The elements of a strut at work, as shapes in px: each as long as it is now, with its inside where it is now.

/** @typedef {[number, number]} Point */
/** `of`: what it belongs to, for what is pointed at.
 * @typedef {{kind: "line", points: Point[], class: string} | {kind: "polygon", points: Point[], class: string}
 * | {kind: "circle", x: number, y: number, r: number, class: string}
 * | {kind: "text", x: number, y: number, text: string, class: string, anchor?: "start" | "middle" | "end"}} Shape */
/** An element, or parts in series, in parallel or in a bridge, with the room that it takes. `key` names its travel.
 * @typedef {{kind: string, name: string, element: string, key: string, value: number, parts: Plan[], left: number,
 * right: number, height: number}} Plan */
/** `travel`: how much longer each element is than at rest [m]; `reach`: at most; `states`: of friction and gaps;
 * `scale` of symbols, `wide` of what is beside each other; `chosen`: the element that is selected.
 * @typedef {{travel: {[key: string]: number}, reach: {[key: string]: number}, states: {[key: string]: string},
 * lift: number, scale: number, wide: number, labels: boolean, chosen?: string | null}} Work */

const HALF = 15; // [px] of an element, at the scale 1
const TALL = 54;
const LABEL = 22; // [px] that a name takes at least
const LONGEST = 8; // letters of a name that is written
const BAR = 6; // [px] from a bar to the end of what it joins
const TURN = 400; // [rad/m] of a flywheel: a lead of 16 mm

/** How a network is drawn: its parts with their room. @param {any} tree @param {boolean} labels whether named
 * @param {Map<string, number>} [met] names that came before, as the server counts them @returns {Plan} */
export function planOf(tree, labels, met = new Map()) {
  if (tree.kind === "element") {
    const times = (met.get(tree.name) ?? 0) + 1;
    met.set(tree.name, times);
    const named = labels && tree.name.length <= LONGEST;
    const right = named ? HALF + Math.max(LABEL, 7 * tree.name.length + 4) : HALF;
    return { kind: "element", name: tree.name, element: tree.key, value: tree.value,
      key: times > 1 ? `${tree.name} ${times}` : tree.name, parts: [], left: HALF, right, height: TALL };
  }
  const parts = tree.parts.map((/** @type {any} */ part) => planOf(part, labels, met));
  const blank = { kind: tree.kind, name: "", element: "", key: "", value: NaN, parts };
  if (tree.kind === "series") {
    return { ...blank, left: largest(parts, "left"), right: largest(parts, "right"),
      height: parts.reduce((/** @type {number} */ sum, /** @type {Plan} */ part) => sum + part.height, 0) };
  }
  const columns = tree.kind === "bridge" ? columnsOf(parts) : parts.map((/** @type {Plan} */ part) => [part]);
  const room = columns.map((/** @type {Plan[]} */ column) => largest(column, "left") + largest(column, "right"));
  const wide = room.reduce((/** @type {number} */ sum, /** @type {number} */ each) => sum + each, 0);
  const last = columns[columns.length - 1];
  const middle = (largest(columns[0], "left") + wide - largest(last, "right")) / 2;
  const tall = tree.kind === "bridge" ? bridgeHeights(parts).inside : largest(parts, "height");
  return { ...blank, left: middle, right: wide - middle, height: tall + 2 * BAR };
}

/** @param {Plan[]} parts @param {"left" | "right" | "height"} side */
const largest = (parts, side) => Math.max(...parts.map((part) => part[side]));

/** Arms a and b, e, and c and d of a bridge. @param {Plan[]} arms @returns {Plan[][]} */
const columnsOf = ([a, b, c, d, e]) => [[a, b], [e], [c, d]];

/** Depths of the inner nodes of a bridge below its upper end. @param {Plan[]} arms */
function bridgeHeights([a, b, c, d, e]) {
  const left = Math.max(a.height, c.height - e.height);
  const right = Math.max(left + e.height, c.height);
  return { left, right, inside: Math.max(left + b.height, right + d.height) };
}

/** How much longer a part is than at rest [m]. @param {Plan} plan @param {{[key: string]: number}} travel
 * @returns {number} */
export function travelOf(plan, travel) {
  if (plan.kind === "element") return travel[plan.key] ?? 0;
  const along = { series: plan.parts.length, parallel: 1, bridge: 2 }[plan.kind] ?? 1;
  return plan.parts.slice(0, along).reduce((sum, part) => sum + travelOf(part, travel), 0);
}

/** How far the parts of a network move at most, one after the other [m]. @param {Plan} plan
 * @param {{[key: string]: number}} reach @returns {number} */
export function reachOf(plan, reach) {
  if (plan.kind === "element") return reach[plan.key] ?? 0;
  const parts = plan.parts.map((part) => reachOf(part, reach));
  return plan.kind === "parallel" ? Math.max(...parts) : parts.reduce((sum, each) => sum + each, 0);
}

/** Shapes of a part whose upper end is at (x, y) and that is `long` at rest. @param {Plan} plan @param {number} x
 * @param {number} y @param {number} long @param {Work} work @param {Shape[]} into */
export function draw(plan, x, y, long, work, into) {
  if (plan.kind === "element") return symbol(plan, x, y, long, work, into);
  if (plan.kind === "series") return inAColumn(plan.parts, x, y, long, work, into);
  const { lift, scale, wide } = work;
  const columns = plan.kind === "bridge" ? columnsOf(plan.parts) : plan.parts.map((part) => [part]);
  let edge = x - plan.left * wide;
  const xs = columns.map((column) => {
    const at = edge + largest(column, "left") * wide;
    edge = at + largest(column, "right") * wide;
    return at;
  });
  const bar = BAR * scale;
  const end = y + long + lift * travelOf(plan, work.travel);
  const inside = long - 2 * bar;
  into.push(
    line([[x, y], [x, y + bar]]), line([[x, end - bar], [x, end]]),
    line([[xs[0], y + bar], [xs[xs.length - 1], y + bar]]),
    line([[xs[0], end - bar], [xs[xs.length - 1], end - bar]]),
  );
  if (plan.kind === "bridge") bridge(plan.parts, xs, y + bar, inside, work, into);
  else plan.parts.forEach((part, i) => draw(part, xs[i], y + bar, inside, work, into));
}

/** Parts one below the other: each has its own room, and of what is left as much as it moves. @param {Plan[]} parts
 * @param {number} x @param {number} y @param {number} long @param {Work} work @param {Shape[]} into */
function inAColumn(parts, x, y, long, work, into) {
  const whole = parts.reduce((sum, part) => sum + part.height, 0);
  const left = long - work.scale * whole;
  const reaches = parts.map((part) => reachOf(part, work.reach));
  const reach = reaches.reduce((sum, each) => sum + each, 0);
  parts.forEach((part, i) => {
    const size = part.height / whole;
    const share = reach > 0 && left > 0 ? 0.7 * (reaches[i] / reach) + 0.3 * size : size;
    const own = work.scale * part.height + left * share;
    draw(part, x, y, own, work, into);
    y += own + work.lift * travelOf(part, work.travel);
  });
}

/** @param {Plan[]} arms @param {number[]} xs @param {number} y @param {number} long @param {Work} work
 * @param {Shape[]} into */
function bridge(arms, xs, y, long, work, into) {
  const [a, b, c, d, e] = arms;
  const heights = bridgeHeights(arms);
  const share = long / heights.inside;
  const [left, right] = [heights.left * share, heights.right * share];
  const drop = (/** @type {Plan} */ plan) => work.lift * travelOf(plan, work.travel);
  const [yLeft, yRight] = [y + left + drop(a), y + right + drop(c)];
  draw(a, xs[0], y, left, work, into);
  draw(b, xs[0], yLeft, long - left, work, into);
  draw(c, xs[2], y, right, work, into);
  draw(d, xs[2], yRight, long - right, work, into);
  draw(e, xs[1], yLeft, right - left, work, into);
  into.push(line([[xs[0], yLeft], [xs[1], yLeft]]), line([[xs[1], yRight], [xs[2], yRight]]));
}

/** @param {Point[]} points @param {string} [kind] @returns {Shape} */
export const line = (points, kind = "wire") => ({ kind: "line", points, class: kind });

/** @param {Point[]} points @param {string} kind @returns {Shape} */
export const polygon = (points, kind) => ({ kind: "polygon", points, class: kind });

/** @param {number} x @param {number} y @param {number} r @param {string} kind @returns {Shape} */
export const circle = (x, y, r, kind) => ({ kind: "circle", x, y, r, class: kind });

/** @param {number} x @param {number} y @param {string} words @param {string} [kind]
 * @param {"start" | "middle" | "end"} [anchor] @returns {Shape} */
export const text = (x, y, words, kind = "text", anchor = "start") =>
  ({ kind: "text", x, y, text: words, class: kind, anchor });

/** A rectangle. @param {number} left @param {number} top @param {number} right @param {number} bottom
 * @param {string} kind @returns {Shape} */
export const box = (left, top, right, bottom, kind) =>
  polygon([[left, top], [right, top], [right, bottom], [left, bottom]], kind);

const SYMBOLS = { spring, damper, inerter, friction, gap };

/** @param {Plan} plan @param {number} x @param {number} y @param {number} long @param {Work} work
 * @param {Shape[]} into */
function symbol(plan, x, y, long, work, into) {
  const { lift, scale: s } = work;
  const grown = lift * (work.travel[plan.key] ?? 0);
  const at = { x, y, s, end: y + long + grown, upper: y + long / 2, lower: y + long / 2 + grown, long, grown,
    reach: Math.min(lift * (work.reach[plan.key] ?? 0), long / 2 - 4 * s) };
  const from = into.length;
  (SYMBOLS[/** @type {keyof typeof SYMBOLS} */ (plan.element)] ?? other)(at, plan, work, into);
  if (plan.name === work.chosen) for (const shape of into.slice(from)) shape.class += " chosen";
  if (!work.labels || plan.right === HALF) return;
  into.push(text(x + (HALF + 2) * s, y + (long + grown) / 2 + 4, plan.name, "name"));
}

/** `upper` and `lower`: the middle of the symbol, as far as it moves with the upper and with the lower end.
 * @typedef {{x: number, y: number, s: number, end: number, upper: number, lower: number, long: number, grown: number,
 * reach: number}} At */

const COILS = 8;

/** @param {At} at @param {Plan} plan @param {Work} work @param {Shape[]} into */
function spring({ x, y, s, end, long, grown }, plan, work, into) {
  const lead = Math.max(0, Math.min((long - 52 * s) / 2, (long + grown - 14 * s) / 2));
  const step = (end - y - 2 * lead) / COILS;
  /** @type {Point[]} */
  const coils = Array.from({ length: COILS }, (_, i) => [x + (i % 2 ? -8 : 8) * s, y + lead + (i + 0.5) * step]);
  into.push(line([[x, y], [x, y + lead], ...coils, [x, end - lead], [x, end]]));
}

/** A piston on the upper rod, in a cup on the lower one, which is as deep as it moves. @param {At} at
 * @param {Plan} plan @param {Work} work @param {Shape[]} into */
function damper({ x, y, s, end, upper, lower, reach }, plan, work, into) {
  const deep = Math.max(13 * s, reach + 3 * s);
  const [top, bottom] = [lower - deep, Math.min(lower + deep, end)];
  const piston = Math.max(top + 2 * s, Math.min(bottom - 2 * s, upper));
  into.push(
    box(x - 10 * s, top, x + 10 * s, bottom, "oil"),
    line([[x, Math.min(y, piston)], [x, piston]]), line([[x - 7 * s, piston], [x + 7 * s, piston]]),
    line([[x - 10 * s, top], [x - 10 * s, bottom], [x + 10 * s, bottom], [x + 10 * s, top]]),
    line([[x, bottom], [x, end]]),
  );
}

/** A flywheel in a box, which its own travel turns. @param {At} at @param {Plan} plan @param {Work} work
 * @param {Shape[]} into */
function inerter({ x, y, s, end, lower }, plan, work, into) {
  const angle = TURN * (work.travel[plan.key] ?? 0) + 0.6;
  const middle = Math.max(lower, y + 12 * s);
  into.push(
    line([[x, y], [x, middle - 12 * s]]), box(x - 11 * s, middle - 12 * s, x + 11 * s, middle + 12 * s, "box"),
    circle(x, middle, 8 * s, "flywheel"),
    line([[x, middle], [x + 7.5 * s * Math.sin(angle), middle - 7.5 * s * Math.cos(angle)]]),
    circle(x, middle, 1.9 * s, "dot"), line([[x, middle + 12 * s], [x, end]]),
  );
}

/** A block on the upper rod, along a wall on the lower one. @param {At} at @param {Plan} plan @param {Work} work
 * @param {Shape[]} into */
function friction({ x, y, s, end, upper, lower, reach }, plan, work, into) {
  const tall = Math.max(15 * s, Math.min(reach + 10 * s, end - lower - 3 * s));
  const block = Math.max(lower - tall + 8 * s, Math.min(lower + tall - 8 * s, upper));
  const sticks = work.states[plan.key] === "stick";
  /** @type {Shape[]} */
  const hatches = [];
  for (let h = -tall + s; h < tall; h += 5 * s) hatches.push(line([[x + 5 * s, lower + h], [x + 10 * s, lower + h
    + 5 * s]], "hatch"));
  into.push(
    line([[x, y], [x, block - 8 * s]]), box(x - 6 * s, block - 8 * s, x + 5 * s, block + 8 * s, sticks ? "block stick"
      : "block"),
    line([[x + 5 * s, lower - tall], [x + 5 * s, lower + tall], [x, lower + tall + 3 * s], [x, end]]), ...hatches,
  );
}

/** A pin on the lower rod, between two jaws on the upper one. The travel inside is drawn much larger than it is.
 * @param {At} at @param {Plan} plan @param {Work} work @param {Shape[]} into */
function gap({ x, y, s, end, upper }, plan, work, into) {
  const share = Math.max(-1, Math.min(1, (work.travel[plan.key] ?? 0) / (plan.value || 1)));
  const open = work.states[plan.key] === "open" || (work.states[plan.key] === undefined && Math.abs(share) < 1);
  const jaws = Math.min(Math.max(upper, y + 9 * s), end - 14 * s);
  const pin = jaws + 6 * s * share;
  const kind = open ? "wire open" : "wire";
  into.push(
    line([[x, y], [x, jaws - 7 * s], [x - 9 * s, jaws - 7 * s], [x - 9 * s, jaws + 7 * s], [x + 3 * s, jaws + 7 * s]],
      kind),
    line([[x - 9 * s, jaws - 7 * s], [x + 3 * s, jaws - 7 * s]], kind),
    line([[x - 4 * s, pin], [x + 9 * s, pin], [x + 9 * s, jaws + 13 * s], [x, jaws + 13 * s], [x, end]], kind),
  );
}

/** A kind of element without a symbol of its own. @param {At} at @param {Plan} plan @param {Work} work
 * @param {Shape[]} into */
function other({ x, y, s, end, lower }, plan, work, into) {
  const middle = Math.max(lower, y + 12 * s);
  into.push(line([[x, y], [x, middle - 12 * s]]), box(x - 9 * s, middle - 12 * s, x + 9 * s, middle + 12 * s, "box"),
    line([[x, middle + 12 * s], [x, end]]));
}
