// What a person works on, and all that can be done to it. A document is never changed in place: each action gives the
// next.
//
// `study` is the file, as JSON of its TOML tables, with quantities as they were written. What a file does not hold
// stands
// beside it: the present values of free elements (by layout), the ranges of sliders, designs by name.

/** @typedef {{from: string, to: string, [more: string]: unknown}} Range */
/** @typedef {string | Range | {[key: string]: unknown}} ElementEntry */
/** @typedef {string | {[strut: string]: string}} LayoutEntry */
/** @typedef {{[key: string]: any, title?: string, vehicle?: {[key: string]: any}, road?: {[key: string]: any},
 * elements?: {[name: string]: ElementEntry}, layouts?: {[name: string]: LayoutEntry}, study?: {[key: string]: any}}}
 * Study */
/** @typedef {{[layout: string]: {[element: string]: string}}} Values */
/** @typedef {{name: string, study: Study, layout: string, values: Values}} Design */
/** @typedef {{study: Study, layout: string, strut: string | null, values: Values, ranges: {[place: string]: {from:
 * string, to: string}}, designs: Design[]}} Document */

/** @typedef {{type: "opened", study: Study}
 *  | {type: "restored", document: Document}
 *  | {type: "placed", place: string[], value: unknown}
 *  | {type: "valued", layout: string, values: {[element: string]: string}}
 *  | {type: "valuedAll", values: Values}
 *  | {type: "ranged", place: string, from: string, to: string}
 *  | {type: "freed", place: string[], name: string, from: string, to: string, method?: string}
 *  | {type: "fixed", place: string[], name: string, text: string}
 *  | {type: "drawn", text: string, added?: {[name: string]: ElementEntry}}
 *  | {type: "selected", layout: string, strut?: string | null}
 *  | {type: "layoutAdded", name: string}
 *  | {type: "layoutRenamed", name: string}
 *  | {type: "layoutRemoved"}
 *  | {type: "strutsParted", struts: string[]}
 *  | {type: "strutsJoined"}
 *  | {type: "elementRenamed", old: string, name: string, study: Study}
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
  freed: (document, { place, name, from, to, method }) => {
    const entry = entryAt(document.study, place);
    const text = typeof entry === "string" ? entry : null;
    const users = text === null ? [] : Object.keys(document.study.layouts ?? {});
    const values = { ...document.values };
    for (const layout of users) values[layout] = { ...values[layout], [name]: /** @type {string} */ (text) };
    const { study } = document;
    // What is free needs a method that chooses it.
    const has = method === undefined || study.study?.optimise !== undefined;
    const searched = has ? study : placed(study, ["study", "optimise"], method);
    return { ...document, values, study: placed(searched, place, { from, to }) };
  },
  fixed: (document, { place, name, text }) => {
    const entry = entryAt(document.study, place);
    const bounds = isRange(entry) ? { [place.join(".")]: { from: entry.from, to: entry.to } } : {};
    const ranges = { ...document.ranges, ...bounds };
    const values = Object.fromEntries(
      Object.entries(document.values).map(([layout, of]) => [layout, without(of, name)]),
    );
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
    return standing({
      ...document,
      values,
      layout: name,
      study: { ...document.study, layouts: { ...layouts, [name]: like } },
    });
  },
  layoutRenamed: (document, { name }) => {
    const old = document.layout;
    const { study, values } = document;
    if (!(old in (study.layouts ?? {})) || name in (study.layouts ?? {})) return document;
    const settings = study.study?.baseline === old ? { ...study.study, baseline: name } : study.study;
    const renamedStudy = {
      ...study,
      layouts: keyRenamed(study.layouts ?? {}, old, name),
      ...(settings && { study: settings }),
    };
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
    return standing({
      ...document,
      strut: struts[0],
      study: placed(document.study, ["layouts", document.layout], each),
    });
  },
  strutsJoined: (document) => ({
    ...document,
    strut: null,
    study: placed(document.study, ["layouts", document.layout], textOf(document)),
  }),
  elementRenamed: (document, { old, name, study }) => elementRenamed(document, old, name, study),
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
    return design
      ? standing({ ...document, study: design.study, layout: design.layout, values: design.values })
      : document;
  },
  designRemoved: (document, { name }) => ({
    ...document,
    designs: document.designs.filter((design) => design.name !== name),
  }),
};

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
  const struts = strutsOf(layouts[layout]);
  const strut = struts.length === 0 ? null : struts.includes(document.strut ?? "") ? document.strut : struts[0];
  return layout === document.layout && strut === document.strut ? document : { ...document, layout, strut };
}

/** The struts that a layout names, none where one text is for all. @param {LayoutEntry | undefined} entry
 * @returns {string[]} */
export const strutsOf = (entry) => (entry !== null && typeof entry === "object" ? Object.keys(entry) : []);

/** The text of the network that is edited. @param {Document} document @returns {string} */
export function textOf({ study, layout, strut }) {
  const entry = study.layouts?.[layout];
  const text = entry !== null && typeof entry === "object" ? entry[strut ?? ""] : entry;
  return typeof text === "string" ? text : "";
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

/** The document whose study has another name of an element: it is called so beside the study too.
 * @param {Document} document @param {string} old @param {string} name @param {Study} study @returns {Document} */
function elementRenamed(document, old, name, study) {
  const values = Object.fromEntries(
    Object.entries(document.values).map(([layout, of]) => [layout, keyRenamed(of, old, name)]),
  );
  const [before, after] = [`elements.${old}`, `elements.${name}`];
  const ranges = Object.fromEntries(
    Object.entries(document.ranges).map(([place, range]) => {
      const inside = place === before || place.startsWith(`${before}.`);
      return [inside ? after + place.slice(before.length) : place, range];
    }),
  );
  return standing({ ...document, values, ranges, study });
}

/** What stands in a table at a place. @param {any} table @param {string[]} place @returns {any} */
export const entryAt = (table, place) => place.reduce((inside, key) => inside?.[key], table);

/** A table with something at a place; `undefined` takes the key away. @param {any} table @param {string[]} place
 * @param {unknown} value @returns {any} */
function placed(table, place, value) {
  const [key, ...rest] = place;
  if (rest.length > 0) return { ...table, [key]: placed(table?.[key] ?? {}, rest, value) };
  return value === undefined ? without(table, key) : { ...table, [key]: value };
}

/** @template T @param {{[key: string]: T}} table @param {string} key @returns {{[key: string]: T}} */
const without = (table, key) => Object.fromEntries(Object.entries(table).filter(([each]) => each !== key));

/** A table in which a key is another one, at its place. @template T @param {{[key: string]: T}} table
 * @param {string} old @param {string} name @returns {{[key: string]: T}} */
const keyRenamed = (table, old, name) =>
  Object.fromEntries(Object.entries(table).map(([key, value]) => [key === old ? name : key, value]));
