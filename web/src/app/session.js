// What the program says, looked at again and again. Events: "change" (a document is new), "state" (see below).
const LOOK_MS = 2000;
const HIDDEN_MS = 10000;  // nobody looks at the page
const GONE_AFTER = 2;  // failures, one after the other

export class Session extends EventTarget {
  constructor() {
    super();
    this.library = null;
    this.id = null;  // of the project that is looked at
    this.project = null;  // its document, with `asked`: when it was asked for (performance.now())
    this.missing = false;  // there is no such project
    this.state = 'asking';  // 'ok', 'gone': no answer, 'locked': the cookie is missing, 'ended': somebody has quit
    this.failures = 0;
    this.known = new Map();  // path to {tag, value}
    document.addEventListener('visibilitychange', () => this.poll());
  }

  watch(id) {
    if (id !== this.id) Object.assign(this, {id, project: null, missing: false});
    return this.poll();
  }

  // Looks now; once more where a look goes on already, because what it asked may be older than what has changed.
  async poll() {
    clearTimeout(this.timer);
    if (this.polling) {
      this.again = true;
      return this.polling;
    }
    this.polling = this.look();
    await this.polling;
    this.polling = null;
    if (this.again) {
      this.again = false;
      return this.poll();
    }
    this.timer = setTimeout(() => this.poll(), document.hidden ? HIDDEN_MS : LOOK_MS);
  }

  async look() {
    const {id} = this;
    try {
      const asked = performance.now();
      const [library, project] = await Promise.all([this.get('api/library'), id && this.get(`api/projects/${encodeURIComponent(id)}`)]);
      this.failures = 0;
      const own = id && id === this.id;
      const news = library?.value !== this.library || (own && (!project || project.value !== this.project));
      if (library) this.library = library.value;
      if (own) {
        this.missing = !project;
        this.project = project ? Object.assign(project.value, {asked}) : null;
      }
      this.enter('ok');
      if (news) this.dispatchEvent(new Event('change'));
    } catch (error) {
      if (error.status === 403) this.enter('locked');
      else if (++this.failures >= GONE_AFTER) this.enter('gone');
    }
  }

  enter(state) {
    if (state === this.state || (state === 'gone' && this.state === 'ended')) return;
    this.state = state;
    this.dispatchEvent(new Event('state'));
  }

  // {tag, value}, the same object as before when nothing has changed; null when there is no such thing.
  async get(path) {
    const known = this.known.get(path);
    const response = await fetch(path, {
      cache: 'no-store', headers: known?.tag ? {'If-None-Match': known.tag} : {}, signal: AbortSignal.timeout(20000)});
    if (response.status === 304) return known;
    if (response.status === 404) return null;
    if (!response.ok) throw Object.assign(new Error(`${path}: ${response.status}`), {status: response.status});
    const text = await response.text();
    if (known?.text === text) return known;
    const entry = {tag: response.headers.get('ETag'), text, value: JSON.parse(text)};
    this.known.set(path, entry);
    return entry;
  }
}
