// Messages are searched for as they are printed: their signs are operators of the search engine, and their numbers
// are in no page.
const QUERY = 2; // kind of a message to the search worker
const OPERATORS = /[-+:^~*"'`=<>…]+/g;
const PATHS_AND_VALUES = /(?<!\S)(\S*\/\S*|\S+\.toml|[a-z]|\d+\.\d\S*)(?!\S)/gi;
const inWords = (sent) =>
  sent?.type === QUERY
    ? { ...sent, data: sent.data.replace(OPERATORS, " ").replace(PATHS_AND_VALUES, " ") }
    : sent;

// Pages that are opened as files may start no workers, and the search runs in one: an iframe takes its place.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      const inner = frame.contentWindow;
      inner.postMessage = (data) => {
        const event = new MessageEvent("message", { data });
        this.dispatchEvent(event);
        this.onmessage?.(event);
      };
      const script = inner.document.createElement("script");
      script.src = url;
      this.frame = frame;
      this.loaded = new Promise((resolve) => (script.onload = resolve));
      inner.document.body.append(script);
    }
    postMessage(data) {
      const inner = this.frame.contentWindow;
      this.loaded.then(() => inner.dispatchEvent(new inner.MessageEvent("message", { data })));
    }
    terminate() {
      this.frame.remove();
    }
  };
}
const post = Worker.prototype.postMessage;
Worker.prototype.postMessage = function (sent) {
  post.call(this, inWords(sent));
};
