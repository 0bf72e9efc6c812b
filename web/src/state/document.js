// What a person works on, and all that can be done to it. A document is never changed in place: each action gives the
// next.
//
// `study` is the file, as JSON of its TOML tables, with quantities as they were written. What a file does not hold
// stands beside it: the present values of free elements and the last optimum by layout, ranges of sliders, designs by
// name.

/** @typedef {{from: string, to: string, [more: string]: unknown}} Range */
/** @typedef {string | Range | {[key: string]: unknown}} ElementEntry */
/** @typedef {string | {[strut: string]: string}} LayoutEntry */
/** @typedef {{[key: string]: any, title?: string, vehicle?: {[key: string]: any}, road?: {[key: string]: any},
 * elements?: {[name: string]: ElementEntry}, layouts?: {[name: string]: LayoutEntry}, study?: {[key: string]: any}}}
 * Study */
/** @typedef {{[layout: string]: {[element: string]: string}}} Values */
/** Values that are the best of a layout, and digests of the problems that they solve: one, or one for each index of a
 * front. @typedef {{problems: string[], values: {[element: string]: string}}} Optimum */
/** @typedef {{[layout: string]: Optimum}} Optima */
/** @typedef {{name: string, study: Study, layout: string, values: Values, optima?: Optima}} Design */
/** @typedef {{study: Study, layout: string, strut: string | null, values: Values, optima: Optima,
 * ranges: {[place: string]: {from: string, to: string}}, designs: Design[]}} Document */

/** @typedef {{type: "opened", study: Study}
 *  | {type: "restored", document: Document}
 *  | {type: "placed", place: string[], value: unknown}
 *  | {type: "valued", layout: string, values: {[element: string]: string}}
 *  | {type: "optimised", optima: Optima}
 *  | {type: "ranged", place: string, from: string, to: string}
 *  | {type: "freed", place: string[], name: string, from: string, to: string, method?: string}
 *  | {type: "fixed", place: string[], name: string, text: string}
 *  | {type: "drawn", text: string, added?: {[name: string]: ElementEntry}}
 *  | {type: "networkTaken", layout: string, entry: LayoutEntry, elements: {[name: string]: string},
 *     values: {[element: string]: string}}
 *  | {type: "selected", layout: string, strut?: string | null}
 *  | {type: "layoutAdded", name: string}
 *  | {type: "layoutRenamed", name: string}
 *  | {type: "layoutRemoved"}
 *  | {type: "strutsParted", texts: {[strut: string]: string}, strut: string}
 *  | {type: "strutsJoined"}
 *  | {type: "elementRenamed", old: string, name: string, study: Study}
 *  | {type: "elementRemoved", name: string}
 *  | {type: "designKept", name: string}
 *  | {type: "designTaken", name: string}
 *  | {type: "designRemoved", name: string}} Change */

/** What is there when nothing was opened. @returns {Document} */
export const empty = () => ({ study: {}, layout: "", strut: null, values: {}, optima: {}, ranges: {},
  designs: [] });

/** @type {{[type: string]: (document: Document, change: any) => Document}} */
const CHANGES = {
  opened: (document, { study }) => standing({ ...empty(), designs: document.designs, study }),
  restored: (_, { document }) => standing(document),
  placed: (document, { place, value }) => withEntry(document, place, value),
  valued: (document, { layout, values }) =>
    ({ ...document, values: { ...document.values, [layout]: { ...own(document.values, layout), ...values } } }),
  optimised: (document, { optima }) => ({ ...document, optima: { ...document.optima, ...optima },
    values: { ...document.values, ...mapValues(optima, ({ values }) => values) } }),
  ranged: (document, { place, from, to }) => ({ ...document, ranges: { ...document.ranges, [place]: { from, to } } }),
  freed: (document, { place, name, from, to, method }) => {
    const entry = entryAt(document.study, place);
    const text = typeof entry === "string" ? entry : null;
    const users = text === null ? [] : Object.keys(document.study.layouts ?? {});
    const chosen = Object.fromEntries(users.map((layout) =>
      [layout, { ...own(document.values, layout), [name]: /** @type {string} */ (text) }]));
    const values = { ...document.values, ...chosen };
    const { study } = document;
    // What is free needs a method that chooses it.
    const has = method === undefined || study.study?.optimise !== undefined;
    const searched = has ? study : withValueAt(study, ["study", "optimise"], method);
    return { ...document, values, study: withValueAt(searched, place, { from, to }) };
  },
  fixed: (document, { place, name, text }) => {
    const entry = entryAt(document.study, place);
    const bounds = isRange(entry) ? { [place.join(".")]: { from: entry.from, to: entry.to } } : {};
    const ranges = { ...document.ranges, ...bounds };
    const values = mapValues(document.values, (of) => without(of, name));
    return withEntry({ ...document, ranges, values }, place, text);
  },
  drawn: (document, { text, added = {} }) => {
    if (document.layout === "") return document;
    const study = { ...document.study, elements: { ...document.study.elements, ...added } };
    const place = document.strut === null ? [document.layout] : [document.layout, document.strut];
    return withEntry({ ...document, study }, ["layouts", ...place], text);
  },
  networkTaken: (document, { layout, entry, elements, values }) => {
    const study = { ...document.study, elements: { ...document.study.elements, ...elements } };
    const chosen = { ...document.values, [layout]: { ...own(document.values, layout), ...values } };
    const optima = without(document.optima, layout);
    return standing(withEntry({ ...document, study, layout, values: chosen, optima }, ["layouts", layout], entry));
  },
  selected: (document, { layout, strut }) => standing({ ...document, layout, strut: strut ?? null }),
  layoutAdded: (document, { name }) => {
    const values = { ...document.values, [name]: own(document.values, document.layout) ?? {} };
    const optimum = own(document.optima, document.layout);
    const optima = optimum ? { ...document.optima, [name]: optimum } : document.optima;
    const like = own(document.study.layouts, document.layout) ?? Object.keys(document.study.elements ?? {})[0] ?? "";
    const study = withBaseline(document.study, name);
    return standing(withEntry({ ...document, study, values, optima, layout: name }, ["layouts", name], like));
  },
  layoutRenamed: (document, { name }) => {
    const { values, optima, layout: old } = document;
    const study = withBaseline(document.study, name);
    const layouts = study.layouts ?? {};
    if (own(layouts, old) === undefined || own(layouts, name) !== undefined) return document;
    const renamed = { ...document, layout: name, values: keyRenamed(values, old, name),
      optima: keyRenamed(optima, old, name), study: { ...study, layouts: keyRenamed(layouts, old, name) } };
    return study.study?.baseline === old ? withEntry(renamed, ["study", "baseline"], name) : renamed;
  },
  layoutRemoved: (document) => {
    const { study, layout } = document;
    const [values, optima] = [without(document.values, layout), without(document.optima, layout)];
    const rest = withEntry({ ...document, values, optima }, ["layouts", layout], undefined);
    return standing(study.study?.baseline === layout ? withEntry(rest, ["study", "baseline"], undefined) : rest);
  },
  strutsParted: (document, { texts, strut }) =>
    standing(withEntry({ ...document, strut }, ["layouts", document.layout], texts)),
  strutsJoined: (document) =>
    withEntry({ ...document, strut: null }, ["layouts", document.layout], textOf(document)),
  elementRenamed: (document, { old, name, study }) => elementRenamed(document, old, name, study),
  elementRemoved: (document, { name }) => withEntry(document, ["elements", name], undefined),
  designKept: (document, { name }) => {
    const { study, layout, values, optima } = document;
    const others = document.designs.filter((design) => design.name !== name);
    return { ...document, designs: [...others, { name, study, layout, values, optima }] };
  },
  designTaken: (document, { name }) => {
    const design = document.designs.find((each) => each.name === name);
    if (design === undefined) return document;
    const { study, layout, values, optima = {} } = design;
    return standing({ ...document, study, layout, values, optima });
  },
  designRemoved: (document, { name }) =>
    ({ ...document, designs: document.designs.filter((design) => design.name !== name) }),
};

/** The study with its baseline by name before a layout is called like a number: objects have such keys first, and the
 * first layout is the baseline of a study that names none.
 * @param {Study} study @param {string} name @returns {Study} */
function withBaseline(study, name) {
  const [first] = Object.keys(study.layouts ?? {});
  const stays = !/^\d+$/.test(name) || first === undefined || study.study?.baseline !== undefined;
  return stays ? study : { ...study, study: { ...study.study, baseline: first } };
}

/** The document after a change. @param {Document} document @param {Change} change @returns {Document} */
export const after = (document, change) => CHANGES[change.type](document, change);

/** Whether something that is dispatched changes the document. @param {{type: string}} action
 * @returns {action is Change} */
export const isChange = (action) => Object.hasOwn(CHANGES, action.type);

/** The document with a layout and a strut that are there. @param {Document} document @returns {Document} */
function standing(document) {
  const layouts = document.study.layouts ?? {};
  const known = Object.keys(layouts);
  const layout = known.includes(document.layout) ? document.layout : (known.at(-1) ?? "");
  const struts = strutsOf(own(layouts, layout));
  const strut = struts.length === 0 ? null : struts.includes(document.strut ?? "") ? document.strut : struts[0];
  return layout === document.layout && strut === document.strut ? document : { ...document, layout, strut };
}

/** The struts that a layout names, none where one text is for all. @param {LayoutEntry | undefined} entry
 * @returns {string[]} */
export const strutsOf = (entry) => (entry !== null && typeof entry === "object" ? Object.keys(entry) : []);

/** The text of the network that is edited. @param {Document} document @returns {string} */
export function textOf({ study, layout, strut }) {
  const entry = own(study.layouts, layout);
  const text = entry !== null && typeof entry === "object" ? own(entry, strut ?? "") : entry;
  return typeof text === "string" ? text : "";
}

/** Whether no study is open. @param {{study: Study}} document */
export const isBlank = ({ study }) => Object.keys(study).length === 0;

/** The indices of a study: where it names none, those of its trade-off. @param {Study} study @returns {string[]} */
export const indicesIn = ({ study = {} }) => study.indices ?? study.trade_off ?? [];

/** @param {unknown} entry @returns {entry is Range} */
export const isRange = (entry) => typeof entry === "object" && entry !== null && "from" in entry && "to" in entry;

/** A name for a new layout. @param {Document} document */
export function nextLayout(document) {
  const known = Object.keys(document.study.layouts ?? {});
  const match = /^(.*?)(\d+)$/.exec(document.layout);
  let number = match ? Number(match[2]) + 1 : 2;
  const stem = match ? match[1] : document.layout || "S";
  while (known.includes(`${stem}${number}`)) number += 1;
  return `${stem}${number}`;
}

/** The document whose study has another name of an element: it is called so beside the study too.
 * @param {Document} document @param {string} old @param {string} name @param {Study} study @returns {Document} */
function elementRenamed(document, old, name, study) {
  const values = mapValues(document.values, (of) => keyRenamed(of, old, name));
  const optima = mapValues(document.optima, (of) => ({ ...of, values: keyRenamed(of.values, old, name) }));
  const [before, after] = [`elements.${old}`, `elements.${name}`];
  const ranges = Object.fromEntries(
    Object.entries(document.ranges).map(([place, range]) => {
      const inside = place === before || place.startsWith(`${before}.`);
      return [inside ? after + place.slice(before.length) : place, range];
    }),
  );
  return standing({ ...document, values, optima, ranges, study });
}

/** What a table itself has by a name; a name such as `constructor` is one like any other. @param {any} table
 * @param {string} key @returns {any} */
export const own = (table, key) => (table !== null && typeof table === "object" && Object.hasOwn(table, key)
  ? table[key] : undefined);

/** What stands in a table at a place. @param {any} table @param {string[]} place @returns {any} */
export const entryAt = (table, place) => place.reduce(own, table);

/** The document with something at a place of its study. @param {Document} document @param {string[]} place
 * @param {unknown} value @returns {Document} */
const withEntry = (document, place, value) => ({ ...document, study: withValueAt(document.study, place, value) });

/** A table with something at a place; `undefined` takes the key away. @param {any} table @param {string[]} place
 * @param {unknown} value @returns {any} */
function withValueAt(table, place, value) {
  const [key, ...rest] = place;
  if (rest.length > 0) return { ...table, [key]: withValueAt(own(table, key) ?? {}, rest, value) };
  return value === undefined ? without(table, key) : { ...table, [key]: value };
}

/** A table without a key. @template T @param {{[key: string]: T}} table @param {string} key
 * @returns {{[key: string]: T}} */
export const without = (table, key) => Object.fromEntries(Object.entries(table).filter(([each]) => each !== key));

/** A table with each of its values changed. @template T, R @param {{[key: string]: T}} table
 * @param {(value: T) => R} change @returns {{[key: string]: R}} */
export const mapValues = (table, change) =>
  Object.fromEntries(Object.entries(table).map(([key, value]) => [key, change(value)]));

/** A table in which a key is another one, at its place. @template T @param {{[key: string]: T}} table
 * @param {string} old @param {string} name @returns {{[key: string]: T}} */
const keyRenamed = (table, old, name) =>
  Object.fromEntries(Object.entries(table).map(([key, value]) => [key === old ? name : key, value]));
