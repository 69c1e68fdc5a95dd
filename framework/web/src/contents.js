// SPDX-License-Identifier: Apache-2.0
// The table of contents marks the section that is being read.

const kLine = 0.25; // share of the window's height

export function mark_contents() {
  const links = [...document.querySelectorAll("nav a")];
  const sections = links.map((link) => document.querySelector(link.hash));
  const mark = () => {
    const read = sections.findLastIndex(
      (section) => section.getBoundingClientRect().top <= kLine * window.innerHeight,
    );
    links.forEach((link, i) => {
      if (i === Math.max(0, read)) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    });
  };
  document.addEventListener("scroll", mark, { passive: true });
  mark();
}
