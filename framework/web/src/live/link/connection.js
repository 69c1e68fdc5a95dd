// SPDX-License-Identifier: Apache-2.0
// The WebSocket to the run: it is opened again, after growing pauses, for as long as the page is.

const kProtocol = "weft.live.1";
const kFirstPause_ms = 500;
const kLongestPause_ms = 10000;

/** Where the page's own server takes WebSockets, with the token of the page's address. */
export function socket_address({ protocol, host, search }) {
  const token = new URLSearchParams(search).get("token");
  const query = token === null ? "" : `?token=${encodeURIComponent(token)}`;
  return `${protocol === "https:" ? "wss" : "ws"}://${host}/ws${query}`;
}

export class Connection {
  #address;
  #told;
  #socket = null;
  #was = null; // how the last connection that stood ended
  #pause_ms = kFirstPause_ms;

  /** `told` has a function for each of: message(object or ArrayBuffer), online(), offline({was,
      pause_ms}). */
  constructor(address, told) {
    this.#address = address;
    this.#told = told;
    this.#open();
  }

  /** Says whether there is a connection; what is sent is an object. */
  send(message) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** The connection that stands now, to compare with. */
  get current() {
    return this.#socket;
  }

  #open() {
    const socket = new WebSocket(this.#address, kProtocol);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    let stood = false;
    socket.addEventListener("open", () => {
      stood = true;
      this.#pause_ms = kFirstPause_ms;
      this.#told.online();
    });
    socket.addEventListener("message", ({ data }) => {
      this.#told.message(typeof data === "string" ? JSON.parse(data) : data);
    });
    socket.addEventListener("close", ({ code, reason }) => {
      this.#socket = null;
      if (stood) this.#was = { code, reason };
      const pause_ms = this.#pause_ms;
      this.#pause_ms = Math.min(kLongestPause_ms, 2 * pause_ms);
      this.#told.offline({ was: this.#was, pause_ms });
      setTimeout(() => this.#open(), pause_ms);
    });
  }
}
