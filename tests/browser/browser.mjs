// Headless Chromium with software graphics, and pages that report every console error and every request to the outside.
import {createRequire} from 'node:module';
import {existsSync} from 'node:fs';
import {fileURLToPath} from 'node:url';

const require = createRequire(fileURLToPath(new URL('../../web/package.json', import.meta.url)));

export async function launch() {
  const {chromium} = require('playwright-core');
  const executablePath = [process.env.ORACLEGS_CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find((path) => path && existsSync(path));
  if (!executablePath) throw new Error('there is no Chromium; run scripts/bootstrap.sh, or set ORACLEGS_CHROMIUM to the program');
  const sandbox = process.getuid?.() === 0 ? ['--no-sandbox'] : [];
  return chromium.launch({executablePath, args: [...sandbox, '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-dev-shm-usage']});
}

// Sizes in CSS pixels. Software draws slowly: half the pixels each way do, except for screenshots to look at.
const fine = process.argv.includes('--screenshots');
export const DESKTOP = {viewport: fine ? {width: 1440, height: 900} : {width: 1280, height: 800}, deviceScaleFactor: fine ? 1 : 0.5};
export const PHONE = {viewport: {width: 390, height: 844}, isMobile: true, hasTouch: true, deviceScaleFactor: fine ? 2 : 1};
export const NARROW = {...PHONE, viewport: {width: 360, height: 740}};

// A page whose `problems` must stay empty. origin: where it may load from; anything else is refused.
export async function openPage(browser, options, origin) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.setDefaultTimeout(30000);
  const problems = [];
  await context.route('**/*', (route) => {
    const url = route.request().url();
    if (url.startsWith(origin) || /^(data|blob):/.test(url)) return route.continue();
    problems.push(`asks for ${url}`);
    return route.abort();
  });
  page.on('console', (message) => {
    if (message.type() === 'error' || (message.type() === 'warning' && /CSP|Content Security|WebGL/.test(message.text()))) problems.push(`console: ${message.text()}`);
  });
  page.on('pageerror', (error) => problems.push(`exception: ${error.message}`));
  return {page, problems, close: () => context.close()};
}
