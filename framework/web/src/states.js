// SPDX-License-Identifier: Apache-2.0
/** The states of a shape; one that is seldom seen stands out. */
export const kStates = [
  { name: "estimated", colour: "var(--series-1)" },
  { name: "weak", colour: "var(--series-5)" },
  { name: "predicted", colour: "var(--series-2)" },
  { name: "lost", colour: "var(--bad)" },
  { name: "none", colour: "var(--series-8)" },
];
