// SPDX-License-Identifier: Apache-2.0
// A run that a test plays: it serves the live page and implements its protocol.
import assert from "node:assert/strict";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import path from "node:path";
import { frame_message } from "./messages.mjs";

const kTypes = { "/": "text/html", "/live.css": "text/css", "/live.js": "text/javascript" };
const kFiles = { "/": "live.html", "/live.css": "live.css", "/live.js": "live.js" };
// Nothing inline, nothing from elsewhere.
const kPolicy =
  "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; " +
  "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'";
const kToken = "a token of sixteen";

export class PlayedRun {
  requests = []; // texts, in the order in which they came
  most_requests_under_way = 0;
  cameras = []; // as /cameras.json lists them
  saved = 0; // files of settings in its folder
  /** The outcome of a change request: a refusal, or "" where it is granted. */
  judge = () => "";
  /** Answers at once, or only when the test requests it. */
  answers_at_once = true;

  #web;
  #clients = new Map(); // socket -> {asked, had}: whether it waits for a frame, and its last one
  #newest = null;
  #unanswered = [];

  constructor(web, hello) {
    this.#web = path.resolve(web);
    this.hello = hello;
  }

  async start(port = 0) {
    const { WebSocketServer } = createRequire(path.join(this.#web, "package.json"))("ws");
    this.http = createServer((request, response) => this.#serve(request, response));
    const server = new WebSocketServer({
      server: this.http,
      path: "/ws",
      handleProtocols: (offered) => (offered.has("weft.live.1") ? "weft.live.1" : false),
      verifyClient: ({ req }) => new URL(req.url, "http://x").searchParams.get("token") === kToken,
    });
    server.on("connection", (client) => this.#greet(client));
    this.http.listen(port, "127.0.0.1");
    await once(this.http, "listening");
    this.port = this.http.address().port;
  }

  get address() {
    return `http://127.0.0.1:${this.port}/?token=${encodeURIComponent(kToken)}`;
  }

  /** Ends the run: it notifies its clients, and its port is free. */
  async end(code = 1001) {
    for (const client of this.#clients.keys()) client.close(code);
    this.#clients.clear();
    const closed = once(this.http, "close");
    this.http.close();
    this.http.closeAllConnections(); // those of requests; WebSockets end their handshake
    await closed;
  }

  /** The newest frame: each client that has requested one gets it. */
  show(frame) {
    this.#newest = frame_message(frame);
    for (const client of this.#clients.keys()) this.#offer(client);
  }

  /** Bytes instead of a frame. */
  show_bytes(bytes) {
    this.#newest = bytes;
    for (const client of this.#clients.keys()) this.#offer(client);
  }

  /** A setting has another value, whichever client requested it. */
  change(setting, value) {
    const { settings } = this.hello;
    const parameter = settings.stages
      .flatMap(({ parameters }) => parameters)
      .find((each) => each.setting === setting);
    parameter.value = value;
    for (const client of this.#clients.keys()) {
      client.send(JSON.stringify({ type: "settings", settings }));
    }
  }

  /** The run pauses or goes on, whichever client requested it. */
  pause(paused, frame, more = {}) {
    this.say({ type: "pause", paused, frame, ...more });
  }

  /** A message to all clients. */
  say(message) {
    for (const client of this.#clients.keys()) client.send(JSON.stringify(message));
  }

  /** Breaks all connections, as a network that fails does. */
  break_connections() {
    for (const client of this.#clients.keys()) client.terminate();
  }

  /** Answers the oldest request that has no answer. */
  answer(refusal = "") {
    const { client, number, text } = this.#unanswered.shift();
    const set = /^set ([^=]+)=(.*)$/s.exec(text);
    if (set && !refusal) this.change(set[1], JSON.parse(set[2]));
    const frame = text === "save" ? ++this.saved : 313;
    client.send(JSON.stringify({ type: "answer", number, frame, refusal }));
    if (!refusal && ["pause", "step", "resume"].includes(text)) this.pause(text !== "resume", 313);
  }

  #serve(request, response) {
    const { pathname, searchParams } = new URL(request.url, "http://x");
    if (pathname === "/cameras.json") {
      const is_allowed = searchParams.get("token") === kToken;
      response.writeHead(is_allowed ? 200 : 401, { "Content-Type": "application/json" });
      return response.end(JSON.stringify({ cameras: this.cameras }));
    }
    const known = kFiles[pathname];
    response.writeHead(known ? 200 : 404, {
      "Content-Type": `${kTypes[pathname] ?? "text/plain"}; charset=utf-8`,
      "Content-Security-Policy": kPolicy,
    });
    response.end(known ? readFileSync(path.join(this.#web, "dist", known)) : "");
  }

  #greet(client) {
    this.#clients.set(client, { asked: false, had: null });
    client.on("close", () => this.#clients.delete(client));
    client.on("message", (data) => {
      if (!this.#clients.has(client)) return; // the run has ended
      const message = JSON.parse(data);
      if (message.type === "ready") this.#ready(client);
      else this.#take_request(client, message);
    });
    client.send(JSON.stringify(this.hello));
  }

  #ready(client) {
    const state = this.#clients.get(client);
    assert.ok(!state.asked, "it asks for a second frame before it has had the first");
    state.asked = true;
    this.#offer(client);
  }

  #offer(client) {
    const state = this.#clients.get(client);
    if (!state.asked || state.had === this.#newest || !this.#newest) return;
    state.asked = false;
    state.had = this.#newest;
    client.send(this.#newest);
  }

  #take_request(client, { type, number, text }) {
    assert.equal(type, "change_request");
    this.requests.push(text);
    this.#unanswered.push({ client, number, text });
    this.most_requests_under_way = Math.max(this.most_requests_under_way, this.#unanswered.length);
    if (this.answers_at_once) this.answer(this.judge(text));
  }
}
