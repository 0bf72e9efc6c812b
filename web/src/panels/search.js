// A search for the best network: rankings, which fill while it goes on, the best for each number of elements, the front
// over all networks, and real inerters; each network can be taken into the editor.

import { Field, IndexChips, Select, Table, useChoice } from "../parts/controls.js";
import { Doubts, isOk } from "../parts/doubts.js";
import { html, useMemo, useState } from "../parts/html.js";
import { isFreeNetwork, kindOf, quickMethod, searchedLayouts, treeOf } from "../library.js";
import { freshName, written } from "../network/algebra.js";
import { Plot } from "../plot.js";
import { goalOf, strutTexts } from "../questions.js";
import { entryAt, own, strutsOf, textOf } from "../state/document.js";
import { aligned, withError, printed, scaled, shown, strutWords, times, unitFor, valuesIn, withUnit }
  from "../state/scale.js";
import { TAKEN } from "../state/store.js";
import { takeNetwork } from "../working.js";
import { indexAxis, indicesOf, percentChange } from "./answers.js";
import { Constraints } from "./asked.js";
import { Files } from "./files.js";
import { Sketch } from "./sketch.js";
import { FrontView } from "./front.js";

/** @import { State, Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { WrittenUnit } from "../state/scale.js" */
/** @import { Declaration, Point } from "../plots/layout.js" */
/** A network with its elements and the entry of a layout, as in a study document. @typedef {any} Row */

const FRONT = "Front";

/** Shows the form of a search. @param {Store} store */
export function toSearch(store) {
  store.look({ tab: "work", tall: true });
  requestAnimationFrame(() => {
    const field = /** @type {HTMLElement | null} */ (document.querySelector(".begin :is([name=layout], .remedy)"));
    field?.closest("form")?.scrollIntoView({ block: "start" });
    field?.focus();
  });
}

/** A network with the spring that carries the vehicle, null where there is none. @param {State} state
 * @param {string} text */
function carryingIn(state, text) {
  const tree = treeOf(state, text);
  return tree?.kind === "parallel" ? tree.parts.find((part) => part.kind === "element"
    && kindOf(state, part.name)?.linear === "stiffness") : null;
}

/** Buttons that add a layout with a free network: for several struts at one of them, or the same at all that carry.
 * @param {{store: Store}} props */
export function AddFreeNetwork({ store }) {
  const state = store.get();
  const texts = strutTexts(state);
  const struts = Object.keys(texts);
  const carrying = struts.filter((strut) => carryingIn(state, texts[strut]));
  /** @param {string[]} at @param {string} words */
  const button = (at, words) => html`<button type="button" class="edged remedy" key=${words}
    onClick=${() => addFreeNetwork(store, at)}>${words}</button>`;
  if (struts.length < 2) return button([""], "Add a layout with a free network");
  return html`Add a layout with a free network
    ${carrying.length > 1 && button(carrying, `the same at ${strutWords(carrying)}`)}
    ${struts.map((strut) => button([strut], `at ${strutWords([strut])}`))}`;
}

/** Adds a layout in which these struts, or the only one, are the spring that carries the vehicle with a free network in
 * parallel, and shows what can be searched in it. @param {Store} store @param {string[]} struts */
function addFreeNetwork(store, struts) {
  const state = store.get();
  const { study, strut } = state.history.present;
  const [name, added] = [study.elements, study.layouts].map((table) => freshName("any", Object.keys(table ?? {})));
  const texts = struts[0] === "" ? { "": textOf(state.history.present) } : strutTexts(state);
  /** @param {string} text */
  const freed = (text) => {
    const carries = carryingIn(state, text);
    return carries ? `${written(carries)} | ${name}` : name;
  };
  const next = Object.fromEntries(Object.entries(texts).map(([each, text]) =>
    [each, struts.includes(each) ? freed(text) : text]));
  store.change([
    { type: "layoutAdded", name: added },
    { type: "placed", place: ["elements", name], value: state.about?.new_free_network },
    { type: "placed", place: ["layouts", added], value: next[""] ?? next },
    { type: "selected", layout: added, strut: struts.includes(strut ?? "") ? strut : struts[0] },
    { type: "placed", place: ["study", "optimise"], value: study.study?.optimise ?? quickMethod(state)?.name },
  ]);
  toSearch(store);
}

/** What stands in the place of what needs a network. @param {{layout: string}} props */
export const SearchFirst = ({ layout }) =>
  html`<p class="quiet">The network of ${layout} is free: search for the best one first.</p>`;

/** Layouts to search, the selected one first. @param {{store: Store}} props */
export function SearchForm({ store }) {
  const state = store.get();
  const { study, layout: here } = state.history.present;
  const layouts = searchedLayouts(state);
  const [layout = layouts[0], setLayout] = useChoice(layouts.includes(here) ? [here, ...layouts] : layouts);
  const wanted = study.study?.trade_off ?? [goalOf(state)];
  return html`<${Select} label="layout" name="layout" choices=${layouts} value=${layout}
      set=${setLayout} />
    <fieldset class="row"><legend class="visually-hidden">Indices</legend>
      ${indicesOf(state).map(({ symbol, title }) => html`<label key=${symbol} title=${title}><input type="checkbox"
        name="index" value=${symbol} defaultChecked=${wanted.includes(symbol)} /> ${symbol}</label>`)}</fieldset>
    <${Where} state=${state} layout=${layout} />
    ${state.parts?.layouts[layout].free_networks.map((name) => html`<${FreeNetwork} key=${name} store=${store}
      name=${name} />`)}
    <${Constraints} store=${store} />`;
}

/** At which struts the network is searched, and what is at the others.
 * @param {{state: State, layout: string}} props */
function Where({ state, layout }) {
  const entry = own(state.history.present.study.layouts, layout);
  const rows = (state.parts?.networks ?? []).filter(({ path }) => path[1] === layout
    && strutsOf(entry).includes(path[2]));
  const [free, others] = [true, false].map((is) => rows.filter(({ names = [] }) =>
    names.some((name) => isFreeNetwork(state, name)) === is).map(({ path }) => path[2]));
  return free.length > 0 && html`<p class="quiet">Free at ${strutWords(free)}${free.length > 1
    && ", the same network with the same values"}.${others.map((strut) =>
    ` At ${strutWords([strut])}: ${entry[strut]}.`)}</p>`;
}

/** A key of a free network that is a number or a switch, as the library declares it.
 * @typedef {{key: string, type: string, description: string, minimum?: number, maximum?: number, default?: any}} Key */

/** How many elements a free network may have, and of each kind. @param {{store: Store, name: string}} props */
function FreeNetwork({ store, name }) {
  const { about, history } = store.get();
  const entry = entryAt(history.present.study, ["elements", name]) ?? {};
  /** @type {Key[]} */
  const keys = about?.free_networks ?? [];
  /** @param {string} key @param {unknown} value */
  const place = (key, value) => store.change({ type: "placed", place: ["elements", name, key], value });
  return html`<fieldset class="row"><legend class="visually-hidden">${name}</legend>${keys.map((one) => {
    const { key, type, description, minimum, maximum, default: usual } = one;
    const value = entry[key] ?? usual;
    const number = (/** @type {string} */ text) => place(key, text === "" ? undefined : Number(text));
    const switched = (/** @type {any} */ { currentTarget }) => place(key, currentTarget.checked);
    return html`<label key=${key} title=${description}>${key === "network" ? "elements at most"
      : key.replaceAll("_", " ")} ${type === "boolean" ? html`<input type="checkbox" checked=${value}
        onChange=${switched} />` : html`<${Field} type="number" class="short" min=${minimum} max=${maximum}
        text=${value} placeholder="no limit" done=${number} />`}</label>`;
  })}</fieldset>`;
}

/** @param {FormData} form */
export const searchBody = (form) => ({ layouts: form.getAll("layout"), indices: form.getAll("index") });

/** The best networks, also of a search that goes on or was stopped.
 * @param {{store: Store, api: Api, job: Job}} props */
export function SearchResult({ store, api, job }) {
  const state = store.get();
  const found = job.result ?? job.found;
  /** @type {any[]} */
  const searches = found.searches;
  const views = [...(found.front ? [FRONT] : []), ...searches.map(({ index }) => index)];
  const [view, setView] = useChoice(views);
  const one = searches.find(({ index }) => index === view);
  /** @param {Row} row */
  const take = (row) => store.say(takeNetwork(store, found, row), TAKEN);
  /** @type {string[]} */
  const sentences = found.sentences ?? [];
  return html`${sentences.map((sentence) => html`<p key=${sentence}>${sentence}</p>`)}
    ${views.length > 1 && html`<${IndexChips} indices=${views} picked=${view} pick=${setView} />`}
    ${one ? html`<${Ranking} key=${view} state=${state} found=${found} one=${one} take=${take} />`
      : html`<${NetworkFront} about=${state.about} found=${found} take=${take} />`}
    ${job.result && html`<${Files} store=${store} api=${api} job=${job} />`}`;
}

/** The front over all networks, and over those of fewer elements.
 * @param {{about: any, found: any, take: (row: Row) => void}} props */
function NetworkFront({ about, found: { front, baseline }, take }) {
  const fronts = useMemo(() => front.fronts.toReversed().map((/** @type {any} */ { elements, points }) =>
    ({ layout: `up to ${elements} element${elements === 1 ? "" : "s"}`, status: "ok", knee: null,
      points: points.map((/** @type {Row} */ row) => ({ ...row, values: row.indices, row,
        texts: { ...row.elements, ...row.values }, improvements: baseline && row.improvements_percent })) })), [front]);
  return html`<${FrontView} about=${about} indices=${front.indices} fronts=${fronts} baseline=${baseline ?? ""} alone
    take=${(/** @type {any} */ { point }) => take(point.row)} />`;
}

/** The best networks for an index.
 * @param {{state: State, found: any, one: any, take: (row: Row) => void}} props */
function Ranking({ state, found: { baseline, complete, networks }, one, take }) {
  const { index, ranking, frontier, real_inerters: real } = one;
  const written = unitFor(state.about, ranking.map((/** @type {Row} */ { value }) => value), one.unit);
  const compared = complete && baseline !== null;
  const against = compared ? [`gain on ${baseline}`] : [];
  /** @type {string[]} */
  const methods = [...new Set(real.map((/** @type {Row} */ { method }) => method))];
  /** @param {string} label @param {string} words @param {Row[]} rows
   * @param {{numbered?: (row: Row, i: number) => number, stepped?: boolean}} [how]  `stepped`: compared with the
   * row before */
  const table = (label, words, rows, { numbered, stepped = false } = {}) => html`<p class="quiet">${words}</p>
    <${Table} key=${label} label=${label} heads=${["network", withUnit(index, written.unit),
      ...(stepped ? ["gain on previous"] : []), ...against, ""]}>
      ${rows.map((row, i) => html`<${NetworkRow} key=${row.network} state=${state} row=${row} take=${take}
        number=${numbered?.(row, i)} factor=${written.factor} stepped=${stepped} compared=${compared} />`)}
    <//>`;
  return html`<${Doubts} members=${[...ranking, ...real].map(({ network, status, message }) =>
      ({ of: network, status, message }))} />
    ${ranking.length === 0 && html`<p class="quiet">No network is optimised yet.</p>`}
    ${frontier.length > 1 && html`<${Frontier} about=${state.about} one=${one} baseline=${baseline} written=${written}
      take=${take} />
      ${table("Frontier", "The best network for each number of elements, and what one more gains", frontier,
        { numbered: ({ n_elements: count }) => count, stepped: true })}`}
    ${ranking.length > 0 && table("Ranking", `The best ${ranking.length} ${complete ? `of ${networks} networks`
      : "so far"} (* at a bound)`, ranking, { numbered: (_, i) => i + 1 })}
    ${methods.map((method) => table(`Real inerters by ${method}`,
      `With real inerters, elastic and with friction: optimised by ${method}`,
      real.filter((/** @type {Row} */ row) => row.method === method)))}`;
}

/** The best value with its standard uncertainty. @param {Row} row */
const optimised = ({ value, standard_error: error }) =>
  (typeof value === "number" && error > 0 ? withError(value, error).join(" ± ") : aligned(value, 5));

/** @param {{state: State, row: Row, number?: number, factor: number, stepped: boolean, compared: boolean,
 * take: (row: Row) => void}} props */
function NetworkRow({ state, row, number, factor, stepped, compared, take }) {
  const { network, status, improvement_percent: part, ideal, same_values: same, same_values_doubt: doubt } = row;
  return html`<tr data-network=${network}>
    <th scope="row"><div class="found"><span>${number}</span><${Sketch} state=${state} tree=${row.tree} />
      <div><code>${network}</code><div class="scatter">${valuesIn(state.about, { ...row.elements, ...row.values },
        row.active_bounds)}</div></div></div></th>
    <td class="number">${!isOk(status) && html`<div class="doubt">${status}</div>`}
      ${optimised(scaled(row, factor))}
      ${doubt && html`<div class="doubt">${`same values: ${doubt}`}</div>`}
      ${ideal !== undefined && html`<div class="scatter" title="with the values of the ideal network">${`same values ${
        shown(times(same, factor))}`}</div><div class="scatter">ideal ${shown(times(ideal, factor))}</div>`}</td>
    ${stepped && html`<td class="number">${percentChange(row.gain_on_previous_percent)}</td>`}
    ${compared && html`<td class="number">${percentChange(part)}</td>`}
    <td><button type="button" title="Take it into the editor" onClick=${() => take(row)}>Take</button></td>
  </tr>`;
}

/** The best value for each number of elements.
 * @param {{about: any, one: any, baseline: string | null, written: WrittenUnit, take: (row: Row) => void}} props */
function Frontier({ about, one, baseline, written, take }) {
  const [picked, look] = useState(/** @type {number | null} */ (null));
  const plot = useMemo(() => frontierOf(about, one, baseline, written), [about, one, baseline]);
  return html`<${Plot} plot=${plot} picked=${picked} look=${look}
    take=${(/** @type {Point} */ { of }) => take(of)} />`;
}

/** @param {any} about @param {any} one @param {string | null} baseline @param {WrittenUnit} written
 * @returns {Declaration} */
function frontierOf(about, { index, title, frontier, baseline_value: base }, baseline, { unit, factor }) {
  const counts = frontier.map((/** @type {Row} */ { n_elements: count }) => count);
  const ends = [counts[0], counts.at(-1)];
  const below = typeof base === "number" ? [{ name: baseline ?? "", colour: "s1", dash: true, x: ends,
    y: [base, base] }] : [];
  return {
    title: `${index} by number of elements`,
    x: { what: "Number of elements", unit: "", ticks: counts, padded: true },
    y: { what: indexAxis(index, title), unit, size: 1 / factor, padded: true },
    curves: [{ name: "best network", colour: "s3", x: counts,
      y: frontier.map((/** @type {Row} */ { value }) => value) }, ...below],
    points: frontier.map((/** @type {Row} */ row) => {
      const value = `${index} ${shown(times(row.value, factor), 4)} ${printed(unit)}`.trim();
      return { curve: 0, x: row.n_elements, y: row.value, doubtful: !isOk(row.status), of: row,
        lines: [row.network, value, valuesIn(about, { ...row.elements, ...row.values })],
        label: `${row.network}: ${value}; take it into the editor` };
    }),
  };
}
