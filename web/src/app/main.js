// The door of OracleGS: photos in, a splat out, without a terminal.
import {fill, h, put} from '../shared/dom.js';
import {post} from './api.js';
import {listenForDrops} from './drop.js';
import {LibraryPage} from './library.js';
import {begin, NewPage} from './new_page.js';
import {announcer, ask, attempt, button, setText, toasts} from './parts.js';
import {ProjectPage} from './project_page.js';
import {Session} from './session.js';
import {anyPending, retryAllBroken} from './uploads.js';

const BANNERS = {
  gone: 'The program has ended; start OracleGS again. A run that was going on goes on without it, and this page finds it again by itself.',
  locked: 'This page is locked. Open the address that the program printed when it was started, or start OracleGS from the menu.',
  ended: 'OracleGS has ended. A run that was going on goes on. Start OracleGS again to see it; this tab can be closed.'};

const session = new Session();
const banner = h('p', {class: 'banner', role: 'alert', hidden: true});
const main = h('main', {id: 'main', tabIndex: -1});
const library = new LibraryPage(session);
const links = {library: h('a', {href: '#/'}, 'Your splats'), new: h('a', {href: '#/new', class: 'button primary'}, 'New splat')};

put(document.getElementById('page'),
  h('header', {class: 'top'}, h('a', {class: 'brand', href: '#/', 'aria-label': 'OracleGS, your splats'}, 'OracleGS'),
    h('nav', {'aria-label': 'Pages'}, links.library, links.new), button('Quit', quit, {class: 'quit'})),
  banner, main, announcer, toasts);

// "Skip to content" must not change the hash, which says what is shown.
document.querySelector('[data-skip]').addEventListener('click', (event) => {
  event.preventDefault();
  main.focus();
});

let page;

function route() {
  const [, where, id] = /^#\/(p\/)?([^/]*)/.exec(location.hash) ?? [];
  if (where) return {key: `p/${id}`, id: decode(id), make: () => new ProjectPage(session, decode(id))};
  if (id === 'new') return {key: 'new', make: () => new NewPage(session)};
  return {key: 'library', make: () => library};
}

function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

let at;
function go() {
  const {key, id, make} = route();
  if (key === at) return;
  const first = at === undefined;
  at = key;
  page?.close?.();
  page = make();
  page.key = key;
  fill(main, page.element);
  for (const [name, link] of Object.entries(links)) {
    if (name === key) link.setAttribute('aria-current', 'page');
    else link.removeAttribute('aria-current');
  }
  session.watch(id ?? null);
  update();
  if (first) return;
  window.scrollTo(0, 0);
  page.element.querySelector('h1').focus({preventScroll: true});
}

function update() {
  page.update();
  const title = page.title === 'OracleGS' ? page.title : `${page.title} – OracleGS`;
  if (document.title !== title) document.title = title;
}

async function quit() {
  const sure = await ask({
    title: 'Quit OracleGS?', yes: 'Quit', text: 'This page then shows nothing new until you start OracleGS again. A run that is going on goes on, and so does the queue once you are back.'});
  if (sure && (await attempt(() => post('api/quit')))) session.enter('ended');
}

session.addEventListener('change', update);
session.addEventListener('state', () => {
  const text = BANNERS[session.state];
  banner.hidden = !text;
  setText(banner, text ?? '');
  if (session.state === 'ok') retryAllBroken();
});
window.addEventListener('hashchange', go);
window.addEventListener('beforeunload', (event) => anyPending() && event.preventDefault());
listenForDrops((drop) => (page.take ? page.take(drop) : begin(session, drop)));

go();
globalThis.oraclegsApp = {session};  // for the console and for tests
