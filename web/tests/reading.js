// What the library would say, for tests of the page that have no server.
import { element, join } from "../src/network/algebra.js";

/** The tree that a text describes: `-` binds tighter than `|`, brackets group, a bridge has five arms.
 * @param {string} text @returns {any} */
export function read(text) {
  const tokens = text.match(/[A-Za-z][A-Za-z0-9_]*|[|(),-]/g) ?? [];
  let at = 0;
  const atom = () => {
    if (tokens[at] === "bridge" && tokens[at + 1] === "(") {
      const parts = [];
      for (at += 1; tokens[at] !== ")"; ) {
        at += 1;
        parts.push(parallel());
      }
      at += 1;
      return { kind: "bridge", parts };
    }
    if (tokens[at] !== "(") return element(tokens[at++]);
    at += 1;
    const inside = parallel();
    at += 1;
    return inside;
  };
  const several = (/** @type {string} */ sign, /** @type {any} */ kind, /** @type {() => any} */ one) => {
    const parts = [one()];
    while (tokens[at] === sign) {
      at += 1;
      parts.push(one());
    }
    return join(kind, parts);
  };
  const parallel = () => several("|", "parallel", () => several("-", "series", atom));
  return parallel();
}

/** The parts of a study whose elements are texts or ranges of no kind, and whose layouts are single texts.
 * @param {any} study @returns {import("../src/library.js").Parts} */
export function partsOf({ vehicle = {}, elements = {}, layouts = {} }) {
  const free = (/** @type {any} */ table) => Object.keys(table).filter((name) => typeof table[name] === "object");
  const inside = Object.fromEntries(
    Object.entries(layouts).map(([layout, text]) => [layout, [...new Set(String(text).match(/[A-Za-z]\w*/g) ?? [])]]),
  );
  const { model, ...quantities } = vehicle;
  const numbers = Object.entries({ vehicle: quantities, elements }).flatMap(([section, table]) =>
    Object.keys(table).map((name) => ({
      path: [section, name],
      place: section === "elements" ? name : `${section}.${name}`,
      words: name,
      sentence: "",
      unit: section === "elements" ? "N s/m" : "kg",
      value: null,
      may_be_free: true,
      name,
    })),
  );
  return {
    networks: Object.entries(layouts).map(([layout, text]) => {
      const tree = String(text).trim() ? { tree: read(String(text)) } : { sentence: "It is empty." };
      return { path: ["layouts", layout], text: String(text), ...tree };
    }),
    layouts: Object.fromEntries(
      Object.entries(inside).map(([layout, names]) => {
        const own = names.filter((name) => free(elements).includes(name));
        return [layout, { elements: names, free: [...own, ...free(quantities)], free_networks: [] }];
      }),
    ),
    elements: Object.fromEntries(
      Object.keys(elements).map((name) => {
        const users = Object.keys(inside).filter((layout) => inside[layout].includes(name));
        return [name, { kind: null, layouts: users }];
      }),
    ),
    numbers,
  };
}
