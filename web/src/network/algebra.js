// The algebra of networks as they are written: `|` is parallel, `-` is series and binds tighter, brackets group, and
// bridge(a, b, c, d, e) is a bridge.
// Texts are written here, and read by the library alone.
//
// A tree is a frozen value: {kind: "element", name}, {kind: "series" | "parallel", parts} with two parts or more,
// none of them of its own kind, or {kind: "bridge", parts} with five. Each function that changes a tree gives another
// one.

/** @typedef {{kind: "element", name: string}} Leaf */
/** @typedef {{kind: "series" | "parallel" | "bridge", parts: Tree[]}} Group */
/** @typedef {Leaf | Group} Tree */
/** @typedef {number[]} Path  where a part is: the place among the parts of the whole, then among the parts of
 * that... */
/** @typedef {"series" | "parallel"} Joint */

/** @param {string} name @returns {Leaf} */
export const element = (name) => ({ kind: "element", name });

/** Some trees joined, with what is of the same kind taken in. @param {Group["kind"]} kind @param {Tree[]} parts
 * @returns {Tree} */
export function join(kind, parts) {
  if (kind === "bridge") return { kind, parts };
  const flat = parts.flatMap((part) => (part.kind === kind ? part.parts : [part]));
  return flat.length === 1 ? flat[0] : { kind, parts: flat };
}

/** A tree of the library, with what is of the same kind taken in. @param {any} tree @returns {Tree} */
export const canonical = (tree) =>
  tree.kind === "element" ? element(tree.name) : join(tree.kind, tree.parts.map(canonical));

/** A tree as text, with the brackets that it needs. @param {Tree} tree @param {"" | "|" | "-"} inside
 * @returns {string} */
export function written(tree, inside = "") {
  if (tree.kind === "element") return tree.name;
  if (tree.kind === "bridge") return `bridge(${tree.parts.map((arm) => written(arm)).join(", ")})`;
  const sign = tree.kind === "parallel" ? "|" : "-";
  const text = tree.parts.map((part) => written(part, sign)).join(` ${sign} `);
  const bare = inside === "" || (tree.kind === "series" && inside === "|");
  return bare ? text : `(${text})`;
}

/** The names in a tree, each once, in the order in which they are written. @param {Tree} tree @returns {string[]} */
export function names(tree) {
  return [...new Set(leaves(tree).map(({ name }) => name))];
}

/** All elements with their places. @param {Tree} tree @param {Path} path @returns {{name: string, path: Path}[]} */
export function leaves(tree, path = []) {
  if (tree.kind === "element") return [{ name: tree.name, path }];
  return tree.parts.flatMap((part, i) => leaves(part, [...path, i]));
}

/** The part at a place, or null. @param {Tree} tree @param {Path} path @returns {Tree | null} */
export function partAt(tree, path) {
  /** @type {Tree | undefined} */
  let part = tree;
  for (const i of path) part = part?.kind === "element" ? undefined : part?.parts[i];
  return part ?? null;
}

/** @param {Tree[]} parts @param {number} i @param {Tree} part */
const changedAt = (parts, i, part) => parts.map((each, j) => (j === i ? part : each));

/** The tree with another part at a place. @param {Tree} tree @param {Path} path @param {Tree} part @returns {Tree} */
export function replaceAt(tree, path, part) {
  if (path.length === 0 || tree.kind === "element") return part;
  const [i, ...rest] = path;
  return join(tree.kind, changedAt(tree.parts, i, replaceAt(tree.parts[i], rest, part)));
}

/** The tree without the part at a place; null where nothing is left. @param {Tree} tree @param {Path} path
 * @returns {Tree | null} */
export function removeAt(tree, path) {
  if (path.length === 0 || tree.kind === "element") return null;
  const [i, ...rest] = path;
  const left = removeAt(tree.parts[i], rest);
  if (left === null && tree.kind === "bridge") return withoutArm(tree.parts, i);
  return join(tree.kind, left === null ? tree.parts.filter((_, j) => j !== i) : changedAt(tree.parts, i, left));
}

/** The series-parallel network that a bridge is without one arm. @param {Tree[]} arms @param {number} i
 * @returns {Tree} */
function withoutArm([a, b, c, d, e], i) {
  /** @param {Tree[]} parts */
  const series = (...parts) => join("series", parts);
  /** @param {Tree[]} parts */
  const parallel = (...parts) => join("parallel", parts);
  return [
    () => series(c, parallel(d, series(turned(e), b))),
    () => series(parallel(c, series(a, e)), d),
    () => series(a, parallel(b, series(e, d))),
    () => series(parallel(a, series(c, turned(e))), b),
    () => parallel(series(a, b), series(c, d)),
  ][i]();
}

/** The tree upside down. @param {Tree} tree @returns {Tree} */
function turned(tree) {
  if (tree.kind === "element") return tree;
  const parts = tree.parts.map(turned);
  if (tree.kind === "parallel") return { kind: tree.kind, parts };
  if (tree.kind === "series") return { kind: tree.kind, parts: parts.reverse() };
  const [a, b, c, d] = parts;
  return { kind: tree.kind, parts: [b, a, d, c, tree.parts[4]] };
}

/** The tree with `added` joined to the part at a place, after it (below it in series, right of it in parallel) or
 * before it. @param {Tree} tree @param {Path} path @param {Joint} kind @param {Tree} added @param {boolean} before
 * @returns {Tree} */
export function joinAt(tree, path, kind, added, before = false) {
  const part = partAt(tree, path);
  if (part === null) return tree;
  return replaceAt(tree, path, join(kind, before ? [added, part] : [part, added]));
}

/**
 * The tree with the part at one place joined to the part at another; the tree itself where one lies in the other.
 * @param {Tree} tree @param {Path} from @param {Path} to @param {Joint} kind @param {boolean} before @returns {Tree}
 */
export function moveTo(tree, from, to, kind, before = false) {
  const moved = partAt(tree, from);
  if (moved === null || partAt(tree, to) === null || within(to, from) || within(from, to)) return tree;
  const marked = replaceLeafwise(tree, from);
  const joined = joinAt(marked, to, kind, moved, before);
  const mark = markIn(joined);
  return (mark && removeAt(joined, mark)) ?? tree;
}

const MARK = "\u0000"; // no name: what stands where the moved part was, until it is taken away

/** @param {Tree} tree @param {Path} path */
const replaceLeafwise = (tree, path) => replaceAt(tree, path, element(MARK));

/** @param {Tree} tree */
const markIn = (tree) => leaves(tree).find(({ name }) => name === MARK)?.path ?? null;

/** Whether a place is inside another, or the same. @param {Path} path @param {Path} whole */
const within = (path, whole) => whole.every((i, level) => path[level] === i);

/** The tree with the part at a place changed for its neighbour before (-1) or after (+1) it; the tree itself for an
 * arm of a bridge. @param {Tree} tree @param {Path} path @param {-1 | 1} step @returns {Tree} */
export function shiftAt(tree, path, step) {
  const above = path.slice(0, -1);
  const group = partAt(tree, above);
  const i = path[path.length - 1];
  if (group === null || group.kind === "element" || group.kind === "bridge") return tree;
  if (group.parts[i + step] === undefined) return tree;
  const parts = changedAt(changedAt(group.parts, i, group.parts[i + step]), i + step, group.parts[i]);
  return replaceAt(tree, above, { kind: group.kind, parts });
}

/** A name with this beginning that is not taken. @param {string} symbol @param {Iterable<string>} taken */
export function freshName(symbol, taken) {
  const known = new Set(taken);
  let name = symbol;
  for (let number = 2; known.has(name); number += 1) name = `${symbol}${number}`;
  return name;
}
