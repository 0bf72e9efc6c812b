import assert from "node:assert/strict";
import { test } from "node:test";
import { coloursOf } from "../src/plots/colours.js";
import { layoutOf, nearest, valueAt } from "../src/plots/layout.js";
import { csvOf, tableOf, thinned } from "../src/plots/table.js";
import { axisTitle, linearTicks, logTicks, roundStep, shortUnit, tickTexts } from "../src/plots/ticks.js";

const near = (one, other, far = 1e-9) => assert.ok(Math.abs(one - other) <= far, `${one} is not ${other}`);

test("marks of linear axes are round, lie on the axis and are as many as fit", () => {
  for (const [from, to] of [[0, 1], [-3.2, 7.9], [1e-7, 4.4e-7], [59.3, 241], [-80, -20], [1199, 1201], [0, 3e9]]) {
    for (const most of [2, 5, 10]) {
      const ticks = linearTicks(from, to, most);
      const step = roundStep(to - from, most);
      assert.ok(ticks.length >= 1 && ticks.length <= most + 1, `${from} ${to} ${most}: ${ticks}`);
      assert.match(step.toExponential(6), /^(1|2|5)\.000000e/);
      for (const tick of ticks) {
        assert.ok(tick >= from - 1e-9 * (to - from) && tick <= to + 1e-9 * (to - from));
        near(tick / step, Math.round(tick / step), 1e-6);
      }
    }
  }
});

test("marks of logarithmic axes are 1, 2 and 5, fewer over many powers of ten", () => {
  assert.deepEqual(logTicks(0.3, 154, 9), [0.5, 1, 2, 5, 10, 20, 50, 100]);
  assert.deepEqual(logTicks(0.9, 1200, 4), [1, 10, 100, 1000]);
  assert.deepEqual(logTicks(1, 1e12, 5), [1, 1e3, 1e6, 1e9, 1e12]);
  assert.ok(logTicks(42, 47, 6).length >= 2);
  for (const [from, to] of [[1e-9, 1e-3], [2, 3], [0.5, 30]])
    for (const tick of logTicks(from, to, 6)) assert.ok(tick >= from * (1 - 1e-9) && tick <= to * (1 + 1e-9));
});

test("texts of marks have the same places and read back", () => {
  assert.deepEqual(tickTexts([1.1, 1.12, 1.14], false), ["1.10", "1.12", "1.14"]);
  assert.deepEqual(tickTexts([-10, 0, 10], false), ["−10", "0", "10"]);
  assert.deepEqual(tickTexts([0.5, 1, 20], true), ["0.5", "1", "20"]);
  assert.deepEqual(tickTexts([1e-5, 2e-5, 0.1], true), ["10⁻⁵", "2·10⁻⁵", "10⁻¹"]);
});

test("units get a prefix where numbers would be long", () => {
  assert.deepEqual(shortUnit(0.048, "m"), { unit: "mm", size: 1e-3 });
  assert.deepEqual(shortUnit(25_000, "N"), { unit: "kN", size: 1e3 });
  assert.deepEqual(shortUnit(9e-6, "m/N"), { unit: "µm/N", size: 1e-6 });
  assert.deepEqual(shortUnit(3e-5, "(m/s^2)/(m/s)"), { unit: "10⁻⁶ (m/s²)/(m/s)", size: 1e-6 });
  assert.deepEqual(shortUnit(80, "N"), { unit: "N", size: 1 });
  assert.equal(axisTitle("body acceleration", "m/s^2"), "Body acceleration [m/s²]");
  assert.equal(axisTitle("k", "N/m"), "k [N/m]");
});

const wave = (name, height, more = {}) => ({ name, colour: "s2", x: Array.from({ length: 200 }, (_, i) => 1 + i / 10),
  y: Array.from({ length: 200 }, (_, i) => height * (1.2 + Math.sin(i / 20))), ...more });
const PLOT = { title: "a plot", x: { what: "frequency", unit: "Hz", log: true }, y: { what: "gain", unit: "N" },
  curves: [wave("S1", 10), wave("S2", 25), wave("S3", 40)] };

test("a path reads back to its data, linear and logarithmic, whole and in part", () => {
  for (const logX of [true, false]) for (const logY of [true, false]) for (const zoom of [null, [3, 9]]) {
    const plot = { ...PLOT, x: { ...PLOT.x, log: logX }, y: { ...PLOT.y, log: logY } };
    const { paths, x, y } = layoutOf(plot, { width: 560, height: 240, font: 11, zoom });
    plot.curves.forEach((curve, number) => {
      const pixels = paths[number].slice(1).split("L").map((pair) => pair.split(" ").map(Number));
      assert.equal(pixels.length, curve.x.length);
      pixels.forEach(([across, up], i) => {
        near(x.at(curve.x[i]), across, 0.051);
        near(y.at(curve.y[i]), up, 0.051);
        near(x.of(x.at(curve.x[i])), curve.x[i], 1e-9 * curve.x[i]);
      });
    });
  }
});

test("a phase leaves at one edge and goes on at the other, and loses no sample", () => {
  const x = Array.from({ length: 60 }, (_, i) => 1 + i / 10);
  const phases = x.map((at) => ((((-97 * at + 180) % 360) + 360) % 360) - 180); // as a delay turns it
  const curve = { name: "S1", colour: "s1", x, y: phases, turn: 360 };
  const plot = { ...PLOT, x: { what: "frequency", unit: "Hz" }, y: { what: "phase", unit: "°", from: -180, to: 180 } };
  const laid = layoutOf({ ...plot, curves: [curve] }, { width: 600, height: 300, font: 11 });
  const numbersOf = (line) => line.split("L").map((pair) => pair.split(" ").map(Number));
  const lines = laid.paths[0].slice(1).split("M").map(numbersOf);
  const turns = phases.filter((each, i) => i > 0 && Math.abs(each - phases[i - 1]) > 180).length;
  assert.equal(lines.length, turns + 1);
  assert.equal(lines.flat().length, x.length + 2 * turns);
  lines.slice(1).forEach((line, i) => {
    near(lines[i].at(-1)[1], laid.y.at(-180), 0.051);
    near(line[0][1], laid.y.at(180), 0.051);
    near(line[0][0], laid.x.at((180 + 360 * i) / 97), 0.11);
  });
});

test("the title of an axis keeps off the uppermost number, also in a low plot", () => {
  for (const height of [90, 120, 200, 400]) for (const font of [11, 14]) {
    const { titles, y } = layoutOf(PLOT, { width: 500, height, font });
    const highest = Math.min(...y.ticks.map(({ at }) => at)) + 0.35 * font - 0.75 * font; // the upper edge of digits
    assert.ok(highest - (titles.y.y + 0.25 * font) >= 0.3 * font, `${height} ${font}`);
  }
});

test("what cannot be drawn breaks a curve, and nothing else", () => {
  const curve = { name: "S1", colour: "s1", x: [1, 2, 3, 4, 5], y: [1, null, 3, -4, 5] };
  const both = [false, true].map((log) => layoutOf({ ...PLOT, y: { ...PLOT.y, log }, curves: [curve] },
    { width: 400, height: 200, font: 11 }).paths[0].match(/M/g)?.length);
  assert.deepEqual(both, [2, 3]);
  const empty = layoutOf({ ...PLOT, curves: [] }, { width: 400, height: 200, font: 11 });
  assert.ok(empty.x.ticks.every(({ at }) => Number.isFinite(at)));
});

test("names stand apart, inside, nearest to their own curve, and stay where they are", () => {
  const how = { width: 560, height: 240, font: 11 };
  const { names, box } = layoutOf(PLOT, how);
  assert.deepEqual(names.map(({ name }) => name), ["S1", "S2", "S3"]);
  for (const [i, one] of names.entries()) {
    assert.ok(one.x >= box.left && one.x <= box.right && one.y > box.top - 11 && one.y < box.bottom);
    for (const other of names.slice(i + 1)) assert.ok(Math.hypot(one.x - other.x, one.y - other.y) > 11);
  }
  const moved = { ...PLOT, curves: PLOT.curves.map((curve) => ({ ...curve, y: curve.y.map((value) => value * 1.002) })) };
  const after = layoutOf(moved, { ...how, before: names });
  assert.deepEqual(after.names.map(({ spot }) => spot), names.map(({ spot }) => spot));
});

test("shaded intervals are where they are, and none vanishes", () => {
  const plot = { ...PLOT, x: { ...PLOT.x, log: false }, bands: [{ from: 2, to: 4, kind: "stick" },
    { from: 5, to: 5.0001, kind: "stick" }, { from: 30, to: 40, kind: "open" }], keys: [{ kind: "stick", text: "f sticks" }] };
  const { bands, x, keys, width } = layoutOf(plot, { width: 560, height: 240, font: 11 });
  assert.deepEqual(bands.map(({ kind }) => kind), ["stick"]);
  const [first, second] = bands[0].path.match(/M([\d.]+) [\d.]+H([\d.]+)/g).map((part) =>
    part.match(/[\d.]+/g).map(Number));
  near(x.of(first[0]), 2, 0.01);
  near(x.of(first[2]), 4, 0.01);
  assert.ok(second[2] - second[0] >= 0.9);
  assert.ok(keys[0].x + keys[0].text.length * 6 < width);
});

test("a written unit divides numbers, ticks and the table", () => {
  const plot = { title: "sweep", x: { what: "spring k", unit: "kN/m", size: 1e3 }, y: { what: "J1", unit: "m/s^2" },
    curves: [{ name: "S1", colour: "s1", x: [60e3, 120e3, 240e3], y: [1, 2, 3] }] };
  const { x } = layoutOf(plot, { width: 560, height: 240, font: 11 });
  assert.equal(x.title, "Spring k [kN/m]");
  assert.ok(x.ticks.some(({ text, at }) => text === "120" && Math.abs(at - x.at(120e3)) < 1e-6));
  assert.deepEqual(tableOf(plot).rows, [[60, 1], [120, 2], [240, 3]]);
  assert.deepEqual(tableOf(plot).heads, ["spring k [kN/m]", "J1 of S1 [m/s²]"]);
});

test("a table has the curves beside each other, or each with its own places; as CSV all digits", () => {
  const other = { name: "kept, S2", colour: "s2", x: [1, 2], y: [0.1 + 0.2, null] };
  const mixed = tableOf({ ...PLOT, curves: [PLOT.curves[0], other] });
  assert.equal(mixed.heads.length, 4);
  assert.equal(mixed.rows.length, 200);
  assert.deepEqual(mixed.rows[1].slice(2), [2, null]);
  const [head, first] = csvOf(mixed).split("\r\n");
  assert.ok(head.endsWith('"frequency of kept, S2 [Hz]","gain of kept, S2 [N]"'));
  assert.ok(first.endsWith(`1,${0.1 + 0.2}`));
  assert.equal(tableOf(PLOT).heads.length, 4);
  assert.deepEqual([thinned(tableOf(PLOT), 100).rows.length, thinned(tableOf(PLOT), 100).every], [100, 2]);
});

test("values are read at samples exactly and between them by a line", () => {
  const curve = { name: "S1", colour: "s1", x: [1, 2, 4], y: [10, 20, null] };
  assert.deepEqual([0.5, 1, 1.5, 2, 3, 5].map((at) => valueAt(curve, at)), [null, 10, 15, 20, null, null]);
  assert.deepEqual([0, 1.4, 1.6, 3.1, 9].map((at) => nearest(curve.x, at)), [0, 0, 1, 2, 2]);
});

test("the baseline is grey, every other layout keeps its colour", () => {
  assert.deepEqual(coloursOf(["S1", "S2", "S3"], "S1"), { S1: "s1", S2: "s2", S3: "s3" });
  assert.deepEqual(coloursOf(["S1", "S2", "S3"], "S3"), { S3: "s1", S1: "s2", S2: "s3" });
});
