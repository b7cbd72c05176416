// Checks that the answers of a monitor in trouble fit docs/openapi.yaml.
//
// node refusals_fit.mjs URL TOKEN TROUBLE
//
// TROUBLE: full, the service has no room on its disk and says so; silent, the service says nothing; absent, the monitor
// runs without --control.
import assert from 'node:assert/strict';

import {asker, operations} from './described_api.mjs';

const [url, token, trouble] = process.argv.slice(2);
const ask = asker(url, token);
const goal = {x: 1, y: 2};

const checks = {
  async full() {
    const {detail} = await ask('POST', '/api/orders', {body: {goal}, expected: 503});
    assert.equal((await ask('GET', '/api/orders', {expected: 200})).problem, detail);
    const {alarms} = await ask('GET', '/api/alarms', {expected: 200});
    assert(alarms.some(({kind, text}) => kind === 'orders_refused' && text.endsWith(detail)), JSON.stringify(alarms));
  },
  async silent() {
    await ask('POST', '/api/orders', {body: {goal}, expected: 504});
    for (const what of ['stop', 'release', 'pause', 'resume']) await ask('POST', `/api/${what}`, {expected: 504});
  },
  async absent() {
    for (const [method, path] of operations) await ask(method, path.replace('{id}', 'one'), {described: path, expected: 404});
  },
};

await checks[trouble]();
