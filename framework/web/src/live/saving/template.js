// SPDX-License-Identifier: Apache-2.0
// A template made of the frame that is shown: its image, the corners of the object in it, and a
// pipeline with that template. templates/photo rectifies the image.
import { camera_of_picture, text_file } from "./recording.js";
import { StoredFile, zip } from "./zip.js";

export const kCorners = ["top left", "top right", "bottom right", "bottom left"];

const kLeastSide_px = 16; // as templates/photo has it
const kLeastSine = 0.035;

/** Why no rectangle has its corners [[x, y], ...] px there, in the order of kCorners; "" where one
    can. */
export function corners_fault(corners) {
  const side = (k) => corners[(k + 1) % 4].map((px, axis) => px - corners[k % 4][axis]);
  const short = kCorners.findIndex((_, k) => Math.hypot(...side(k)) < kLeastSide_px);
  if (short >= 0) {
    const both = `The ${kCorners[short]} and the ${kCorners[(short + 1) % 4]} corner`;
    return `${both} are closer than ${kLeastSide_px} px.`;
  }
  const sines = kCorners.map((_, k) => {
    const [to, from] = [side(k + 3), side(k)];
    return (to[0] * from[1] - to[1] * from[0]) / (Math.hypot(...to) * Math.hypot(...from));
  });
  if (sines.every((sine) => sine <= -kLeastSine)) {
    return "The corners run anticlockwise, which would mirror the object.";
  }
  const wrong = sines.findIndex((sine) => sine < kLeastSine);
  return wrong < 0 ? "" : `These are no corners of a rectangle: move the ${kCorners[wrong]} one.`;
}

/** The pipeline file that extends that of the run by the template. */
export function template_pipeline(pipeline, corners, width_mm) {
  const is_absolute = pipeline.startsWith("/");
  const base = is_absolute ? pipeline : pipeline.split("/").at(-1);
  const where = is_absolute ? "" : ` Unpack these files in the folder of ${base}.`;
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
