// Controls and tables that the panels share, and handlers of their events.
import { symbolParts } from "../state/scale.js";
import { html, useState } from "./html.js";

/** A handler of events that hands on the text of the control.
 * @param {(text: string) => void} set @returns {(event: Event) => void} */
export const textHandler = (set) => (event) => set(/** @type {HTMLInputElement} */ (event.currentTarget).value);

/** A handler of the submission of a form that hands on its fields, and the event.
 * @param {(form: FormData, event: SubmitEvent) => unknown} act @returns {(event: SubmitEvent) => void} */
export const formHandler = (act) => (event) => {
  event.preventDefault();
  act(new FormData(/** @type {HTMLFormElement} */ (event.currentTarget)), event);
};

/** Shows the first element that a selector finds, from its top, once what is due is drawn. @param {string} selector */
export const showNewest = (selector) => setTimeout(() => requestAnimationFrame(() =>
  document.querySelector(selector)?.scrollIntoView({ block: "start" })));

/** Scrolls a row, such as that of the tabs, and nothing else, so that one of its children is seen.
 * @param {HTMLElement | null} child */
export function bringIntoRow(child) {
  const row = child?.parentElement;
  if (row) row.scrollLeft = child.offsetLeft - row.offsetLeft - (row.clientWidth - child.offsetWidth) / 2;
}

/** The name that is picked, or the first where none of them is, and the function that picks one.
 * @param {string[]} names @returns {[string | undefined, (name: string) => void]} */
export function useChoice(names) {
  const [picked, setPicked] = useState("");
  return [names.includes(picked) ? picked : names[0], setPicked];
}

/** A choice of one value; `choices` are values, or pairs of value and title. `set` is given the value that is chosen.
 * @param {{label?: string, choices: (string | string[])[], selected?: string, set?: (value: string) => void,
 * [attribute: string]: unknown}} props */
export function Select({ label, choices, selected, set, ...attributes }) {
  const select = html`<select ...${attributes} onChange=${set && textHandler(set)}>${choices.map((choice) => {
    const [value, title = value] = [choice].flat();
    return html`<option key=${value} value=${value} selected=${value === selected || undefined}>${title}</option>`;
  })}</select>`;
  return label === undefined ? select : html`<label>${label} ${select}</label>`;
}

/** A button that stays pressed while what it stands for is on.
 * @param {{on: boolean, set: () => void, children: any, [attribute: string]: unknown}} props */
export const Chip = ({ on, set, children, ...attributes }) =>
  html`<button type="button" class="chip" aria-pressed=${on} onClick=${set} ...${attributes}>${children}</button>`;

/** The indices of an answer, one of which is shown.
 * @param {{indices: string[], picked: string | undefined, pick: (index: string) => void}} props */
export const IndexChips = ({ indices, picked, pick }) => html`<div class="row" role="group" aria-label="Index">
  ${indices.map((each) => html`<${Chip} key=${each} on=${each === picked} set=${() => pick(each)}>${each}<//>`)}</div>`;

/** A menu that drops down; `onOpen` is called when it does.
 * @param {{title: string, onOpen?: () => void, id?: string, children: any}} props */
export const DropDown = ({ title, onOpen, id, children }) => html`<details class="menu" id=${id} onToggle=${(
  /** @type {Event} */ event) => /** @type {HTMLDetailsElement} */ (event.currentTarget).open && onOpen?.()}>
  <summary>${title}</summary><div class="menu-body">${children}</div></details>`;

/** A table that can be scrolled; `heads` are the heads of its columns, or pairs of head and explanation.
 * @param {{label: string, heads: (string | string[])[], children: any, [attribute: string]: unknown}} props */
export const Table = ({ label, heads, children, ...attributes }) => html`<div class="scroll" tabindex="0"
  role="region" aria-label=${label}><table ...${attributes}><thead><tr>${heads.map((head) => {
    const [text, title] = [head].flat();
    return text ? html`<th scope="col" title=${title}>${text}</th>` : html`<td></td>`;
  })}</tr></thead><tbody>${children}</tbody></table></div>`;

/** A field of which the text is taken over with Enter, or on leaving it; what is being typed stays while answers
 * arrive and the page is drawn anew.
 * @param {{text: string | number | undefined, done: (text: string) => void, [attribute: string]: unknown}} props */
export function Field({ text, done, ...attributes }) {
  const [typed, setTyped] = useState(/** @type {string | null} */ (null));
  const finish = textHandler((entered) => {
    setTyped(null);
    if (entered !== String(text ?? "")) done(entered);
  });
  return html`<input ...${attributes} value=${typed ?? text} onInput=${textHandler(setTyped)} onChange=${finish}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Enter" && finish(event)} />`;
}

/** A name; that of an element as a symbol, as in the picture of the vehicle.
 * @param {{label: string, element?: boolean}} props */
export function Name({ label, element = true }) {
  const [symbol, subscript] = element ? symbolParts(label) : [label, ""];
  return subscript ? html`${symbol}<sub>${subscript}</sub>` : symbol;
}
