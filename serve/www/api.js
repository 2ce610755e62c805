// Answers of this page's server. Whatever goes wrong is an Error whose message is for people.

const KEPT = 80;
const kept = new Map();

export const addressOf = (path, parameters) => {
  const out = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters ?? {}))
    if (value !== "" && value !== undefined && value !== null) out.set(name, value);
  return out.size > 0 ? `${path}?${out}` : path;
};

const fromServer = (words) => Object.assign(new Error(words), { fromServer: true });

async function fetched(address, read = (reply) => reply.json()) {
  let reply;
  try {
    reply = await fetch(address);
  } catch {
    throw fromServer("The server of this page does not answer: has irsig serve ended?");
  }
  let body;
  try {
    body = await (reply.ok ? read(reply) : reply.json());
  } catch {
    throw fromServer(`The server's answer cannot be read (${reply.status}).`);
  }
  if (!reply.ok) throw fromServer(body.error ?? `The server refused (${reply.status}).`);
  return body;
}

// Returns an answer from the cache, if there is one, until forget().
export function ask(path, parameters) {
  const address = addressOf(path, parameters);
  let answer = kept.get(address);
  kept.delete(address);
  answer ??= fetched(address);
  kept.set(address, answer);
  answer.catch(() => kept.delete(address));
  if (kept.size > KEPT) kept.delete(kept.keys().next().value);
  return answer;
}

// Bytes that are not kept, since images may be large.
export const askBytes = (path, parameters) => fetched(addressOf(path, parameters), (reply) => reply.arrayBuffer());
export const askAnew = (path) => fetched(path);
export const forget = () => kept.clear();
