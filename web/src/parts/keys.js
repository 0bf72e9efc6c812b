// The keys of the page: a table by what has the focus, for the lowest line and for the list of all of them.
import { html, useEffect, useRef, useState } from "./html.js";

const LETTERS = "letters"; // stands for those of the kinds of elements

/** Of each place its keys and what they do. @type {{[place: string]: [string, string][]}} */
const KEYS = {
  Page: [["1 2 3 4", "steps"], ["V", "verdict"], ["O", "find best"], ["Space", "hold the car"],
    ["Ctrl Z", "undo"], ["Ctrl Shift Z", "redo"], ["Ctrl O", "open"], ["Ctrl S", "save"], ["F8", "next message"],
    ["Esc", "close"], ["?", "all keys"]],
  Drawing: [["← →", "select"], [LETTERS, "join in series"], [`Shift + ${LETTERS}`, "in parallel"],
    ["Alt ← →", "move"], ["Del", "remove"], ["F2", "name"], ["Esc", "select the group"]],
  Ranking: [["↑ ↓", "layout"], ["Enter", "edit it"]],
  Values: [["↑ ↓", "1 %"], ["Shift ↑ ↓", "10 %"], ["Alt ↑ ↓", "0.1 %"], ["Home", "best found"],
    ["X", "may vary (on a slider)"]],
  Questions: [["← → ↑ ↓", "choose"], ["Enter", "open"], ["Ctrl O", "file"]],
  Tabs: [["← →", "next tab"]],
  Plot: [["← →", "read"], ["Shift ← →", "faster"], ["+ −", "range"], ["0", "whole range"]],
  Points: [["← →", "next point"], ["↑ ↓", "layout"], ["K", "knee"], ["Enter", "take"]],
};

/** The key that joins a new element of a kind. @param {{key: string}} kind */
export const letterOf = ({ key }) => key[0].toUpperCase();

/** @param {{keys: string, about: any}} props */
const Keys = ({ keys, about }) => keys.split(" ").flatMap((key) =>
  (key === LETTERS ? (about?.elements ?? []).map(letterOf) : [key])).map((key) => html`<kbd key=${key}>${key}</kbd> `);

/** @param {{place: string, about: any}} props */
const Row = ({ place, about }) => KEYS[place].map(([keys, words]) => html`<span key=${words}>
  <${Keys} keys=${keys} about=${about} />${words} ${" "}</span>`);

/** Where the focus is. */
function placeOfFocus() {
  const inside = document.activeElement?.closest("[data-keys]")?.getAttribute("data-keys");
  return inside && inside in KEYS ? inside : "Page";
}

/** The keys of what has the focus. @param {{about: any}} props */
export function KeysOfFocus({ about }) {
  const [place, setPlace] = useState("Page");
  const look = () => setPlace(placeOfFocus());
  useEffect(look); // what had the focus may be gone with what was drawn, of which no event tells
  useEffect(() => {
    addEventListener("focusin", look);
    return () => removeEventListener("focusin", look);
  }, []);
  return html`<span><b>${place}</b> ${" "}<${Row} place=${place} about=${about} /></span>`;
}

/** All keys, in a dialog that `open` shows. @param {{about: any, open: boolean, close: () => void}} props */
export function AllKeys({ about, open, close }) {
  const dialog = useRef(/** @type {HTMLDialogElement | null} */ (null));
  useEffect(() => {
    if (open) dialog.current?.showModal();
  }, [open]);
  return html`<dialog ref=${dialog} onClose=${close} aria-labelledby="all-keys-title">
    <h2 id="all-keys-title">Keys</h2>
    <p class="quiet">Single letters work where no text is typed.</p>
    <div class="all-keys">${open && Object.entries(KEYS).map(([place, rows]) => html`<div key=${place}><h3>${place}</h3>
      ${rows.map(([keys, words]) => html`<p key=${words}>
        <${Keys} keys=${keys} about=${about} />${words}</p>`)}</div>`)}</div>
    <form method="dialog"><button class="edged">Close</button></form>
  </dialog>`;
}

/** Whether text is typed there, so that a letter is one. @param {EventTarget | null} target */
export const isTyped = (target) => target instanceof Element
  && target.closest("textarea, select, input:not([type=range], [type=checkbox], [type=radio])") !== null;

/** Whether the space bar presses what is there. @param {EventTarget | null} target */
export const isPressed = (target) => target instanceof Element
  && target.closest("button, summary, input, textarea, select, a, [role=button]") !== null;
