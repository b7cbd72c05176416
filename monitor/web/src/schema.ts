// Checks that data of the API is what docs/openapi.yaml says. Further fields are fine: the API may grow.
import {events, type Named, schemas} from './api_types.ts';

interface Schema {
  $ref?: string;
  type?: string | string[];
  enum?: unknown[];
  const?: unknown;
  required?: string[];
  properties?: Record<string, Schema>;
  items?: Schema;
  oneOf?: Schema[];
}

/// The fleet said something that this page does not understand.
export class SchemaError extends Error {}

type Events = typeof events;
export type ApiEvent = {[Kind in keyof Events]: {kind: Kind; data: Named[Events[Kind]]}}[keyof Events];

export function read<Name extends keyof Named>(name: Name, data: unknown): Named[Name] {
  check({$ref: name}, data, name);
  return data as Named[Name];
}

/// Nothing: an event of a kind that this page does not know.
export function readEvent(kind: string, data: unknown): ApiEvent | undefined {
  if (!Object.hasOwn(events, kind)) return undefined;
  return {kind, data: read(events[kind as keyof Events], data)} as ApiEvent;
}

function check(schema: Schema, data: unknown, place: string): void {
  if (schema.$ref) return check((schemas as Record<string, Schema>)[schema.$ref], data, place);
  if (schema.oneOf) return checkOneOf(schema.oneOf, data, place);
  const types = schema.type === undefined ? [] : [schema.type].flat();
  if (types.length > 0 && !types.some((type) => isOf(type, data))) fail(place, data, types.join(' or '));
  if (schema.enum && !schema.enum.includes(data)) fail(place, data, `one of ${schema.enum.join(', ')}`);
  if (schema.const !== undefined && schema.const !== data) fail(place, data, String(schema.const));
  if (Array.isArray(data) && schema.items) data.forEach((each, k) => check(schema.items!, each, `${place}[${k}]`));
  else if (isOf('object', data)) checkFields(schema, data as Record<string, unknown>, place);
}

function checkFields({required = [], properties = {}}: Schema, data: Record<string, unknown>, place: string): void {
  for (const name of required) if (!(name in data)) fail(place, data, `a field ${name}`);
  for (const [name, field] of Object.entries(properties)) if (name in data) check(field, data[name], `${place}.${name}`);
}

function checkOneOf(schemas: Schema[], data: unknown, place: string): void {
  const nullable = schemas.filter(({type}) => type !== 'null');
  if (data === null && nullable.length < schemas.length) return;
  for (const schema of nullable) check(schema, data, place);
}

function isOf(type: string, data: unknown): boolean {
  switch (type) {
    case 'null': return data === null;
    case 'array': return Array.isArray(data);
    case 'integer': return Number.isInteger(data);
    case 'object': return typeof data === 'object' && data !== null && !Array.isArray(data);
    default: return typeof data === type;
  }
}

function fail(place: string, data: unknown, expected: string): never {
  throw new SchemaError(`${place}: ${JSON.stringify(data)?.slice(0, 200)}, expected ${expected}`);
}
