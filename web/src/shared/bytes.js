// The bytes behind a URL of the document. data: URIs are decoded here: no request, whatever the page's policy.
export async function bytesOf(url) {
  if (url.startsWith('data:')) return fromDataUri(url);
  const response = await fetch(url, {cache: 'no-cache'});
  if (!response.ok) throw new Error(`${url}: the program answers ${response.status}`);
  return response.arrayBuffer();
}

export function fromDataUri(uri) {
  const comma = uri.indexOf(',');
  return fromBase64(uri.slice(comma + 1)).buffer;
}

export function fromBase64(text) {
  const binary = atob(text);
  const out = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) out[i] = binary.charCodeAt(i);
  return out;
}

// What a splat's entry of the document names: its bytes and what is known of its Gaussians. urlOf: from its URLs to those to fetch.
export async function splatOf(entry, urlOf) {
  const marks = ['support', 'uncertainty'];
  const [bytes, ...known] = await Promise.all(
    [entry.url, ...marks.map((mark) => entry[mark]?.url)].map((url) => url && bytesOf(urlOf(url))));
  const lists = marks.map((mark, i) => [mark, known[i] && new Uint8Array(known[i])]);
  return {bytes, format: entry.format ?? 'spz', ...Object.fromEntries(lists)};
}
