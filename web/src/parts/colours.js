// The colour of a layout, for styles.
import { layoutColours } from "../plots/colours.js";

/** @param {import("../state/document.js").Document} document @param {string} layout */
export const layoutColour = (document, layout) => `var(--${layoutColours(document)[layout] ?? "s3"})`;
