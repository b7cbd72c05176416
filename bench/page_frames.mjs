// Measures the frames per second that the page draws of a recording, in Debian's chromium without a graphics card, and
// the monitor's share of a core and peak resident memory. With a DOMAIN the recording is replayed there, and the
// monitor shows what it receives.
//
// node bench/page_frames.mjs COPPICE RECORDING [SECONDS [DOMAIN]]
//
// Takes its browser from tests/web (npm ci --prefix tests/web --ignore-scripts).

import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';

import {arguments_of_chromium, program_of_chromium} from '../tests/web/page/chromium.mjs';

const {chromium} = createRequire(new URL('../tests/web/package.json', import.meta.url))('playwright-core');
const [coppice, recording, seconds = '10', domain] = process.argv.slice(2);
if (!recording) {
  console.error('usage: node bench/page_frames.mjs COPPICE RECORDING [SECONDS [DOMAIN]]');
  process.exit(2);
}

const ticks_a_second = 100;  // of /proc: sysconf(_SC_CLK_TCK) on Linux
const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
const shown = domain ? ['--domain', domain] : [recording];
const monitor = spawn(coppice, ['monitor', ...shown, '--port', '0'], {stdio: ['ignore', 'pipe', 'inherit']});
const [first_line] = await once(monitor.stdout, 'data');

const replay = domain && spawn(coppice, ['replay', recording, '--domain', domain], {stdio: 'inherit'});

function processor_seconds() {
  const fields = readFileSync(`/proc/${monitor.pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / ticks_a_second;
}
function largest_memory() {
  return Number(/VmHWM:\s*(\d+)/.exec(readFileSync(`/proc/${monitor.pid}/status`, 'utf8'))[1]) / 1024;
}

const browser = await chromium.launch({executablePath: program_of_chromium, args: arguments_of_chromium});
const page = await browser.newPage({viewport: {width: 1440, height: 900}});
await page.goto(first_line.toString().split('\n')[0]);
await page.waitForFunction(() => window.coppice.ready);

async function measure(what) {
  const state = () => page.evaluate(() => ({frames: window.coppice.frames, time: window.coppice.time, robots: window.coppice.robots}));
  const [from, began, used] = [await state(), performance.now(), processor_seconds()];
  const each = [];
  for (let k = 0; k < Number(seconds); ++k) {
    await pause(1000);
    each.push(await page.evaluate(() => window.coppice.fps));
  }
  const [to, took] = [await state(), (performance.now() - began) / 1000];
  console.log(`${what}: ${to.robots} robots, ${((to.frames - from.frames) / took).toFixed(1)} frames/s (least in a second ${Math.min(...each)}), ` +
    `${((to.time - from.time) / took).toFixed(2)} fleet seconds a second; monitor ${(100 * (processor_seconds() - used) / took).toFixed(1)} % of a core, ` +
    `at most ${largest_memory().toFixed(1)} MB`);
}

await pause(2000);
await measure('whole map');
await page.locator('#table tbody tr:not(.spacer)').nth(1).click();
await page.keyboard.press('t');
await pause(1000);
await measure('following a robot');
await browser.close();
replay?.kill('SIGTERM');
monitor.kill('SIGTERM');
await once(monitor, 'exit');
