// SPDX-License-Identifier: Apache-2.0
// What a saved pipeline file extends.

/** The pipeline of the run as a saved file names it: by its path if that is absolute, else by its
    name. Then `folder` is where the file belongs. */
export function base_of(pipeline) {
  if (pipeline.startsWith("/")) return { base: pipeline, folder: null };
  const base = pipeline.split("/").at(-1);
  return { base, folder: `the folder of ${base}` };
}
