// What a person works on, and all that can be done to it. A document is never changed in place: each action gives the next.
//
// `study` is the file, as JSON of its TOML tables, with quantities as they were written. What a file does not hold stands
// beside it: the present values of free elements (by layout), the ranges of sliders, designs by name.

import { freshName, names, parse, renamed } from "../network/algebra.js";

/** @typedef {{from: string, to: string, [more: string]: unknown}} Range */
/** @typedef {string | Range | {[key: string]: unknown}} ElementEntry */
/** @typedef {string | {[strut: string]: string}} LayoutEntry */
/** @typedef {{[key: string]: any, title?: string, vehicle?: {[key: string]: any}, road?: {[key: string]: any}, elements?: {[name: string]: ElementEntry}, layouts?: {[name: string]: LayoutEntry}, study?: {[key: string]: any}}} Study */
/** @typedef {{[layout: string]: {[element: string]: string}}} Values */
/** @typedef {{name: string, study: Study, layout: string, values: Values}} Design */
/** @typedef {{study: Study, layout: string, strut: string | null, values: Values, ranges: {[place: string]: {from: string, to: string}}, designs: Design[]}} Document */

/** @typedef {{type: "opened", study: Study}
 *  | {type: "restored", document: Document}
 *  | {type: "placed", place: string[], value: unknown}
 *  | {type: "valued", layout: string, values: {[element: string]: string}}
 *  | {type: "valuedAll", values: Values}
 *  | {type: "ranged", place: string, from: string, to: string}
 *  | {type: "freed", place: string[], from: string, to: string, method?: string}
 *  | {type: "fixed", place: string[], text: string}
 *  | {type: "drawn", text: string, added?: {[name: string]: ElementEntry}}
 *  | {type: "selected", layout: string, strut?: string | null}
 *  | {type: "layoutAdded", name: string}
 *  | {type: "layoutRenamed", name: string}
 *  | {type: "layoutRemoved"}
 *  | {type: "strutsParted", struts: string[]}
 *  | {type: "strutsJoined"}
 *  | {type: "elementRenamed", old: string, name: string}
 *  | {type: "elementRemoved", name: string}
 *  | {type: "designKept", name: string}
 *  | {type: "designTaken", name: string}
 *  | {type: "designRemoved", name: string}} Change */

/** What is there when nothing was opened. @returns {Document} */
export const empty = () => ({ study: {}, layout: "", strut: null, values: {}, ranges: {}, designs: [] });

/** @type {{[type: string]: (document: Document, change: any) => Document}} */
const CHANGES = {
  opened: (document, { study }) => standing({ ...empty(), designs: document.designs, study }),
  restored: (_, { document }) => standing(document),
  placed: (document, { place, value }) => ({ ...document, study: placed(document.study, place, value) }),
  valued: (document, { layout, values }) => ({
    ...document,
    values: { ...document.values, [layout]: { ...document.values[layout], ...values } },
  }),
  valuedAll: (document, { values }) => ({ ...document, values: { ...document.values, ...values } }),
  ranged: (document, { place, from, to }) => ({ ...document, ranges: { ...document.ranges, [place]: { from, to } } }),
  freed: (document, { place, from, to, method }) => {
    const [section, name] = place;
    const entry = /** @type {any} */ (document.study)[section]?.[name];
    const text = typeof entry === "string" ? entry : null;
    const users = text === null ? [] : Object.keys(document.study.layouts ?? {});
    const values = { ...document.values };
    for (const layout of users) values[layout] = { ...values[layout], [name]: /** @type {string} */ (text) };
    const { study } = document;
    const searched = method === undefined || study.study?.optimise !== undefined ? study : placed(study, ["study", "optimise"], method); // what is free needs a method that chooses it
    return { ...document, values, study: placed(searched, place, { from, to }) };
  },
  fixed: (document, { place, text }) => {
    const [section, name] = place;
    const entry = /** @type {any} */ (document.study)[section]?.[name];
    const ranges = isRange(entry) ? { ...document.ranges, [place.join(".")]: { from: entry.from, to: entry.to } } : document.ranges;
    const values = Object.fromEntries(Object.entries(document.values).map(([layout, of]) => [layout, without(of, name)]));
    return { ...document, ranges, values, study: placed(document.study, place, text) };
  },
  drawn: (document, { text, added = {} }) => {
    if (document.layout === "") return document;
    const study = { ...document.study, elements: { ...document.study.elements, ...added } };
    const place = document.strut === null ? [document.layout] : [document.layout, document.strut];
    return { ...document, study: placed(study, ["layouts", ...place], text) };
  },
  selected: (document, { layout, strut }) => standing({ ...document, layout, strut: strut ?? null }),
  layoutAdded: (document, { name }) => {
    const layouts = document.study.layouts ?? {};
    const values = { ...document.values, [name]: document.values[document.layout] ?? {} };
    const like = layouts[document.layout] ?? Object.keys(document.study.elements ?? {})[0] ?? "";
    return standing({ ...document, values, layout: name, study: { ...document.study, layouts: { ...layouts, [name]: like } } });
  },
  layoutRenamed: (document, { name }) => {
    const old = document.layout;
    const { study, values } = document;
    if (!(old in (study.layouts ?? {})) || name in (study.layouts ?? {})) return document;
    const settings = study.study?.baseline === old ? { ...study.study, baseline: name } : study.study;
    const renamedStudy = { ...study, layouts: keyRenamed(study.layouts ?? {}, old, name), ...(settings && { study: settings }) };
    return { ...document, layout: name, values: keyRenamed(values, old, name), study: renamedStudy };
  },
  layoutRemoved: (document) => {
    const layouts = without(document.study.layouts ?? {}, document.layout);
    const settings = document.study.study;
    const kept = settings?.baseline === document.layout ? without(settings, "baseline") : settings;
    const study = { ...document.study, layouts, ...(kept && { study: kept }) };
    return standing({ ...document, study, values: without(document.values, document.layout) });
  },
  strutsParted: (document, { struts }) => {
    const text = textOf(document);
    const each = Object.fromEntries(struts.map((/** @type {string} */ strut) => [strut, text]));
    return standing({ ...document, strut: struts[0], study: placed(document.study, ["layouts", document.layout], each) });
  },
  strutsJoined: (document) => ({ ...document, strut: null, study: placed(document.study, ["layouts", document.layout], textOf(document)) }),
  elementRenamed: (document, { old, name }) => elementRenamed(document, old, name),
  elementRemoved: (document, { name }) => ({
    ...document,
    study: { ...document.study, elements: without(document.study.elements ?? {}, name) },
  }),
  designKept: (document, { name }) => {
    const { study, layout, values } = document;
    const others = document.designs.filter((design) => design.name !== name);
    return { ...document, designs: [...others, { name, study, layout, values }] };
  },
  designTaken: (document, { name }) => {
    const design = document.designs.find((each) => each.name === name);
    return design ? standing({ ...document, study: design.study, layout: design.layout, values: design.values }) : document;
  },
  designRemoved: (document, { name }) => ({ ...document, designs: document.designs.filter((design) => design.name !== name) }),
};

/** The document after a change. @param {Document} document @param {Change} change @returns {Document} */
export const after = (document, change) => CHANGES[change.type](document, change);

/** Whether something that is dispatched changes the document. @param {{type: string}} action @returns {action is Change} */
export const isChange = (action) => Object.hasOwn(CHANGES, action.type);

/** The document with a layout and a strut that are there. @param {Document} document @returns {Document} */
function standing(document) {
  const layouts = document.study.layouts ?? {};
  const known = Object.keys(layouts);
  const layout = known.includes(document.layout) ? document.layout : (known.at(-1) ?? "");
  const struts = strutsOf(layouts[layout]);
  const strut = struts.length === 0 ? null : struts.includes(document.strut ?? "") ? document.strut : struts[0];
  return layout === document.layout && strut === document.strut ? document : { ...document, layout, strut };
}

/** The struts that a layout names, none where one text is for all. @param {LayoutEntry | undefined} entry @returns {string[]} */
export const strutsOf = (entry) => (entry !== null && typeof entry === "object" ? Object.keys(entry) : []);

/** The text of the network that is edited. @param {Document} document @returns {string} */
export function textOf({ study, layout, strut }) {
  const entry = study.layouts?.[layout];
  const text = entry !== null && typeof entry === "object" ? entry[strut ?? ""] : entry;
  return typeof text === "string" ? text : "";
}

/** All texts of a layout. @param {LayoutEntry | undefined} entry @returns {string[]} */
export const textsOf = (entry) => (typeof entry === "string" ? [entry] : Object.values(entry ?? {}).filter((text) => typeof text === "string"));

/** The names of the elements of a layout. @param {Study} study @param {string} layout @returns {string[]} */
export function namesIn(study, layout) {
  const found = textsOf(study.layouts?.[layout]).flatMap((text) => {
    const tree = parse(text);
    return tree === null ? [] : names(tree);
  });
  return [...new Set(found)];
}

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

/** @param {Study} study @param {string} symbol */
export const nextElement = (study, symbol) => freshName(symbol, Object.keys(study.elements ?? {}));

/** @param {Document} document @param {string} old @param {string} name @returns {Document} */
function elementRenamed(document, old, name) {
  const { study } = document;
  if (name in (study.elements ?? {})) return document;
  /** @param {LayoutEntry} entry @returns {LayoutEntry} */
  const changed = (entry) =>
    typeof entry === "string"
      ? renamed(entry, old, name)
      : Object.fromEntries(Object.entries(entry).map(([strut, text]) => [strut, renamed(text, old, name)]));
  const layouts = Object.fromEntries(Object.entries(study.layouts ?? {}).map(([key, entry]) => [key, changed(entry)]));
  const values = Object.fromEntries(Object.entries(document.values).map(([layout, of]) => [layout, keyRenamed(of, old, name)]));
  const settings = study.study && settingsRenamed(study.study, old, name);
  const elements = keyRenamed(study.elements ?? {}, old, name);
  const vehicle = study.vehicle && networksRenamed(study.vehicle, old, name);
  const ranges = keyRenamed(document.ranges, `elements.${old}`, `elements.${name}`);
  return { ...document, values, ranges, study: { ...study, elements, layouts, ...(vehicle && { vehicle }), ...(settings && { study: settings }) } };
}

const NETWORK = "network"; // the key under which a vehicle has networks of its own

/** The networks in a table of a vehicle, and in the tables in it. @param {any} table @returns {string[]} */
export function networksIn(table) {
  if (table === null || typeof table !== "object") return [];
  return Object.entries(table).flatMap(([key, inside]) => (key === NETWORK && typeof inside === "string" ? [inside] : networksIn(inside)));
}

/** A table of a vehicle in whose networks an element is called otherwise. @param {any} table @param {string} old @param {string} name @returns {any} */
function networksRenamed(table, old, name) {
  if (table === null || typeof table !== "object" || Array.isArray(table)) return table;
  return Object.fromEntries(Object.entries(table).map(([key, inside]) => [key, key === NETWORK && typeof inside === "string" ? renamed(inside, old, name) : networksRenamed(inside, old, name)]));
}

/** @param {{[key: string]: any}} settings @param {string} old @param {string} name */
function settingsRenamed(settings, old, name) {
  const { sweep, budgets } = settings;
  const result = { ...settings };
  if (sweep) result.sweep = keyRenamed(keyRenamed(sweep, old, name), `elements.${old}`, `elements.${name}`);
  if (Array.isArray(budgets)) result.budgets = budgets.map((each) => (each === old ? name : each));
  return result;
}

/** A table with something at a place; `undefined` takes the key away. @param {any} table @param {string[]} place @param {unknown} value @returns {any} */
function placed(table, place, value) {
  const [key, ...rest] = place;
  if (rest.length > 0) return { ...table, [key]: placed(table?.[key] ?? {}, rest, value) };
  return value === undefined ? without(table, key) : { ...table, [key]: value };
}

/** @template T @param {{[key: string]: T}} table @param {string} key @returns {{[key: string]: T}} */
const without = (table, key) => Object.fromEntries(Object.entries(table).filter(([each]) => each !== key));

/** A table in which a key is another one, at its place. @template T @param {{[key: string]: T}} table @param {string} old @param {string} name @returns {{[key: string]: T}} */
const keyRenamed = (table, old, name) => Object.fromEntries(Object.entries(table).map(([key, value]) => [key === old ? name : key, value]));
