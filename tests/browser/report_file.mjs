// Composes a report as SelfContainedPage (src/oraclegs/web/assets.h) does, with every file of the run as a data: URI.
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';

const TYPES = {png: 'image/png', spz: 'application/octet-stream', bin: 'application/octet-stream'};

export async function writeReport(path, assets, {document, files}) {
  const inlined = JSON.parse(JSON.stringify(document), (key, value) => (key === 'url' ? dataUri(value, files) : value));
  const parts = [
    ['/*STYLE*/', await readFile(join(assets, 'report.css'), 'utf8')],
    ['{"DOCUMENT":0}', JSON.stringify(inlined).replaceAll('<', '\\u003c')],
    ['/*SCRIPT*/', await readFile(join(assets, 'report.js'), 'utf8')]];
  let page = await readFile(join(assets, 'report.html'), 'utf8');
  for (const [marker, text] of parts) page = page.replace(marker, () => text);
  await writeFile(path, page);
}

function dataUri(path, files) {
  const type = TYPES[path.split('.').pop()] ?? 'application/octet-stream';
  return `data:${type};base64,${files.get(path).toString('base64')}`;
}
