// SPDX-License-Identifier: Apache-2.0
// A template made of the frame that is shown: its image, the corners of the object in it, and a
// pipeline with that template. templates/photo rectifies the image.
import { base_of } from "./base.js";
import { camera_of_picture, text_file } from "./recording.js";
import { StoredFile, zip } from "./zip.js";

/** The pipeline file that extends that of the run by the template. */
export function template_pipeline(pipeline, corners, width_mm) {
  const { base, folder } = base_of(pipeline);
  const where = folder ? ` Unpack these files in ${folder}.` : "";
  const numbers = corners.flat().map((px) => Number(px.toFixed(1)));
  return (
    `# A template of the live view.${where}\nweft: 1\nextends: ${JSON.stringify(base)}\n` +
    "template:\n  use: templates/photo\n  params:\n    photo: object.jpg\n" +
    "    camera: object_camera.json\n" +
    `    width_m: ${width_mm / 1000}\n    corners: [${numbers.join(", ")}]\n`
  );
}

/** All files as one Blob: of the frame's JPEG with its size {width, height}, the camera of the run,
    the path of its pipeline, the corners, and the width of the object. */
export function template_zip({ image, picture, camera, pipeline, corners, width_mm }) {
  const pinhole = camera_of_picture(camera, picture);
  return zip([
    text_file("object.yaml", template_pipeline(pipeline, corners, width_mm)),
    text_file("object_camera.json", `${JSON.stringify(pinhole, null, 2)}\n`),
    new StoredFile("object.jpg").add(image, new Blob([image])),
  ]);
}
