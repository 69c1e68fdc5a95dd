// SPDX-License-Identifier: Apache-2.0
// What the page carries for its figures: JSON in which arrays are base64 of little-endian numbers.

function bytes_of(base64) {
  return Uint8Array.from(atob(base64), (character) => character.charCodeAt(0)).buffer;
}

export const floats = (base64) => new Float32Array(bytes_of(base64));
export const indices = (base64) => new Uint32Array(bytes_of(base64));

/** The data of the page. */
export function page_data() {
  return JSON.parse(document.getElementById("weft-data").textContent);
}

/** A number as a table shows it. */
export function shown(value, digits = 3) {
  return Number.isFinite(value) ? value.toPrecision(digits) : "–";
}

/** A new element with properties and children. */
export function element(name, properties = {}, ...children) {
  const node = Object.assign(document.createElement(name), properties);
  node.append(...children);
  return node;
}
