// Shapes on a canvas, in the colours of the page.

import { symbolParts } from "../state/scale.js";

/** @import { Shape, Point } from "./symbols.js" */
/** @typedef {{fill?: string, stroke?: string, width?: number, dash?: number[], font?: string, alpha?: number,
 * round?: boolean}} Style */

const COLOURS = ["surface", "ink", "ink2", "line", "accent", "soft", "stick", "warn", "body", "glass", "tyre", "earth",
  "road", "s1", "s2", "s3", "s4", "s5", "s6"]; // of the page's styles

const DASH = [4, 3];
const SERIF = "italic 14px 'STIX Two Math', 'Cambria Math', Georgia, 'DejaVu Serif', serif";
const PLAIN = "11px Inter, system-ui, 'Segoe UI', Roboto, sans-serif";

/** How each class looks. @param {Element} element whose styles hold @param {string} own the colour of the design
 * @returns {{[kind: string]: Style}} */
export function stylesOf(element, own = "var(--s3)") {
  const found = getComputedStyle(element);
  const c = Object.fromEntries(COLOURS.map((name) => [name, found.getPropertyValue(`--${name}`)]));
  return {
    ground: { fill: c.surface },
    wire: { stroke: c.ink, width: 1.6 }, "wire open": { stroke: c.stick, width: 1.8 },
    hatch: { stroke: c.ink2, width: 1 },
    oil: { fill: c.soft }, box: { fill: c.surface, stroke: c.ink, width: 1.6 },
    flywheel: { fill: c.soft, stroke: c.ink, width: 1.6 }, dot: { fill: c.ink },
    block: { fill: c.surface, stroke: c.ink, width: 1.6 }, "block stick": { fill: c.stick, stroke: c.ink, width: 1.6 },
    name: { fill: c.ink, font: SERIF, stroke: c.surface }, text: { fill: c.ink, font: PLAIN },
    quiet: { fill: c.ink2, font: PLAIN }, "on earth": { fill: c.ink2, font: PLAIN, stroke: c.earth },
    beside: { fill: c.ink2, font: PLAIN, stroke: c.surface },
    told: { fill: c.warn, font: `600 ${PLAIN}`, stroke: c.surface },
    earth: { fill: c.earth }, plain: { fill: c.earth, alpha: 0.6 }, road: { stroke: c.road, width: 2.2 },
    strip: { stroke: c.road, width: 8, alpha: 0.3 },
    body: { fill: c.body, stroke: c.ink, width: 1.6 },
    "body round": { fill: c.body, stroke: c.ink, width: 1.6, round: true },
    "body far": { fill: c.body, stroke: c.ink, width: 1.4, alpha: 0.5 },
    "body near": { fill: c.body, stroke: c.ink, width: 1.4, alpha: 0.72 },
    glass: { fill: c.glass, stroke: c.ink2, width: 0.9 },
    "glass near": { fill: c.glass, stroke: c.ink2, width: 0.9, alpha: 0.7 },
    edge: { stroke: c.ink2, width: 1, alpha: 0.6 }, cut: { fill: c.surface, alpha: 0.88, round: true },
    seat: { stroke: c.ink, width: 4 }, centre: { fill: c.surface, stroke: c.ink, width: 1.3 }, quarter: { fill: c.ink },
    tyre: { fill: c.tyre, stroke: c.ink2, width: 1 }, rim: { fill: c.body }, spoke: { stroke: c.ink2, width: 2.6 },
    hub: { fill: c.ink }, halo: { stroke: c.surface, width: 8 }, "halo thin": { stroke: c.surface, width: 4 },
    carrier: { stroke: c.ink, width: 4 }, "carrier thin": { stroke: c.ink, width: 2 },
    link: { stroke: c.s4, width: 4 }, lever: { stroke: c.ink, width: 4 }, beam: { stroke: c.ink, width: 7 },
    joint: { fill: c.surface, stroke: c.ink, width: 1.4 }, pivot: { fill: c.ink2 },
    chair: { fill: c.ink2 }, limb: { stroke: c.ink, width: 6 }, "limb thin": { stroke: c.ink, width: 3 },
    trunk: { stroke: c.ink, width: 9 }, "trunk thin": { stroke: c.ink, width: 4.5 }, head: { fill: c.ink },
    chosen: { stroke: c.accent, width: 0.7 },
    other: { stroke: c.s1, width: 1.5, dash: DASH },
    "other round": { stroke: c.s1, width: 1.5, dash: DASH, round: true },
    "other trail": { stroke: c.s1, width: 1.5, dash: DASH }, bar: { stroke: c.ink, width: 1.2 },
    own: { stroke: c[own.replace(/^var\(--|\)$/g, "")] ?? c.s3, width: 2.2 },
  };
}

/** @param {string} kind @param {{[kind: string]: Style}} styles @returns {Style} */
function styleOf(kind, styles) {
  const found = styles[kind] ?? styles[kind.trim()];
  if (found) return found;
  const plain = styles[kind.replace(/ chosen$/, "")] ?? styles.wire;
  const { stroke, width } = styles.chosen;
  return (styles[kind] = plain.stroke ? { ...plain, stroke, width: (plain.width ?? 1) + (width ?? 0) } : plain);
}

const HALO = 3; // [px] around what is written over something
const CORNER = 9; // [px] of a body

/** Paints shapes one over the other. @param {CanvasRenderingContext2D} pen @param {Shape[]} shapes
 * @param {{[kind: string]: Style}} styles */
export function paint(pen, shapes, styles) {
  pen.lineJoin = "round";
  pen.lineCap = "round";
  for (const shape of shapes) {
    const style = styleOf(shape.class, styles);
    pen.globalAlpha = style.alpha ?? 1;
    if (shape.kind === "text") {
      write(pen, shape, style);
      continue;
    }
    pen.beginPath();
    if (shape.kind === "circle") pen.arc(shape.x, shape.y, Math.max(0, shape.r), 0, 2 * Math.PI);
    else if (style.round && shape.kind === "polygon") rounded(pen, shape.points);
    else for (const [x, y] of shape.points) pen.lineTo(x, y);
    if (shape.kind === "polygon") pen.closePath();
    if (style.fill && shape.kind !== "line") {
      pen.fillStyle = style.fill;
      pen.fill();
    }
    if (!style.stroke) continue;
    pen.strokeStyle = style.stroke;
    pen.lineWidth = style.width ?? 1;
    pen.setLineDash(style.dash ?? []);
    pen.stroke();
  }
  pen.globalAlpha = 1;
  pen.setLineDash([]);
}

/** @param {CanvasRenderingContext2D} pen @param {Point[]} points */
function rounded(pen, points) {
  const last = points[points.length - 1];
  const tall = Math.hypot(points[1][0] - points[2][0], points[1][1] - points[2][1]);
  pen.moveTo((last[0] + points[0][0]) / 2, (last[1] + points[0][1]) / 2);
  points.forEach(([x, y], i) => {
    const next = points[(i + 1) % points.length];
    pen.arcTo(x, y, (x + next[0]) / 2, (y + next[1]) / 2, Math.min(CORNER, tall / 2.2));
  });
}

/** A text, or a name as a symbol. @param {CanvasRenderingContext2D} pen
 * @param {Extract<Shape, {kind: "text"}>} shape @param {Style} style */
function write(pen, { x, y, text, anchor = "start", class: kind }, style) {
  pen.fillStyle = style.fill ?? "";
  pen.font = style.font ?? PLAIN;
  pen.textAlign = anchor === "middle" ? "center" : anchor;
  const [symbol, subscript] = kind === "name" ? symbolParts(text) : [text, ""];
  pen.strokeStyle = style.stroke ?? "";
  pen.lineWidth = HALO;
  pen.setLineDash([]);
  /** @param {string} words @param {number} across @param {number} down */
  const put = (words, across, down) => {
    if (style.stroke) pen.strokeText(words, across, down);
    pen.fillText(words, across, down);
  };
  put(symbol, x, y);
  if (!subscript) return;
  const beside = x + pen.measureText(symbol).width + 1;
  pen.font = SERIF.replace("14px", "10px");
  put(subscript, beside, y + 3);
}
