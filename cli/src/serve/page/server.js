// Requests to the server, and their answers in words.

/** The failure of a request or a run in words. */
export function words(error) {
  const { message, remedy, line } = error ?? {};
  return [message ?? "It failed.", line ? ` (line ${line})` : "", remedy ? `\nRemedy: ${remedy}` : ""].join("");
}

/** Sends a request; its answer as JSON. Throws an error whose message is for people. */
export async function ask(method, address, body, kind = "application/json") {
  let response;
  try {
    response = await fetch(address, { method, body, headers: body === undefined ? {} : { "Content-Type": kind } });
  } catch {
    throw new Error("The server does not answer: was `knotdock serve` ended?");
  }
  const text = await response.text();
  let answer = null;
  try { answer = JSON.parse(text); } catch { /* An answer of the server's library is plain text. */ }
  if (!response.ok) throw new Error(words(answer?.error ?? { message: text || response.statusText }));
  return answer;
}

/** A file of an upload as text, unpacked. */
export async function textOf(upload, name) {
  const response = await fetch(`/api/uploads/${encodeURIComponent(upload)}/${encodeURIComponent(name)}`);
  if (!response.ok) throw new Error(`${name} is not on the server any more.`);
  if (!/\.gz$/i.test(name)) return response.text();
  return new Response(response.body.pipeThrough(new DecompressionStream("gzip"))).text();
}

export function duration(seconds) {
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  return whole < 3600 ? `${Math.floor(whole / 60)} min ${whole % 60} s` : `${Math.floor(whole / 3600)} h ${Math.round(whole % 3600 / 60)} min`;
}
