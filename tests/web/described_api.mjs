// Asks a monitor, and checks each answer by what docs/openapi.yaml says of its path, method and status.
//
// A field that the description does not name is an error here, though clients accept it: else the description would not
// grow with the API.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import http from 'node:http';
import {createRequire} from 'node:module';

import Ajv from 'ajv/dist/2020.js';

export const root = new URL('../../', import.meta.url);
const {parse} = createRequire(new URL('monitor/web/package.json', root))('yaml');
export const api = parse(readFileSync(new URL('docs/openapi.yaml', root), 'utf8'));

/// [method, path] of all that is described.
export const operations = Object.entries(api.paths).flatMap(([path, all]) =>
  ['get', 'post', 'delete'].filter((method) => all[method]).map((method) => [method.toUpperCase(), path]));

/// 'GET /api/orders 200': how often.
export const seen = new Map();

/// Objects have no fields but those that are described.
function closed(schema) {
  if (Array.isArray(schema)) return schema.map(closed);
  if (typeof schema !== 'object' || schema === null) return schema;
  const all = Object.fromEntries(Object.entries(schema).map(([word, value]) => [word, closed(value)]));
  return all.properties ? {additionalProperties: false, ...all} : all;
}

const ajv = new Ajv({strict: false, validateFormats: false});
ajv.addSchema({...closed(api), $id: 'api'});
const resolve = (part) => (part.$ref ? part.$ref.slice(2).split('/').reduce((at, name) => at[name], api) : part);
const escaped = (name) => name.replaceAll('~', '~0').replaceAll('/', '~1');

export function fits(pointer, data, what) {
  const check = ajv.getSchema(`api#${pointer}`);
  assert(check, `the description has no ${pointer}`);
  assert(check(data), `${what}: ${JSON.stringify(data)}: ${ajv.errorsText(check.errors)}`);
}

/// Unlike fetch(), it also says another Host.
function request(url, {method, headers, body = ''}) {
  return new Promise((done, fail) => {
    const asked = http.request(url, {method, agent: false, headers: {...headers, 'Content-Length': Buffer.byteLength(body)}}, async (answer) => {
      let text = '';
      for await (const piece of answer.setEncoding('utf8')) text += piece;
      done({status: answer.statusCode, headers: answer.headers, text});
    });
    asked.on('error', fail);
    asked.end(body);
  });
}

/// `described`: the path in the description, if it has parameters.
export const asker = (url, token) => async (method, path, {body, query = '', expected, headers = {Authorization: `Bearer ${token}`}, described = path} = {}) => {
  const {status, headers: told, text} = await request(new URL(`${path.slice(1)}${query}`, url), {method, headers, body: body && JSON.stringify(body)});
  const what = `${method} ${described} ${status}`;
  assert.equal(status, expected, `${method} ${path}${query}: ${text}`);
  const answer = api.paths[described][method.toLowerCase()].responses[status];
  assert(answer, `${what} is not in the description`);
  const [[type, {schema}]] = Object.entries(resolve(answer).content);
  assert.equal(told['content-type'], type, what);
  const place = answer.$ref ? answer.$ref.slice(1) : `/paths/${escaped(described)}/${method.toLowerCase()}/responses/${status}`;
  const data = JSON.parse(text);
  fits(schema.$ref ? schema.$ref.slice(1) : `${place}/content/${escaped(type)}/schema`, data, what);
  for (const name of Object.keys(resolve(answer).headers ?? {})) assert(told[name.toLowerCase()], `${what} has a header ${name}`);
  seen.set(what, (seen.get(what) ?? 0) + 1);
  return data;
};
