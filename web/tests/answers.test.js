import assert from "node:assert/strict";
import { test } from "node:test";
import { unchosenIn } from "../src/library.js";
import { answerOf, questions, soughtAnswer, soughtOf } from "../src/questions.js";
import { TAKEN, initial, messagesOf, reduce, toldOfValues } from "../src/state/store.js";
import { doubted, doubtsIn } from "../src/parts/doubts.js";
import { takeFitted, takeOptima, withSpeeds } from "../src/working.js";
import { indexAxis, indexName, indexWords, ownIndex, percentChange } from "../src/panels/answers.js";
import { createStore } from "../src/state/store.js";
import { keepAsking } from "../src/asking.js";
import { partsOf } from "./reading.js";

const study = (/** @type {any} */ { title, k = "120 kN/m", strut = "k | c", model = "quarter-car" }) => ({
  title,
  vehicle: { model, sprung_mass: "180 kg" },
  elements: { k, c: { from: "100 N s/m", to: "100 kN s/m" }, b: "300 kg" },
  layouts: { S1: "k | c | b", S2: strut },
  study: { indices: ["J1"], baseline: "S1", optimise: "norm" },
});
const ABOUT = {
  vehicles: [{ key: "quarter-car", fields: [], mounts: ["strut"] }],
  road: [],
  elements: [],
  methods: [{ name: "norm", sees: "neither", searches: true, averages: false }],
};
const PANELS = ["parts", "check", "decision", "response"];

/** A generator of numbers in [0, 1) from a seed (mulberry32). */
function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

const opened = (/** @type {any} */ which) =>
  reduce(
    { ...initial(), about: ABOUT },
    { type: "changed", change: { type: "opened", study: study(which) }, gesture: null },
  );
const keyOf = (/** @type {any} */ state, /** @type {string} */ panel) =>
  questions(state).find((question) => question.panel === panel)?.key ?? null;
const change = (/** @type {any} */ state, /** @type {any} */ of) =>
  reduce(state, { type: "changed", change: of, gesture: null });
const ask = (/** @type {any} */ state, /** @type {string} */ panel) =>
  reduce(state, { type: "asked", panel, question: keyOf(state, panel) });
const tell = (/** @type {any} */ state, /** @type {string} */ panel, /** @type {any} */ question) =>
  reduce(state, { type: "answered", panel, question, value: { to: question } });

test("whatever is opened, changed, undone and answered, no panel shows the answer to another question", () => {
  const titles = ["seat", "train"];
  for (let seed = 0; seed < 150; seed += 1) {
    const draw = random(seed);
    let state = opened({ title: "seat" });
    /** @type {{panel: string, question: any, title: string}[]} */
    let underWay = [];
    for (let step = 0; step < 40; step += 1) {
      const what = Math.floor(8 * draw());
      if (what === 0)
        state = change(state, {
          type: "opened",
          study: study({
            title: titles[Math.floor(2 * draw())],
            strut: ["k | c", "k | c - b"][Math.floor(2 * draw())],
          }),
        });
      if (what === 1)
        state = change(state, {
          type: "placed",
          place: ["elements", "k"],
          value: `${1 + Math.floor(5 * draw())} kN/m`,
        });
      if (what === 2) state = change(state, { type: "drawn", text: ["", "k", "k | c - b"][Math.floor(3 * draw())] });
      if (what === 3) state = change(state, { type: "selected", layout: ["S1", "S2"][Math.floor(2 * draw())] });
      if (what === 4) state = reduce(state, { type: draw() < 0.7 ? "undone" : "redone" });
      for (const panel of PANELS) {
        if (draw() < 0.5 || underWay.some((each) => each.panel === panel)) continue;
        state = ask(state, panel);
        underWay.push({ panel, question: keyOf(state, panel), title: state.history.present.study.title });
      }
      const ready = underWay.filter(() => draw() < 0.4);
      underWay = underWay.filter((each) => !ready.includes(each));
      for (const { panel, question } of ready)
        state =
          draw() < 0.8
            ? tell(state, panel, question)
            : reduce(state, { type: "refused", panel, question, sentence: `no: ${question}` });
      for (const panel of PANELS) {
        const shown = answerOf(state, panel);
        const question = keyOf(state, panel);
        if (shown.is === "current") assert.equal(shown.value.to, question);
        if (shown.sentence !== null) assert.equal(shown.sentence, `no: ${question}`);
        if (shown.value === null || shown.is === "current") continue;
        assert.ok(shown.before && shown.is === "coming");
        const [mine, other] = [question, shown.value.to].map((each) => JSON.parse(each));
        // a step of a slider of the same study and network
        assert.equal(JSON.stringify(mine.study?.title), JSON.stringify(other.study?.title));
        assert.deepEqual(mine.study?.layouts, other.study?.layouts);
        assert.deepEqual(
          mine.designs?.map((/** @type {any} */ { layout }) => layout),
          other.designs?.map((/** @type {any} */ { layout }) => layout),
        );
      }
    }
  }
});

test("an answer is current, coming, or none, and says so at once", () => {
  let state = ask(opened({ title: "seat" }), "decision");
  const first = keyOf(state, "decision");
  assert.deepEqual(answerOf(state, "decision"), { is: "coming", value: null, sentence: null, before: false });
  state = tell(state, "decision", first);
  assert.equal(answerOf(state, "decision").is, "current");
  state = change(state, { type: "placed", place: ["elements", "k"], value: "7 kN/m" });
  assert.deepEqual(answerOf(state, "decision"), { is: "coming", value: { to: first }, sentence: null, before: true });
  const cleared = change(state, { type: "drawn", text: "" });
  assert.deepEqual(answerOf(cleared, "decision"), { is: "coming", value: null, sentence: null, before: false });
  const question = keyOf(cleared, "decision");
  const refused = reduce(reduce(cleared, { type: "asked", panel: "decision", question }), {
    type: "refused",
    panel: "decision",
    question,
    sentence: "no network",
  });
  assert.deepEqual(answerOf(refused, "decision"), { is: "none", value: null, sentence: "no network", before: false });
  // it was asked before
  assert.equal(answerOf(reduce(reduce(refused, { type: "undone" }), { type: "undone" }), "decision").value.to, first);
});

test("a copy of a study with other numbers is another study", () => {
  let state = ask(opened({ title: "same", k: "1 kN/m" }), "decision");
  state = tell(state, "decision", keyOf(state, "decision"));
  state = change(state, { type: "opened", study: study({ title: "same", k: "2 kN/m" }) });
  assert.deepEqual(answerOf(state, "decision"), { is: "coming", value: null, sentence: null, before: false });
});

test("an answer that comes when another study is open is not of that, and is there when the first is opened again",
  () => {
  let state = ask(opened({ title: "seat" }), "decision");
  const late = keyOf(state, "decision");
  state = change(state, { type: "opened", study: study({ title: "train" }) });
  state = tell(state, "decision", late);
  assert.deepEqual(answerOf(state, "decision"), { is: "coming", value: null, sentence: null, before: false });
  state = reduce(state, { type: "undone" });
  assert.equal(answerOf(state, "decision").value.to, late);
});

test("what a button asked is told of the design that it was asked of, and of no other", () => {
  for (const [panel, parameters] of Object.entries({
    budget: { index: "J1", parameter: "c" },
    tolerance: { index: "J1", spread: { c: 0.1 } },
  })) {
    let state = change(opened({ title: "seat" }), { type: "valued", layout: "S2", values: { c: "3 kN s/m" } });
    assert.equal(soughtAnswer(state, panel).is, "none");
    state = reduce(state, { type: "sought", panel, parameters });
    const question = soughtOf(state, panel)?.key;
    state = reduce(state, { type: "asked", panel, question: String(question) });
    assert.equal(soughtAnswer(state, panel).is, "coming");
    const moved = change(state, { type: "valued", layout: "S2", values: { c: "4 kN s/m" } });
    assert.equal(soughtAnswer(moved, panel).is, "none");
    const told = reduce(moved, { type: "answered", panel, question: String(question), value: 1 });
    assert.deepEqual(soughtAnswer(told, panel), { is: "none", value: null, sentence: null, before: false });
    assert.equal(soughtAnswer(reduce(told, { type: "undone" }), panel).value, 1);
    assert.equal(soughtAnswer(change(told, { type: "opened", study: study({ title: "train" }) }), panel).value, null);
  }
});

test("messages stand below each other; one about the same replaces the one before, and another study has none of them",
  () => {
  let state = opened({ title: "seat" });
  for (const [text, about] of [
    ["press Optimise", undefined],
    ["Reading a.csv", "a.csv"],
    ["a.csv was read", "a.csv"],
    ["press Optimise", undefined],
  ])
    state = reduce(state, { type: "said", text: String(text), about });
  assert.deepEqual(
    state.messages.map(({ text }) => text),
    ["a.csv was read", "press Optimise"],
  );
  assert.deepEqual(
    reduce(state, { type: "closed", about: "a.csv" }).messages.map(({ text }) => text),
    ["press Optimise"],
  );
  assert.deepEqual(change(state, { type: "placed", place: ["title"], value: "x" }).messages, state.messages);
  assert.deepEqual(change(state, { type: "opened", study: study({ title: "train" }) }).messages, []);
  assert.deepEqual(reduce(state, { type: "undone" }).messages, []);
});

test("what is free is unchosen until it has a value, in each layout by itself", () => {
  const state = opened({ title: "seat" });
  const unchosen = (/** @type {any} */ of, /** @type {any} */ values) => {
    const parted = reduce(of, { type: "parted", parts: partsOf(of.history.present.study) });
    return unchosenIn(parted, { layout: "S2", values });
  };
  assert.deepEqual(unchosenIn(state, { layout: "S2", values: {} }), []); // the library has not said yet
  assert.deepEqual(unchosen(state, {}), ["c"]);
  assert.deepEqual(unchosen(state, { c: "1 N s/m" }), []);
  const sprung = { type: "freed", place: ["vehicle", "sprung_mass"], name: "sprung_mass", from: "1 kg", to: "2 kg" };
  assert.deepEqual(unchosen(change(state, sprung), {}), ["c", "sprung_mass"]);
});

test("a doubt is told once for all that it is about, and before anything else", () => {
  const members = [
    { of: "J1 of S1", status: "inaccurate", message: "friction is large" },
    { of: "J3 of S1", status: "ok" },
    { of: "J3 of S2", status: "inaccurate: friction is large" },
  ];
  assert.deepEqual(doubtsIn(members), ["J1 of S1, J3 of S2: inaccurate: friction is large"]);
  assert.equal(
    doubted([{ of: "the budget", status: "failed", message: "" }]),
    "Unreliable: the budget: failed. ",
  );
  assert.equal(doubted([members[1]]), "");
});

test("only what is given is handed on: no withheld device, no values of another study", async () => {
  const store = createStore();
  store.change({ type: "opened", study: study({ title: "seat" }) });
  store.dispatch({ type: "parted", parts: partsOf(store.get().history.present.study) });
  const before = store.get().history.present;
  const fit = {
    status: "inaccurate: the model leaves 13 times",
    parameters: { b: { value: null, interval: [null, null] } },
  };
  const device = { elements: { b2: "123 kg" }, layouts: { device: "b2" } };
  // what explains the misfit says of it
  const known = { ...fit, parameters: { b: { value: null, interval: [113, 122] } } };
  /** @type {any} */
  const api = {
    post: async (/** @type {string} */ path, /** @type {any} */ body) => ({ elements: body.device.elements,
      struts: [{ words: "in parallel", network: `${body.network} | ${body.device.layouts.device}` }] }),
  };
  const refused = /^Unreliable: .*leaves 13 times\. There is no device to take: the fit withholds b\.$/;
  for (const each of [fit, known]) assert.match(await takeFitted(store, api, each, device), refused);
  assert.equal(store.get().history.present, before);
  assert.match(
    takeOptima(store, [{ layout: "S9", index: "J1", texts: { c: "1 N s/m" }, status: "ok" }]),
    /nothing was changed/,
  );
  assert.match(
    takeOptima(store, [{ layout: "S2", index: "J1", texts: { f: "1 N" }, status: "ok" }]),
    /nothing was changed/,
  );
  assert.equal(store.get().history.present, before);
  const optimum = { layout: "S2", index: "J1", texts: { c: "1 N s/m" } };
  const broken = { ...optimum, status: { norm: "infeasible" }, message: "a limit is broken" };
  const said = /^Unreliable: J1 of S2: infeasible: a limit is broken\. The values of S2 are the best found for J1\.$/;
  assert.match(takeOptima(store, [broken]), said);
  const given = { status: "ok", parameters: { b: { value: 123, interval: [120, 125] } } };
  assert.match(await takeFitted(store, api, given, device), /^The device is in the new layout/);
  assert.equal(store.get().history.present.study.layouts?.S3, "k | c | b2");
});

test("what optima become at other speeds stands before them where it is doubtful", () => {
  assert.equal(
    withSpeeds("The values of S2 are the best found for J1.", { doubts: ["Not certain away from 90 km/h: x."], others: ["Also y."] }),
    "Not certain away from 90 km/h: x. The values of S2 are the best found for J1. Also y.",
  );
  assert.equal(withSpeeds("The values of S2 are the best found for J1.", undefined), "The values of S2 are the best found for J1.");
});

test("the parts are those of the study that is open, also of one whose answer is still kept", async () => {
  const store = createStore({ ...initial(), about: ABOUT, connection: "ready" });
  /** @type {any} */
  const api = { post: async (/** @type {string} */ path, /** @type {any} */ body) =>
    (path === "study/parts" ? partsOf(body.study) : {}) };
  keepAsking(store, api, "test");
  const [first, second] = [study({ title: "one" }), { ...study({ title: "two" }), layouts: { only: "k" } }];
  for (const each of [first, second, first]) {
    store.change({ type: "opened", study: each });
    await new Promise((done) => setTimeout(done));
    assert.deepEqual(Object.keys(store.get().parts?.layouts ?? {}), Object.keys(each.layouts));
  }
});

test("a drag leaves no timers behind: one for each panel that waits until it rests", async () => {
  const store = createStore({ ...initial(), about: ABOUT, connection: "ready" });
  /** @type {any} */
  const api = { post: async (/** @type {string} */ path, /** @type {any} */ body) =>
    (path === "study/parts" ? partsOf(body.study) : {}) };
  store.change({ type: "opened", study: study({}) });
  keepAsking(store, api, "test");
  await new Promise((done) => setTimeout(done, 5));
  const own = globalThis.setTimeout;
  let timers = 0;
  const begun = Date.now();
  /** @type {any} */ (globalThis).setTimeout = (/** @type {any} */ act, /** @type {number} */ after) => {
    timers += after > 100 ? 1 : 0;
    return own(act, after);
  };
  try {
    for (let step = 0; step < 50; step += 1) {
      store.change({ type: "placed", place: ["elements", "k"], value: `${100 + step} kN/m` }, "drag");
      await new Promise((done) => own(done));
    }
  } finally {
    globalThis.setTimeout = own;
  }
  const rests = 1 + Math.ceil((Date.now() - begun) / 300); // of each of the two panels, on a machine however slow
  assert.ok(timers > 0 && timers <= 2 * rests && timers < 50, `${timers} timers of 50 steps`);
});

test("a percentage that rounds to nothing has no sign", () => {
  assert.deepEqual([-3e-5, 0.004, -0.006, -12.345, 7].map((each) => percentChange(each)),
    ["0 %", "0 %", "−0.01 %", "−12.3 %", "+7.0 %"]);
});

test("an index has its name beside its title unless that contains it, as in the report", () => {
  const own = { symbol: "wk", title: "ride comfort" };
  assert.deepEqual([indexName(own), indexWords(own, ": "), indexAxis(own.symbol, own.title)],
    ["wk", "wk: ride comfort", "ride comfort wk"]);
  const words = { symbol: "suspension-travel", title: "suspension travel" };
  assert.equal(indexWords(ownIndex("ride-comfort"), ", "), "ride comfort");
  assert.deepEqual([indexName(words), indexWords(words, ": "), indexAxis(words.symbol, words.title)],
    Array(3).fill("suspension travel"));
});

test("what is told of values stands with them, while they are the present ones, and no other message does", () => {
  const study = { layouts: { S1: "k" } };
  let state = reduce(initial(), { type: "changed", change: { type: "opened", study }, gesture: null });
  for (const [text, about] of [["first", "a"], ["taken", TAKEN], ["last", "b"]])
    state = reduce(state, { type: "said", text, about });
  assert.deepEqual(messagesOf(state).map(({ text }) => text), ["last", "first"]);
  assert.equal(toldOfValues(state), "taken");
  state = reduce(state, { type: "changed", change: { type: "placed", place: ["title"], value: "x" }, gesture: null });
  assert.equal(toldOfValues(state), "");
});
