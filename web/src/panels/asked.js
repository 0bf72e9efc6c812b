// What is asked of the study: its indices, and the limits that every design keeps.

import { numbersOf } from "../library.js";
import { Chip, Select, formHandler } from "../parts/controls.js";
import { html } from "../parts/html.js";
import { answerOf } from "../questions.js";
import { entryAt, indicesIn } from "../state/document.js";
import { indexChoices, indexName } from "./answers.js";
import { Entry } from "./values.js";

/** @import { Store, State } from "../state/store.js" */
/** @typedef {{path: string[], sense: string, value: string | number}} Limit  of what, as the keys of its table say
 * it */

const SENSES = ["at_most", "at_least", "equal"];
const PLACE = ["study", "subject_to"];
const STIFFNESS = "static-stiffness"; // of a strut, beside the indices

/** @param {{store: Store}} props */
export function AskedPanel({ store }) {
  const state = store.get();
  const { study } = state.history.present;
  const asked = indicesIn(study);
  const limits = limitsOf(state);
  const choices = limitable(state);
  /** @type {{of: string, quantity: string}[]} */
  const told = (answerOf(state, "decision").value?.rows ?? [])
    .flatMap((/** @type {any} */ { limits }) => limits ?? []);
  /** @param {string} symbol */
  const toggle = (symbol) => store.change({ type: "placed", place: ["study", "indices"], value: asked.includes(symbol)
    ? asked.filter((/** @type {string} */ each) => each !== symbol) : [...asked, symbol] });
  /** @param {Limit} limit @param {string | undefined} value */
  const place = ({ path, sense }, value) => {
    const { turn, history } = store.get(); // of now: what is typed may be taken over later
    if (turn === state.turn) store.change({ type: "placed", place: PLACE,
      value: limited(entryAt(history.present.study, PLACE), [...path, sense], value) });
  };
  return html`<div class="asked"><b class="legend">Indices and constraints</b>
    <div class="row" role="group" aria-label="Indices of the study">
      ${indexNames(state).map(({ symbol, title }) => html`<${Chip} key=${symbol} title=${title}
        on=${asked.includes(symbol)} disabled=${asked.length === 1 && asked[0] === symbol}
        set=${() => toggle(symbol)}>${indexName({ symbol, title })}<//>`)}
    </div>
    ${limits.map((limit) => {
      const of = limit.path.join(".");
      const quantities = [...new Set(told.filter((each) => each.of === of).map(({ quantity }) => quantity))];
      const what = quantities.length === 1 ? quantities[0] : choices.find(([value]) => value === of)?.[1] ?? of;
      const label = `${what} ${limit.sense.replace("_", " ")}`;
      const key = `${of} ${limit.sense}`;
      return html`<p class="row" key=${key}>${label} <${Entry} id=${`limit ${key}`} label=${label}
        text=${String(limit.value)} done=${(/** @type {string} */ text) => place(limit, text)} />
        <button type="button" aria-label=${`Delete the limit: ${label}`}
          onClick=${() => place(limit, undefined)}>Delete</button></p>`;
    })}
    <form class="row" onSubmit=${formHandler((form, { currentTarget }) => {
      const [of, sense, value] = ["of", "sense", "value"].map((name) => String(form.get(name) ?? "").trim());
      if (!value) return;
      place({ path: of.split("."), sense, value }, value);
      /** @type {HTMLFormElement} */ (currentTarget).reset();
    })}>
      <${Select} label="Constraint on" name="of" choices=${choices} />
      <${Select} name="sense" aria-label="Which side"
        choices=${SENSES.map((sense) => [sense, sense.replace("_", " ")])} />
      <input name="value" class="entry" aria-label="How much, with its unit" placeholder="such as 8 mm"
        autocomplete="off" /> <button class="edged">Add</button>
    </form>
  </div>`;
}

/** The indices that there are, with those that the file has of its own. @param {State} state
 * @returns {{symbol: string, title: string}[]} */
function indexNames(state) {
  const { study } = state.history.present;
  const known = state.about?.indices ?? [];
  const own = [...Object.keys(study.indices ?? {}),
    ...indicesIn(study)].filter((symbol) =>
      !known.some((/** @type {any} */ each) => each.symbol === symbol));
  return [...known, ...[...new Set(own)].map((symbol) => ({ symbol, title: symbol }))];
}

/** What a limit can be put on, for a `Select`. @param {State} state */
function limitable(state) {
  const layouts = Object.values(answerOf(state, "check").value?.layouts ?? {});
  const struts = Object.keys(/** @type {any} */ (layouts[0])?.mounts ?? {});
  return [...indexChoices(indexNames(state)), ...struts.map((strut) => [`${STIFFNESS}.${strut}`,
    `static stiffness${struts.length > 1 ? ` of ${strut.replaceAll("_", " ")}` : ""}`])];
}

/** The limits of the study, as the library lists them. @param {State} state @returns {Limit[]} */
function limitsOf(state) {
  const { study } = state.history.present;
  const rows = numbersOf(state).filter(({ path }) => PLACE.every((key, level) => path[level] === key));
  return rows.map(({ path }) => ({
    path: path.slice(PLACE.length, -1),
    sense: path.at(-1) ?? "",
    value: entryAt(study, path),
  }));
}

/** The table of limits with another value at a place; without one, the limit and the tables that are then empty are
 * taken away. @param {any} table @param {string[]} path @param {string | undefined} value @returns {any} */
export function limited(table, [key, ...rest], value) {
  const inside = rest.length === 0 ? value : limited(table?.[key], rest, value);
  const next = Object.fromEntries(Object.entries({ ...table, [key]: inside }).filter(([, each]) => each !== undefined));
  return Object.keys(next).length === 0 ? undefined : next;
}
