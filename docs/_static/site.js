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

function reachWhatScrolls() {
  for (const block of all("pre, .table-wrapper")) {
    if (block.scrollWidth > block.clientWidth) block.tabIndex = 0;
    else block.removeAttribute("tabindex");
  }
}

addEventListener("DOMContentLoaded", nameParts);
addEventListener("load", reachWhatScrolls);
addEventListener("resize", reachWhatScrolls);
