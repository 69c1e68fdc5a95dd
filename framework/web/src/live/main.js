// SPDX-License-Identifier: Apache-2.0
// The live page: it keeps and draws what the run sends, and sends changes made here as requests.
import { CameraDialog } from "./camera/camera_dialog.js";
import { Keyboard } from "./layout/keyboard.js";
import { Layout } from "./layout/layout.js";
import { Announcer, Notices } from "./layout/notices.js";
import { shortcuts_of } from "./layout/shortcuts.js";
import { ChangeRequests } from "./link/change_requests.js";
import { Commands } from "./link/commands.js";
import { Connection, socket_address } from "./link/connection.js";
import { decode_frame, read_frame, template_of } from "./link/messages.js";
import { Status } from "./link/status.js";
import { Recorder } from "./saving/recorder.js";
import { save_picture } from "./saving/save.js";
import { TemplateDialog } from "./saving/template_dialog.js";
import { other_stage_of, Settings } from "./settings/settings.js";
import { write_comparison } from "./time/comparison.js";
import { Delays } from "./time/delays.js";
import { History, sample_of } from "./time/history.js";
import { Playback } from "./time/playback.js";
import { Strips } from "./time/strips.js";
import { Transport } from "./time/transport.js";
import { ImageView } from "./views/image_view.js";
import { MeshPane } from "./views/mesh_pane.js";
import { ViewOptions } from "./views/view_options.js";
import { notices_of, other_shape_words, state_words } from "./words.js";

const kStrips_ms = 500; // between drawings of the strips, in which this is a pixel or two

const by_id = (id) => document.getElementById(id);
const now_s = () => performance.now() / 1000;

class Page {
  #scene = null; // text of camera and template of the run
  #frame = null; // that is shown
  #camera = null; // of the run
  #is_seeking = false; // an earlier frame is being read
  #compared = null; // place of the frame to compare with
  #other = { place: null, vertices_m: null }; // that was read last
  #other_stage = null; // the stage of `other_m`, where the run names it
  #strips_at_s = 0;
  #strips_timer = null; // until they are drawn with what came since

  constructor() {
    this.notices = new Notices(by_id("notices"));
    this.announcer = new Announcer(by_id("announcement"));
    this.history = new History();
    this.delays = new Delays();
    this.playback = new Playback(this.history, () => this.#move());
    this.image = new ImageView(by_id("image"), by_id("patch"));
    this.mesh = new MeshPane(by_id("mesh-view"), this.notices, () => this.#draw_mesh());
    this.options = new ViewOptions({
      image: () => this.image.set(this.options.image),
      mesh: () => {
        if (!this.#frame) return;
        this.#compare_image();
        this.image.draw();
        this.#draw_mesh();
      },
    });
    this.image.set(this.options.image);
    this.strips = new Strips(by_id("strips"), this.history, this.playback);
    this.change_requests = new ChangeRequests((message) => this.connection.send(message));
    this.settings = new Settings(by_id("settings"), this.change_requests);
    this.commands = new Commands(by_id("outcome"), this.change_requests, () => this.#run_changed());
    this.status = new Status(by_id("connection"), this.announcer, this.commands);
    this.transport = new Transport(by_id("transport"), this);
    this.recorder = new Recorder(by_id("transport"));
    this.template_dialog = new TemplateDialog(by_id("template-dialog"), () => ({
      camera: this.#camera,
      pipeline: this.settings.pipeline,
    }));
    this.camera_dialog = new CameraDialog(by_id("camera-dialog"), this.change_requests);
    this.layout = new Layout(() => this.#recolour());
    this.#listen();
    this.connection = new Connection(socket_address(location), {
      message: (message) => this.#receive(message),
      online: () => this.#connected(),
      offline: (how) => this.#disconnected(how),
    });
    setInterval(() => this.status.write(), 1000);
  }

  /** The frame that is shown, for tests and curious readers. */
  get frame() {
    return this.#frame;
  }

  #listen() {
    by_id("screenshot").addEventListener("click", () => this.#save());
    by_id("compare").addEventListener("click", () => this.#compare());
    const make_template = () => this.template_dialog.open(this.#frame);
    by_id("make-template").addEventListener("click", make_template);
    by_id("camera").addEventListener("click", () => this.camera_dialog.open());
    const actions = {
      compare: () => this.#compare(),
      help: () => this.keyboard.show(),
      make_template,
    };
    this.keyboard = new Keyboard(by_id("help-dialog"), shortcuts_of(this, actions));
  }

  #receive(message) {
    if (message instanceof ArrayBuffer) {
      this.#take_frame(message);
    } else if (message.type === "hello") {
      this.#begin(message);
    } else if (message.type === "settings") {
      this.#show_settings(message.settings);
    } else if (message.type === "answer") {
      this.change_requests.answer(message);
    } else if (message.type === "pause") {
      this.commands.pause_told(message);
    } else if (message.type === "calibration") {
      this.camera_dialog.calibration_told(message.calibration);
    } else if (message.type === "still") {
      this.status.still_told(message.still);
    }
  }

  #begin(hello) {
    const { camera, settings, started_with } = hello;
    this.notices.clear();
    this.#camera = camera;
    this.commands.forget();
    this.delays.begin();
    const template = template_of(hello);
    const scene = JSON.stringify([camera, hello.template]);
    if (scene !== this.#scene) {
      // Frames of the same scene stay after a break of the connection.
      this.#scene = scene;
      this.history.clear();
      this.playback.go_live();
      this.#frame = null;
      this.#compared = null;
      this.image.begin(camera, template);
      this.mesh.begin(camera, template);
    }
    this.recorder.begin_run(camera, template);
    this.camera_dialog.begin_run();
    this.settings.begin(settings, started_with);
    this.#show_settings(settings);
    this.#ask_for_frame();
  }

  #show_settings(settings) {
    this.settings.show(settings);
    this.recorder.show_settings(settings);
    this.camera_dialog.show_settings(settings);
    this.#other_stage = other_stage_of(settings);
    this.options.name_other(this.#other_stage);
    const folders = settings?.pipeline?.split("/") ?? [];
    by_id("pipeline").textContent = folders.slice(-2).join("/");
    by_id("pipeline").title = settings?.pipeline ?? "";
    const file = folders.at(-1);
    document.title = file ? `${file} – Weft live` : "Weft live";
    for (const text of settings?.warnings ?? []) this.notices.add(text);
  }

  /** One more frame, once the browser has drawn; a hidden page asks for none. */
  #ask_for_frame() {
    const asked_of = this.connection.current;
    requestAnimationFrame(() => {
      if (asked_of === this.connection.current) this.connection.send({ type: "ready" });
    });
  }

  async #take_frame(buffer) {
    const from = this.connection.current;
    const arrived_s = now_s();
    try {
      const frame = await read_frame(buffer);
      if (from !== this.connection.current) return frame.picture?.close(); // of a run that left
      await new Promise(requestAnimationFrame);
      this.#keep(frame, buffer, arrived_s);
    } catch (error) {
      this.notices.add(`A frame could not be shown: ${error.message}.`);
    }
    if (from === this.connection.current) this.connection.send({ type: "ready" });
  }

  #keep(frame, buffer, arrived_s) {
    this.status.frame_came();
    const sample = sample_of(frame, arrived_s);
    sample.delays = this.delays.of(sample);
    this.history.push(sample, buffer);
    this.commands.frame_came(frame.frame);
    this.recorder.take(frame);
    for (const text of notices_of(frame.report)) this.notices.add(text);
    this.camera_dialog.draw(frame, this.#camera);
    if (this.playback.is_live) {
      this.#show(frame);
      sample.delays.browser_ms = 1000 * (now_s() - arrived_s);
    } else {
      frame.picture?.close();
      // The moment may have left the history.
      if (this.playback.sample.frame !== this.#frame?.frame) this.#move();
    }
    const wait_ms = kStrips_ms - 1000 * (now_s() - this.#strips_at_s);
    if (wait_ms <= 0) this.#draw_time();
    else this.#strips_timer ??= setTimeout(() => this.#draw_time(), wait_ms);
  }

  #draw_time() {
    clearTimeout(this.#strips_timer);
    this.#strips_timer = null;
    this.#strips_at_s = now_s();
    this.strips.draw();
    this.transport.draw();
  }

  /** Another moment is to be shown. */
  #move() {
    this.#draw_time();
    if (!this.#is_seeking) this.#seek();
  }

  /** Shows the moment, and again if it has moved meanwhile. */
  async #seek() {
    this.#is_seeking = true;
    for (let shown = null; this.playback.sample && shown !== this.playback.sample; ) {
      shown = this.playback.sample;
      const frame = await read_frame(shown.message);
      if (this.playback.is_live && shown !== this.playback.sample) {
        frame.picture?.close(); // newer ones come by themselves
        break;
      }
      this.#show(frame);
    }
    this.#is_seeking = false;
  }

  #show(frame) {
    this.#frame = frame;
    this.options.offer(frame);
    this.#compare_image();
    this.image.show(frame);
    this.mesh.when_due(() => this.#draw_mesh());
    this.#write_state(frame);
    const other = this.#compared === null ? null : this.history.at(this.#compared);
    write_comparison(by_id("comparison"), other, this.playback.sample);
  }

  /** Vertices [3 V] m of the frame at a place of the history, or null. */
  #vertices_at(place) {
    const sample = place === null ? null : this.history.at(place);
    if (!sample) return null;
    if (sample.place !== this.#other.place) {
      const { vertices_m = null } = decode_frame(sample.message);
      this.#other = { place: sample.place, vertices_m };
    }
    return this.#other.vertices_m;
  }

  /** Compares the moment with the frame before the last change, or ends that. */
  #compare() {
    const ends = this.#compared !== null;
    this.#compared = ends ? null : this.playback.place_to_compare();
    by_id("compare").setAttribute("aria-pressed", this.#compared !== null);
    if (this.#frame) this.#move();
  }

  /** The compared mesh, else that of another stage, goes over the image too. */
  #compare_image() {
    const is_beside = this.#compared === null && this.options.mesh.beside === "other";
    const other_m = is_beside ? (this.#frame.other_m ?? null) : this.#vertices_at(this.#compared);
    this.image.compare(other_m);
  }

  /** The second mesh: {vertices_m, words} or null. */
  #second_mesh() {
    const { sample } = this.playback;
    const { beside } = this.options.mesh;
    if (this.#compared === null && beside === "other") {
      const { other_m } = this.#frame;
      const words = other_shape_words(this.#other_stage);
      return other_m ? { vertices_m: other_m, words } : null;
    }
    const place = this.#compared ?? (beside === "before" && sample ? sample.place - 1 : null);
    const vertices_m = this.#vertices_at(place);
    return vertices_m && { vertices_m, words: `frame ${this.history.at(place).frame}` };
  }

  #draw_mesh() {
    if (!this.#frame) return;
    const { sample } = this.playback;
    const { beside } = this.options.mesh;
    this.mesh.show(this.#frame, {
      ...this.options.mesh,
      other: this.#second_mesh(),
      truth_m: beside === "truth" ? (this.#frame.truth_m ?? null) : null,
      until: sample,
      history: this.history,
    });
  }

  #write_state({ report }) {
    const words = state_words(report);
    const root = by_id("state");
    const write = (part, text) => {
      const node = root.querySelector(part);
      if (node.textContent !== text) node.textContent = text; // each writing costs a layout
    };
    root.dataset.state = words.state;
    write(".title", words.title);
    write(".text", words.text);
    this.announcer.say(words.topic, `${words.title}. ${words.text}`);
  }

  #recolour() {
    this.mesh.colour();
    this.#draw_mesh();
    this.image.draw();
    this.#draw_time();
  }

  #run_changed() {
    this.delays.begin(); // the clock of a file stops in a pause
    this.transport?.draw();
  }

  #connected() {
    this.status.connected();
    this.commands.connect(true);
    by_id("stages").inert = false;
  }

  #disconnected(how) {
    this.change_requests.lose();
    this.status.disconnected(how, this.commands.stops);
    this.commands.forget();
    this.commands.connect(false);
    by_id("stages").inert = true;
    this.recorder.leave_run();
  }

  #save() {
    if (!this.#frame) return;
    const { title, text } = state_words(this.#frame.report);
    const number = String(this.#frame.frame).padStart(6, "0");
    const words = `Frame ${this.#frame.frame}. ${title}${text && `: ${text}`}`;
    this.mesh.render();
    save_picture(this.image.canvas, by_id("mesh"), words, `weft_${number}.png`);
  }
}

// For tests and for curious readers: `weft_live.frame` is the frame that is shown.
window.weft_live = new Page();
document.documentElement.dataset.ready = "true";
