// What one can do with a project from more than one place.
import {post, projectPath} from './api.js';
import {ask, attempt, say} from './parts.js';
import {uploadsOf} from './uploads.js';

export async function rename(session, project) {
  const name = await ask({title: 'Rename', label: 'Name', value: project.name, yes: 'Rename'});
  if (name === null || name === project.name) return;
  await attempt(() => post(projectPath(project.id, 'rename'), {name}));
  session.poll();
}

// True when it is gone.
export async function remove(project) {
  const path = projectPath(project.id, 'delete');
  const gone = await attempt(async () => {
    try {
      await post(path);
      say(`“${project.name}” is in the trash of your desktop.`);
      return true;
    } catch (error) {
      if (!error.body?.permanent) throw error;
      const sure = await ask({
        title: `Delete “${project.name}” for good?`, danger: true, yes: 'Delete for good',
        text: `${error.message} Its photos in the library and its splat cannot be brought back. Your own copies of the photos stay where they are.`});
      if (!sure) return false;
      await post(path, {permanent: true});
      say(`“${project.name}” is deleted.`);
      return true;
    }
  });
  if (gone) uploadsOf(project.id).clear();
  return Boolean(gone);
}

// pause, resume, stop, start: true when the program agreed.
export async function change(session, project, action, body = {}) {
  const answer = await attempt(() => post(projectPath(project.id, action), body));
  await session.poll();
  return Boolean(answer);
}
