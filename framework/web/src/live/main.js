// SPDX-License-Identifier: Apache-2.0
// The live page: it draws what the run sends, and sends changes made here as requests.
import { Colouring, kColourings, write_legend } from "./colouring.js";
import { Commands } from "./commands.js";
import { Connection, socket_address } from "./connection.js";
import { History, sample_of } from "./history.js";
import { ImageView } from "./image_view.js";
import { MeshView } from "./mesh_view.js";
import { decode_frame, template_of } from "./messages.js";
import { Announcer, Notices } from "./notices.js";
import { Recorder } from "./recorder.js";
import { save_picture } from "./save.js";
import { Settings } from "./settings.js";
import { Strips } from "./strips.js";
import { ChangeRequests } from "./change_requests.js";
import {
  behind_words,
  has_ended,
  notices_of,
  offline_words,
  silent_words,
  state_words,
} from "./words.js";

const kStrips_ms = 200; // between drawings of the strips
const kStill_s = 3; // without a frame of the run, when the server says so
const kBehind_s = 5; // without one here although the run goes on, from which the page says so

const by_id = (id) => document.getElementById(id);
const now_s = () => performance.now() / 1000;

class Page {
  #template = null;
  #frame = null; // that is shown
  #colouring = new Colouring();
  #strips_at_s = 0;
  #frame_at_s = null; // when the last one was shown; null without a connection
  #ended = false; // by a request of this page
  #still_since_s = null; // when the run's last frame came, where the server says so

  constructor() {
    this.notices = new Notices(by_id("notices"));
    this.announcer = new Announcer(by_id("announcement"));
    this.history = new History();
    this.image = new ImageView(by_id("image"));
    this.mesh = this.#make_mesh_view();
    this.strips = new Strips(by_id("strips"), this.history);
    this.change_requests = new ChangeRequests((message) => this.connection.send(message));
    this.settings = new Settings(by_id("settings"), this.change_requests);
    this.commands = new Commands(by_id("commands"), this.change_requests);
    this.recorder = new Recorder(by_id("commands"));
    this.#listen();
    this.connection = new Connection(socket_address(location), {
      message: (message) => this.#receive(message),
      online: () => this.#connected(),
      offline: (how) => this.#disconnected(how),
    });
    setInterval(() => this.#watch(), 1000);
  }

  /** What tests and curious readers may ask for. */
  get frame() {
    return this.#frame;
  }

  #make_mesh_view() {
    try {
      return new MeshView(by_id("mesh"));
    } catch (error) {
      this.notices.add(`This browser draws no 3D view: ${error.message}`);
      return null;
    }
  }

  #listen() {
    for (const { name, title } of kColourings) by_id("colouring").append(new Option(title, name));
    by_id("colouring").addEventListener("change", () => this.#draw_mesh());
    by_id("overlay").addEventListener("change", ({ target }) =>
      this.image.show_mesh(target.checked),
    );
    by_id("axes").addEventListener("change", ({ target }) =>
      this.mesh?.view.show_axes(target.checked),
    );
    by_id("reset-view").addEventListener("click", () => this.mesh?.reset());
    by_id("screenshot").addEventListener("click", () => this.#save());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.mesh?.colour();
      this.#draw_mesh();
      this.image.draw();
      this.strips.draw();
    });
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
    } else if (message.type === "still") {
      this.#still_since_s = message.still ? now_s() - kStill_s : null;
      this.#watch();
    }
  }

  #begin(hello) {
    this.notices.clear();
    this.commands.forget();
    this.#template = template_of(hello);
    this.#frame = null;
    this.#colouring = new Colouring();
    const { camera } = hello;
    if (camera && this.mesh) {
      this.mesh.canvas.style.aspectRatio = `${camera.width_px} / ${camera.height_px}`;
    }
    this.image.begin(camera, this.#template);
    this.mesh?.begin(this.#template);
    this.recorder.begin_run(camera, this.#template);
    this.#show_settings(hello.settings);
    this.#ask_for_frame();
  }

  #show_settings(settings) {
    this.settings.show(settings);
    this.recorder.show_settings(settings);
    by_id("pipeline").textContent = settings?.pipeline ?? "";
    const file = settings?.pipeline?.split("/").at(-1);
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
    try {
      const frame = decode_frame(buffer);
      frame.picture = frame.image
        ? await createImageBitmap(new Blob([frame.image], { type: "image/jpeg" }))
        : null;
      if (from !== this.connection.current) return; // of a run that went away meanwhile
      await new Promise(requestAnimationFrame);
      this.#show(frame);
    } catch (error) {
      this.notices.add(`A frame could not be shown: ${error.message}.`);
    }
    if (from === this.connection.current) this.connection.send({ type: "ready" });
  }

  #show(frame) {
    this.#frame = frame;
    this.#frame_at_s = now_s();
    this.history.push(sample_of(frame, this.#frame_at_s));
    this.commands.frame_came(frame.frame);
    this.recorder.take(frame);
    this.image.show(frame);
    this.#draw_mesh();
    this.#write_state(frame);
    for (const text of notices_of(frame.report)) this.notices.add(text);
    if (this.#frame_at_s - this.#strips_at_s < kStrips_ms / 1000) return;
    this.#strips_at_s = this.#frame_at_s;
    this.strips.draw();
  }

  #draw_mesh() {
    if (!this.#frame || !this.mesh) return;
    const { value } = by_id("colouring");
    const { shares, legend } = this.#colouring.of(value, this.#frame, this.#template);
    this.mesh.show(this.#frame, shares);
    write_legend(by_id("legend"), legend);
  }

  #write_state({ frame, time_s, report }) {
    const words = state_words(report);
    const root = by_id("state");
    root.dataset.state = words.state;
    root.querySelector(".title").textContent = words.title;
    root.querySelector(".text").textContent = words.text;
    const time = Number.isFinite(time_s) ? ` · ${time_s.toFixed(2)} s` : "";
    root.querySelector(".frame").textContent = `frame ${frame}${time}`;
    this.announcer.say(words.topic, `${words.title}. ${words.text}`);
  }

  #connected() {
    this.#frame_at_s = now_s();
    this.#still_since_s = null;
    this.#ended = false;
    this.commands.connect(true);
    by_id("stages").inert = false;
    this.#say_connection("Connected", "on");
  }

  #disconnected({ was, pause_ms }) {
    this.#frame_at_s = null;
    this.change_requests.lose();
    if (this.commands.stops) this.#ended = true;
    this.commands.forget();
    this.commands.connect(false);
    by_id("stages").inert = true;
    this.recorder.leave_run();
    const how = this.#ended ? { code: 1001 } : was;
    const again = `Trying again in ${pause_ms < 1000 ? "a moment" : `${pause_ms / 1000} s`}.`;
    const words = offline_words(how, location.host);
    this.#say_connection(has_ended(how) ? words : `${words} ${again}`, "off");
    this.announcer.say("offline", words);
  }

  #say_connection(words, kind) {
    const root = by_id("connection");
    root.textContent = words;
    root.dataset.kind = kind;
  }

  /** Says so where frames do not come although the run is there. */
  #watch() {
    if (this.#frame_at_s === null || document.hidden) return;
    const since = (at_s) => Math.floor(now_s() - at_s);
    let words = "Connected";
    if (this.commands.paused) {
      // No frame is due.
    } else if (this.#still_since_s !== null) {
      words = silent_words(since(this.#still_since_s));
    } else if (since(this.#frame_at_s) >= kBehind_s) {
      words = behind_words(since(this.#frame_at_s));
    }
    this.#say_connection(words, "on");
  }

  #save() {
    if (!this.#frame) return;
    const { title, text } = state_words(this.#frame.report);
    const number = String(this.#frame.frame).padStart(6, "0");
    const words = `Frame ${this.#frame.frame}. ${title}${text && `: ${text}`}`;
    this.mesh?.view.render();
    save_picture(this.image.canvas, by_id("mesh"), words, `weft_${number}.png`);
  }
}

// For tests and for curious readers: `weft_live.frame` is the frame that is shown.
window.weft_live = new Page();
document.documentElement.dataset.ready = "true";
