// The routes of `oraclegs view` for the tests: the pages, the document, the live state, and the files that they name.
import {readFile} from 'node:fs/promises';
import {createServer} from 'node:http';
import {join} from 'node:path';

const CSP = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval' blob:; worker-src blob: 'self'; img-src 'self' data: blob:; style-src 'self'; connect-src 'self' data: blob:";
const TYPES = {html: 'text/html; charset=utf-8', js: 'text/javascript; charset=utf-8', css: 'text/css; charset=utf-8', png: 'image/png'};

// state: {document, live, files: Map}; what it holds may change between requests. Counts requests by path.
export async function startServer(assets, state) {
  const counts = new Map();
  const server = createServer(async (request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    counts.set(path, (counts.get(path) ?? 0) + 1);
    const send = (body, type) => {
      response.writeHead(body ? 200 : 204, {'Content-Type': type, 'Content-Security-Policy': CSP, 'Cache-Control': 'no-cache', 'X-Content-Type-Options': 'nosniff'});
      response.end(body);
    };
    const type = TYPES[path.split('.').pop()] ?? 'application/octet-stream';
    if (path === '/') return send(await readFile(join(assets, 'viewer.html')), TYPES.html);
    if (/^\/assets\/viewer\.(js|css)$/.test(path)) return send(await readFile(join(assets, path.slice(8))), type);
    if (path === '/api/document') return send(state.document && JSON.stringify(state.document), 'application/json');
    if (path === '/api/live') return send(state.live && JSON.stringify(state.live), 'application/json');
    const file = path.startsWith('/files/') && state.files.get(path.slice(7));
    if (file) return send(file, type);
    response.writeHead(404).end();
  });
  await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
  const close = () => new Promise((done) => {
    server.close(done);
    server.closeAllConnections();
  });
  return {url: `http://127.0.0.1:${server.address().port}/`, counts, close};
}
