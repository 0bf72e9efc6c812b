// A name; that of an element as a symbol, as in the picture of the vehicle.
import { symbolParts } from "../state/scale.js";
import { html } from "./html.js";

/** @param {{label: string, element?: boolean}} props */
export function Name({ label, element = true }) {
  const [symbol, subscript] = element ? symbolParts(label) : [label, ""];
  return subscript ? html`${symbol}<sub>${subscript}</sub>` : symbol;
}
