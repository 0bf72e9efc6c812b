import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { Refusal } from "../src/api.js";
import { enter, isBeingRead, wronglyTyped } from "../src/entering.js";
import { freeIn, layoutsWith, numbersOf, unchosenIn } from "../src/library.js";
import { choicesOf, designOf, questions } from "../src/questions.js";
import { open } from "../src/remembering.js";
import { after, empty, entryAt, textOf } from "../src/state/document.js";
import { createStore, initial } from "../src/state/store.js";
import { watchFile } from "../src/watching.js";
import { findWork, resume, stop } from "../src/working.js";
import { partsOf } from "./reading.js";

const NAMES = ["constructor", "toString", "valueOf", "hasOwnProperty", "isPrototypeOf", "__proto__"];

/** A study with an element and a layout of this name. @param {string} name @returns {any} */
const studyWith = (name) => JSON.parse(JSON.stringify({
  vehicle: { model: "quarter-car", sprung_mass: "180 kg" },
  elements: { c: "1 kN s/m" },
  layouts: { S1: "c" },
  study: { indices: ["J1"] },
}).replace('"c":"1 kN s/m"', `"c":"1 kN s/m","${name}":{"from":"1 kg","to":"9 kg"}`)
  .replace('"S1":"c"', `"S1":"c","${name}":"c | ${name}"`));

for (const name of NAMES) {
  test(`${name} is a name like any other`, () => {
    const study = studyWith(name);
    let document = after(empty(), { type: "opened", study });
    assert.equal(document.layout, name);
    assert.equal(textOf(document), `c | ${name}`);
    const state = { ...initial(), history: { past: [], present: document, future: [], gesture: null },
      parts: partsOf(study) };
    if (name !== "__proto__") { // which no element can be called
      assert.deepEqual(freeIn(state, name), [name]);
      assert.deepEqual(layoutsWith(state, name), [name]);
      assert.deepEqual(unchosenIn(state, designOf(document)), [name]);
    }
    assert.deepEqual(designOf(document).values, {});
    assert.ok(questions(state).length > 0);
    assert.deepEqual(choicesOf(document).map(({ name: each }) => each), ["S1", name]);
    document = after(document, { type: "valued", layout: name, values: { c: "2 kN s/m" } });
    assert.deepEqual(designOf(document).values, { c: "2 kN s/m" });
    document = after(document, { type: "layoutRenamed", name: "S9" });
    assert.deepEqual(Object.keys(document.study.layouts ?? {}), ["S1", "S9"]);
    assert.deepEqual(designOf(document).values, { c: "2 kN s/m" });
    document = after(after(document, { type: "selected", layout: "S1" }), { type: "layoutRenamed", name });
    assert.deepEqual(Object.keys(document.study.layouts ?? {}), [name, "S9"]);
    assert.equal(entryAt({}, [name]), undefined);
    assert.deepEqual(JSON.parse(JSON.stringify(document)), document);
  });
}

const OPEN = { type: "opened", study: { ...studyWith("b"), elements: { c: "1 kN s/m", b: "1 kg" } } };
const FIELD = { turn: 1, id: "elements.c", unit: "N s/m", before: "1 kN s/m" };

/** A store with this study, and what is typed into the field of its damper. @param {string} text */
function typedInto(text) {
  const store = createStore();
  store.change(/** @type {any} */ (OPEN));
  enter(store, FIELD, text, { type: "placed", place: ["elements", "c"], value: text });
  return store;
}

/** @param {any} store */
const damper = (store) => entryAt(store.get().history.present.study, ["elements", "c"]);

/** @param {any} store */
const asked = (store) => questions(store.get()).find(({ panel }) => panel === "typed elements.c");

for (const text of ["2 kN s/m", "300 N s/m"]) {
  test(`${text} is taken over at once`, () => {
    const store = typedInto(text);
    assert.equal(damper(store), text);
    assert.equal(asked(store), undefined);
  });
}

for (const text of ["5 kg", "12 furlong", "much", "7", "9 lbf s/ft"]) {
  test(`${text} is read by the library before it is taken over`, () => {
    const store = typedInto(text);
    assert.equal(damper(store), FIELD.before);
    assert.ok(isBeingRead(store.get(), FIELD.id));
    assert.deepEqual(asked(store)?.body, { text, unit: FIELD.unit });
    store.dispatch(/** @type {any} */ (asked(store)?.learnt?.({ sentence: "It is none." })));
    assert.equal(damper(store), FIELD.before);
    assert.equal(wronglyTyped(store.get(), FIELD.id), "It is none.");
    assert.equal(asked(store), undefined);
    enter(store, FIELD, "3 kN s/m", { type: "placed", place: ["elements", "c"], value: "3 kN s/m" });
    assert.equal(wronglyTyped(store.get(), FIELD.id), "");
  });

  test(`${text} is taken over once the library knows it`, () => {
    const store = typedInto(text);
    store.dispatch(/** @type {any} */ (asked(store)?.learnt?.({ value: 3 })));
    assert.equal(damper(store), text);
    assert.equal(numbersOf(store.get()).length, 0);
    assert.ok(!isBeingRead(store.get(), FIELD.id));
    store.dispatch({ type: "undone" });
    assert.equal(damper(store), FIELD.before);
  });
}

const MASS = { turn: 1, id: "elements.b", unit: "kg", before: "1 kg" };

/** What is typed into the field of the inerter. @param {any} store @param {string} text */
const typeMass = (store, text) => enter(store, MASS, text, { type: "placed", place: ["elements", "b"], value: text });

/** The library knows all that was typed, what was typed last first. @param {any} store */
function readAll(store) {
  for (const { path, learnt } of questions(store.get()).reverse()) {
    if (path === "quantity" && learnt) store.dispatch(/** @type {any} */ (learnt({ value: 3 })));
  }
}

for (const mass of ["5 kg", "5 lb"]) {
  test(`what is being read is not lost where ${mass} is typed into another field`, () => {
    const store = typedInto("9 lbf s/ft");
    typeMass(store, mass);
    store.change({ type: "selected", layout: "S2" });
    readAll(store);
    assert.deepEqual(store.get().history.present.study.elements, { c: "9 lbf s/ft", b: mass });
  });
}

test("what is typed next into the same field is the one that counts", () => {
  for (const next of ["2 kN s/m", "8 lbf s/ft"]) {
    const store = typedInto("9 lbf s/ft");
    enter(store, FIELD, next, { type: "placed", place: ["elements", "c"], value: next });
    readAll(store);
    assert.equal(damper(store), next);
  }
});

test("what is being read is undone first", () => {
  const store = typedInto("2 kN s/m");
  typeMass(store, "5 lb");
  store.dispatch({ type: "undone" });
  readAll(store);
  assert.deepEqual(store.get().history.present.study.elements, { c: "2 kN s/m", b: "1 kg" });
  store.dispatch({ type: "undone" });
  assert.equal(damper(store), FIELD.before);
});

test("what was typed for a study is not taken over into another one that came meanwhile", () => {
  const store = createStore();
  store.change(/** @type {any} */ (OPEN));
  store.change(/** @type {any} */ (OPEN));
  enter(store, FIELD, "2 kN s/m", { type: "placed", place: ["elements", "c"], value: "2 kN s/m" });
  assert.equal(damper(store), FIELD.before);
  enter(store, { ...FIELD, turn: 2 }, "2 kN s/m", { type: "placed", place: ["elements", "c"], value: "2 kN s/m" });
  assert.equal(damper(store), "2 kN s/m");
});

test("a layout called like a number does not become the baseline", () => {
  const opened = after(empty(), { type: "opened", study: studyWith("S2") });
  const added = after(opened, { type: "layoutAdded", name: "10" });
  assert.equal(Object.keys(added.study.layouts ?? {})[0], "10"); // as objects have it
  assert.equal(added.study.study?.baseline, "S1");
  const renamed = after(after(opened, { type: "selected", layout: "S1" }), { type: "layoutRenamed", name: "7" });
  assert.equal(renamed.study.study?.baseline, "7");
  assert.equal(after(opened, { type: "layoutAdded", name: "S3" }).study.study?.baseline, undefined);
});

for (const [what, act] of /** @type {[string, (store: any, api: any) => Promise<void>][]} */ ([
  ["stopped", (store, api) => stop(store, api, "gone")],
  ["resumed", (store, api) => resume(store, api, "gone")],
  ["looked at", (store, api) => findWork(store, api)],
])) {
  test(`work that the server has no more goes from the page where it is ${what}`, async () => {
    const store = createStore();
    store.dispatch({ type: "worked", job: /** @type {any} */ ({ id: "gone", kind: "sweep", state: "done" }) });
    const refused = async () => { throw new Refusal(404, { sentence: "Unknown work." }); };
    const list = { work: [{ id: "gone", kind: "sweep", state: "done" }] }; // of before it was forgotten
    await act(store, { remove: refused, post: refused, get: (/** @type {string} */ path) =>
      (path === "work" ? Promise.resolve(list) : refused()) });
    assert.deepEqual(store.get().work, {});
  });
}

test("a look at the work brings back nothing that was forgotten meanwhile, and drops nothing that began", async () => {
  const store = createStore();
  const job = (/** @type {string} */ id, state = "stopped") => /** @type {any} */ ({ id, kind: "sweep", state });
  store.dispatch({ type: "worked", job: job("forgotten") });
  await findWork(store, /** @type {any} */ ({ get: async (/** @type {string} */ path) => {
    if (path === "work/done/result") return store.dispatch({ type: "dropped", id: "done" }); // just as its result came
    store.dispatch({ type: "dropped", id: "forgotten" });
    store.dispatch({ type: "worked", job: job("begun") });
    return { work: [job("forgotten"), job("done", "done"), job("other")] };
  } }));
  assert.deepEqual(Object.keys(store.get().work), ["begun", "other"]);
});

test("the file of the command line is looked at once at a time, so that no late look tells what was before", async () => {
  const { addEventListener: listen, setInterval: repeat } = globalThis;
  /** @type {() => void} */
  let look = () => assert.fail("nothing listens");
  /** @type {{path: string, tell: (answer: any) => void}[]} */
  const asked = [];
  const get = (/** @type {string} */ path) => new Promise((tell) => asked.push({ path, tell }));
  const store = createStore({ ...initial(), connection: "ready" });
  Object.assign(globalThis, { document: { hidden: false }, setInterval: () => 0,
    addEventListener: (/** @type {string} */ _, /** @type {() => void} */ act) => (look = act) });
  try {
    watchFile(store, /** @type {any} */ ({ get }), "before");
    look();
    look();
    assert.deepEqual(asked.map(({ path }) => path), ["start/stamp"]);
    asked[0].tell({ name: "car.toml", stamp: "before" });
    await new Promise((done) => setTimeout(done));
    look();
    assert.equal(asked.length, 2);
  } finally {
    Object.assign(globalThis, { addEventListener: listen, setInterval: repeat });
    delete (/** @type {any} */ (globalThis).document);
  }
});

test("that a file is open is told for a while", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  try {
    const store = createStore();
    const read = { study: studyWith("b"), kind: "run", problems: [] };
    const api = /** @type {any} */ ({ post: async (/** @type {string} */ path) => (path === "study/read" ? read : {}) });
    await open(store, api, [new File([""], "car.toml")]);
    assert.deepEqual(store.get().messages.map(({ text }) => text), ["car.toml is open."]);
    mock.timers.tick(60_000);
    assert.deepEqual(store.get().messages, []);
  } finally {
    mock.timers.reset();
  }
});
