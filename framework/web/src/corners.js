// SPDX-License-Identifier: Apache-2.0
// The corners of a flat object in its image, moved by hand: for the live page, and for the page that
// `weft template make` writes. Places are [x, y] in px of the image, whose top left pixel has its
// centre at (0, 0).

export const kNames = ["top left", "top right", "bottom right", "bottom left"];

const kLeastSide_px = 16; // as templates/photo has it
const kLeastSine = 0.035;
const kInset = 0.15; // of the image, where no corners are known

/** Along an axis: the place at a share of the image, and the share of a place. */
export const to_px = (share, size_px) => share * size_px - 0.5;
export const to_share = (px, size_px) => (px + 0.5) / size_px;

/** The nearest place of the image, which ends half a pixel beyond its outer centres; to a
    tenth of a pixel. */
export const within = (place_px, sizes_px) =>
  place_px.map((px, axis) => {
    const legal = Math.min(Math.max(px, -0.5), sizes_px[axis] - 0.5);
    return Math.round(10 * legal) / 10;
  });

/** Where the rings stand at first. */
export function first_corners({ width_px, height_px, corners_px }) {
  const sizes_px = [width_px, height_px];
  const shares = [
    [kInset, kInset],
    [1 - kInset, kInset],
    [1 - kInset, 1 - kInset],
    [kInset, 1 - kInset],
  ];
  const places = corners_px ?? shares.map((at) => at.map((s, axis) => to_px(s, sizes_px[axis])));
  return places.map((place) => within(place, sizes_px));
}

/** Why no rectangle has its corners [[x, y], ...] px there, in the order of kNames; "" where one
    can. */
export function fault_of(corners) {
  const side = (k) => corners[(k + 1) % 4].map((px, axis) => px - corners[k % 4][axis]);
  for (let k = 0; k < 4; ++k) {
    if (Math.hypot(...side(k)) >= kLeastSide_px) continue;
    const both = `The ${kNames[k]} and the ${kNames[(k + 1) % 4]} corner`;
    return `${both} are closer than ${kLeastSide_px} px.`;
  }
  const sines = kNames.map((_, k) => {
    const [to, from] = [side(k + 3), side(k)];
    return (to[0] * from[1] - to[1] * from[0]) / (Math.hypot(...to) * Math.hypot(...from));
  });
  if (sines.every((sine) => sine <= -kLeastSine)) {
    return "The corners run anticlockwise, which would mirror the object.";
  }
  const wrong = sines.findIndex((sine) => sine < kLeastSine);
  if (wrong < 0) return "";
  return `These are no corners of a rectangle: move the ${kNames[wrong]} one.`;
}

const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** A button that pointer and arrow keys move over a picture. `corner` has box(), the DOMRect of the
    picture as it is shown, sizes_px(), place(), and move(place_px, is_by_key). */
export function make_ring(name, corner) {
  const ring = document.createElement("button");
  ring.type = "button";
  ring.className = "ring";
  ring.title = `${name} corner`;
  let grip = null; // from the ring's middle to where it is held, in px of the screen
  ring.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const box = ring.getBoundingClientRect();
    grip = [event.clientX - (box.left + box.width / 2), event.clientY - (box.top + box.height / 2)];
    ring.setPointerCapture(event.pointerId);
    ring.focus();
    event.preventDefault();
  });
  ring.addEventListener("pointermove", (event) => {
    if (!grip) return;
    const box = corner.box();
    const [width_px, height_px] = corner.sizes_px();
    const place_px = [
      to_px((event.clientX - grip[0] - box.left) / box.width, width_px),
      to_px((event.clientY - grip[1] - box.top) / box.height, height_px),
    ];
    corner.move(place_px, false);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    ring.addEventListener(end, () => (grip = null));
  }
  ring.addEventListener("keydown", (event) => {
    const arrow = kArrows[event.key];
    if (!arrow || event.altKey || event.ctrlKey || event.metaKey) return;
    const step_px = event.shiftKey ? 10 : 1;
    corner.move(corner.place().map((px, axis) => px + step_px * arrow[axis]), true);
    event.preventDefault();
  });
  return ring;
}
