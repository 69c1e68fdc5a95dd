// SPDX-License-Identifier: Apache-2.0

/** The keys of the page, as Keyboard takes them; `compare()`, `help()` and `make_template()` are
    actions of the page. */
export function shortcuts_of(page, { compare, help, make_template }) {
  const { transport, playback, mesh, layout, settings, camera_dialog } = page;
  const keys = [
    [" ", "play or pause the run", () => transport.toggle(), "space"],
    ["ArrowLeft", "frame before", () => transport.step(-1), "←"],
    ["ArrowRight", "next frame; at the newest one a step of the run", () => transport.step(1), "→"],
    [",", "loss or change before", () => playback.go_to_mark(-1)],
    [".", "next loss or change", () => playback.go_to_mark(1)],
    ["l", "newest frame", () => playback.go_live()],
    ["c", "compare with the frame before the last change", compare],
    ["f", "fit the mesh into the view", () => mesh.fit("fit")],
    ["1", "view of the camera", () => mesh.fit("front")],
    ["2", "view from the right", () => mesh.fit("side")],
    ["3", "view from above", () => mesh.fit("top")],
    ["i", "image alone", () => layout.toggle_alone("image")],
    ["m", "mesh alone", () => layout.toggle_alone("mesh")],
    ["Escape", "both views again", () => layout.leave_alone(), "Esc"],
    ["s", "settings", () => layout.toggle_drawer("settings")],
    ["t", "strips", () => layout.toggle_drawer("strips")],
    ["w", "save the settings in the folder of the run", () => settings.panel.save_in_run()],
    ["n", "template of this frame", make_template],
    ["v", "camera and its calibration", () => camera_dialog.open()],
    ["?", "this list", help],
  ];
  return keys.map(([key, words, act, name]) => ({ key, words, act, name }));
}
