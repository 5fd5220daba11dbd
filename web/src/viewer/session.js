// Talks with the program. Events: "change" (the document or the live state is new), "gone", "back".
const RUNNING_MS = 2000;  // between two looks at a running program
const WAITING_MS = 4000;  // nothing is there yet
const ENDED_MS = 20000;  // a later run in the same folder appears without a reload
const MAX_RETRY_MS = 30000;

export class Session extends EventTarget {
  constructor() {
    super();
    this.document = null;
    this.live = null;
    this.failures = 0;
    document.addEventListener('visibilitychange', () => (document.hidden ? clearTimeout(this.timer) : this.poll()));
  }

  get running() {
    return this.live?.state === 'running';
  }

  start() {
    return this.poll();
  }

  async poll() {
    clearTimeout(this.timer);
    if (this.polling) return;
    this.polling = true;
    try {
      await this.look();
      if (this.failures >= 2) this.dispatchEvent(new Event('back'));
      this.failures = 0;
    } catch {
      this.failures++;
      if (this.failures === 2) this.dispatchEvent(new Event('gone'));
    }
    this.polling = false;
    if (!document.hidden) this.schedule();
  }

  schedule() {
    let wait = this.running ? RUNNING_MS : this.live ? ENDED_MS : WAITING_MS;
    if (this.failures > 0) wait = Math.min(RUNNING_MS * 2 ** (this.failures - 1), MAX_RETRY_MS);
    else if (!this.live && this.document) return;  // a file, or a run that ended before: nothing will change
    this.timer = setTimeout(() => this.poll(), wait);
  }

  async look() {
    const live = await getJson('api/live');
    const revision = live?.document ? (live.document_revision ?? 0) : undefined;
    let changed = !this.asked || JSON.stringify(live) !== JSON.stringify(this.live);
    const stateChanged = live?.state !== this.live?.state;
    if (!this.asked || !this.document || revision !== this.revision || stateChanged) {
      const run = await getJson('api/document');
      changed ||= JSON.stringify(run) !== JSON.stringify(this.document);
      this.document = run;
      this.revision = revision;
      this.asked = true;
    }
    this.live = live;
    if (changed) this.dispatchEvent(new Event('change'));
  }
}

// The JSON of an answer; null when there is none yet (204).
async function getJson(url) {
  const response = await fetch(url, {cache: 'no-store', signal: AbortSignal.timeout(20000)});
  if (response.status === 204) return null;
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  return response.json();
}

// Where the page gets a file that the document names. All addresses are relative: the page lies at /, or deeper in the app.
export const fileUrl = (url) => (/^(data|blob):/.test(url) ? url : `files/${url.split('/').map(encodeURIComponent).join('/')}`);
