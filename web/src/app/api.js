// Changes are POSTs of JSON. What the program refuses becomes an error with its words.

export class Refused extends Error {
  constructor(status, body) {
    super(body.error || (status === 403 ? 'Open the address that the program printed.' : `The program answers ${status}.`));
    Object.assign(this, {status, body});
  }
}

// The answer as JSON; {} where there is none.
export async function post(path, body = {}) {
  let response;
  try {
    response = await fetch(path, {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body)});
  } catch {
    throw new Error('The program does not answer.');
  }
  const answer = await response.json().catch(() => ({}));
  if (!response.ok) throw new Refused(response.status, answer);
  return answer;
}

export const projectPath = (id, action) => `api/projects/${encodeURIComponent(id)}/${action}`;
export const filesPath = (id, rest) => `projects/${encodeURIComponent(id)}/${rest}`;
