// Makes src/api_types.ts from docs/openapi.yaml: types for the compiler, and the schemas by which the page checks what it
// hears (src/schema.ts). So page and API cannot differ: a field that is not in the description is an error of the compiler,
// and an answer that does not fit it is an error that the page shows. It knows the part of JSON Schema that the file uses.
import {readFileSync, writeFileSync} from 'node:fs';
import {parse} from 'yaml';

const api = parse(readFileSync(new URL('../../docs/openapi.yaml', import.meta.url), 'utf8'));
const {schemas} = api.components;
const events = api.paths['/api/events'].get.responses['200'].content['text/event-stream']['x-events'];

// Limits are the server's to check, and texts are for people.
const left_out = ['description', 'examples', 'default', 'format', 'pattern', 'minLength', 'maxLength', 'minimum', 'maximum',
  'exclusiveMinimum', 'minItems', 'maxItems', 'additionalProperties'];
const known = ['$ref', 'type', 'enum', 'const', 'required', 'properties', 'items', 'oneOf'];

const nameOf = ({$ref}) => $ref.replace('#/components/schemas/', '');
const quoted = (text) => `'${String(text).replaceAll("'", "\\'")}'`;

function typeOf(schema, indent) {
  if (schema.$ref) return nameOf(schema);
  if (schema.oneOf) return schema.oneOf.map((one) => typeOf(one, indent)).join(' | ');
  if (schema.enum) return schema.enum.map(quoted).join(' | ');
  if (schema.const !== undefined) return quoted(schema.const);
  return [schema.type].flat().map((type) => ofOneType(type, schema, indent)).join(' | ');
}

function ofOneType(type, {items, properties, required = []}, indent) {
  if (type === 'integer') return 'number';
  if (type === 'array') return `(${typeOf(items, indent)})[]`;
  if (type !== 'object') return type;
  const fields = Object.entries(properties).map(([name, field]) =>
    `${indent}  ${name}${required.includes(name) ? '' : '?'}: ${typeOf(field, `${indent}  `)};\n`);
  return `{\n${fields.join('')}${indent}}`;
}

/// The schema without what the page does not check.
function bare(schema, place) {
  const entries = Object.entries(schema).filter(([word]) => !left_out.includes(word));
  for (const [word] of entries)
    if (!known.includes(word)) throw new Error(`openapi.yaml: ${place} uses ${word}, which api_types.mjs does not know`);
  return Object.fromEntries(entries.map(([word, value]) => {
    if (word === '$ref') return [word, nameOf(schema)];
    if (word === 'items') return [word, bare(value, `${place}[]`)];
    if (word === 'oneOf') return [word, value.map((one) => bare(one, place))];
    if (word !== 'properties') return [word, value];
    return [word, Object.fromEntries(Object.entries(value).map(([name, field]) => [name, bare(field, `${place}.${name}`)]))];
  }));
}

const types = Object.entries(schemas).map(([name, schema]) => `export type ${name} = ${typeOf(schema, '')};\n`);
const all = Object.fromEntries(Object.entries(schemas).map(([name, schema]) => [name, bare(schema, name)]));
const text = `// Made by api_types.mjs from docs/openapi.yaml.

${types.join('\n')}
/// By the names of schemas.
export interface Named {
${Object.keys(schemas).map((name) => `  ${name}: ${name};\n`).join('')}}

/// What the data of a server-sent event of this kind is.
export const events = ${JSON.stringify(Object.fromEntries(Object.entries(events).map(([kind, schema]) => [kind, nameOf(schema)])))} as const;

export const schemas = ${JSON.stringify(all)};
`;
writeFileSync(new URL('src/api_types.ts', import.meta.url), text);
