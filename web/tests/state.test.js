import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { after, empty, textOf } from "../src/state/document.js";
import {
  positionOf,
  quantity,
  shown,
  symbolParts,
  takenApart,
  valueAt,
  STEPS,
  aligned,
  brief,
  completed,
  withError,
  toPlaces,
  printed,
  unitFor,
  withUnit,
} from "../src/state/scale.js";
import { documentFrom, open as openFiles } from "../src/remembering.js";
import { createStore, initial, reduce } from "../src/state/store.js";
import { limited } from "../src/panels/asked.js";
import { elementsIn, freeIn, judging, numbersOf, quickMethod, treeOf } from "../src/library.js";
import { bestOf, comparedOf, questions, staleLayouts, unitsIn } from "../src/questions.js";
import { takeNetwork } from "../src/working.js";
import { partsOf } from "./reading.js";

const STUDY = {
  title: "car",
  vehicle: { model: "quarter-car", sprung_mass: "180 kg" },
  road: { speed: "25 m/s" },
  elements: { k: "120 kN/m", c: { from: "100 N s/m", to: "100 kN s/m" }, b: "300 kg" },
  layouts: { S1: "k | c", S2: "k | c - b" },
  study: {
    indices: ["J1"],
    baseline: "S1",
    budgets: ["b"],
    sweep: { k: { from: "10 kN/m", to: "20 kN/m", points: 3 } },
  },
};
const ABOUT = {
  vehicles: [{ key: "quarter-car", fields: [{ key: "sprung_mass", unit: "kg" }], mounts: ["strut"] }],
  road: [{ key: "speed", unit: "m/s" }],
  elements: [],
};

/** Changes of every kind, to be drawn from. */
const CHANGES = [
  { type: "opened", study: STUDY },
  { type: "placed", place: ["vehicle", "sprung_mass"], value: "200 kg" },
  { type: "placed", place: ["title"], value: undefined },
  { type: "valued", layout: "S1", values: { c: "3 kN s/m" } },
  { type: "optimised", optima: { S1: { problems: ["a"], values: { c: "3 kN s/m" } },
    S2: { problems: ["b"], values: { c: "7 kN s/m" } } } },
  { type: "ranged", place: "elements.k", from: "1 kN/m", to: "1 MN/m" },
  { type: "freed", place: ["elements", "b"], name: "b", from: "1 kg", to: "2000 kg" },
  { type: "fixed", place: ["elements", "c"], name: "c", text: "4 kN s/m" },
  { type: "drawn", text: "k | c | b" },
  { type: "drawn", text: "k | ", added: { f: "10 N" } },
  { type: "networkTaken", layout: "S2", entry: "k | c1", elements: { c1: "9 N s/m" }, values: { c: "8 N s/m" } },
  { type: "selected", layout: "S1" },
  { type: "layoutAdded", name: "S3" },
  { type: "layoutRenamed", name: "other" },
  { type: "layoutRemoved" },
  { type: "strutsParted", texts: { front: "k | c", rear: "k" }, strut: "rear" },
  { type: "strutsJoined" },
  { type: "elementRenamed", old: "c", name: "damper", study: STUDY },
  { type: "elementRemoved", name: "b" },
  { type: "designKept", name: "mine" },
  { type: "designTaken", name: "mine" },
  { type: "designRemoved", name: "mine" },
];

const open = () => after(empty(), { type: "opened", study: STUDY });

/** A generator of numbers in [0, 1) from a seed (mulberry32). */
function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function frozen(value) {
  if (value !== null && typeof value === "object") Object.values(Object.freeze(value)).forEach(frozen);
  return value;
}

test("undoing all and redoing all gives every document again, whatever was done", () => {
  for (let seed = 0; seed < 300; seed += 1) {
    const draw = random(seed);
    let state = initial();
    const documents = [state.history.present];
    for (let step = 0; step < 25; step += 1) {
      const change = CHANGES[Math.floor(CHANGES.length * draw())];
      state = reduce(state, { type: "changed", change, gesture: null });
      if (state.history.present !== documents.at(-1)) documents.push(frozen(state.history.present));
    }
    for (const document of documents.slice(0, -1).reverse()) {
      state = reduce(state, { type: "undone" });
      assert.equal(state.history.present, document);
    }
    assert.equal(state.history.past.length, 0);
    for (const document of documents.slice(1)) {
      state = reduce(state, { type: "redone" });
      assert.equal(state.history.present, document);
    }
  }
});

test("whatever was done, the layout that is edited is there, and a document outlives JSON", () => {
  for (let seed = 0; seed < 300; seed += 1) {
    const draw = random(seed);
    let document = open();
    for (let step = 0; step < 25; step += 1) document = after(document, CHANGES[Math.floor(CHANGES.length * draw())]);
    const layouts = Object.keys(document.study.layouts ?? {});
    assert.ok(layouts.length === 0 ? document.layout === "" : layouts.includes(document.layout));
    assert.equal(typeof textOf(document), "string");
    assert.deepEqual(
      JSON.parse(JSON.stringify(document)),
      JSON.parse(JSON.stringify(after(document, { type: "restored", document }))),
    );
  }
});

test("the drag of a slider is one step, two drags are two", () => {
  const store = createStore();
  store.change({ type: "opened", study: STUDY });
  for (let drag = 0; drag < 2; drag += 1) {
    for (let i = 1; i <= 60; i += 1)
      store.change({ type: "placed", place: ["elements", "k"], value: `${100 * drag + i} kN/m` }, "slide elements.k");
    store.dispatch({ type: "rested" });
  }
  assert.equal(store.get().history.past.length, 3);
  store.dispatch({ type: "undone" });
  assert.equal(store.get().history.present.study.elements.k, "60 kN/m");
});

test("a name is another one beside the study too: in values, and in the ranges of sliders", () => {
  const ranged = (/** @type {any} */ document, /** @type {string} */ place) =>
    after(document, { type: "ranged", place, from: "1", to: "2" });
  const valued = after(open(), { type: "valued", layout: "S2", values: { c: "1 N s/m" } });
  const before = ["elements.c", "elements.c.gap", "elements.c2"].reduce(ranged, valued);
  const study = { ...STUDY, title: "renamed" };
  const document = after(before, { type: "elementRenamed", old: "c", name: "d", study });
  assert.equal(document.study, study);
  assert.deepEqual(document.values, { S2: { d: "1 N s/m" } });
  assert.deepEqual(Object.keys(document.ranges), ["elements.d", "elements.d.gap", "elements.c2"]);
});

test("what is freed begins at its value in every layout, and what is fixed keeps its bounds for later", () => {
  const freed = after(open(), { type: "freed", place: ["elements", "b"], name: "b", from: "1 kg", to: "2000 kg" });
  assert.equal(freed.values.S2.b, "300 kg");
  const fixed = after(freed, { type: "fixed", place: ["elements", "b"], name: "b", text: "400 kg" });
  assert.equal(fixed.study.elements.b, "400 kg");
  assert.deepEqual(fixed.ranges["elements.b"], { from: "1 kg", to: "2000 kg" });
});

test("questions follow from the state alone, and nothing of the page's own goes into a study", () => {
  const store = createStore();
  store.dispatch({ type: "told", about: ABOUT });
  assert.deepEqual(questions(store.get()), []);
  store.change({ type: "opened", study: STUDY });
  store.change({ type: "ranged", place: "elements.k", from: "1 kN/m", to: "1 MN/m" });
  const asked = questions(store.get());
  assert.deepEqual(
    asked.map(({ panel }) => panel),
    ["parts", "check", "decision", "response", "history", "mechanism"],
  );
  for (const { body } of asked.slice(1, 4)) assert.deepEqual(body.study, STUDY);
});

test("a slider's places and values undo each other, and cover the range", () => {
  for (const [lower, upper] of [
    [1, 10],
    [1e-7, 5],
    [100, 1e5],
  ]) {
    for (let position = 0; position <= STEPS; position += 1)
      assert.equal(positionOf(valueAt(position, lower, upper), lower, upper), position);
    assert.ok(Math.abs(valueAt(STEPS, lower, upper) / upper - 1) < 1e-12);
  }
  assert.equal(positionOf(1e9, 1, 10), STEPS);
  assert.equal(positionOf(0, 1, 10), 0);
});

test("quantities come apart and together as they are written", () => {
  assert.deepEqual(takenApart("120 kN/m"), { number: 120, unit: "kN/m" });
  assert.deepEqual(takenApart("5e-7 m^3/cycle"), { number: 5e-7, unit: "m^3/cycle" });
  assert.equal(takenApart("abc"), null);
  assert.equal(quantity(123456.789, "N/m"), "123500 N/m");
  assert.equal(quantity(0.000005, "m^3/cycle"), "5e-6 m^3/cycle");
  assert.equal(quantity(-0.0000123456, "m"), "-1.235e-5 m");
  assert.equal(quantity(0.0005, "m"), "0.0005 m");
  assert.equal(quantity(0, "N"), "0 N");
  assert.equal(brief("7544.184883044672 N s/m"), "7544.2 N s/m");
  assert.equal(brief("181.75 kg"), "181.75 kg");
  assert.equal(brief("5e-7 m^3/cycle"), "5 × 10⁻⁷ m³/cycle");
  assert.equal(brief("1.5e2 kg"), "1.5 × 10² kg");
  assert.equal(brief("2.345678912e-08 m"), "2.3457 × 10⁻⁸ m");
  assert.equal(brief("3.19238 kN s/m"), "3.1924 kN s/m");
  const about = { units: { "N/m": [{ least: 1e6, most: 1e12, factor: 1e-6, unit: "MN/m" }] } };
  assert.equal(brief("10000000.0 N/m", about, "N/m"), "10 MN/m");
  assert.equal(brief("3200000 N/m", about, "kg"), "3200000 N/m");
  assert.equal(brief("3200 N/m", about, "N/m"), "3200 N/m"); // as it was written
  assert.equal(shown(-6.4525e-5), "−6.4525 × 10⁻⁵");
  assert.equal(shown(null), "–");
});

test("numbers and their units are written as the library writes them", () => {
  const { numbers, units, suited } = JSON.parse(readFileSync(new URL("numbers.json", import.meta.url), "utf8"));
  for (const [number, digits, text] of numbers) assert.equal(shown(number, digits), text, `${number}, ${digits} digits`);
  for (const [unit, size, factor, text] of suited) {
    const found = unitFor({ units }, [size], unit);
    assert.deepEqual([found.factor, printed(found.unit)], [factor, text], `${size} ${unit}`);
  }
});

test("numbers in a column have as many digits, zeros at the end too", () => {
  const numbers = [523, 520.93, 5.37e-5, -0.05, 0, 12000, 1, 2e6, null, 0.001];
  assert.deepEqual(numbers.map((number) => aligned(number, 4)),
    ["523.0", "520.9", "5.370 × 10⁻⁵", "−0.05000", "0", "12000", "1.000", "2000000", "–", "0.001000"]);
});

test("a symbol has a subscript, a word has none", () => {
  const names = ["k", "ks", "c_f", "b12", "cs2", "k_front", "flywheel", "friction", "inerter_f", "f", "gap",
    "gap2", "ksh"];
  assert.deepEqual(names.map((name) => symbolParts(name).join(" ")),
    ["k ", "k s", "c f", "b 12", "c s2", "k front", "flywheel ", "friction ", "inerter_f ", "f ",
      "gap ", "gap2 ", "k sh"]);
});

test("what the library said of a study stands until it says more, without what the document has no longer", () => {
  const store = createStore();
  store.change({ type: "opened", study: STUDY });
  store.dispatch({ type: "parted", parts: partsOf(STUDY) });
  const places = () => numbersOf(store.get()).map(({ place }) => place);
  assert.deepEqual(places(), ["vehicle.sprung_mass", "k", "c", "b"]);
  assert.deepEqual([elementsIn(store.get(), "S2"), freeIn(store.get(), "S2")], [["k", "c", "b"], ["c"]]);
  store.change({ type: "elementRemoved", name: "b" });
  store.change({ type: "fixed", place: ["elements", "c"], name: "c", text: "4 kN s/m" });
  assert.deepEqual(places(), ["vehicle.sprung_mass", "k", "c"]);
  assert.deepEqual(freeIn(store.get(), "S2"), []);
});

test("a tree is known by its text: from the library, or since it was drawn here", () => {
  const store = createStore();
  store.change({ type: "opened", study: STUDY });
  assert.equal(treeOf(store.get(), "k | c - b"), null);
  assert.equal(treeOf(store.get(), "constructor"), null);
  store.dispatch({ type: "parted", parts: partsOf(STUDY) });
  const tree = treeOf(store.get(), "k | c - b");
  assert.equal(tree?.kind, "parallel");
  store.dispatch({ type: "planted", text: "k", tree: { kind: "element", name: "k" } });
  store.dispatch({ type: "parted", parts: partsOf(STUDY) });
  assert.equal(treeOf(store.get(), "k | c - b"), tree); // the same, so that nothing is drawn anew
  assert.deepEqual(treeOf(store.get(), "k"), { kind: "element", name: "k" });
});

test("the units are asked in which numbers, bounds and values are written, if they are not those of the library",
  () => {
  const store = createStore();
  const elements = { ...STUDY.elements, k: "120 N s/mm", b: "3 N s/m", f: "parrots" };
  store.change({ type: "opened", study: { ...STUDY, elements } });
  store.dispatch({ type: "parted", parts: partsOf({ ...STUDY, elements }) });
  store.change({ type: "valued", layout: "S1", values: { c: "2 MN s/m" } });
  store.change({ type: "ranged", place: "elements.b", from: "1 lbf s/in", to: "9 N s/m" });
  const keys = unitsIn(store.get(), store.get().history.present).map(({ key }) => key);
  const units = ["N s/mm", "kN s/m", "MN s/m", "lbf s/in"].map((unit) => `${unit} in N s/m`);
  assert.deepEqual(keys.toSorted(), units.toSorted());
});

test("what is made free gets a method that chooses it, and keeps one that is there", () => {
  const bounds = { from: "1 kg", to: "2 kg" };
  const freed = { type: "freed", place: ["elements", "b"], name: "b", ...bounds, method: "norm" };
  const document = after(empty(), { type: "opened", study: STUDY });
  assert.equal(after(document, freed).study.study.optimise, "norm");
  const chosen = after(document, { type: "placed", place: ["study", "optimise"], value: "other" });
  assert.equal(after(chosen, freed).study.study.optimise, "other");
});

test("limits are put and taken away one by one, and no empty table is left", () => {
  const draw = random(5);
  const places = [
    ["a", "at_most"],
    ["a", "at_least"],
    ["b", "strut", "equal"],
    ["b", "other", "at_most"],
  ];
  /** @type {any} */
  let table;
  const expected = new Map();
  for (let step = 0; step < 200; step += 1) {
    const place = places[Math.floor(draw() * places.length)];
    const value = draw() < 0.5 ? undefined : String(step);
    table = limited(table, place, value);
    if (value === undefined) expected.delete(place.join("."));
    else expected.set(place.join("."), value);
    assert.deepEqual(new Map(textsIn(table)), expected);
    assert.equal(table === undefined, expected.size === 0);
    assert.ok(!JSON.stringify(table ?? 1).includes("{}"));
  }
});

/** The texts in a table, and in the tables in it, by their places. @returns {[string, string][]} */
const textsIn = (/** @type {any} */ table, /** @type {string[]} */ path = []) =>
  Object.entries(table ?? {}).flatMap(([key, inside]) =>
    typeof inside === "string" ? [[[...path, key].join("."), inside]] : textsIn(inside, [...path, key]),
  );

test("a slider of what is negative keeps the sign, and the ends of its scale", () => {
  for (const [lower, upper] of [
    [-1, -100],
    [2, 50],
  ]) {
    assert.equal(positionOf(lower, lower, upper), 0);
    assert.equal(positionOf(upper, lower, upper), STEPS);
    for (let position = 0; position <= STEPS; position += 40)
      assert.equal(positionOf(valueAt(position, lower, upper), lower, upper), position);
  }
});

test("a value has as many places as its error tells", () => {
  const written = [
    [2.50911, 0.00047],
    [503.88, 0.0883],
    [16.0237, 0.0137],
    [-0.29, 0.0071],
    [6.6506e-5, 2.1e-9],
    [1.2e7, 3e5],
    [0, 0.02],
    [4, 30],
  ];
  const expected = [
    "2.5091 ± 0.0005",
    "503.88 ± 0.09",
    "16.024 ± 0.014",
    "−0.290 ± 0.007",
    "6.6506 × 10⁻⁵ ± 0.0002 × 10⁻⁵",
    "1.20 × 10⁷ ± 0.03 × 10⁷",
    "0.00 ± 0.02",
    "4 ± 30",
  ];
  assert.deepEqual(
    written.map(([value, error]) => withError(value, error).join(" ± ")),
    expected,
  );
});

test("a value has no more places than its error bound leaves", () => {
  assert.equal(withError(2.50911, 0.00047, 3).join(" ± "), "2.5091 ± 0.0005");
  assert.equal(withError(16.0237, 0.0137, 2).join(" ± "), "16.02 ± 0.01");
  assert.equal(withError(1.2e7, 1.3e5, -6).join(" ± "), "1.20 × 10⁷ ± 0.01 × 10⁷");
  const written = [
    [2.50911, 2],
    [503.88, -1],
    [6.6506e-5, 7],
    [-0.29, 6],
    [1.068, 4],
    [0, 2],
    [4.5, null],
    [null, 2],
  ];
  assert.deepEqual(
    written.map(([value, places]) => toPlaces(value, places)),
    ["2.51", "500", "6.65 × 10⁻⁵", "−0.29000", "1.0680", "0", "4.5", "–"],
  );
});

test("what is compared stands first beside what it is compared with, and goes with its layout", () => {
  const store = createStore();
  store.change({ type: "opened", study: STUDY });
  store.change({ type: "designKept", name: "mine" });
  const compared = ["layout S1", "layout S2", "kept mine", "layout S9"];
  store.dispatch({ type: "viewed", view: { tab: "compare", compared } });
  const keys = () => comparedOf(store.get()).map(({ key }) => key);
  assert.deepEqual(keys(), ["layout S1", "layout S2", "kept mine"]);
  store.dispatch({ type: "viewed", view: { against: "kept mine" } });
  assert.deepEqual(keys(), ["kept mine", "layout S1", "layout S2"]);
  const { designs } = questions(store.get()).find(({ panel }) => panel === "compare")?.body;
  assert.deepEqual(
    designs.map((/** @type {any} */ { study }) => study !== undefined),
    [true, false, false],
  );
  store.change({ type: "designRemoved", name: "mine" });
  assert.deepEqual(keys(), ["layout S1", "layout S2"]);
  store.dispatch({ type: "viewed", view: { compared: [] } });
  assert.deepEqual(keys(), []); // the last one was taken out
  store.dispatch({ type: "viewed", view: { compared: ["layout S9"] } });
  store.change({ type: "selected", layout: "S2" });
  assert.deepEqual(keys(), ["layout S1", "layout S2"]);
  store.change({ type: "selected", layout: "S1" });
  assert.deepEqual(keys(), ["layout S1", "layout S2"]);
});

test("methods are told apart by their rows, whatever they are called", () => {
  const row = (/** @type {string} */ name, /** @type {any} */ sees, searches = true) => ({
    name,
    sees,
    searches,
    averages: false,
  });
  const state = {
    ...initial(),
    about: { ...ABOUT, methods: [row("first", "both"), row("looks on", "neither", false), row("quick", "neither")] },
  };
  const judged = (/** @type {string} */ method) => judging({ ...state, view: { ...state.view, method } })?.name;
  assert.deepEqual(
    [quickMethod(state)?.name, judged(""), judged("first"), judged("of another version")],
    ["quick", "quick", "first", "quick"],
  );
  assert.equal(quickMethod(initial()), undefined);
});

test("a unit stands in brackets as a person writes it, and a ratio has none", () => {
  assert.equal(withUnit("ride comfort", "m/s^2"), "ride comfort [m/s²]");
  assert.equal(withUnit("roughness", "m^3/cycle"), "roughness [m³/cycle]");
  assert.equal(withUnit("load coefficient", ""), "load coefficient");
});

test("a network of a search replaces that of its layout, and no element of another one", () => {
  const study = { ...STUDY, elements: { ...STUDY.elements, any: { network: 3 } },
    layouts: { ...STUDY.layouts, S9: "k | any" } };
  const found = { layout: "S9", index: "J1", free_networks: ["any"] };
  const row = (/** @type {string} */ name) =>
    ({ network: name, entry: `k | ${name}`, elements: { [name]: "9 N s/m" }, values: { c: "8 N s/m" }, status: "ok" });
  const store = createStore();
  assert.match(takeNetwork(store, found, row("c1")), /nothing was changed/);
  store.change({ type: "opened", study });
  store.dispatch({ type: "parted", parts: partsOf(study) });
  assert.match(takeNetwork(store, found, row("c")), /nothing was changed/); // it is in S1 and S2
  assert.equal(store.get().history.present.study, study);
  store.change({ type: "selected", layout: "S1" });
  assert.doesNotMatch(takeNetwork(store, found, row("c1")), /nothing/);
  const { present } = store.get().history;
  assert.equal(textOf(present), "k | c1");
  assert.deepEqual([present.layout, present.study.elements.c1, present.values.S9], ["S9", "9 N s/m", { c: "8 N s/m" }]);
  assert.match(takeNetwork(store, found, { ...row("c2"), status: "failed" }), /^Unreliable/);
  store.dispatch({ type: "undone" });
  assert.equal(textOf(store.get().history.present), "k | c1");
});

test("a message about a file that was opened again stays as long as the first one did", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const store = createStore();
  const read = { study: STUDY, kind: "run", problems: [] };
  const api = /** @type {any} */ ({ post: async () => read });
  const openIt = () => openFiles(store, api, [/** @type {any} */ ({ name: "car.toml", text: async () => "" })]);
  const isTold = () => store.get().messages.some(({ text }) => text === "car.toml is open.");
  await openIt();
  context.mock.timers.tick(19_000);
  assert.ok(isTold());
  await openIt();
  context.mock.timers.tick(2_000);
  assert.ok(isTold());
  context.mock.timers.tick(19_000);
  assert.ok(!isTold());
});

test("a number without a unit has the unit that stands there, and a name the value that the library gives it", () => {
  const classes = { A: "16e-6 m^3", C: "256e-6 m^3" };
  for (const [typed, before, text] of [
    ["40", "25 kg", "40 kg"],
    ["40 lb", "25 kg", "40 lb"],
    ["-2e3", "3 kN", "-2e3 kN"],
    ["0.3", "0.5", "0.3"],
    ["fast", "25 m/s", "fast"],
  ]) {
    assert.equal(completed(typed, before), text);
    assert.equal(completed(typed, before, classes), text);
  }
  assert.equal(completed("C", "25 kg"), "C");
  assert.equal(completed("c", "5e-7 m^3/cycle", classes), "256e-6 m^3");
  assert.equal(completed("class A", "16e-6 m^3/rad", classes), "16e-6 m^3");
  assert.equal(completed("Very poor", "5e-7 m^3/cycle", { ...classes, "very poor": "4096e-6 m^3" }), "4096e-6 m^3");
  assert.equal(completed("I", "5e-7 m^3/cycle", classes), "I");
});

test("values are stale while the library says that another problem is asked than they solve", () => {
  const study = { ...STUDY, study: { ...STUDY.study, indices: ["J1", "J3"] } };
  const optimum = (/** @type {string[]} */ ...problems) => ({ problems, values: { c: "3 kN s/m" } });
  const opened = { ...initial(), about: { ...ABOUT, indices: [] } };
  /** @param {any} state @param {{[layout: string]: string}} digests what the library says that is asked */
  const decided = (state, digests) => {
    const rows = Object.entries(digests).map(([layout, problem_digest]) => ({ layout, problem_digest }));
    const question = questions(state).find(({ panel }) => panel === "decision")?.key ?? "";
    return reduce(state, { type: "answered", panel: "decision", question, value: { rows } });
  };
  const changed = (/** @type {any} */ state, /** @type {any[]} */ ...changes) =>
    changes.reduce((now, change) => reduce(now, { type: "changed", change }), state);
  const optima = { S1: optimum("a"), S2: optimum("b", "c") }; // S2 is a point of a front
  const state = changed(opened, { type: "opened", study }, { type: "optimised", optima });
  assert.deepEqual(staleLayouts(state), []); // nothing is known yet
  assert.deepEqual(staleLayouts(decided(state, { S1: "a", S2: "c" })), []);
  assert.deepEqual(bestOf(decided(state, { S1: "a", S2: "c" }), "S1"), { c: "3 kN s/m" });
  const other = decided(state, { S1: "d", S2: "d" });
  assert.deepEqual([staleLayouts(other), bestOf(other, "S1")], [["S1", "S2"], {}]);
  assert.deepEqual(staleLayouts(decided(state, { S1: "", S2: "b" })), []); // nothing of S1 may vary
  const document = documentFrom(JSON.parse(JSON.stringify(state.history.present)));
  const restored = changed(opened, { type: "restored", document });
  assert.deepEqual(staleLayouts(decided(restored, { S1: "d", S2: "b" })), ["S1"]);
  const renamed = changed(state, { type: "selected", layout: "S1" }, { type: "layoutRenamed", name: "first" });
  assert.deepEqual(staleLayouts(decided(renamed, { first: "d", S2: "b" })), ["first"]);
  const undone = reduce(state, { type: "undone" });
  assert.deepEqual(staleLayouts(decided(undone, { S1: "d", S2: "d" })), []); // no optimum is there
  const odd = documentFrom({ study, optima: { S1: null, S2: { problems: "b" } } });
  assert.deepEqual(odd?.optima, {});
});
