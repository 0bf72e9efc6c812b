// A plot as a file: the picture with its colours in it, as SVG or as pixels.

const KEPT = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "opacity",
  "font-family", "font-size", "font-weight", "font-style", "text-anchor", "paint-order"];
const SHARP = 2; // pixels of a picture for one of the screen

/** The picture as a text, which needs no style of the page. @param {SVGSVGElement} drawn @param {string} ground */
export function svgOf(drawn, ground) {
  const copy = /** @type {SVGSVGElement} */ (drawn.cloneNode(true));
  const [from, to] = [drawn, copy].map((each) => [...each.querySelectorAll("*")]);
  from.forEach((element, i) => {
    const style = getComputedStyle(element);
    const text = KEPT.map((name) => [name, style.getPropertyValue(name)]).filter(([, value]) => value !== "");
    for (const [name, value] of text) to[i].setAttribute(name, value.replaceAll('"', "'"));
    for (const name of ["class", "style", "tabindex", "role", "aria-label"]) to[i].removeAttribute(name);
  });
  for (const extra of copy.querySelectorAll("[data-screen]")) extra.remove();
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  const behind = document.createElementNS(copy.namespaceURI, "rect");
  for (const name of ["width", "height"]) behind.setAttribute(name, "100%");
  behind.setAttribute("fill", ground);
  copy.prepend(behind);
  for (const name of ["class", "style", "role", "aria-label"]) copy.removeAttribute(name);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(copy)}\n`;
}

/** The picture in pixels. @param {SVGSVGElement} drawn @param {string} ground @returns {Promise<Blob>} */
export async function pngOf(drawn, ground) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svgOf(drawn, ground))}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [drawn.clientWidth, drawn.clientHeight].map((size) => Math.round(SHARP * size));
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  pen.fillStyle = ground;
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done, fail) => canvas.toBlob((blob) => (blob ? done(blob) : fail(new Error("no picture")))));
}
