// Which questions the state asks: a row a panel. A question is null where there is nothing to ask yet.

import { isSearched, judging, layoutsWith, numbersOf } from "./library.js";
import { panelOf, shownOf, soughtIn } from "./state/answers.js";
import { entryAt, indicesIn, isBlank, isRange, mapValues, own } from "./state/document.js";
import { takenApart } from "./state/scale.js";

/** @import { State, Action } from "./state/store.js" */
/** @import { Document, Study } from "./state/document.js" */
/** `ofDesigns`: whether it is about designs, whose values must be chosen first; `learnt` is what else an answer
 * tells; `rest`: how long the state must have been the same before it is asked [ms], if only where numbers alone have
 * changed, `ofSteps`.
 * @typedef {{panel: string, path: string, body: any, ofDesigns?: boolean, rest?: number, ofSteps?: boolean,
 * learnt?: (value: any) => Action}} Row */
/** `key`: all that is asked, by which its answer is kept. @typedef {Row & {key: string}} Question */

/** The design that is edited. @param {Document} document */
export const designOf = ({ layout, values }) => ({ layout, values: own(values, layout) ?? {}, name: layout });

/** The design that it is compared with. @param {Document} document */
export function baselineOf({ study, values }) {
  const layout = study.study?.baseline ?? Object.keys(study.layouts ?? {})[0] ?? "";
  return { layout, values: own(values, layout) ?? {}, name: layout };
}

/** All layouts of the study as designs. @param {Document} document */
export const allDesigns = (document) =>
  Object.keys(document.study.layouts ?? {}).map((layout) => designOf({ ...document, layout }));

/** Whether the page is about records, whose fit is the next thing to do. @param {State} state */
export const isFitting = ({ view, records }) => view.tab === "rig" && records.length > 0;

/** The index by which designs are ranked. @param {State} state @returns {string | undefined} */
export function goalOf({ view, history }) {
  const indices = indicesIn(history.present.study);
  return indices.includes(view.index) ? view.index : indices[0];
}

/** The best values that were found of a layout, as long as they solve the problem that is asked now.
 * @param {State} state @param {string} layout @returns {{[name: string]: string}} */
export function bestOf(state, layout) {
  const { problems, values } = own(state.history.present.optima, layout) ?? NO_OPTIMUM;
  return problems.length === 1 && problems[0] === problemOf(state, layout) ? values : {};
}

/** The layouts whose values were optimised for another vehicle, road, network or goal, by what the library says that
 * they were and now are optimised for. @param {State} state */
export const staleLayouts = (state) => Object.keys(state.history.present.study.layouts ?? {}).filter((layout) => {
  const { problems } = own(state.history.present.optima, layout) ?? NO_OPTIMUM;
  const problem = problemOf(state, layout);
  return problem !== "" && problems.length > 0 && !problems.includes(problem);
});

/** @type {import("./state/document.js").Optimum} */
const NO_OPTIMUM = { problems: [], values: {} };

/** The digest of what an optimum of a layout is asked for; empty where nothing varies, or while it is not known.
 * @param {State} state @param {string} layout @returns {string} */
const problemOf = (state, layout) => answerOf(state, "decision").value?.rows
  .find((/** @type {any} */ row) => row.layout === layout)?.problem_digest ?? "";

/** The design that is edited and the one that it is compared with; that one alone if it is edited.
 * @param {Document} document */
export function shownDesigns(document) {
  const [design, baseline] = [designOf(document), baselineOf(document)];
  return design.layout === baseline.layout ? [design] : [design, baseline];
}

/** What can stand in the comparison: the layouts of the study, and the designs that were kept.
 * @typedef {{key: string, name: string, kept: boolean, study: Study, design: ReturnType<typeof designOf>}} Choice */

/** @param {Document} document @returns {Choice[]} */
export function choicesOf(document) {
  const { study, designs } = document;
  const layouts = Object.keys(study.layouts ?? {}).map((layout) =>
    ({ key: `layout ${layout}`, name: layout, kept: false, study, design: designOf({ ...document, layout }) }));
  const kept = designs.map(({ name, ...design }) => ({ key: `kept ${name}`, name, kept: true, study: design.study,
    design: { ...designOf({ ...document, ...design }), name } }));
  return [...layouts, ...kept];
}

/** What can stand in the comparison: no layout whose network is still to be searched. @param {State} state */
export const comparable = (state) =>
  choicesOf(state.history.present).filter(({ kept, design }) => kept || !isSearched(state, design.layout));

/** What stands in the comparison, first what the others are compared with. Where nothing is chosen among them, the
 * baseline stands beside the design that is edited, or beside the first other one. @param {State} state
 * @returns {Choice[]} */
export function comparedOf(state) {
  const { view, history: { present } } = state;
  const choices = comparable(state);
  const chosen = view.compared?.flatMap((key) => choices.filter((choice) => choice.key === key)) ?? [];
  const [base, here] = [baselineOf(present).layout, present.layout].map((layout) => `layout ${layout}`);
  const [first, others] = [choices.filter(({ key }) => key === base), choices.filter(({ key }) => key !== base)];
  const other = others.find(({ key }) => key === here) ?? others[0];
  const isChosen = chosen.length > 0 || view.compared?.length === 0;
  const those = isChosen ? chosen : [...first, ...(other ? [other] : [])];
  return [...those.filter(({ key }) => key === view.against), ...those.filter(({ key }) => key !== view.against)];
}

/** @type {((state: State, document: Document) => Row[])[]} */
const ROWS = [
  (_, { study }) => [
    { panel: "parts", path: "study/parts", body: { study }, learnt: (parts) => ({ type: "parted", parts }) },
    { panel: "check", path: "study/check", body: { study } },
  ],
  (state, document) => {
    const asked = decided(state, document);
    return asked.designs.length > 0 ? [ofDesigns("decision", asked)] : [];
  },
  (state, document) => {
    const asked = { ...about(state, document), ...drawn(state) };
    return state.view.tab === "response" && asked.designs.length > 0 ? [ofDesigns("response", asked)] : [];
  },
  (state) => (state.view.tab === "response" ? ghostsOf(state).map((choice) => ghostly(state, choice)) : []),
  (state, document) => {
    const { seconds, seed, output } = state.view;
    return isSearched(state, document.layout) ? [] : [
      { ...ofDesigns("history", { ...presentDesign(document), ...beside(document), duration: seconds, seed, output }),
        rest: 300 },
      { ...ofDesigns("mechanism", presentDesign(document)), rest: 300, ofSteps: true },
    ];
  },
  (state) => (state.view.tab === "compare" ? comparison(state) : []),
  unitsOf,
  typedTexts,
];

/** Whether what was typed into each field is a quantity of its unit. @param {State} state @returns {Row[]} */
function typedTexts({ typed }) {
  return typed.filter(({ sentence }) => sentence === undefined).map((each) => ({
    panel: panelOf(each), path: "quantity", body: { text: each.text, unit: each.unit },
    learnt: ({ sentence }) => ({ type: "read", typed: each, sentence }),
  }));
}

/** What is drawn beside the design that is edited and the baseline. @param {State} state @returns {Choice[]} */
export function ghostsOf({ view, history: { present } }) {
  const drawn = shownDesigns(present).map(({ layout }) => `layout ${layout}`);
  return choicesOf(present).filter(({ key }) => view.ghosts.includes(key) && !drawn.includes(key));
}

/** The panel of such a design, whose answers are kept by it. @param {string} key */
export const ghostPanel = (key) => `response of ${key}`;

/** @param {State} state @param {Choice} choice @returns {Row} */
const ghostly = (state, { key, study, design }) => ({ panel: ghostPanel(key), path: "panel/response", ofDesigns: true,
  body: { study, designs: [design], ...drawn(state) } });

/** The index whose frequency response is drawn. @param {State} state @returns {string | undefined} */
export function drawnIndex({ view, history }) {
  const indices = indicesIn(history.present.study);
  return indices.includes(view.response) ? view.response : indices[0];
}

/** What is asked of responses: those of the index that is drawn. @param {State} state */
function drawn(state) {
  const index = drawnIndex(state);
  return index === undefined ? {} : { indices: [index] };
}

/** A question of a panel about designs. @param {string} panel @param {any} body @returns {Row} */
const ofDesigns = (panel, body) => ({ panel, path: `panel/${panel}`, ofDesigns: true, body });

/** What was asked of each state, since a page asks it often. @type {WeakMap<State, Question[]>} */
const ASKED = new WeakMap();

/** All questions that the state asks. @param {State} state @returns {Question[]} */
export function questions(state) {
  const known = ASKED.get(state);
  if (known) return known;
  const document = state.history.present;
  const found = isBlank(document) ? [] : ROWS.flatMap((row) => row(state, document)).map(keyed);
  ASKED.set(state, found);
  return found;
}

/** @param {Row} row @returns {Question} */
const keyed = (row) => ({ ...row, key: JSON.stringify(row.body) });

/** What a panel shows: the answer to what it asks now. @param {State} state @param {string} panel */
export function answerOf(state, panel) {
  const key = questions(state).find((question) => question.panel === panel)?.key ?? null;
  const found = shownOf(state.answers[panel], key);
  return state.connection === "lost" ? { ...found, lost: true } : found;
}

/** Whether an answer of before is still right about a layout, which does not depend on what was changed.
 * @param {State} state @param {string} panel @returns {(layout: string) => boolean} */
export function isRightStill(state, panel) {
  const latest = state.answers[panel]?.kept[0]?.question;
  const now = questions(state).find((question) => question.panel === panel)?.body;
  if (latest === undefined || now === undefined) return () => false;
  const before = JSON.parse(latest);
  return (layout) => askedOf(state, before, layout) === askedOf(state, now, layout);
}

/** All that a question asks of one layout. @param {State} state @param {any} body @param {string} layout */
function askedOf(state, { study: { elements = {}, layouts = {}, ...rest }, designs = [], index, methods }, layout) {
  const used = Object.entries(elements).filter(([name]) => layoutsWith(state, name)?.includes(layout) ?? true);
  return JSON.stringify([rest, used, own(layouts, layout), index, methods,
    designs.filter((/** @type {any} */ design) => design.layout === layout)]);
}

/** The same of a panel that asks by a button. @param {State} state @param {string} panel */
export const soughtAnswer = (state, panel) => soughtIn(state.answers[panel], soughtOf(state, panel)?.key ?? null);

/** What a panel that asks by a button has last been asked, of the design that is edited now. @param {State} state
 * @param {string} panel @returns {Question | null} */
export function soughtOf(state, panel) {
  const parameters = state.sought[panel];
  if (parameters === undefined) return null;
  const document = state.history.present;
  return keyed({ panel, path: `panel/${panel}`, body: { ...presentDesign(document), baseline: baselineOf(document),
    index: goalOf(state), methods: methodNames(state), ...parameters } });
}

/** What is asked for a table of a panel, whether it is shown or not: of all outputs and indices. @param {State} state
 * @param {string} panel */
export function bodyOf(state, panel) {
  if (panel === "indices") return indicesBody(state);
  const asked = questions({ ...state, view: { ...state.view, tab: panel } });
  const { output, indices, ...body } = asked.find((question) => question.panel === panel)?.body ?? {};
  return body;
}

/** The method by which the page judges; none where the server has told of none, and then those of the study.
 * @param {State} state */
const methodNames = (state) => [judging(state)?.name ?? []].flat();

/** Those that are designs: a layout with a free network is for a search.
 * @template {{layout: string}} T @param {State} state @param {T[]} designs */
const chosenOf = (state, designs) => designs.filter(({ layout }) => !isSearched(state, layout));

/** What the decision is asked of: all layouts. @param {State} state @param {Document} document */
const decided = (state, document) => ({ study: document.study, designs: chosenOf(state, allDesigns(document)),
  baseline: baselineOf(document), methods: methodNames(state), index: goalOf(state) });

/** What a table of the indices is asked of. @param {State} state */
const indicesBody = (state) => ({ ...about(state, state.history.present), methods: methodNames(state) });

/** @param {State} state @param {Document} document */
const about = (state, document) => ({ study: document.study, designs: chosenOf(state, shownDesigns(document)),
  baseline: baselineOf(document) });

/** @param {Document} document */
const presentDesign = (document) => ({ study: document.study, design: designOf(document) });

/** The baseline, where that is another design. @param {Document} document */
const beside = (document) => (shownDesigns(document).length > 1 ? { baseline: baselineOf(document) } : {});

/** @param {State} state @returns {Row[]} */
function comparison(state) {
  const compared = comparedOf(state);
  if (compared.length < 2) return [];
  const designs = compared.map(({ kept, study, design }) => (kept ? { ...design, study } : design));
  return [ofDesigns("compare", { study: state.history.present.study, designs, methods: methodNames(state) })];
}

/** Units whose size is not known yet, all in one question. @param {State} state @param {Document} document
 * @returns {Row[]} */
function unitsOf(state, document) {
  const asked = unitsIn(state, document).filter(({ key }) => !(key in state.quantities));
  if (asked.length === 0) return [];
  const items = asked.map(({ text, unit }) => ({ text, unit }));
  /** @param {{items: any[]}} value @returns {Action} */
  const learnt = (value) => ({
    type: "measured",
    quantities: Object.fromEntries(asked.map(({ key }, i) => [key, value.items[i]])),
  });
  return [{ panel: "units", path: "quantities", body: { items }, learnt }];
}

/** The key by which the size of a unit is kept. @param {string} written @param {string} unit */
export const unitKey = (written, unit) => `${written} in ${unit}`;

/** The units in which numbers, their bounds and their values are written, where these are not the SI units.
 * @param {State} state @param {Document} document @returns {{key: string, text: string, unit: string}[]} */
export function unitsIn(state, { study, values, ranges }) {
  /** @type {Map<string, {key: string, text: string, unit: string}>} */
  const found = new Map();
  /** @param {unknown} text @param {string} unit */
  const add = (text, unit) => {
    const apart = takenApart(text);
    if (apart === null || apart.unit === "" || unit === "" || apart.unit === unit) return;
    const key = unitKey(apart.unit, unit);
    found.set(key, { key, text: `1 ${apart.unit}`, unit });
  };
  for (const { path, unit, name } of numbersOf(state)) {
    const entry = entryAt(study, path);
    const bounds = own(ranges, path.join("."));
    const chosen = name === "" ? [] : Object.values(values).map((of) => own(of, name));
    for (const text of [...(isRange(entry) ? [entry.from, entry.to] : [entry]), bounds?.from, bounds?.to, ...chosen]) {
      add(text, unit);
    }
  }
  return [...found.values()];
}

/** The networks of the present layout by strut, also those that the vehicle gives, as the library lists them: of a text
 * the first one and those that are like it have that text. @param {State} state
 * @returns {{[strut: string]: string}} */
export function strutTexts(state) {
  const { study, layout } = state.history.present;
  const entry = own(study.layouts, layout) ?? "";
  /** @type {{[strut: string]: string}} */
  const known = own(answerOf(state, "check").value?.layouts, layout)?.mounts ?? {};
  if (typeof entry === "object") return { ...known, ...entry };
  const [first] = Object.values(known);
  return mapValues(known, (text) => (text === first ? entry : text));
}
