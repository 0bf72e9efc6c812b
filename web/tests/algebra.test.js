import assert from "node:assert/strict";
import { test } from "node:test";
import {
  canonical,
  element,
  freshName,
  join,
  joinAt,
  leaves,
  moveTo,
  names,
  partAt,
  removeAt,
  replaceAt,
  shiftAt,
  written,
} from "../src/network/algebra.js";
import { read } from "./reading.js";

/** A generator of numbers in [0, 1) from a seed (mulberry32). */
function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function randomTree(draw, depth = 4) {
  if (depth === 0 || draw() < 0.35) return element("kcbfg"[Math.floor(5 * draw())] + Math.floor(10 * draw()));
  if (draw() < 0.2) {
    return { kind: "bridge", parts: Array.from({ length: 5 }, () => randomTree(draw, Math.min(depth - 1, 1))) };
  }
  const parts = Array.from({ length: 2 + Math.floor(3 * draw()) }, () => randomTree(draw, depth - 1));
  return join(draw() < 0.5 ? "series" : "parallel", parts);
}

function* places(tree, path = []) {
  yield path;
  if (tree.kind !== "element") for (const [i, part] of tree.parts.entries()) yield* places(part, [...path, i]);
}

const pick = (draw, list) => list[Math.floor(list.length * draw())];
const sorted = (tree) =>
  leaves(tree)
    .map(({ name }) => name)
    .sort();
const isCanonical = (tree) =>
  tree.kind === "element" ||
  (tree.kind === "bridge" && tree.parts.length === 5 && tree.parts.every(isCanonical)) ||
  (tree.kind !== "bridge" && tree.parts.length > 1 &&
    tree.parts.every((part) => part.kind !== tree.kind && isCanonical(part)));

function each(check, count = 500) {
  for (let seed = 0; seed < count; seed += 1) {
    const draw = random(seed);
    check(randomTree(draw), draw, seed);
  }
}

/** The admittance of a network at s = 1 whose elements have prime values: a number that knows the structure. */
function admittance(tree) {
  if (tree.kind === "element") return 1 + tree.name.codePointAt(0) * 0.37 + Number(tree.name.slice(1) || 0) * 1.3;
  const parts = tree.parts.map(admittance);
  const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);
  if (tree.kind === "bridge") return bridgeAdmittance(parts);
  return tree.kind === "parallel" ? sum(parts) : 1 / sum(parts.map((y) => 1 / y));
}

/** Kirchhoff's laws at the two inner nodes, for a velocity of one at the upper end. */
function bridgeAdmittance([a, b, c, d, e]) {
  const [left, right] = [a + b + e, c + d + e];
  const l = (a * right + c * e) / (left * right - e * e);
  const r = (c * left + a * e) / (left * right - e * e);
  return b * l + d * r;
}

const close = (a, b) => assert.ok(Math.abs(a - b) <= 1e-12 * Math.abs(a), `${a} is not ${b}`);

test("what is written reads back as the same tree", () => {
  each((tree) => assert.deepEqual(read(written(tree)), tree));
});

test("series binds tighter than parallel, and brackets group", () => {
  const [k, c, b] = ["k", "c", "b"].map(element);
  assert.equal(written(join("parallel", [k, join("series", [c, b])])), "k | c - b");
  assert.equal(written(join("series", [join("parallel", [k, c]), b])), "(k | c) - b");
});

test("a tree of the library has groups in groups of their kind where brackets did, and here none", () => {
  each((tree) => assert.deepEqual(canonical({ ...nested(tree), from: 0, to: 9 }), tree));
});

/** The same network with a pair of brackets around all but the last part of a group. */
function nested(tree) {
  if (tree.kind === "element") return { ...tree, from: 0, to: 1 };
  if (tree.kind === "bridge") return { kind: tree.kind, parts: tree.parts.map(nested), from: 0, to: 1 };
  const [last, ...others] = tree.parts.map(nested).reverse();
  const first = others.length === 1 ? others[0] : { kind: tree.kind, parts: others.reverse(), from: 0, to: 1 };
  return { kind: tree.kind, parts: [first, last], from: 0, to: 1 };
}

test("every change gives a tree without groups inside groups of their kind", () => {
  each((tree, draw) => {
    const [a, b] = [pick(draw, [...places(tree)]), pick(draw, [...places(tree)])];
    const kind = draw() < 0.5 ? "series" : "parallel";
    const after = [joinAt(tree, a, kind, element("x"), draw() < 0.5), replaceAt(tree, a, randomTree(draw))];
    for (const changed of [...after, removeAt(tree, a), moveTo(tree, a, b, kind), shiftAt(tree, a, 1)]) {
      assert.ok(changed === null || isCanonical(changed), written(tree));
    }
  });
});

test("joining changes the admittance of that part as the law of its joint says", () => {
  each((tree, draw) => {
    const path = pick(draw, [...places(tree)]);
    const [y, x] = [admittance(partAt(tree, path)), admittance(element("x"))];
    close(admittance(joinAt(tree, path, "parallel", element("x"))), admittanceWith(tree, path, y + x));
    close(
      admittance(joinAt(tree, path, "series", element("x"), true)),
      admittanceWith(tree, path, 1 / (1 / y + 1 / x)),
    );
  });
});

function admittanceWith(tree, path, y) {
  if (path.length === 0) return y;
  const [i, ...rest] = path;
  const parts = tree.parts.map((part, j) => (j === i ? admittanceWith(part, rest, y) : admittance(part)));
  const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);
  if (tree.kind === "bridge") return bridgeAdmittance(parts);
  return tree.kind === "parallel" ? sum(parts) : 1 / sum(parts.map((each) => 1 / each));
}

test("a bridge without an arm is what its admittance becomes", () => {
  each((tree, draw) => {
    const arms = Array.from({ length: 5 }, () => randomTree(draw, 2));
    const i = Math.floor(5 * draw());
    const values = arms.map((arm, j) => (j === i ? 0 : admittance(arm)));
    close(admittance(removeAt({ kind: "bridge", parts: arms }, [i])), bridgeAdmittance(values));
  });
});

test("what was joined and is taken away leaves the network as it was", () => {
  each((tree, draw) => {
    const path = pick(draw, [...places(tree)]);
    const joined = joinAt(tree, path, draw() < 0.5 ? "series" : "parallel", element("x"), draw() < 0.5);
    const there = leaves(joined).find(({ name }) => name === "x").path;
    assert.deepEqual(removeAt(joined, there), tree);
  });
});

test("moving keeps all elements, and a part is never moved into itself", () => {
  each((tree, draw) => {
    const all = [...places(tree)];
    const [from, to] = [pick(draw, all), pick(draw, all)];
    const moved = moveTo(tree, from, to, draw() < 0.5 ? "series" : "parallel", draw() < 0.5);
    assert.deepEqual(sorted(moved), sorted(tree));
    if (to.length <= from.length && to.every((i, level) => from[level] === i)) assert.equal(moved, tree);
  });
});

test("a change of neighbours leaves the admittance, and changing back gives the same tree", () => {
  each((tree, draw) => {
    const path = pick(draw, [...places(tree)]);
    const shifted = shiftAt(tree, path, 1);
    close(admittance(shifted), admittance(tree));
    if (shifted !== tree) assert.deepEqual(shiftAt(shifted, [...path.slice(0, -1), path.at(-1) + 1], -1), tree);
  });
});

test("names stand in the order of the text, each once, and a fresh one is not taken", () => {
  assert.deepEqual(names(read("c | k - c")), ["c", "k"]);
  assert.equal(freshName("b", ["b", "b2"]), "b3");
});
