// A field of which the text is taken over with Enter, or on leaving it.
import { textHandler } from "./controls.js";
import { html, useState } from "./html.js";

/** What is being typed stays while answers arrive and the page is drawn anew.
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
