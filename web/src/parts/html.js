// What components are made of.
import htm from "htm";
import { h } from "preact";

export { Fragment } from "preact";
export { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
export const html = htm.bind(h);
