// SPDX-License-Identifier: Apache-2.0
// Choices that the browser keeps for the next visit, where it keeps such.

const kPrefix = "weft-live.";

export function recall(name, otherwise) {
  try {
    const text = localStorage.getItem(kPrefix + name);
    return text === null ? otherwise : JSON.parse(text);
  } catch {
    return otherwise; // storage is switched off, or holds nonsense
  }
}

export function remember(name, value) {
  try {
    localStorage.setItem(kPrefix + name, JSON.stringify(value));
  } catch {
    // The choice holds until the page is closed.
  }
}
