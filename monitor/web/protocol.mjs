// Makes src/live.js and its types from idl/live.proto.
import {readFileSync, writeFileSync} from 'node:fs';
import {compileRaw} from 'pbf/compile';
import {parse} from 'protocol-buffers-schema';

const source = readFileSync(new URL('../../idl/live.proto', import.meta.url), 'utf8');
const schema = parse(source);
const optional = new Set([...source.matchAll(/^ *optional \S+ (\w+)/gm)].map((m) => m[1]));  // parse() drops this property

const scalar = {string: 'string', bool: 'boolean', bytes: 'Uint8Array | undefined'};
const numbers = ['double', 'float', 'uint32', 'sint32', 'int32', 'uint64'];

function typeOf(field, scope) {
  const nested = scope.find((path) => declared.has(path + field.type));
  const single = nested !== undefined ? nested + field.type
    : numbers.includes(field.type) ? 'number' : scalar[field.type];
  if (!single) throw new Error(`live.proto: ${field.name} has type ${field.type}, which protocol.mjs does not support`);
  if (field.repeated) return `${single}[]`;
  return declared.get(single) === 'message' ? `${single} | undefined` : single;
}

const declared = new Map();  // full name: message or enum
function declare({messages = [], enums = []}, path) {
  for (const e of enums) declared.set(path + e.name, 'enum');
  for (const m of messages) {
    declared.set(path + m.name, 'message');
    declare(m, path + m.name);
  }
}
declare(schema, '');

function types({messages = [], enums = []}, path) {
  let text = '';
  for (const e of enums) {
    const values = Object.entries(e.values);
    text += `export const ${path}${e.name}: {${values.map(([name, {value}]) => `readonly ${name}: ${value}`).join('; ')}};\n`;
    text += `export type ${path}${e.name} = ${values.map(([, {value}]) => value).join(' | ')};\n`;
  }
  for (const m of messages) {
    const name = path + m.name;
    const oneofs = new Map();
    let fields = '';
    for (const field of m.fields) {
      // Like protoc: an optional field is alone in a oneof, which tells whether the field was sent.
      if (optional.has(field.name) && !field.oneof) field.oneof = `_${field.name}`;
      if (field.oneof) oneofs.set(field.oneof, [...(oneofs.get(field.oneof) ?? []), `'${field.name}'`]);
      fields += `  ${field.name}: ${typeOf(field, [name, path, ''])};\n`;
    }
    for (const [oneof, members] of oneofs) fields += `  ${oneof}?: ${members.join(' | ')};\n`;
    text += `export interface ${name} {\n${fields}}\n`;
    text += `export function read${name}(reader: PbfReader, end?: number): ${name};\n`;
    text += `export function write${name}(message: Partial<${name}>, writer: PbfWriter): void;\n`;
    text += types(m, name);
  }
  return text;
}

const declarations = `import type {PbfReader, PbfWriter} from 'pbf';\n\n${types(schema, '')}`;
writeFileSync(new URL('src/live.d.ts', import.meta.url), declarations);
writeFileSync(new URL('src/live.js', import.meta.url), compileRaw(schema));
