/* What the theme leaves out for those who do not use a mouse or see the page: levels, names, and keys for what scrolls. */
const all = selector => document.querySelectorAll(selector);

function nameParts() {
  for (const caption of all("p.caption[role=heading]")) caption.setAttribute("aria-level", "2");
  for (const link of all(".sphx-glr-thumbcontainer a")) link.setAttribute("aria-label", link.textContent.trim());
  document.querySelector("aside.sidebar-drawer")?.setAttribute("aria-label", "All pages");
  document.querySelector("aside.toc-drawer")?.setAttribute("aria-label", "Contents of this page");
  const article = document.querySelector("article[role=main]");
  if (article && !document.querySelector("h1")) {
    const heading = document.createElement("h1");
    heading.textContent = "Search";
    article.prepend(heading);
  }
}

function reachIfItScrolls(block) {
  if (block.scrollWidth > block.clientWidth) block.tabIndex = 0;
  else block.removeAttribute("tabindex");
}

const blocks = () => all("pre, .table-wrapper");
// A block is observed from its first layout on, so also where it changes before "load" or without a "resize" of the window;
// a font that arrives late changes what is in a block and not its own size.
const resized = new ResizeObserver(changes => changes.forEach(change => reachIfItScrolls(change.target)));
const whenFontsArrive = () => blocks().forEach(reachIfItScrolls);

addEventListener("DOMContentLoaded", nameParts);
addEventListener("DOMContentLoaded", () => blocks().forEach(block => resized.observe(block)));
addEventListener("load", whenFontsArrive);
document.fonts.addEventListener("loadingdone", whenFontsArrive);
