// SPDX-License-Identifier: Apache-2.0
// Search from file://, where browsers start no worker: the script of the worker runs in a frame.
// The theme's worker looks for IFrameWorker in its parent. search_index.js has the index as a script.
window.IFrameWorker = class extends EventTarget {
  constructor(url) {
    super();
    const frame = document.createElement("iframe");
    frame.hidden = true;
    frame.srcdoc = "<!doctype html><html><body></body></html>";
    this.frame = new Promise((ready) => frame.addEventListener("load", () => {
      const inner = frame.contentWindow;
      inner.postMessage = (data) => this.answer(data);
      const script = frame.contentDocument.createElement("script");
      script.src = url;
      script.addEventListener("load", () => ready(inner));
      frame.contentDocument.body.append(script);
    }, { once: true }));
    document.body.append(frame);
  }
  answer(data) {
    const event = new MessageEvent("message", { data });
    this.dispatchEvent(event);
    this.onmessage?.(event);
  }
  postMessage(data) {
    this.frame.then((inner) => inner.dispatchEvent(new inner.MessageEvent("message", { data })));
  }
  terminate() {}
};
window.Worker = window.IFrameWorker;
