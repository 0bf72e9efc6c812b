import assert from "node:assert/strict";
import { test } from "node:test";
import { after, empty, namesIn, textOf } from "../src/state/document.js";
import { positionOf, quantity, shown, takenApart, valueAt, STEPS, brief, estimated, placed, withUnit } from "../src/state/scale.js";
import { createStore, initial, reduce } from "../src/state/store.js";
import { limited, limitsIn } from "../src/panels/asked.js";
import { judging, quickMethod } from "../src/methods.js";
import { comparedOf, namesOfVehicle, numbersOf, questions } from "../src/questions.js";

const STUDY = {
  title: "car",
  vehicle: { model: "quarter-car", sprung_mass: "180 kg" },
  road: { speed: "25 m/s" },
  elements: { k: "120 kN/m", c: { from: "100 N s/m", to: "100 kN s/m" }, b: "300 kg" },
  layouts: { S1: "k | c", S2: "k | c - b" },
  study: { indices: ["J1"], baseline: "S1", budgets: ["b"], sweep: { k: { from: "10 kN/m", to: "20 kN/m", points: 3 } } },
};
const ABOUT = { vehicles: [{ key: "quarter-car", fields: [{ key: "sprung_mass", unit: "kg" }], mounts: ["strut"] }], road: [{ key: "speed", unit: "m/s" }], elements: [] };

/** Changes of every kind, to be drawn from. */
const CHANGES = [
  { type: "opened", study: STUDY },
  { type: "placed", place: ["vehicle", "sprung_mass"], value: "200 kg" },
  { type: "placed", place: ["title"], value: undefined },
  { type: "valued", layout: "S1", values: { c: "3 kN s/m" } },
  { type: "valuedAll", values: { S1: { c: "3 kN s/m" }, S2: { c: "7 kN s/m" } } },
  { type: "ranged", place: "elements.k", from: "1 kN/m", to: "1 MN/m" },
  { type: "freed", place: ["elements", "b"], from: "1 kg", to: "2000 kg" },
  { type: "fixed", place: ["elements", "c"], text: "4 kN s/m" },
  { type: "drawn", text: "k | c | b" },
  { type: "drawn", text: "k | ", added: { f: "10 N" } },
  { type: "selected", layout: "S1" },
  { type: "layoutAdded", name: "S3" },
  { type: "layoutRenamed", name: "other" },
  { type: "layoutRemoved" },
  { type: "strutsParted", struts: ["front", "rear"] },
  { type: "strutsJoined" },
  { type: "elementRenamed", old: "c", name: "damper" },
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
    assert.deepEqual(JSON.parse(JSON.stringify(document)), JSON.parse(JSON.stringify(after(document, { type: "restored", document }))));
  }
});

test("the drag of a slider is one step, two drags are two", () => {
  const store = createStore();
  store.change({ type: "opened", study: STUDY });
  for (let drag = 0; drag < 2; drag += 1) {
    for (let i = 1; i <= 60; i += 1) store.change({ type: "placed", place: ["elements", "k"], value: `${100 * drag + i} kN/m` }, "slide elements.k");
    store.dispatch({ type: "rested" });
  }
  assert.equal(store.get().history.past.length, 3);
  store.dispatch({ type: "undone" });
  assert.equal(store.get().history.present.study.elements.k, "60 kN/m");
});

test("a name is changed wherever the study has it", () => {
  const { study, values } = after(after(open(), { type: "valued", layout: "S2", values: { c: "1 N s/m" } }), { type: "elementRenamed", old: "c", name: "d" });
  assert.deepEqual(study.layouts, { S1: "k | d", S2: "k | d - b" });
  assert.deepEqual(Object.keys(study.elements), ["k", "d", "b"]);
  assert.deepEqual(values, { S2: { d: "1 N s/m" } });
  const swept = after(after(open(), { type: "elementRenamed", old: "k", name: "spring" }), { type: "elementRenamed", old: "b", name: "wheel" }).study.study;
  assert.deepEqual([Object.keys(swept.sweep), swept.budgets], [["spring"], ["wheel"]]);
});

test("what is freed begins at its value in every layout, and what is fixed keeps its bounds for later", () => {
  const freed = after(open(), { type: "freed", place: ["elements", "b"], from: "1 kg", to: "2000 kg" });
  assert.equal(freed.values.S2.b, "300 kg");
  const fixed = after(freed, { type: "fixed", place: ["elements", "b"], text: "400 kg" });
  assert.equal(fixed.study.elements.b, "400 kg");
  assert.deepEqual(fixed.ranges["elements.b"], { from: "1 kg", to: "2000 kg" });
  assert.deepEqual(namesIn(fixed.study, "S2"), ["k", "c", "b"]);
});

test("questions follow from the state alone, and nothing of the page's own goes into a study", () => {
  const store = createStore();
  store.dispatch({ type: "told", about: ABOUT });
  assert.deepEqual(questions(store.get()), []);
  store.change({ type: "opened", study: STUDY });
  store.change({ type: "ranged", place: "elements.k", from: "1 kN/m", to: "1 MN/m" });
  const asked = questions(store.get());
  assert.deepEqual(asked.map(({ panel }) => panel), ["network", "check", "indices", "response", "units"]);
  for (const { body } of asked.slice(1, 4)) assert.deepEqual(body.study, STUDY);
});

test("a slider's places and values undo each other, and cover the range", () => {
  for (const [lower, upper] of [[1, 10], [1e-7, 5], [100, 1e5]]) {
    for (let position = 0; position <= STEPS; position += 1) assert.equal(positionOf(valueAt(position, lower, upper), lower, upper), position);
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
  assert.equal(brief("7544.184883044672 N s/m"), "7544.2 N s/m");
  assert.equal(brief("181.75 kg"), "181.75 kg");
  assert.equal(shown(-6.4525e-5), "−6.4525·10⁻⁵");
  assert.equal(shown(null), "–");
});

test("every number of vehicle and road has a row, whatever table it stands in", () => {
  const study = {
    vehicle: { model: "mechanism", coordinates: { body: "19 t" }, struts: { s: { upper: { body: 1, pitch: "-9.5 m" }, network: "k | c" } } },
    road: { speed: "25 m/s", class: "C", coherence: { wavenumber: "0.2 cycle/m" } },
  };
  const rows = numbersOf(ABOUT, { ...empty(), study });
  const told = Object.fromEntries(rows.map(({ place, unit }) => [place.join("."), unit]));
  assert.deepEqual(told, {
    "vehicle.coordinates.body": "t",
    "vehicle.struts.s.upper.body": "",
    "vehicle.struts.s.upper.pitch": "m",
    "road.speed": "m/s",
    "road.coherence.wavenumber": "cycle/m",
  });
});

test("an element is called otherwise in the networks of a vehicle too", () => {
  const study = { ...STUDY, vehicle: { seat: { mass: "70 kg", network: "k | c" } } };
  const document = after({ ...empty(), study, layout: "S1" }, { type: "elementRenamed", old: "c", name: "damper" });
  assert.deepEqual(document.study.vehicle, { seat: { mass: "70 kg", network: "k | damper" } });
  assert.deepEqual(namesOfVehicle(document.study), ["k", "damper"]);
});

test("what is made free gets a method that chooses it, and keeps one that is there", () => {
  const freed = { type: "freed", place: ["elements", "b"], from: "1 kg", to: "2 kg", method: "norm" };
  const document = after(empty(), { type: "opened", study: STUDY });
  assert.equal(after(document, freed).study.study.optimise, "norm");
  const chosen = after(document, { type: "placed", place: ["study", "optimise"], value: "other" });
  assert.equal(after(chosen, freed).study.study.optimise, "other");
});

test("limits are put and taken away one by one, and no empty table is left", () => {
  const draw = random(5);
  const places = [["a", "at_most"], ["a", "at_least"], ["b", "strut", "equal"], ["b", "other", "at_most"]];
  /** @type {any} */
  let table;
  const expected = new Map();
  for (let step = 0; step < 200; step += 1) {
    const place = places[Math.floor(draw() * places.length)];
    const value = draw() < 0.5 ? undefined : String(step);
    table = limited(table, place, value);
    if (value === undefined) expected.delete(place.join("."));
    else expected.set(place.join("."), value);
    const found = limitsIn(table).map(({ path, sense, value: text }) => [[...path, sense].join("."), text]);
    assert.deepEqual(new Map(found), expected);
    assert.equal(table === undefined, expected.size === 0);
    assert.ok(!JSON.stringify(table ?? 1).includes("{}"));
  }
});

test("a slider of what is negative keeps the sign, and the ends of its scale", () => {
  for (const [lower, upper] of [[-1, -100], [2, 50]]) {
    assert.equal(positionOf(lower, lower, upper), 0);
    assert.equal(positionOf(upper, lower, upper), STEPS);
    for (let position = 0; position <= STEPS; position += 40) assert.equal(positionOf(valueAt(position, lower, upper), lower, upper), position);
  }
});

test("a value has as many places as its error tells", () => {
  const written = [[2.50911, 0.00047], [503.88, 0.0883], [16.0237, 0.0137], [-0.29, 0.0071], [6.6506e-5, 2.1e-9], [1.2e7, 3e5], [0, 0.02], [4, 30]];
  const expected = ["2.5091 ± 0.0005", "503.88 ± 0.09", "16.024 ± 0.014", "−0.290 ± 0.007", "6.6506·10⁻⁵ ± 0.0002·10⁻⁵", "1.20·10⁷ ± 0.03·10⁷", "0.00 ± 0.02", "4 ± 30"];
  assert.deepEqual(written.map(([value, error]) => estimated(value, error).join(" ± ")), expected);
});

test("a value has no more places than its error bound leaves", () => {
  assert.equal(estimated(2.50911, 0.00047, 3).join(" ± "), "2.5091 ± 0.0005");
  assert.equal(estimated(16.0237, 0.0137, 2).join(" ± "), "16.02 ± 0.01");
  assert.equal(estimated(1.2e7, 1.3e5, -6).join(" ± "), "1.20·10⁷ ± 0.01·10⁷");
  const written = [[2.50911, 2], [503.88, -1], [6.6506e-5, 7], [-0.29, 6], [0, 2], [4.5, null], [null, 2]];
  assert.deepEqual(written.map(([value, places]) => placed(value, places)), ["2.51", "500", "6.65·10⁻⁵", "−0.29", "0", "4.5", "–"]);
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
  assert.deepEqual(designs.map((/** @type {any} */ { study }) => study !== undefined), [true, false, false]);
  store.change({ type: "designRemoved", name: "mine" });
  assert.deepEqual(keys(), ["layout S1", "layout S2"]);
});

test("methods are told apart by their rows, whatever they are called", () => {
  const row = (/** @type {string} */ name, /** @type {any} */ sees, searches = true) => ({ name, sees, searches, averages: false });
  const state = { ...initial(), about: { ...ABOUT, methods: [row("first", "both"), row("looks on", "neither", false), row("quick", "neither")] } };
  const judged = (/** @type {string} */ method) => judging({ ...state, view: { ...state.view, method } })?.name;
  assert.deepEqual([quickMethod(state)?.name, judged(""), judged("first"), judged("of another version")], ["quick", "quick", "first", "quick"]);
  assert.equal(quickMethod(initial()), undefined);
});

test("a unit stands in brackets as a person writes it, and a ratio has none", () => {
  assert.equal(withUnit("ride comfort", "m/s^2"), "ride comfort [m/s²]");
  assert.equal(withUnit("roughness", "m^3/cycle"), "roughness [m³/cycle]");
  assert.equal(withUnit("load coefficient", ""), "load coefficient");
});
